//! Contacts that cross: nodes of a contact between bodies that another contact has, too.
//!
//! With conditions of both, rows along a surface nearly depend on one another where meshes do not match, and active
//! sets run in circles. Flush sides hand theirs on to the neighbours (`mortar`). A side that several contacts have, as
//! a lintel on its posts, is crossed only where it is folded: along one normal their conditions are on other bodies.

use crate::mortar::MortarNode;
use crate::scene::{Contact, Gap, Scene};
use crate::tolerances::{FLUSH, SHARP};
use signorini_fem_mesh::vec3::{area_vector, dot, unit};
use signorini_fem_mesh::{FacetTag, Surface, TetMesh};
use std::collections::{HashMap, HashSet};

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
    let tags: HashSet<FacetTag> = others.flat_map(|(_, contact)| contact.side_tags()).collect();
    let has = |tag: &FacetTag| group.iter().any(|k| scene.contacts[*k].side_tags().any(|t| t == *tag));
    let (shared, others): (HashSet<FacetTag>, HashSet<FacetTag>) = tags.into_iter().partition(has);
    let mut out: HashSet<u32> = others.into_iter().flat_map(|tag| scene.mesh.nodes_on(tag)).collect();
    out.extend(folds(&scene.mesh, &shared));
    out
}

/// Nodes at which facets with these tags meet at an angle.
fn folds(mesh: &TetMesh, tags: &HashSet<FacetTag>) -> HashSet<u32> {
    let mut out = HashSet::new();
    let mut normals: HashMap<u32, Vec<[f64; 3]>> = HashMap::new();
    let facets = mesh.facets().iter().enumerate();
    for (k, facet) in facets.filter(|(_, facet)| tags.contains(&facet.tag)) {
        let normal = unit(area_vector(&mesh.facet_points(k)));
        for node in facet.nodes {
            let known = normals.entry(node).or_default();
            if known.iter().any(|other| dot(*other, normal) < SHARP) {
                out.insert(node);
            }
            known.push(normal);
        }
    }
    out
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
