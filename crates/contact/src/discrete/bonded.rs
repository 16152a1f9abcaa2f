//! What touches where bodies are tied.

use super::extents::Extents;
use super::points::ContactPoint;
use crate::scene::{Contact, Scene};
use signorini_fem_mesh::{Decomposition, FacetTag};
use signorini_tfeti::Side;
use std::collections::{HashMap, HashSet};

/// Takes out what touches at bonded nodes the body that these are bonded to, against which they do not move (nodes
/// behind the side of a tie do), or one that the other side of the tie touches, too.
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
    let mut touched: HashMap<u32, HashSet<usize>> = HashMap::new();
    for c in &*conditions {
        touched.entry(c.node()).or_default().extend(partners(c));
        for (node, _) in c.sides.partner.iter().flat_map(Side::nodes) {
            touched.entry(*node).or_default().insert(body_of(c.node()));
        }
    }
    let mut bonded: HashMap<u32, HashSet<usize>> = HashMap::new();
    for ContactPoint { sides: tie, .. } in ties {
        let both = [Some(&tie.own), tie.partner.as_ref()].map(|side| side.map_or(&[][..], Side::nodes));
        for [side, other] in [both, [both[1], both[0]]] {
            let others = other.iter().filter_map(|(node, _)| touched.get(node)).flatten();
            let all: Vec<usize> = others.copied().chain(tie.nodes().map(|n| body_of(n.0))).collect();
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
