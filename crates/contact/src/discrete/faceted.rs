//! Overlaps of bodies that touch, which are there because straight facets stand for a curve.
//!
//! Nodes are on the curve. Facets of a hollow side are before it, and nodes of the other side behind them; those of a
//! convex side are behind it and only open gaps.

use super::partners::Paired;
use super::points::ContactPoint;
use crate::scene::{Gap, Scene};
use crate::tolerances::{FACETED, WITHIN_FACETS};
use signorini_fem_mesh::vec3::{add, cross, dot, norm, scale, sub};
use signorini_fem_mesh::{Surface, TetMesh};

/// A contact whose overlap is measured between facets that are too far from the curve that they stand for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FacetedOverlap {
    pub(crate) contact: usize,
    /// Where it is deepest.
    pub(crate) node: u32,
    pub(crate) place: [f64; 3],
    /// Both m.
    pub(crate) overlap: f64,
    pub(crate) sagitta: f64,
    /// How many points began within facets and now touch; none where one overlap at least is more than that.
    pub(crate) closed: usize,
}

/// Closes the overlaps of a contact if none is deeper than facets of a hollow side are before the curve, and tells which
/// contacts overlap about as much as facets are beside it. Gaps that are told, and those that a history makes grow, are
/// meant.
pub(super) fn close_faceted(
    scene: &Scene,
    paired: &[Paired],
    conditions: &mut [ContactPoint],
    rounding: f64,
) -> Vec<FacetedOverlap> {
    let mut out = Vec::new();
    for (index, paired) in paired.iter().enumerate().filter(|(_, p)| p.is_apart()) {
        let contact = &scene.contacts[index];
        let first = conditions.partition_point(|c| c.surface < index);
        let end = conditions.partition_point(|c| c.surface <= index);
        let points = &mut conditions[first..end];
        if !matches!(contact.gap, Gap::Measured) || contact.gap_history.is_some() {
            continue;
        }
        let mut inside = points.iter().enumerate().filter(|(_, p)| p.gap < -rounding).peekable();
        if inside.peek().is_none() {
            continue;
        }
        let tags = if paired.swapped {
            &contact.tags
        } else {
            &contact.partner
        };
        let Ok(other) = Surface::new(&scene.mesh, tags) else {
            continue;
        };
        let sides = [&paired.surface, &other];
        let sagittas = sides.map(|side| sagittas(&scene.mesh, side));
        let of = |point: &ContactPoint| {
            let nodes = point.sides.nodes().map(|n| n.0);
            let known = nodes.flat_map(|node| {
                let at = |k: usize| Some(sagittas[k][sides[k].nodes().binary_search(&node).ok()?]);
                [at(0), at(1)]
            });
            known.flatten().fold([0.0; 2], larger)
        };
        let inside: Vec<(usize, [f64; 2])> = inside.map(|(k, point)| (k, of(point))).collect();
        let deepest = inside.iter().min_by(|a, b| points[a.0].gap.total_cmp(&points[b.0].gap));
        let Some(&(deepest, [sagitta, _])) = deepest else { continue };
        let point = &points[deepest];
        let overlap = -point.gap;
        if sagitta <= FACETED * overlap || are_over(&scene.mesh, point, sides, sagitta) {
            continue;
        }
        let is_faceted = inside.iter().all(|&(k, [_, hollow])| -points[k].gap <= WITHIN_FACETS * hollow);
        let found = FacetedOverlap {
            contact: index,
            node: point.node(),
            place: point.position,
            overlap,
            sagitta,
            closed: if is_faceted { inside.len() } else { 0 },
        };
        if is_faceted {
            inside.iter().for_each(|&(k, _)| points[k].gap = 0.0);
        }
        out.push(found);
    }
    out
}

/// Whether the nodes around a point have others over them, so that facets are as far from the curve on both sides.
fn are_over(mesh: &TetMesh, point: &ContactPoint, [own, other]: [&Surface; 2], within: f64) -> bool {
    let place = |node: &u32| mesh.points()[*node as usize];
    let is_over = |local: &u32| {
        let (from, normal) = (
            place(&own.nodes()[*local as usize]),
            own.frames()[*local as usize].normal,
        );
        let across = |to: &u32| norm(cross(sub(place(to), from), normal));
        other.nodes().iter().any(|to| across(to) <= within)
    };
    let at = |t: &&[u32; 3]| t.iter().any(|&n| own.nodes()[n as usize] == point.node());
    own.triangles().iter().filter(at).all(|nodes| nodes.iter().all(is_over))
}

fn larger(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].max(b[1])]
}

/// For each node of a surface the largest distance, m, of the middle of an edge from the arc between its ends, of the
/// facets at the node; none where mid-nodes are on it. Beside it that of hollow arcs.
fn sagittas(mesh: &TetMesh, surface: &Surface) -> Vec<[f64; 2]> {
    let mut out = vec![[0.0; 2]; surface.nodes().len()];
    for (&facet, t) in surface.facets().iter().zip(surface.triangles()) {
        let mids = (mesh.order() == 2).then(|| mesh.facet_mids(facet as usize));
        let far = |k: usize| {
            let place = |node: u32| mesh.points()[node as usize];
            let [a, b] = [t[k], t[(k + 1) % 3]].map(|n| n as usize);
            let [from, to] = [a, b].map(|n| place(surface.nodes()[n]));
            let [m, n] = [a, b].map(|n| surface.frames()[n].normal);
            let arc = 0.125 * dot(sub(to, from), sub(n, m));
            let off = mids.map_or([0.0; 3], |mids| sub(place(mids[k]), scale(0.5, add(from, to))));
            // at rims normals are those of one facet, and an arc seems to be half as high
            let bent = 0.5 * dot(off, add(m, n)) * arc.signum() > 0.5 * arc.abs();
            if bent { [0.0; 2] } else { [arc.abs(), -arc] }
        };
        let far = (0..3).map(far).fold([0.0; 2], larger);
        t.iter().for_each(|&n| out[n as usize] = larger(out[n as usize], far));
    }
    out
}
