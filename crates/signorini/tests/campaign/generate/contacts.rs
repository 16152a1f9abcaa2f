//! Contact surfaces: between bodies, with a floor, with walls.

use super::Shaft;
use super::bodies::{SPLIT, World, side};
use super::laws::{field, law, word};
use crate::dice::Dice;
use crate::recipe::{Course, Distance, Law, Recipe, Touch};
use crate::vec3::{Vec3, add, scale, unit};
use signorini::prelude::*;

pub(crate) fn contacts(dice: &mut Dice, world: &World, shaft: &Shaft, recipe: &mut Recipe) {
    for body in 1..world.count {
        between(dice, world, shaft, body, recipe);
    }
    let floor = if world.count == 1 { 0.9 } else { 0.4 };
    if dice.chance(floor) {
        lower(dice, world, shaft, recipe);
    }
    for (tag, often) in [(brick::X_MAX, 0.2), (brick::Y_MIN, 0.08)] {
        if dice.chance(often) {
            let body = dice.whole(0, world.count - 1);
            let touch = obstacle(dice, world, shaft, side(body, tag), "wall", recipe);
            recipe.touches.push(touch);
        }
    }
}

/// The lower side of the first body.
fn lower(dice: &mut Dice, world: &World, shaft: &Shaft, recipe: &mut Recipe) {
    let tag = brick::Z_MIN;
    let mut first = obstacle(dice, world, shaft, tag, "floor", recipe);
    if world.split {
        if dice.chance(0.4) {
            first.tags.push(SPLIT);
            recipe.words.push("two tags".into());
        } else {
            // parts of one floor: those that share nodes have to move alike, which functions cannot be seen to do
            if let Some((_, course @ Course::Wave { .. })) = &mut first.motion {
                *course = Course::Constant(1.0);
            }
            let mut second = first.clone();
            second.tags = vec![SPLIT];
            second.law = law(dice, world, shaft, world.centre(SPLIT));
            recipe.words.push(format!("part[{}]", word(&second.law)));
            if let (Distance::Constant(gap), true) = (&mut second.distance, dice.chance(0.5)) {
                *gap += world.way() * dice.between(0.0, 0.3);
                recipe.words.push("step".into());
            }
            recipe.touches.push(second);
        }
    } else if world.flat && dice.chance(0.07) {
        first.tags.push(brick::X_MAX);
        // two directions have no plane in common
        first.direction = None;
        first.distance = Distance::Constant(world.way() * dice.between(0.0, 0.5));
        recipe.words.push("around the edge".into());
    } else if world.flat && dice.chance(0.06) {
        groove(dice, world, shaft, tag, recipe);
        return;
    }
    recipe.touches.push(first);
}

/// Two half-spaces for one side.
fn groove(dice: &mut Dice, world: &World, shaft: &Shaft, tag: FacetTag, recipe: &mut Recipe) {
    let (n, t) = (world.normal(tag), world.along(dice, tag));
    let tilt = dice.between(0.3, 0.8);
    for sign in [-1.0, 1.0] {
        let outward = unit(add(scale(-1.0, n), scale(sign * tilt, t)));
        let law = law(dice, world, shaft, world.centre(tag));
        let far = scale(-0.3 * world.way() * dice.unit(), outward);
        recipe.words.push(format!("groove[{}]", word(&law)));
        recipe.touches.push(Touch {
            tags: vec![tag],
            partner: None,
            distance: Distance::Plane(add(deepest(world, tag, outward), far), outward),
            direction: None,
            motion: None,
            law,
        });
    }
}

/// The point of a side that is nearest to a plane with this normal out of the obstacle.
fn deepest(world: &World, tag: FacetTag, outward: Vec3) -> Vec3 {
    let points = world
        .mesh
        .nodes_on(tag)
        .into_iter()
        .map(|n| world.mesh.points()[n as usize]);
    let height = |p: &Vec3| crate::vec3::dot(*p, outward);
    points
        .min_by(|a, b| height(a).total_cmp(&height(b)))
        .expect("a side has nodes")
}

/// A rigid obstacle at a side.
fn obstacle(dice: &mut Dice, world: &World, shaft: &Shaft, tag: FacetTag, name: &str, recipe: &mut Recipe) -> Touch {
    let (n, centre) = (world.normal(tag), world.centre(tag));
    let law = law(dice, world, shaft, centre);
    let mut touch = Touch {
        tags: vec![tag],
        partner: None,
        distance: Distance::Touching,
        direction: None,
        motion: None,
        law,
    };
    let way = world.way() * dice.between(0.0, 0.5);
    let kind = match dice.whole(0, 9) {
        0..=2 => "touching",
        3..=5 => {
            touch.distance = Distance::Constant(way);
            "constant"
        }
        6 => {
            touch.distance = Distance::Field(field(dice, world, centre, 0.0, 2.0 * way));
            "field"
        }
        7 | 8 => {
            // tilted a little, so that one edge meets it first
            let lean = scale(world.strain * dice.unit(), world.along(dice, tag));
            let outward = unit(add(scale(-1.0, n), lean));
            let point = add(deepest(world, tag, outward), scale(-way, outward));
            touch.distance = Distance::Plane(point, outward);
            "half-space"
        }
        _ => {
            let lean = scale(0.2 * dice.unit(), world.along(dice, tag));
            touch.direction = Some(unit(add(n, lean)));
            touch.distance = Distance::Constant(way);
            "direction"
        }
    };
    if dice.chance(0.1) && matches!(touch.distance, Distance::Constant(_)) {
        touch.distance = Distance::Constant(-0.3 * way);
        recipe.words.push("interference".into());
    }
    let mut moved = "";
    if dice.chance(0.2) {
        let mut by = scale(world.way() * dice.between(0.1, 1.0), dice.vector());
        if matches!(touch.distance, Distance::Field(_)) {
            // "moved fields"
            by = scale(if world.flat { 0.5 * world.way() * dice.either() } else { 0.0 }, n);
        }
        touch.motion = Some((by, shaft.course(dice)));
        moved = " moved";
    }
    recipe.words.push(format!("{name}[{kind}{moved} {}]", word(&touch.law)));
    touch
}

/// A body and the one below.
fn between(dice: &mut Dice, world: &World, shaft: &Shaft, body: usize, recipe: &mut Recipe) {
    let below = world.below[body];
    let (own, other) = (side(body, brick::Z_MIN), side(below, brick::Z_MAX));
    let same = world.mesh.nodes_on(own).len() == world.mesh.nodes_on(other).len();
    let (tag, partner) = if same && dice.chance(0.3) { (other, own) } else { (own, other) };
    let mut law = law(dice, world, shaft, world.centre(tag));
    if matches!(law, Law::None) && dice.chance(0.7) {
        law = Law::Coulomb(dice.between(0.1, 0.5));
    }
    let way = world.way();
    let (kind, distance) = match dice.whole(0, 9) {
        0..=6 => ("measured", Distance::Measured),
        7 => ("constant", Distance::Constant(way * dice.between(-0.2, 0.4))),
        8 => {
            let centre = world.centre(tag);
            ("field", Distance::Field(field(dice, world, centre, 0.0, 0.3 * way)))
        }
        _ => ("touching", Distance::Touching),
    };
    recipe.words.push(format!("between[{kind} {}]", word(&law)));
    recipe.touches.push(Touch {
        tags: vec![tag],
        partner: Some(partner),
        distance,
        direction: None,
        motion: None,
        law,
    });
}
