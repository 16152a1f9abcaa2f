//! A cut for a mesh that comes without one: slabs of equal numbers of tetrahedra, made compact.

use super::compact::{compact, join_pieces};
use super::parts::expect_parts;
use super::subdomains::DecompositionError;
use crate::mesh::{FACES, TetMesh, connected_sets};
use crate::tables::{buckets, range};
use crate::tolerances::{FARTHER, FILLED, LIGHTER, REACH, REACHING};
use crate::vec3::{self, Vec3};

/// How many parts [`even_parts`] makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartCount {
    /// So many, but where bodies or groups are more.
    Exactly(usize),
    /// A number near by for which the parts of a body that fills its box are nearest to cubes.
    About(usize),
}

/// Cuts a mesh into connected parts of similar numbers of tetrahedra, as compact as can be.
///
/// `groups` are labels, one for each tetrahedron, of what a part must not mix: materials. Bodies are never mixed. Each
/// connected group gets its share of the parts by its number of tetrahedra, at least one. It is cut into slabs, slabs
/// into columns, columns into blocks, each time across the axis and at the places where the interfaces are smallest: at
/// necks, and between the layers of a structured mesh. What is not compact then is made so as by
/// [`compact_parts`](crate::decomposition::compact_parts). The parts are numbered by their first tetrahedra.
///
/// # Errors
/// [`DecompositionError::PartCount`] if there is not one label for each tetrahedron; [`DecompositionError::NoParts`]
/// for no parts.
pub fn even_parts(mesh: &TetMesh, groups: &[u32], count: PartCount) -> Result<Vec<u32>, DecompositionError> {
    let tets = mesh.tets().len();
    expect_parts(mesh, groups)?;
    let (PartCount::Exactly(number) | PartCount::About(number)) = count;
    if number == 0 {
        return Err(DecompositionError::NoParts);
    }
    let groups = connected_sets(mesh.neighbour_table(), |a, b| groups[a] == groups[b]);
    let (starts, members) = buckets(groups.iter().max().map_or(0, |&g| g as usize + 1), &groups);
    let centres: Vec<Vec3> = (0..tets).map(|tet| vec3::centroid(&mesh.tet_points(tet))).collect();
    let face = |tet: usize, opposite: usize| {
        let points = mesh.tet_points(tet);
        vec3::norm(vec3::area_vector(&FACES[opposite].map(|i| points[i])))
    };
    let cutter = Cutter {
        mesh,
        centres: &centres,
        faces: (0..tets).map(|tet| std::array::from_fn(|k| face(tet, k))).collect(),
    };
    let (mut slabs, mut next) = (vec![0; tets], 0);
    for group in 0..starts.len() - 1 {
        let own = &members[range(&starts, group)];
        let share = (own.len() as f64 / tets as f64 * number as f64).round() as usize;
        let share = share.clamp(1, own.len());
        let pieces = match count {
            PartCount::Exactly(_) => cutter.pieces(own, share),
            PartCount::About(_) => cutter.nearest_to_cubes(own, share),
        };
        for piece in pieces {
            for tet in piece {
                slabs[tet as usize] = next;
            }
            next += 1;
        }
    }
    join_pieces(mesh, &groups, &mut slabs);
    Ok(compact(mesh, &groups, &slabs))
}

struct Cutter<'a> {
    mesh: &'a TetMesh,
    centres: &'a [Vec3],
    /// Areas of the faces of each tetrahedron.
    faces: Vec<[f64; 4]>,
}

/// Slabs across an axis.
struct Slabs {
    /// The tetrahedra along the axis.
    sorted: Vec<u32>,
    /// Where each slab ends, and the parts that it is cut into.
    ends: Vec<(usize, usize)>,
    /// Mean weight of the interfaces between them.
    weight: f64,
}

impl Cutter<'_> {
    /// The cut into a number near `share` whose parts have the least surface for their number, if the tetrahedra fill
    /// their box.
    fn nearest_to_cubes(&self, tets: &[u32], share: usize) -> Vec<Vec<u32>> {
        let (lengths, volume) = self.size(tets);
        let first = self.pieces(tets, share);
        if volume < FILLED * lengths.iter().product::<f64>() {
            return first;
        }
        let edge = (volume / share as f64).cbrt();
        let steps = (-REACH..=REACH).map(|k| edge * (1.0 + 0.02 * f64::from(k)));
        let grid = |edge: f64| lengths.map(|length| (length / edge).round().max(1.0) as usize);
        let mut counts: Vec<usize> = steps.map(|edge| grid(edge).iter().product()).collect();
        counts.retain(|&count| count != share && count <= tets.len());
        counts.sort_by_key(|count| (count.abs_diff(share), *count));
        counts.dedup();
        let measure = |pieces: &[Vec<u32>]| {
            let surface: f64 = pieces.iter().map(|piece| self.box_surface(piece)).sum();
            surface / (pieces.len() as f64).cbrt()
        };
        let mut best = (measure(&first), first);
        for count in counts {
            let pieces = self.pieces(tets, count);
            let found = measure(&pieces);
            if found < (1.0 - 1e-9) * best.0 {
                best = (found, pieces);
            }
        }
        best.1
    }

    /// Cuts these tetrahedra into `count` parts, 1 at least and one a tetrahedron at most.
    fn pieces(&self, tets: &[u32], count: usize) -> Vec<Vec<u32>> {
        let mut out = Vec::with_capacity(count);
        let mut places = vec![u32::MAX; self.centres.len()];
        self.cut(tets.to_vec(), count, &mut places, &mut out);
        out
    }

    /// `places` is work memory, full of `u32::MAX`.
    fn cut(&self, tets: Vec<u32>, count: usize, places: &mut [u32], out: &mut Vec<Vec<u32>>) {
        if count == 1 {
            return out.push(tets);
        }
        let slabs = self.lightest_slabs(tets, count, places);
        let mut start = 0;
        for (end, own) in slabs.ends {
            self.cut(slabs.sorted[start..end].to_vec(), own, places, out);
            start = end;
        }
    }

    /// Of the slabs across each axis, as thick as cubes that share the volume, those with the lightest interfaces.
    fn lightest_slabs(&self, tets: Vec<u32>, count: usize, places: &mut [u32]) -> Slabs {
        let (lengths, volume) = self.size(&tets);
        let edge = (volume / count as f64).cbrt();
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a, &b| lengths[b].total_cmp(&lengths[a]).then(a.cmp(&b)));
        let mut best = Slabs {
            sorted: tets,
            ends: Vec::new(),
            weight: f64::INFINITY,
        };
        for (k, axis) in axes.into_iter().enumerate() {
            let slabs = (lengths[axis] / edge).round() as usize;
            if k > 0 && slabs < 2 {
                break;
            }
            let slabs = slabs.max(2).min(count);
            let place = |tet: u32| self.centres[tet as usize][axis];
            let mut sorted = best.sorted.clone();
            sorted.sort_unstable_by(|&a, &b| place(a).total_cmp(&place(b)).then(a.cmp(&b)));
            let areas = self.interfaces(&sorted, places);
            // where the number of parts does not divide, larger slabs come first, or last
            for first in [true, false] {
                let (ends, weight) = ends(&areas, count, slabs, first);
                if weight < (1.0 - LIGHTER) * best.weight {
                    best = Slabs {
                        sorted: sorted.clone(),
                        ends,
                        weight,
                    };
                }
                if count.is_multiple_of(slabs) {
                    break;
                }
            }
        }
        best
    }

    /// Area of the interface between the first `k` of these tetrahedra and the others.
    fn interfaces(&self, sorted: &[u32], places: &mut [u32]) -> Vec<f64> {
        (0..).zip(sorted).for_each(|(k, &tet)| places[tet as usize] = k);
        let mut areas = vec![0.0; sorted.len() + 1];
        for (k, &tet) in sorted.iter().enumerate() {
            let around = self.mesh.neighbours(tet as usize);
            for (other, area) in around.iter().zip(self.faces[tet as usize]) {
                let Some(other) = other.map(|other| places[other]) else {
                    continue;
                };
                if other != u32::MAX && other as usize > k {
                    areas[k + 1] += area;
                    areas[other as usize + 1] -= area;
                }
            }
        }
        sorted.iter().for_each(|&tet| places[tet as usize] = u32::MAX);
        let mut sum = 0.0;
        areas.iter_mut().for_each(|area| {
            sum += *area;
            *area = sum;
        });
        areas
    }

    /// Edges of the box around these tetrahedra, and their volume.
    fn size(&self, tets: &[u32]) -> (Vec3, f64) {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let mut volume = 0.0;
        for &tet in tets {
            volume += self.mesh.volume(tet as usize);
            for point in self.mesh.tet_points(tet as usize) {
                for d in 0..3 {
                    low[d] = low[d].min(point[d]);
                    high[d] = high[d].max(point[d]);
                }
            }
        }
        (std::array::from_fn(|d| high[d] - low[d]), volume)
    }

    fn box_surface(&self, tets: &[u32]) -> f64 {
        let ([a, b, c], _) = self.size(tets);
        2.0 * (a * b + b * c + c * a)
    }
}

/// Ends of slabs, with the parts of each, and their mean weight, if `areas[k]` is the interface after `k` tetrahedra.
fn ends(areas: &[f64], count: usize, slabs: usize, larger_first: bool) -> (Vec<(usize, usize)>, f64) {
    let tets = areas.len() - 1;
    let (mut out, mut weight) = (Vec::with_capacity(slabs), 0.0);
    let (mut start, mut left) = (0, count);
    for slab in (2..=slabs).rev() {
        let own = if larger_first { left.div_ceil(slab) } else { left / slab };
        let (end, lightest) = end(areas, start, own, left);
        out.push((end, own));
        weight += lightest;
        (start, left) = (end, left - own);
    }
    out.push((tets, left));
    (out, weight / (slabs - 1) as f64)
}

/// The place for an interface near the one that leaves `own` of `left` parts their share, and its weight: the area, and
/// more the farther it is from there.
fn end(areas: &[f64], start: usize, own: usize, left: usize) -> (usize, f64) {
    let tets = areas.len() - 1 - start;
    let middle = (tets as f64 * own as f64 / left as f64).round() as usize;
    let middle = middle.clamp(own, tets - (left - own));
    let smaller = middle.min(tets - middle) as f64;
    let reach = (REACHING * smaller) as usize;
    let from = middle.saturating_sub(reach).max(own);
    let to = (middle + reach).min(tets - (left - own));
    let weight = |k: usize| areas[start + k] * (1.0 + FARTHER * k.abs_diff(middle) as f64 / smaller);
    let best = (from..=to).fold((middle, weight(middle)), |best, k| match weight(k) {
        found if found < (1.0 - LIGHTER) * best.1 => (k, found),
        _ => best,
    });
    (start + best.0, best.1)
}
