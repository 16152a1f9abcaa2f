//! The part of a facet that facets of the other side cover, and the means of shape functions that multipliers take
//! there.
//!
//! With `P` the L2 projection on linear functions on the covered part `C` of a facet with corners `x_j`, a multiplier
//! takes of a function `f` the integral `int_C psi_j f = d_j (P f)(x_j)`, `d_j = int_C l_j` (docs/theory.md, section 5;
//! A. Popp, B. I. Wohlmuth, M. W. Gee, W. A. Wall, SIAM J. Sci. Comput. 34, 2012). On quadratic facets it is half the
//! sum of that and of the shape function of the corner, but where a gap opens from the rim; edges that are bent in the
//! plane, as at the rim of a disc, count.
//!
//! A node beyond the cover would press with a lever that the cover does not have. Where flat sides may part `P f` is taken
//! at the border instead, on the way from the corner to the middle of `C`.

use super::pieces::{Flat, Piece, Point, barycentric, cross, place, sub};
use crate::tolerances::{AT_BORDER, NO_EXTENT};
use signorini_fem_mesh::internal::{facet_shape, triangle};

/// The covered part of a facet.
#[derive(Debug, Clone)]
pub(super) struct Cover {
    /// Area of the part, m².
    pub(super) area: f64,
    /// `d_j`, m², of the three corners.
    pub(super) areas: [f64; 3],
    /// Of each node of the other side the integrals of its shape function times the multipliers of the corners, m².
    pub(super) weights: Vec<(u32, [f64; 3])>,
    /// The same of the nodes of the facet, unless each multiplier has that of its own corner alone.
    pub(super) own: Vec<(u32, [f64; 3])>,
    /// The same of the ways to triangles that are not in the plane of the facet, m³.
    pub(super) ways: [f64; 3],
    /// The smallest distance of the other side over the part, m; negative inside.
    pub(super) nearest: f64,
}

/// Adds to what a node has.
fn add(weights: &mut Vec<(u32, [f64; 3])>, node: u32, values: [f64; 3]) {
    match weights.iter_mut().find(|w| w.0 == node) {
        Some((_, sum)) => (0..3).for_each(|j| sum[j] += values[j]),
        None => weights.push((node, values)),
    }
}

/// What the multipliers of the corners take of functions on a covered part, by the moments of these.
struct Multipliers {
    area: f64,
    centre: Point,
    areas: [f64; 3],
    /// What is projected onto linear functions and evaluated at the place of a corner is these times the moments of a
    /// function.
    kernel: [[f64; 3]; 3],
    /// Shape functions of the facet at the places, where these are not the corners.
    places: Option<[[f64; 3]; 3]>,
    /// The same of the shape functions of a quadratic facet, unless it is to have dual functions alone.
    hats: Option<[[f64; 3]; 3]>,
}

impl Multipliers {
    /// `None` without pieces.
    fn new(own: &Flat, pieces: &[Piece], (dual, within): (bool, bool)) -> Option<Self> {
        let facet = &own.corners;
        let (mut area, mut first) = (0.0, [0.0; 2]);
        for piece in pieces {
            piece.integrate(None, |p, w| {
                area += w;
                (0..2).for_each(|c| first[c] += w * p[c]);
            });
        }
        if area <= 0.0 {
            return None;
        }
        let centre = first.map(|f| f / area);
        let mut second = [0.0; 3];
        for piece in pieces {
            piece.integrate(None, |p, w| {
                let [x, y] = sub(p, centre);
                second[0] += w * x * x;
                second[1] += w * x * y;
                second[2] += w * y * y;
            });
        }
        let inverse = pseudo_inverse(second);
        let shares = if within { facet.map(|corner| reach(pieces, centre, corner)) } else { [1.0; 3] };
        let kernel = [0, 1, 2].map(|j| {
            let [x, y] = sub(facet[j], centre).map(|d| shares[j] * d);
            [
                area.recip(),
                inverse[0] * x + inverse[1] * y,
                inverse[1] * x + inverse[2] * y,
            ]
        });
        let middle = barycentric(facet, centre);
        let moved = shares != [1.0; 3];
        let plain = middle.map(|l| area * l);
        let areas = if moved {
            // of the triangle of the places, which has the same middle
            let parts = [0, 1, 2].map(|j| middle[j] / shares[j]);
            parts.map(|part| area * part / parts.iter().sum::<f64>())
        } else {
            plain
        };
        let shape_at = |j: usize| {
            let own = |i| if i == j { shares[j] } else { 0.0 };
            [0, 1, 2].map(|i| (1.0 - shares[j]) * middle[i] + own(i))
        };
        let hat = |j: usize| {
            let [from, to] = [facet[(j + 1) % 3], facet[(j + 2) % 3]];
            let [x, y] = sub(to, from).map(|d| d / cross(sub(to, from), sub(facet[j], from)));
            [plain[j] / area, -y, x]
        };
        Some(Self {
            area,
            centre,
            areas,
            kernel,
            places: (moved && own.nodes.is_none()).then(|| [0, 1, 2].map(shape_at)),
            hats: own.nodes.filter(|_| !dual).map(|_| [0, 1, 2].map(hat)),
        })
    }

    /// Adds to the moments of functions what these values at a point are, of some weight.
    fn add(&self, moments: &mut [[f64; 3]], values: &[f64], p: Point, w: f64) {
        let [x, y] = sub(p, self.centre);
        for (moments, value) in moments.iter_mut().zip(values) {
            let value = w * value;
            moments[0] += value;
            moments[1] += value * x;
            moments[2] += value * y;
        }
    }

    /// What they take of one.
    fn of_one(&self) -> [f64; 3] {
        match &self.hats {
            Some(hats) => [0, 1, 2].map(|j| 0.5 * (self.areas[j] + self.area * hats[j][0])),
            None => self.areas,
        }
    }

    /// What they take of a function with these moments.
    fn take(&self, moments: &[f64; 3]) -> [f64; 3] {
        let times = |a: &[f64; 3]| a.iter().zip(moments).map(|(a, b)| a * b).sum::<f64>();
        let dual = [0, 1, 2].map(|j| self.areas[j] * times(&self.kernel[j]));
        match &self.hats {
            Some(hats) => [0, 1, 2].map(|j| 0.5 * (dual[j] + times(&hats[j]))),
            None => dual,
        }
    }
}

impl Cover {
    /// The cover of a facet by pieces that do not overlap, with `dual` functions alone or not; `None` without pieces.
    /// Of a plane facet with nodes `within` those outside the cover have their places at its border.
    pub(super) fn new(own: &Flat, pieces: &[Piece], dual: bool, within: Option<[u32; 3]>) -> Option<Self> {
        let multipliers = Multipliers::new(own, pieces, (dual, within.is_some()))?;
        let rule = own.nodes.map(|_| triangle());
        let (mut weights, mut here, mut ways) = (Vec::new(), [[0.0; 3]; 6], [[0.0; 3]]);
        for piece in pieces {
            let laid = &piece.laid;
            let mut there = [[0.0; 3]; 10];
            piece.integrate(rule.as_deref(), |p, w| {
                let mut height = 0.0;
                if own.nodes.is_some() {
                    let shape = facet_shape(&place(&own.corners, own.bend.as_ref(), p));
                    multipliers.add(&mut here, &shape, p, w);
                    height = (0..3).map(|k| shape[3 + k] * own.heights[k]).sum();
                }
                let (l, plain) = laid.shape(p);
                let Some(way) = &laid.way else {
                    return multipliers.add(&mut there, &plain, p, w);
                };
                let far = laid.height(&plain) - height;
                let shape = way.shape(&l, &plain, far);
                multipliers.add(&mut there, &shape, p, w);
                multipliers.add(&mut ways, &[far], p, w);
            });
            for (node, moments) in laid.all_nodes().zip(&there) {
                add(&mut weights, node, multipliers.take(moments));
            }
        }
        let own = own.nodes.into_iter().flatten().zip(&here);
        let mut own: Vec<_> = own.map(|(node, moments)| (node, multipliers.take(moments))).collect();
        if let (Some(nodes), Some(places)) = (within, &multipliers.places) {
            let areas = &multipliers.areas;
            let of = |i: usize| [0, 1, 2].map(|j| areas[j] * places[j][i]);
            own.extend([0, 1, 2].map(|i| (nodes[i], of(i))));
        }
        Some(Self {
            area: multipliers.area,
            areas: multipliers.of_one(),
            weights,
            own,
            ways: multipliers.take(&ways[0]),
            nearest: pieces.iter().map(|piece| piece.nearest).fold(f64::INFINITY, f64::min),
        })
    }
}

/// The part of the way from the middle of the pieces to a corner that is within them, the last one where there are
/// several; all of it if there is none.
fn reach(pieces: &[Piece], centre: Point, corner: Point) -> f64 {
    let way = sub(corner, centre);
    let most = way[0].hypot(way[1]);
    let within = |piece: &Piece| {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (k, &p) in piece.polygon.iter().enumerate() {
            let side = sub(piece.polygon[(k + 1) % piece.polygon.len()], p);
            let length = side[0].hypot(side[1]);
            // between corners that differ by rounding it goes anywhere
            if length <= AT_BORDER * most {
                continue;
            }
            let (start, slope) = (cross(side, sub(centre, p)), cross(side, way));
            let rounding = AT_BORDER * length * most;
            match (start + rounding) / -slope {
                t if slope < 0.0 => to = to.min(t),
                t if slope > 0.0 => from = from.max(t),
                _ if start < -rounding => to = -1.0,
                _ => {}
            }
        }
        (from <= to).then_some(to)
    };
    let found = pieces.iter().filter_map(within).fold(0.0, f64::max);
    if found > 0.0 && found < 1.0 - AT_BORDER { found } else { 1.0 }
}

/// Inverse of a symmetric matrix `[xx, xy, yy]` of second moments, without directions in which there is no extent.
fn pseudo_inverse([xx, xy, yy]: [f64; 3]) -> [f64; 3] {
    let (mean, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let (large, small) = (mean + half, (xx * yy - xy * xy) / (mean + half));
    if small > NO_EXTENT * large {
        let det = large * small;
        return [yy / det, -xy / det, xx / det];
    }
    // the direction of the larger one: a column of the matrix minus the smaller one
    let [x, y] = if xx > yy { [xx, xy] } else { [xy, yy] };
    let scale = large * (x * x + y * y);
    [x * x / scale, x * y / scale, y * y / scale]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mortar::pieces::Laid;

    /// Two large triangles in their own rows and one small one: parts of the plane beside a facet.
    fn laid(corners: [Point; 3], first: u32) -> Laid {
        Laid {
            corners,
            nodes: [first, first + 1, first + 2],
            mids: None,
            bend: None,
            heights: [0.0; 6],
            arcs: [0.0; 3],
            way: None,
        }
    }

    /// On any covered part the weights take linear functions to their values at the corners, and sum to the areas.
    #[test]
    fn linear_functions_are_taken_to_the_corners() {
        let facet = [[0.0, 0.0], [1.0, 0.1], [0.2, 0.9]];
        let covers = [
            vec![laid([[-3.0, -3.0], [5.0, -3.0], [-3.0, 5.0]], 0)],
            vec![laid([[0.3, 0.2], [0.4, 0.2], [0.3, 0.31]], 0)],
            vec![laid([[-3.0, 0.05], [5.0, 0.05], [5.0, 0.0500001]], 0)],
            vec![
                laid([[0.5, -1.0], [2.0, 0.0], [0.5, 1.0]], 0),
                laid([[0.3, 0.0], [0.5, 0.2], [0.3, 2.0]], 3),
            ],
        ];
        let linear = |p: Point| 2.0 - 3.0 * p[0] + 0.7 * p[1];
        for laid in covers {
            let pieces: Vec<Piece> = laid.iter().filter_map(|&l| Piece::new(&facet, l)).collect();
            assert_eq!(pieces.len(), laid.len());
            let flat = Flat {
                corners: facet,
                nodes: None,
                bend: None,
                heights: [0.0; 3],
            };
            let cover = Cover::new(&flat, &pieces, false, None).expect("covered");
            let sum: f64 = pieces.iter().map(|p| p.area).sum();
            assert!((cover.area - sum).abs() < 1e-15 && (cover.areas.iter().sum::<f64>() - sum).abs() < 1e-15);
            for (j, &corner) in facet.iter().enumerate() {
                let place = |node: u32| laid[node as usize / 3].corners[node as usize % 3];
                let of = |f: &dyn Fn(Point) -> f64| -> f64 {
                    cover.weights.iter().map(|(node, w)| w[j] * f(place(*node))).sum()
                };
                let size = cover.areas[j].abs();
                assert!((of(&|_| 1.0) - cover.areas[j]).abs() < 1e-10 * size);
                // of a part without extent the constant along it only
                if sum > 1e-4 {
                    assert!(
                        (of(&linear) - cover.areas[j] * linear(corner)).abs() < 1e-10 * size,
                        "{j}"
                    );
                }
            }
        }
    }

    /// Whatever rounding makes of corners that coincide: a facet that is all covered has its places at its corners. One
    /// of them was taken for a third of the way there, in one of fifty turns of these sides.
    #[test]
    fn corners_of_a_covered_facet_are_within_however_it_lies() {
        // cells of 2/3 x 1/3, halved as in a brick, under half a cell of 1/2 x 1/2
        let grid = |k: usize| [2.0 / 3.0 * (k % 4) as f64, 1.0 / 3.0 * (k / 4) as f64];
        let cells = (0..11).filter(|k| k % 4 != 3);
        let halves: Vec<[usize; 3]> = cells.flat_map(|k| [[k, k + 1, k + 5], [k, k + 5, k + 4]]).collect();
        let facets = [
            [[0.5, 0.0], [1.0, 0.0], [1.0, 0.5]],
            [[1.0, 0.0], [1.0, 0.5], [0.5, 0.5]],
        ];
        for turn in 0..500 {
            let (sin, cos) = (0.1 + 0.01 * f64::from(turn)).sin_cos();
            let lie = |[x, y]: Point| [cos * x - sin * y + 0.3, sin * x + cos * y - 0.7];
            for facet in facets.map(|facet| facet.map(lie)) {
                let pieces = halves
                    .iter()
                    .filter_map(|half| Piece::new(&facet, laid(half.map(|k| lie(grid(k))), 0)));
                let pieces: Vec<Piece> = pieces.collect();
                let flat = Flat {
                    corners: facet,
                    nodes: None,
                    bend: None,
                    heights: [0.0; 3],
                };
                let cover = Cover::new(&flat, &pieces, false, Some([0, 1, 2])).expect("covered");
                for area in cover.areas {
                    assert!((area - 0.125 / 3.0).abs() < 1e-9, "{turn}: {:?}", cover.areas);
                }
            }
        }
    }
}
