//! Whether sides of quadratic elements touch along a ridge, or in a place narrower than their facets.
//!
//! There a point sees the gap in the mean over the facets around it. A gap that opens from a node has a mean that is
//! larger than at the node, which is then inside the other side before the point touches. The means of the neighbours
//! tell the gap at the node, as if it were linear between the corners.

use super::recovered::Recovered;
use crate::model::{ConstrainedPoint, Model};
use crate::report::Warning;
use crate::tolerances::{EDGE_OVERLAP, NARROW};
use crate::vec3::norm;
use signorini_fem_mesh::vec3::dot;
use std::collections::HashMap;

/// What a point sees: its own weight, and other points with theirs.
pub(super) type View = (f64, Vec<(usize, f64)>);

/// Of each contact point; empty in a mesh of order 1.
pub(super) fn views(model: &Model) -> Vec<View> {
    let mesh = &model.scene.mesh;
    if mesh.order() == 1 {
        return Vec::new();
    }
    let mut ends: HashMap<u32, [u32; 2]> = HashMap::new();
    for surface in &model.discrete.surfaces {
        for (triangle, &facet) in surface.triangles().iter().zip(surface.facets()) {
            let [a, b, c] = triangle.map(|n| surface.nodes()[n as usize]);
            let mids = mesh.facet_mids(facet as usize).into_iter().flatten();
            ends.extend(mids.zip([[a, b], [b, c], [c, a]]));
        }
    }
    let mut at_node: HashMap<(usize, u32), Vec<usize>> = HashMap::new();
    for (k, point) in model.points.iter().enumerate() {
        at_node.entry((point.surface(), point.node())).or_default().push(k);
    }
    let view = |(own, point): (usize, &ConstrainedPoint)| {
        let normal = &point.contact.frame.normal;
        // of several points of a node that with the normal which is most like the own one
        let alike = |k: &usize| dot(model.points[*k].contact.frame.normal, *normal);
        let of = |node: u32| {
            let all = at_node.get(&(point.surface(), node))?;
            all.iter().copied().max_by(|a, b| alike(a).total_cmp(&alike(b)))
        };
        let (mut weight, mut others) = (0.0, Vec::new());
        for &(node, share) in point.contact.sides.own.nodes() {
            let ends = ends.get(&node).copied().unwrap_or([node; 2]);
            for seen in ends.map(|end| of(end).unwrap_or(own)) {
                if seen == own { weight += 0.5 * share } else { others.push((seen, 0.5 * share)) }
            }
        }
        (weight, others)
    };
    model.points.iter().enumerate().map(view).collect()
}

/// The node that is deepest inside, where that is much of the way by which its contact has closed, or of a tenth of the
/// largest displacement.
pub(super) fn narrow_contact(
    model: &Model,
    views: &[View],
    (recovered, u): (&Recovered, &[f64]),
    step: usize,
) -> Option<Warning> {
    if views.is_empty() {
        return None;
    }
    let points = &recovered.points;
    let largest = u.chunks_exact(3).map(norm).fold(0.0, f64::max);
    let least = (EDGE_OVERLAP * largest).max(model.discrete.rounding) / NARROW;
    let mut way = vec![least; model.scene.contacts.len()];
    for (point, state) in model.points.iter().zip(points) {
        let own = &mut way[point.surface()];
        *own = own.max((point.gap() - state.gap).abs()).max(-point.gap());
    }
    let inside = |own: usize, gap: &dyn Fn(usize) -> f64| {
        let (weight, others) = &views[own];
        let seen: f64 = others.iter().map(|(other, share)| share * gap(*other)).sum();
        (seen - gap(own)) / weight
    };
    let overlaps = (0..points.len()).filter(|own| !model.scene.contacts[points[*own].surface].tied);
    let parts = overlaps.map(|own| {
        // where a gap was not linear at first, as before an edge of the other side, that tells nothing
        let first = inside(own, &|k| model.points[k].gap()).max(0.0);
        let now = inside(own, &|k| points[k].gap);
        (&points[own], (now - first) / way[points[own].surface])
    });
    let finite = parts.filter(|own| own.1.is_finite());
    let (point, part) = finite.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (part > NARROW).then(|| Warning::NarrowContact {
        step,
        contact: point.surface,
        node: point.node,
        place: model.scene.mesh.points()[point.node as usize],
        overlap: part * way[point.surface],
        way: way[point.surface],
    })
}
