//! Distances of the nodes of a facet from what covers it.

use super::cover::{Flat, Laid, Piece, Point, area, barycentric, mean};
use crate::tolerances::OVERLAP;

/// The distances of the corners of a facet from the curve that pieces stand for, m, if they or the facet itself are
/// bent, as the arcs over its `own` edges tell.
pub(super) fn curve(corners: &[Point; 3], own: [f64; 3], pieces: &[Piece]) -> Option<[f64; 3]> {
    let arcs = pieces.iter().map(|piece| piece.laid.arcs).chain([own]);
    let is_bent = arcs.flatten().any(|arc| arc != 0.0);
    if !is_bent || !are_covered(corners, pieces) {
        return None;
    }
    let mut out = [0.0; 3];
    for (out, p) in out.iter_mut().zip(corners) {
        let laid = nearest(pieces, *p)?;
        let (l, shape) = laid.shape(*p);
        let arc: f64 = (0..3).map(|k| 4.0 * laid.arcs[k] * l[k] * l[(k + 1) % 3]).sum();
        *out = laid.height(&shape) - arc;
    }
    Some(out)
}

fn are_covered(corners: &[Point; 3], pieces: &[Piece]) -> bool {
    let covered: f64 = pieces.iter().map(|piece| piece.area).sum();
    covered >= (1.0 - OVERLAP) * area(corners)
}

/// The triangle in which a point of the plane is, or outside of which least.
fn nearest(pieces: &[Piece], p: Point) -> Option<&Laid> {
    let inside = |piece: &Piece| {
        let coordinates = barycentric(&piece.laid.corners, p);
        coordinates.into_iter().fold(f64::INFINITY, f64::min)
    };
    let nearest = pieces.iter().max_by(|a, b| inside(a).total_cmp(&inside(b)));
    nearest.map(|piece| &piece.laid)
}

/// The gaps at the nodes of a quadratic facet, m, where pieces cover it: each from the piece that is nearest in the
/// plane. `None` where a part is not covered.
pub(super) fn gaps(own: &Flat, pieces: &[Piece]) -> Option<[f64; 6]> {
    own.nodes?;
    if !are_covered(&own.corners, pieces) {
        return None;
    }
    let height = |p: Point| {
        let laid = nearest(pieces, p)?;
        Some(laid.height(&laid.shape(p).1))
    };
    let mut gaps = [0.0; 6];
    for k in 0..3 {
        let [bend_x, bend_y] = own.bend.map_or([0.0; 2], |bend| bend[k]);
        let [x, y] = mean(own.corners[k], own.corners[(k + 1) % 3]);
        gaps[k] = height(own.corners[k])?;
        gaps[3 + k] = height([x + bend_x, y + bend_y])? - own.heights[k];
    }
    Some(gaps)
}
