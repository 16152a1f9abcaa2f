//! Scenes of two or three bricks meshed apart, one on the other: partly covered, turned, tied or touching in either
//! order of sides, of any ratio of meshes and stiffness, on obstacles of any shape that are displaced or turned, with
//! friction by direction. The sides are plane or curved, contacts may give way, and an elastic foundation may hold a
//! body.

use super::bodies::side;
use super::{Frame, bare, settings};
use crate::apart::{Apart, Bed, Pair, Rest, Rock, Shape};
use crate::dice::Dice;
use crate::recipe::{Density, Elastic, Fixed, Hold, Law, Push, Where};
use crate::vec3::{Vec3, across, add, scale, unit};
use signorini::prelude::*;

/// A rectangle of a body seen from above: centre, angle, lengths.
#[derive(Clone, Copy)]
struct Foot {
    centre: [f64; 2],
    angle: f64,
    lengths: [f64; 2],
}

impl Foot {
    fn corners(&self) -> Vec<[f64; 2]> {
        let (sin, cos) = self.angle.sin_cos();
        let corner = |[a, b]: [f64; 2]| {
            let (x, y) = (0.5 * a * self.lengths[0], 0.5 * b * self.lengths[1]);
            [self.centre[0] + cos * x - sin * y, self.centre[1] + sin * x + cos * y]
        };
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(corner)
            .to_vec()
    }

    /// Area that two rectangles share: one is cut by the sides of the other.
    fn common(&self, other: &Self) -> f64 {
        let (mut left, knife) = (self.corners(), other.corners());
        for k in 0..4 {
            let (a, b) = (knife[k], knife[(k + 1) % 4]);
            let inside = |p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
            let mut kept = Vec::new();
            for i in 0..left.len() {
                let (p, q) = (left[i], left[(i + 1) % left.len()]);
                let (s, t) = (inside(p), inside(q));
                if s >= 0.0 {
                    kept.push(p);
                }
                if (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0) {
                    kept.push([0, 1].map(|c| p[c] + s / (s - t) * (q[c] - p[c])));
                }
            }
            left = kept;
        }
        let next = |k: usize| left[(k + 1) % left.len()];
        let twice = |(k, p): (usize, &[f64; 2])| p[0] * next(k)[1] - p[1] * next(k)[0];
        0.5 * left.iter().enumerate().map(twice).sum::<f64>()
    }
}

/// The scene with a number.
pub(crate) fn apart(seed: u64, number: u64) -> Apart {
    let mut dice = Dice::new(seed ^ 0xa9a7, number);
    let dice = &mut dice;
    let frame = Frame::new(dice);
    let count = if dice.chance(0.7) { 2 } else { 3 };
    let mut words = vec![format!("apart={count}")];
    // with numbers of their own, so that scenes stay what they were without them
    let mut more = Dice::new(seed ^ 0xc0de, number);
    let bumps = if more.chance(0.25) { frame.length * more.decades(1e-3, 0.1) } else { 0.0 };
    if bumps > 0.0 {
        words.push(format!("bumps {:.1e}", bumps / frame.length));
    }
    let mut alike = Dice::new(seed ^ 0xd1a6, number);
    let soft = frame.way / frame.stress;
    let mut gives_way = |words: &mut Vec<String>| {
        let mut one = || {
            if more.chance(0.7) { soft * more.decades(1e-3, 10.0) } else { 0.0 }
        };
        let compliance = [one(), one()];
        if !more.chance(0.25) {
            return [0.0; 2];
        }
        let [normal, along] = compliance;
        words.push(format!("gives way {normal:.0e} {along:.0e}"));
        compliance
    };

    // the bodies: one on the other, or two on the first
    let cells = [dice.whole(2, 5), dice.whole(2, 4), dice.whole(1, 3)];
    let lengths = [dice.between(0.8, 2.5), dice.between(0.7, 1.5), dice.between(0.4, 1.2)].map(|l| l * frame.length);
    let twins = count == 3 && dice.chance(0.5);
    let mut feet = vec![Foot {
        centre: [0.0; 2],
        angle: 0.0,
        lengths: [lengths[0], lengths[1]],
    }];
    let mut seen: Vec<[usize; 3]> = Vec::new();
    let (mut top, mut mesh, mut elastic) = (vec![lengths[2]], None::<TetMesh>, Vec::new());
    let mut pairs: Vec<Pair> = Vec::new();
    for body in 0..count {
        let (mut sizes, mut own, mut origin, mut below) = (lengths, cells, 0.0, 0);
        let mut whole = false;
        let ratio = if body == 0 { 1.0 } else { dice.decades(1.0 / 3.0, 3.0) };
        if body > 0 {
            below = if twins { 0 } else { body - 1 };
            let under = feet[below];
            let kind = dice.whole(0, 3);
            let mut foot = under;
            // the whole side, a smaller part of it, one that hangs over, one that is turned
            if twins {
                foot.lengths[0] *= 0.4;
                foot.centre[0] += (body as f64 - 1.5) * 0.5 * under.lengths[0];
            }
            if kind > 0 {
                foot.lengths = foot.lengths.map(|l| l * dice.between(0.4, 0.9));
            }
            if kind == 2 {
                (0..2).for_each(|c| foot.centre[c] += 0.4 * dice.either() * under.lengths[c]);
            }
            if kind == 3 {
                foot.angle += dice.either();
            }
            words.push(["whole", "part", "over", "turned"][kind].into());
            words.push(format!("ratio {ratio:.2}"));
            sizes = [foot.lengths[0], foot.lengths[1], lengths[2] * dice.between(0.4, 1.0)];
            let edge = |c: usize| lengths[c] / cells[c] as f64 * ratio;
            own = [0, 1, 2].map(|c| ((sizes[c] / edge(c)).round() as usize).clamp(1, 9));
            whole = kind == 0 && !twins;
            // the same nodes on both sides, with the same diagonals or others
            if whole && alike.chance(0.6) {
                own[..2].copy_from_slice(&seen[below][..2]);
                words.push("same nodes".into());
            }
            origin = top[below];
            top.push(origin + sizes[2]);
            feet.push(foot);
        }
        seen.push(own);
        let mut brick = Brick::new(sizes, own).with_origin([-0.5 * sizes[0], -0.5 * sizes[1], origin]);
        if dice.chance(0.3) {
            brick = brick.perturbed(dice.between(0.02, 0.15), dice.seed());
        }
        let foot = feet[body];
        let (sin, cos) = foot.angle.sin_cos();
        let place = |[x, y, z]: Vec3| {
            let [x, y] = [foot.centre[0] + cos * x - sin * y, foot.centre[1] + sin * x + cos * y];
            // flat below, and above the first body by so much higher everywhere
            let [s, t] = [x / lengths[0], y / lengths[1]];
            let lift = bumps * (s * s - 0.7 * s * t - 0.5 * t * t) * (z / lengths[2]).min(1.0);
            frame.turn.place([x, y, z + lift])
        };
        let brick = brick.build().expect("brick").map_tags(|t| side(body, t));
        let tets = brick.tets().len();
        let brick = brick.with_regions(vec![body as u32; tets]).expect("regions");
        let brick = brick.map_points(place).expect("places");
        mesh = Some(mesh.map_or_else(|| brick.clone(), |m| m.append(&brick).expect("bodies")));
        elastic.push(frame.elastic(dice, body, 0.45, &mut words));
        if body == 0 {
            continue;
        }
        let mut sides = [side(body, brick::Z_MIN), side(below, brick::Z_MAX)];
        if dice.chance(0.5) {
            sides.swap(0, 1);
        }
        let tied = dice.chance(0.25);
        let law = if tied { Law::None } else { frame.law(dice) };
        let axis = (law.is_some() && dice.chance(0.3)).then(|| {
            let angle = dice.between(0.0, 3.0);
            (frame.turn.way([angle.cos(), angle.sin(), 0.0]), dice.decades(0.3, 3.0))
        });
        words.push(if tied { "tied" } else { "touching" }.into());
        if axis.is_some() {
            words.push("axis".into());
        }
        pairs.push(Pair {
            sides,
            tied,
            rest: Rest::Measured(0.0),
            growth: None,
            law,
            axis,
            common: foot.common(&feet[below]),
            whole,
            compliance: if tied { [0.0; 2] } else { gives_way(&mut words) },
            motion: None,
        });
    }
    let mesh = mesh.expect("a body");

    // the first body is held below, or lies on a plane or in a hollow of its own
    let mut recipe = bare(dice, (mesh, elastic), frame.clock.clone(), words);
    let mut rocks = Vec::new();
    let tag = |body: usize, tag: FacetTag| Where::Tag(side(body, tag));
    let rough = |dice: &mut Dice, law: Law| {
        let angle = dice.between(0.0, 3.0);
        let axis = (frame.turn.way([angle.cos(), angle.sin(), 0.0]), dice.decades(0.3, 3.0));
        (law.is_some() && dice.chance(0.3)).then_some(axis)
    };
    if dice.chance(0.7) {
        recipe.holds.push(Hold {
            place: tag(0, if dice.chance(0.8) { brick::Z_MIN } else { brick::X_MIN }),
            fixed: Fixed::All,
            motion: None,
        });
    } else {
        let law = Law::Coulomb(dice.between(0.2, 0.8));
        rocks.push(Rock {
            side: side(0, brick::Z_MIN),
            shape: Shape::Plane(frame.turn.place([0.0; 3]), frame.turn.way([0.0, 0.0, 1.0])),
            motion: None,
            turn: None,
            growth: None,
            axis: rough(dice, law.clone()),
            law,
            compliance: gives_way(&mut recipe.words),
        });
        recipe.words.push("on a plane".into());
    }
    // bodies with nothing on them: moved, loaded, or pressed by a ball or a roll
    for body in 1..count {
        if !twins && body + 1 < count {
            continue;
        }
        let sides = side(body, brick::Z_MAX);
        let down = frame.turn.way([0.6 * dice.either(), 0.6 * dice.either(), -1.0]);
        match dice.whole(0, 9) {
            0..=3 => frame.moved(dice, sides, down, &mut recipe),
            4..=6 => frame.loaded(dice, sides, down, &mut recipe),
            _ => {
                recipe.words.push("loose, obstacle".into());
                let radius = frame.length * dice.decades(0.5, 10.0);
                let foot = feet[body].centre;
                let over = frame.turn.place([foot[0], foot[1], top[body] + radius]);
                let shape = if dice.chance(0.5) {
                    Shape::Ball(over, radius)
                } else {
                    Shape::Roll(over, frame.turn.way(unit([1.0, dice.either(), 0.0])), radius)
                };
                let law = frame.law(dice);
                rocks.push(Rock {
                    side: sides,
                    shape,
                    motion: Some((scale(3.0 * frame.way, down), frame.shaft.course(dice))),
                    turn: None,
                    growth: None,
                    axis: rough(dice, law.clone()),
                    law,
                    compliance: gives_way(&mut recipe.words),
                });
            }
        }
        if dice.chance(0.25) {
            recipe.words.push("pull".into());
            let density = Density::Traction(side(body, brick::X_MAX), scale(0.3 * frame.stress, dice.vector()));
            let course = frame.shaft.course(dice);
            recipe.pushes.push(Push { density, course });
        }
    }
    // obstacles that turn where they are, about their own axis or, planes, a little about one in them
    for rock in &mut rocks {
        if !more.chance(0.3) {
            continue;
        }
        let way = frame.way / frame.length;
        let (axis, angle) = match rock.shape {
            Shape::Plane(_, outward) if more.chance(0.5) => (outward, 3.0 * way),
            Shape::Plane(_, outward) => (unit(across(more.vector(), outward)), 0.3 * way),
            Shape::Ball(..) => (unit(more.vector()), 3.0 * way),
            Shape::Roll(_, axis, _) | Shape::Bore(_, axis, _) | Shape::Taper(_, axis, ..) => (axis, 3.0 * way),
        };
        let point = rock.shape.point();
        let course = frame.shaft.course(&mut more).times(angle * more.between(0.2, 1.0));
        rock.turn = Some((point, axis, course));
        recipe.words.push("turns".into());
        // one motion at a time: a ball is pressed in from the start
        if let (Shape::Ball(centre, _) | Shape::Roll(centre, ..), Some((by, _))) = (&mut rock.shape, rock.motion.take())
        {
            *centre = add(*centre, scale(0.3, by));
            rock.turn.as_mut().expect("it turns").0 = *centre;
        }
    }
    let ground = more.chance(0.2).then(|| {
        let stiffness = frame.young / frame.length * more.decades(1e-3, 1e2);
        recipe.words.push("foundation".into());
        let body = more.whole(0, count - 1);
        let tag = side(body, if more.chance(0.5) { brick::Y_MIN } else { brick::X_MIN });
        (
            tag,
            Bed::Components([1.0, more.between(0.1, 1.0), more.between(0.1, 1.0)].map(|k| k * stiffness)),
        )
    });
    // with a dice of its own; straight edges, and no mean volume strain
    if Dice::new(seed ^ 0x0d2, number).chance(0.25) && recipe.mesh.tets().len() <= 400 {
        recipe.mesh = recipe.mesh.raise_order().expect("order 2");
        for elastic in &mut recipe.elastic {
            if let Elastic::Isotropic(_, poisson) = elastic {
                *poisson = poisson.min(0.4);
            }
        }
        recipe.words.push("order 2".into());
    }
    settings::describe(&mut recipe);
    Apart {
        recipe,
        pairs,
        rocks,
        bumps,
        ground,
        grips: Vec::new(),
    }
}
