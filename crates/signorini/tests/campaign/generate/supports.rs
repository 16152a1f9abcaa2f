//! Supports: clamps, planes, presses, oblique ones, lists of nodes, moved or not.

use super::Shaft;
use super::bodies::{World, side};
use crate::dice::Dice;
use crate::mechanics::Mechanics;
use crate::recipe::{Course, Fixed, Hold, Recipe, Where};
use crate::spots::spots;
use crate::vec3::{Vec3, across, add, cross, dot, norm, scale, sub, unit};
use signorini::prelude::*;
use std::collections::HashMap;

pub(crate) fn supports(dice: &mut Dice, world: &World, shaft: &Shaft, recipe: &mut Recipe) {
    for body in 0..world.count {
        let base = body == 0 && world.count > 1;
        let kind = dice.whole(0, 19);
        match kind {
            _ if base && kind <= 6 => hold(dice, world, recipe, side(body, brick::Z_MIN), "bed"),
            0..=5 => {
                hold(dice, world, recipe, side(body, brick::X_MIN), "clamp");
                if dice.chance(0.25) {
                    moved(dice, world, shaft, side(body, brick::X_MIN), recipe);
                }
            }
            6..=9 => planes(dice, world, recipe, body),
            10..=14 => {
                let top = side(body, brick::Z_MAX);
                hold(dice, world, recipe, top, "press");
                moved(dice, world, shaft, top, recipe);
            }
            15..=17 => some_nodes(dice, world, shaft, recipe, body),
            18 => oblique(dice, world, recipe, body),
            _ => recipe.words.push("free".into()),
        }
        if dice.chance(0.15) {
            let more = [planes, oblique][dice.whole(0, 1)];
            more(dice, world, recipe, body);
        }
    }
    tidy(dice, recipe);
    let loose = loose(recipe);
    if loose > 0 {
        recipe.words.push(format!("loose {loose}"));
    }
}

/// Rigid motions of the bodies that supports leave free, for contact to stop.
fn loose(recipe: &Recipe) -> usize {
    let mesh = &recipe.mesh;
    let body = mesh.components();
    let nodes_of = |b: u32| {
        let cells = mesh.tets().iter().zip(&body).filter(move |(_, of)| **of == b);
        cells.flat_map(|(t, _)| *t).collect::<std::collections::HashSet<u32>>()
    };
    let count = body.iter().max().map_or(0, |b| b + 1);
    let mut free = 0;
    for b in 0..count {
        let own = nodes_of(b);
        let size = own.iter().map(|n| mesh.points()[*n as usize]);
        let centre = scale(1.0 / own.len() as f64, size.clone().fold([0.0; 3], add));
        let radius = size.map(|x| norm(sub(x, centre))).fold(0.0, f64::max);
        // rows of work on the six motions, made orthogonal one by one
        let mut basis: Vec<[f64; 6]> = Vec::new();
        for hold in &recipe.holds {
            let nodes = hold
                .nodes(mesh)
                .into_iter()
                .enumerate()
                .filter(|(_, n)| own.contains(n));
            for (place, node) in nodes {
                let arm = scale(1.0 / radius, sub(mesh.points()[node as usize], centre));
                for v in hold.fixed.vectors(place, mesh.points()[node as usize]) {
                    let (d, m) = (unit(v), cross(arm, unit(v)));
                    let mut row = [d[0], d[1], d[2], m[0], m[1], m[2]];
                    for e in &basis {
                        let along: f64 = row.iter().zip(e).map(|(a, b)| a * b).sum();
                        row.iter_mut().zip(e).for_each(|(r, e)| *r -= along * e);
                    }
                    let length = row.iter().map(|r| r * r).sum::<f64>().sqrt();
                    if length > 1e-6 {
                        basis.push(row.map(|r| r / length));
                    }
                }
            }
        }
        free += 6 - basis.len();
    }
    free
}

fn put(recipe: &mut Recipe, word: &str, place: Where, fixed: Fixed) {
    recipe.words.push(word.into());
    recipe.holds.push(Hold {
        place,
        fixed,
        motion: None,
    });
}

/// All components of a side, or of half of its nodes.
fn hold(dice: &mut Dice, world: &World, recipe: &mut Recipe, tag: FacetTag, word: &str) {
    let place = if dice.chance(0.8) {
        Where::Tag(tag)
    } else {
        let nodes = world.mesh.nodes_on(tag);
        let part = nodes.len().div_ceil(2).max(3.min(nodes.len()));
        Where::Nodes(nodes[..part].to_vec())
    };
    put(recipe, word, place, Fixed::All);
}

/// Moves the last support.
fn moved(dice: &mut Dice, world: &World, shaft: &Shaft, tag: FacetTag, recipe: &mut Recipe) {
    let n = world.normal(tag);
    let press = scale(-world.way() * dice.between(0.0, 1.0), n);
    let drag = scale(world.way() * dice.between(0.0, 1.0), world.along(dice, tag));
    let by = match dice.whole(0, 2) {
        0 => press,
        1 => drag,
        _ => add(press, drag),
    };
    let course = shaft.course(dice);
    if let Some(last) = recipe.holds.last_mut() {
        last.motion = Some((vec![by], course));
        recipe.words.push("moved".into());
    }
}

/// Along the normals of two sides.
fn planes(dice: &mut Dice, world: &World, recipe: &mut Recipe, body: usize) {
    let mut tags = vec![brick::X_MIN, brick::Y_MIN];
    if dice.chance(0.3) {
        tags.push(brick::Z_MAX);
    }
    for tag in tags {
        let tag = side(body, tag);
        let n = world.normal(tag);
        let axis = (0..3).find(|&c| n[c].abs() > 1.0 - 1e-12);
        let fixed = match axis {
            Some(axis) => Fixed::Components([0, 1, 2].map(|c| c == axis)),
            None => Fixed::Vectors(vec![scale(dice.between(0.5, 2.0), n)]),
        };
        put(recipe, "plane", Where::Tag(tag), fixed);
    }
}

/// A list of nodes of one side, all held or each moved by itself.
fn some_nodes(dice: &mut Dice, world: &World, shaft: &Shaft, recipe: &mut Recipe, body: usize) {
    let tag = side(body, [brick::X_MIN, brick::X_MAX, brick::Z_MAX][dice.whole(0, 2)]);
    let mut nodes = world.mesh.nodes_on(tag);
    let least = 3.min(nodes.len());
    let keep = dice.whole(least, nodes.len());
    while nodes.len() > keep {
        nodes.remove(dice.whole(0, nodes.len() - 1));
    }
    let count = nodes.len();
    put(recipe, "nodes", Where::Nodes(nodes), Fixed::All);
    if dice.chance(0.5) {
        let way = 0.3 * world.way();
        let values = (0..count).map(|_| scale(way, dice.vector())).collect();
        let course = shaft.course(dice);
        if let Some(last) = recipe.holds.last_mut() {
            last.motion = Some((values, course));
            recipe.words.push("moved each".into());
        }
    }
}

/// Any one or two directions of a side.
fn oblique(dice: &mut Dice, world: &World, recipe: &mut Recipe, body: usize) {
    let tag = side(body, [brick::X_MIN, brick::X_MAX, brick::Y_MAX][dice.whole(0, 2)]);
    let mut directions = vec![dice.vector()];
    if dice.chance(0.5) {
        directions.push(dice.vector());
    }
    directions.retain(|d| norm(*d) > 0.1);
    if directions.is_empty() {
        directions.push([1.0, 0.5, 0.2]);
    }
    put(recipe, "oblique", Where::Tag(tag), Fixed::Vectors(directions));
    if dice.chance(0.3) {
        let by = scale(0.5 * world.way(), dice.vector());
        let course = Course::Table(vec![(0.0, 0.0), (1.0, 1.0)]);
        if let Some(last) = recipe.holds.last_mut() {
            last.motion = Some((vec![by], course));
            recipe.words.push("moved".into());
        }
    }
}

/// Takes nodes out of supports: where two of them would contradict each other, and mostly where a support would push a
/// contact node through its obstacle.
fn tidy(dice: &mut Dice, recipe: &mut Recipe) {
    let bold = dice.chance(0.03);
    let mechanics = Mechanics::new(recipe);
    // normals at which contact is met, and whether the obstacle comes or is inside at rest
    let mut met: HashMap<u32, Vec<(Vec3, bool)>> = HashMap::new();
    for spot in spots(recipe, &mechanics) {
        let touch = &recipe.touches[spot.contact];
        let comes = touch.motion.is_some() || spot.gap < 0.0;
        for node in std::iter::once(spot.node).chain(spot.partner) {
            met.entry(node).or_default().push((spot.normal, comes));
        }
    }
    let mut held: HashMap<u32, (Vec<Vec3>, bool)> = HashMap::new();
    let holds = std::mem::take(&mut recipe.holds);
    for mut hold in holds {
        let nodes = hold.nodes(&recipe.mesh);
        let moves = hold.motion.is_some();
        let mut kept = Vec::new();
        for (place, &node) in nodes.iter().enumerate() {
            let (mut basis, moved) = held.get(&node).cloned().unwrap_or_default();
            let contradict = !basis.is_empty() && (moves || moved);
            for v in hold.fixed.vectors(place, recipe.mesh.points()[node as usize]) {
                let rest = basis.iter().fold(unit(v), |d, e| across(d, *e));
                if norm(rest) > 1e-6 {
                    basis.push(unit(rest));
                }
            }
            let along = |n: Vec3| basis.iter().map(|d| dot(*d, n).powi(2)).sum::<f64>().sqrt();
            let wrong = met.get(&node).is_some_and(|met| {
                met.iter()
                    .any(|&(n, comes)| along(n) > 0.5 && !bold && (moves || comes))
            });
            if !wrong && !contradict {
                held.insert(node, (basis, moves || moved));
                kept.push(place);
            }
        }
        if kept.len() < nodes.len() {
            hold.place = Where::Nodes(kept.iter().map(|k| nodes[*k]).collect());
            if let Some((values, _)) = hold.motion.as_mut().filter(|m| m.0.len() > 1) {
                *values = kept.iter().map(|k| values[*k]).collect();
            }
        }
        if !kept.is_empty() {
            recipe.holds.push(hold);
        }
    }
}
