//! What touches where bodies are tied, and ties of nodes that several contacts tie.

use super::couplings::Couplings;
use super::extents::Extents;
use super::points::ContactPoint;
use super::side::Sides;
use crate::scene::{Contact, Scene};
use signorini_fem_mesh::{Decomposition, FacetTag};
use signorini_tfeti::Side;
use std::collections::{HashMap, HashSet};

/// Takes out what touches at bonded nodes the body that these are bonded to, against which they do not move (nodes
/// behind the side of a tie do), and of two conditions of both sides of a tie against a third body one.
pub(super) fn leave_bonded(
    scene: &Scene,
    decomposition: &Decomposition,
    ties: &[ContactPoint],
    conditions: &mut Vec<ContactPoint>,
) {
    let mesh = &scene.mesh;
    let tied = scene.contacts.iter().filter(|c| c.tied && scene.acts(c.span));
    let tags: HashSet<FacetTag> = tied.flat_map(Contact::side_tags).collect();
    let sides = mesh.facets().iter().filter(|f| tags.contains(&f.tag));
    let sides: HashSet<u32> = sides.flat_map(|f| f.nodes).collect();
    let extents = Extents::new(mesh, decomposition);
    let body_of = |node: u32| extents.body(node as usize);
    let bodies = |side: &Side| -> Vec<usize> { side.nodes().iter().map(|n| body_of(n.0)).collect() };
    let partners = |c: &ContactPoint| c.sides.partner.as_ref().map_or(Vec::new(), bodies);
    // bodies that conditions of a node touch, and those whose conditions touch it
    let [mut touched, mut met] = [(); 2].map(|()| HashMap::<u32, HashSet<usize>>::new());
    for c in &*conditions {
        touched.entry(c.node()).or_default().extend(partners(c));
        for (node, _) in c.sides.partner.iter().flat_map(Side::nodes) {
            met.entry(*node).or_default().insert(body_of(c.node()));
        }
    }
    let mut bonded: HashMap<u32, HashSet<usize>> = HashMap::new();
    for ContactPoint { sides: tie, .. } in ties {
        let mut both = [Some(&tie.own), tie.partner.as_ref()].map(|side| side.map_or(&[][..], Side::nodes));
        // of what both touch the body that comes first keeps the conditions, however ties are named
        both.sort_by_key(|side| side.first().map(|(node, _)| body_of(*node)));
        for (side, other, is_first) in [(both[0], both[1], true), (both[1], both[0], false)] {
            let kept = |node: &u32| touched.get(node).filter(|_| !is_first);
            let others = other
                .iter()
                .flat_map(|(node, _)| met.get(node).into_iter().chain(kept(node)));
            let all: Vec<usize> = others
                .flatten()
                .copied()
                .chain(tie.nodes().map(|n| body_of(n.0)))
                .collect();
            for (node, _) in side.iter().filter(|(node, _)| sides.contains(node)) {
                bonded.entry(*node).or_default().extend(&all);
            }
        }
    }
    conditions.retain(|c| {
        let left = bonded.get(&c.node());
        !left.is_some_and(|left| partners(c).iter().any(|body| left.contains(body)))
    });
}

/// Leaves out what an earlier tie says of the same sides, as at the seam of two contacts.
pub(super) fn tie_once(scene: &Scene, couplings: &Couplings, ties: &mut Vec<ContactPoint>) {
    let moves = |contact: usize| (&scene.contacts[contact].motions, couplings.relative(contact));
    let mut known: HashMap<u32, Vec<(Sides, usize)>> = HashMap::new();
    ties.retain(|tie| {
        let earlier = known.entry(tie.node()).or_default();
        let says = |(sides, contact): &(Sides, usize)| *sides == tie.sides && moves(*contact) == moves(tie.surface);
        let is_new = !earlier.iter().any(says);
        if is_new {
            earlier.push((tie.sides.clone(), tie.surface));
        }
        is_new
    });
}
