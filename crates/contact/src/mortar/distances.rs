//! Distances of the nodes of a facet from what covers it.

use super::pieces::{Flat, Laid, Piece, Point, area, barycentric, mean};
use crate::tolerances::OVERLAP;

/// The distances of the corners of a facet from the curve that pieces stand for, m, if they or the facet itself are
/// bent, as the arcs over its `own` edges tell. Of a corner beyond all pieces that of both curves where these end.
/// `None` where an arc is not known: a distance would be that of facets on one side.
pub(super) fn curve(corners: &[Point; 3], own: [f64; 3], pieces: &[Piece]) -> Option<[f64; 3]> {
    let arcs = pieces.iter().map(|piece| piece.laid.arcs).chain([own]);
    let mut arcs = arcs.flatten();
    if arcs.clone().all(|arc| arc == 0.0) || arcs.any(f64::is_nan) {
        return None;
    }
    let height = |arcs: &[f64; 3], l: &[f64; 3]| -> f64 { (0..3).map(|k| 4.0 * arcs[k] * l[k] * l[(k + 1) % 3]).sum() };
    let mut out = [0.0; 3];
    for (out, p) in out.iter_mut().zip(corners) {
        let (laid, q) = nearest(pieces, *p)?;
        let (l, shape) = laid.shape(q);
        let own = height(&own, &barycentric(corners, q));
        *out = laid.height(&shape) - height(&laid.arcs, &l) - own;
    }
    Some(out)
}

fn are_covered(corners: &[Point; 3], pieces: &[Piece]) -> bool {
    let covered: f64 = pieces.iter().map(|piece| piece.area).sum();
    covered >= (1.0 - OVERLAP) * area(corners)
}

/// The triangle in which a point of the plane is, with that point, or where pieces end nearest to it.
fn nearest(pieces: &[Piece], p: Point) -> Option<(&Laid, Point)> {
    let to = pieces.iter().map(|piece| (piece, piece.closest(p)));
    let found = to.min_by(|a, b| a.1.0.total_cmp(&b.1.0));
    found.map(|(piece, (_, q))| (&piece.laid, q))
}

/// The gaps at the nodes of a quadratic facet, m, where pieces cover it: each from the piece that is nearest in the
/// plane. `None` where a part is not covered.
pub(super) fn gaps(own: &Flat, pieces: &[Piece]) -> Option<[f64; 6]> {
    own.nodes?;
    if !are_covered(&own.corners, pieces) {
        return None;
    }
    let height = |p: Point| {
        let (laid, _) = nearest(pieces, p)?;
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
