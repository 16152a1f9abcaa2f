//! Contacts that cross: nodes of a contact between bodies that another contact has, too.
//!
//! With conditions of both, rows along a surface nearly depend on one another where meshes do not match, and active
//! sets run in circles. Flush sides hand theirs on to the neighbours (`mortar`).

use crate::mortar::MortarNode;
use crate::scene::{Contact, Gap, Scene};
use crate::tolerances::FLUSH;
use signorini_fem_mesh::{Surface, TetMesh};
use std::collections::HashSet;

/// Nodes at which other contacts have conditions that may nearly depend on those of one between linear meshes, or of a
/// group that goes on in one another: friction of either acts along normals of the other. Of two between bodies the
/// first keeps its conditions.
pub(super) fn crossing(scene: &Scene, group: &[usize]) -> HashSet<u32> {
    let (index, own) = (group[0], &scene.contacts[group[0]]);
    if own.tied || own.partner.is_empty() || scene.mesh.order() == 2 {
        return HashSet::new();
    }
    let times = scene.analysis.times();
    let crosses = |(other, contact): &(usize, &Contact)| {
        let keeps = !group.contains(other) && (contact.partner.is_empty() || *other < index);
        let is_rough = |k: &usize| scene.contacts[*k].friction().is_some();
        let rough = group.iter().any(is_rough) || contact.friction().is_some();
        keeps && rough && !contact.tied && own.span.meets(&contact.span, times)
    };
    let others = scene.contacts.iter().enumerate().filter(crosses);
    let tags = others.flat_map(|(_, contact)| contact.tags.iter().chain(&contact.partner));
    tags.flat_map(|tag| scene.mesh.nodes_on(*tag)).collect()
}

/// Those of these nodes around which the gap is the same: where sides open from an edge on, that edge alone may touch.
pub(super) fn flush(
    mesh: &TetMesh,
    contact: &Contact,
    surface: &Surface,
    seen: &[Option<MortarNode>],
    nodes: &HashSet<u32>,
) -> HashSet<u32> {
    let mut out = match contact.gap {
        Gap::None | Gap::Constant(_) | Gap::Measured => nodes.clone(),
        Gap::Field(_) | Gap::Obstacle => HashSet::new(),
    };
    let gap = |local: usize| {
        let seen = seen[local].as_ref()?;
        let from = mesh.points()[surface.nodes()[local] as usize];
        match contact.gap {
            Gap::Measured => Some(seen.gap(mesh, from, &seen.frame.normal)),
            _ => Some(0.0),
        }
    };
    for triangle in surface.triangles() {
        let corners = triangle.map(|local| local as usize);
        if !corners.iter().any(|&local| out.contains(&surface.nodes()[local])) {
            continue;
        }
        let gaps = corners.map(gap);
        for (local, own) in corners.into_iter().zip(gaps) {
            let within = FLUSH * surface.areas()[local].sqrt();
            let same = |other: &Option<f64>| other.zip(own).is_some_and(|(a, b)| (a - b).abs() <= within);
            if !gaps.iter().all(same) {
                out.remove(&surface.nodes()[local]);
            }
        }
    }
    out
}
