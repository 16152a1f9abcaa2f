//! Loads of all kinds, mostly towards the obstacles.

use super::Shaft;
use super::bodies::{World, side};
use super::laws::field;
use crate::dice::Dice;
use crate::recipe::{Density, Push, Recipe};
use crate::vec3::{add, scale};
use signorini::prelude::*;

pub(crate) fn loads(dice: &mut Dice, world: &World, shaft: &Shaft, recipe: &mut Recipe) {
    let stress = world.stress();
    let mut push = |word: &str, density: Density, dice: &mut Dice| {
        recipe.words.push(word.into());
        recipe.pushes.push(Push {
            density,
            course: shaft.course(dice),
        });
    };
    for body in 0..world.count {
        let top = side(body, brick::Z_MAX);
        let free = !(1..world.count).any(|b| world.below[b] == body);
        if free && dice.chance(0.75) {
            // down, and less along
            let down = scale(-dice.between(0.1, 1.0), world.normal(top));
            let along = scale(0.3 * dice.unit(), world.along(dice, top));
            push("top", Density::Traction(top, scale(stress, add(down, along))), dice);
        }
        if dice.chance(0.3) {
            let tag = side(body, brick::X_MAX);
            push("pull", Density::Traction(tag, scale(0.4 * stress, dice.vector())), dice);
        }
        if dice.chance(0.12) {
            let tag = side(body, brick::Y_MAX);
            push("pressure", Density::Pressure(tag, 0.5 * stress * dice.either()), dice);
        }
        if dice.chance(0.12) {
            let tag = side(body, brick::X_MAX);
            let centre = world.centre(tag);
            let part = |dice: &mut Dice| field(dice, world, centre, -0.3 * stress, 0.3 * stress);
            let density = Density::TractionField(tag, [part(dice), part(dice), part(dice)], part(dice));
            push("traction field", density, dice);
        }
        if dice.chance(0.12) {
            let tag = side(body, brick::Y_MIN);
            let force = 0.3 * stress * world.area(tag);
            let nodes = world.mesh.nodes_on(tag);
            let one = |dice: &mut Dice| {
                let node = nodes[dice.whole(0, nodes.len() - 1)];
                (node, scale(force / 3.0, dice.vector()))
            };
            let forces = vec![one(dice), one(dice), one(dice)];
            push("nodal", Density::Nodes(forces), dice);
        }
    }
    let down = scale(-1.0, world.normal(brick::Z_MAX));
    if dice.chance(0.25) {
        let along = scale(0.2, dice.vector());
        let weight = stress / world.length * dice.between(0.1, 0.8);
        push("weight", Density::Body(scale(weight, add(down, along))), dice);
    }
    if dice.chance(0.1) {
        let centre = world.centre(brick::Z_MAX);
        let high = 0.3 * stress / world.length;
        let part = |dice: &mut Dice| field(dice, world, centre, -high, high);
        push(
            "weight field",
            Density::BodyField([part(dice), part(dice), part(dice)]),
            dice,
        );
    }
}
