//! Scenes of bodies meshed apart, parts of whose sides are rigid couplings: free, held, moved or loaded; also one that
//! holds two bodies together.

use super::bodies::side;
use super::{Shaft, apart, settings};
use crate::apart::Apart;
use crate::dice::Dice;
use crate::grip::Grip;
use crate::recipe::{Density, Elastic, Fixed, Hold, Push, Solver, Where};
use crate::vec3::{Vec3, add, cross, dot, norm, scale, sub};
use signorini::prelude::*;
use std::collections::HashSet;

const SIDES: [FacetTag; 6] = [
    brick::Z_MAX,
    brick::X_MAX,
    brick::X_MIN,
    brick::Y_MAX,
    brick::Y_MIN,
    brick::Z_MIN,
];

/// Nodes of a tag.
fn nodes_of(mesh: &TetMesh, tag: FacetTag) -> Vec<u32> {
    let (place, fixed) = (Where::Tag(tag), Fixed::All);
    let motion = None;
    Hold { place, fixed, motion }.nodes(mesh)
}

/// The scene with a number.
pub(crate) fn grip(seed: u64, number: u64) -> Apart {
    let mut scene = apart::apart(seed ^ 0x9219, number);
    let mut dice = Dice::new(seed ^ 0x6219, number);
    let dice = &mut dice;
    let count = 1 + usize::from(dice.chance(0.3));
    let mut tries = 0..8;
    let bodies = scene.recipe.mesh.distinct_regions().len();
    while scene.grips.len() < count && tries.next().is_some() {
        // mostly in the place of a support
        let body = if dice.chance(0.6) { bodies - 1 } else { dice.whole(0, bodies - 1) };
        let at = if dice.chance(0.4) { 0 } else { dice.whole(0, 5) };
        let mut tags = vec![side(body, SIDES[at])];
        if dice.chance(0.15) && bodies > 1 {
            tags.push(side((body + 1) % bodies, SIDES[at]));
        }
        let mut other = scene.clone();
        if dice.chance(0.8) {
            let is_here = |hold: &Hold| matches!(hold.place, Where::Tag(tag) if tags.contains(&tag));
            other.recipe.holds.retain(|hold| !is_here(hold));
        }
        // what loads do to nodes that are held is no strain, but estimates are relative to it, too
        let is_here = |push: &Push| matches!(push.density, Density::Traction(tag, _) if tags.contains(&tag));
        other.recipe.pushes.retain(|push| !is_here(push));
        let Some(grip) = one(dice, &other, &tags) else {
            continue;
        };
        scene = other;
        let kind = match grip.held {
            [true, true, true, true, true, true] => "held",
            held if held.contains(&true) => "guided",
            _ => "free",
        };
        let moved = if grip.motion.is_some() { " moved" } else { "" };
        let loaded = if grip.load.is_some() { " loaded" } else { "" };
        let loose = if kind == "held" { "" } else { "loose, " };
        let words = format!(
            "{loose}coupling {kind}{moved}{loaded}, {} nodes, {} sides",
            grip.nodes.len(),
            tags.len()
        );
        scene.recipe.words.push(words);
        scene.grips.push(grip);
    }
    if scene.recipe.how.solver != Solver::Face {
        // KNOWN: stiff foundations
        scene.ground = None;
    }
    settings::describe(&mut scene.recipe);
    scene
}

/// A coupling on some sides, where nothing else is that it could contradict.
fn one(dice: &mut Dice, scene: &Apart, tags: &[FacetTag]) -> Option<Grip> {
    let (recipe, mesh) = (&scene.recipe, &scene.recipe.mesh);
    let points = mesh.points();
    let mut taken: HashSet<u32> = recipe.holds.iter().flat_map(|hold| hold.nodes(mesh)).collect();
    taken.extend(scene.grips.iter().flat_map(|grip| &grip.nodes));
    taken.extend(scene.rocks.iter().flat_map(|rock| nodes_of(mesh, rock.side)));
    for pair in &scene.pairs {
        let sides = pair.sides.map(|tag| nodes_of(mesh, tag));
        let gripped = |nodes: &[u32]| scene.grips.iter().any(|g| nodes.iter().any(|n| g.nodes.contains(n)));
        // what is tied would be left out of the check
        let both = pair.tied || tags.len() > 1;
        if both || gripped(&sides[0]) {
            taken.extend(&sides[1]);
        }
        if both || gripped(&sides[1]) {
            taken.extend(&sides[0]);
        }
        // nodes at the rim of one side may be on the other
        if scene.bumps > 0.0 && pair.tied {
            return None;
        }
    }
    let mut nodes: Vec<u32> = tags.iter().flat_map(|tag| nodes_of(mesh, *tag)).collect();
    nodes.retain(|n| !taken.contains(n));
    let place = |n: &u32| points[*n as usize];
    let centre = |nodes: &[u32]| {
        let sum = nodes.iter().fold([0.0; 3], |sum, n| add(sum, place(n)));
        scale(1.0 / nodes.len() as f64, sum)
    };
    if dice.chance(0.4) && tags.len() == 1 && !nodes.is_empty() {
        let (middle, way) = (centre(&nodes), dice.vector());
        nodes.retain(|n| dot(sub(place(n), middle), way) >= 0.0);
    }
    // three that are not on a line
    let first = place(nodes.first()?);
    let arms = || nodes.iter().map(|n| sub(place(n), first));
    let longest = arms().fold([0.0; 3], |a, b| if norm(b) > norm(a) { b } else { a });
    let off = arms().map(|arm| norm(cross(arm, longest))).fold(0.0, f64::max);
    if off <= 1e-2 * dot(longest, longest) {
        return None;
    }
    let length = norm(longest);
    let reference = add(centre(&nodes), scale(length * dice.between(0.0, 1.5), dice.vector()));
    let young = match recipe.elastic.first()? {
        Elastic::Isotropic(young, _) => *young,
        Elastic::Matrix(matrix) => matrix[0][0],
    };
    let strain = dice.decades(1e-4, 1e-2);
    let held: [bool; 6] = match dice.whole(0, 3) {
        0 => [true; 6],
        1 => [false; 6],
        _ => std::array::from_fn(|_| dice.chance(0.5)),
    };
    let way = |dice: &mut Dice| -> [f64; 6] {
        std::array::from_fn(|c| strain * dice.either() * if c < 3 { length } else { 0.5 })
    };
    let shaft = Shaft::new(&recipe.clock);
    let motion = (dice.chance(0.7) && held.contains(&true)).then(|| {
        let motion = way(dice);
        (
            std::array::from_fn(|c| if held[c] { motion[c] } else { 0.0 }),
            shaft.course(dice),
        )
    });
    let load = dice.chance(0.6).then(|| {
        let size = 0.3 * young * strain * length * length;
        let lever: Vec3 = scale(0.3 * length * size, dice.vector());
        ([scale(size, dice.vector()), lever], shaft.course(dice))
    });
    Some(Grip {
        nodes,
        reference,
        held,
        motion,
        load,
    })
}
