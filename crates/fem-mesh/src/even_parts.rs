//! A cut for a mesh that comes without one: slabs of equal numbers of tetrahedra, made compact.

use crate::buckets::{buckets, range};
use crate::compact::{compact, join_pieces};
use crate::decomposition::DecompositionError;
use crate::mesh::{TetMesh, connected_sets};
use crate::vec3::{self, Vec3};

/// Part of a slab's tetrahedra by which its end may move to a gap between layers of tetrahedra.
const SNAP: f64 = 0.15;

/// Cuts a mesh into about `count` connected parts of similar numbers of tetrahedra, as compact as cubes.
///
/// `groups` are labels, one for each tetrahedron, of what a part must not mix: materials that differ much. Bodies are never mixed. Each group
/// gets its share of the parts by its number of tetrahedra, at least one. A group is cut across the longest edge of its box into slabs, slabs
/// into columns, columns into blocks; cells of a structured mesh stay whole where their number allows it. What is not compact then is made so
/// as by [`compact_parts`](crate::compact_parts). The parts are numbered by their first tetrahedra.
///
/// # Errors
/// [`DecompositionError::PartCount`] if there is not one label for each tetrahedron; [`DecompositionError::NoParts`] if `count` is zero.
pub fn even_parts(
    mesh: &TetMesh,
    groups: &[u32],
    count: usize,
) -> Result<Vec<u32>, DecompositionError> {
    let tets = mesh.tets().len();
    if groups.len() != tets {
        return Err(DecompositionError::PartCount {
            given: groups.len(),
            tets,
        });
    }
    if count == 0 {
        return Err(DecompositionError::NoParts);
    }
    let groups = connected_sets(mesh.neighbour_table(), |a, b| groups[a] == groups[b]);
    let number = groups.iter().max().map_or(0, |&g| g as usize + 1);
    let (starts, members) = buckets(number, &groups);
    let centres: Vec<Vec3> = (0..tets)
        .map(|tet| vec3::centroid(&mesh.tet_points(tet)))
        .collect();
    let mut cutter = Cutter {
        mesh,
        centres: &centres,
        parts: vec![0; tets],
        next: 0,
    };
    for group in 0..number {
        let own = &members[range(&starts, group)];
        let share = (own.len() as f64 / tets as f64 * count as f64).round() as usize;
        cutter.cut(&mut own.to_vec(), share.clamp(1, own.len()));
    }
    let mut slabs = cutter.parts;
    join_pieces(mesh, &groups, &mut slabs);
    Ok(compact(mesh, &groups, &slabs))
}

struct Cutter<'a> {
    mesh: &'a TetMesh,
    centres: &'a [Vec3],
    parts: Vec<u32>,
    next: u32,
}

impl Cutter<'_> {
    /// Cuts these tetrahedra into `count` parts, 1 at least and one a tetrahedron at most.
    fn cut(&mut self, tets: &mut [u32], count: usize) {
        if count == 1 {
            for &tet in &*tets {
                self.parts[tet as usize] = self.next;
            }
            self.next += 1;
            return;
        }
        let (axis, slabs) = self.slabs(tets, count);
        let place = |tet: u32| self.centres[tet as usize][axis];
        tets.sort_unstable_by(|&a, &b| place(a).total_cmp(&place(b)).then(a.cmp(&b)));
        let (mut rest, mut left) = (tets, count);
        for slab in (1..=slabs).rev() {
            let own = left.div_ceil(slab);
            let middle = (rest.len() as f64 * own as f64 / left as f64).round() as usize;
            let end = if own == left {
                rest.len()
            } else {
                let most = rest.len() - (left - own);
                self.gap(rest, axis, middle.clamp(own, most), own, most)
            };
            let (here, next) = rest.split_at_mut(end);
            self.cut(here, own);
            (rest, left) = (next, left - own);
        }
    }

    /// The axis along which these tetrahedra reach farthest, and how many slabs across it are as thick as cubes that share the volume.
    fn slabs(&self, tets: &[u32], count: usize) -> (usize, usize) {
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
        let lengths: Vec3 = std::array::from_fn(|d| high[d] - low[d]);
        let longest = (1..3).fold(
            0,
            |best, d| {
                if lengths[d] > lengths[best] { d } else { best }
            },
        );
        let edge = (volume / count as f64).cbrt();
        let slabs = (lengths[longest] / edge).round().max(2.0) as usize;
        (longest, slabs.min(count))
    }

    /// The widest gap between neighbours near `middle` in sorted tetrahedra: a plane between layers of a structured mesh.
    fn gap(&self, tets: &[u32], axis: usize, middle: usize, least: usize, most: usize) -> usize {
        let reach = (SNAP * middle.min(tets.len() - middle) as f64) as usize;
        let from = middle.saturating_sub(reach).max(least).max(1);
        let to = (middle + reach).min(most);
        let width = |k: usize| {
            self.centres[tets[k] as usize][axis] - self.centres[tets[k - 1] as usize][axis]
        };
        // in equal layers the nearest wins: wider by more than rounding counts
        let mut best = (width(middle), middle);
        let mut nearest: Vec<usize> = (from..=to).collect();
        nearest.sort_by_key(|&k| (k.abs_diff(middle), k));
        for k in nearest {
            if width(k) > (1.0 + 1e-6) * best.0 {
                best = (width(k), k);
            }
        }
        best.1
    }
}
