//! A cut for a mesh that comes without one: slabs of equal numbers of tetrahedra, made compact.

use super::compact::{compact, join_pieces};
use super::cracks::split_at_cracks;
use super::frame::Frame;
use super::parts::{expect_parts, split_by, volumes_and_surfaces};
use super::subdomains::DecompositionError;
use crate::mesh::{TetMesh, extent};
use crate::tables::Lists;
use crate::tolerances::{
    BOX, EDGE_STEPS, FILLED, GRADED, LARGER, PLANE, ROD, ROD_BEND, ROD_QUADRATIC, ROD_TETS, ROUND, SNAP, STRAP_BEND,
    STRONGLY,
};
use crate::vec3::{self, Vec3};

/// How many parts [`even_parts`] makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PartCount {
    /// So many of one body; bodies and groups have their shares by numbers of tetrahedra, rounded and one at least, so
    /// that the sum may be a few less or more. More where cracks split them.
    Exactly(usize),
    /// A number near by for which the parts of a body that fills its box are nearest to cubes; a sixth of it where
    /// quadratic cells are graded so strongly along all axes that many parts would be flat. Rods, more than eight times
    /// as long as thick, have a part for each two thicknesses if their tetrahedra suffice: in long parts, bending costs
    /// iterations. With a number of 1, bodies that are no rods stay whole.
    About(usize),
}

/// Cuts a mesh into connected parts of similar numbers of tetrahedra, as compact as can be.
///
/// `groups` are labels, one for each tetrahedron, of what a part must not mix: materials. Bodies are never mixed. Each
/// connected group gets its share of the parts by its number of tetrahedra, at least one. It is cut across the longest
/// edge of its box, which may lie obliquely, into slabs, slabs into columns, columns into blocks; cells of a structured
/// mesh stay whole where the number of parts allows it. What is not compact then is made so as by
/// [`compact_parts`](crate::decomposition::compact_parts), cracks included. In a box with cells graded along an axis,
/// slabs of long cells get fewer of them, so that parts are not flat, and where all fell into boxes they stay so. The
/// parts are numbered by their first tetrahedra.
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
    let groups = split_by(mesh, groups);
    let members = Lists::by_number(&groups);
    let frames: Vec<Option<Frame>> = members.iter().map(|own| Frame::new(mesh, &groups, own)).collect();
    let frame = |group: usize| frames[group].as_ref();
    let centre = |tet: usize| vec3::centroid(&corners(mesh, frame(groups[tet] as usize), tet));
    let centres: Vec<Vec3> = (0..tets).map(centre).collect();
    let shares = (0..tets).map(|tet| shares(mesh, frame(groups[tet] as usize), tet));
    let shares: Vec<Vec3> = shares.collect();
    let volumes: Vec<f64> = (0..tets).map(|tet| mesh.volume(tet)).collect();
    let bulk = match count {
        PartCount::Exactly(_) => Vec::new(),
        PartCount::About(_) => volumes_and_surfaces(mesh, &groups),
    };
    let (mut slabs, mut next) = (vec![0; tets], 0);
    let mut whole = vec![false; members.count()];
    for (group, own) in members.iter().enumerate() {
        let share = (own.len() as f64 / tets as f64 * number as f64).round() as usize;
        let share = share.clamp(1, own.len());
        let mut cutter = Cutter {
            mesh,
            frame: frame(group),
            centres: &centres,
            shares: &shares,
            volumes: &volumes,
            graded: [false; 3],
        };
        // elsewhere long cells along an axis are not layers
        let grading = if cutter.is_box(own) { grading(&shares, own) } else { [1.0; 3] };
        cutter.graded = grading.map(|ratio| ratio > GRADED);
        let layered = cutter.graded.contains(&true);
        let flat = mesh.order() == 2 && grading.iter().all(|ratio| *ratio > STRONGLY);
        let pieces = match count {
            PartCount::Exactly(_) => cutter.pieces(own, share),
            PartCount::About(_) => match cutter.lengths(own, bulk[group]) {
                lengths if lengths > share => cutter.pieces(own, lengths),
                _ if number == 1 => cutter.pieces(own, 1),
                _ if flat => cutter.nearest_to_cubes(own, share.div_ceil(LARGER)),
                _ => cutter.nearest_to_cubes(own, share),
            },
        };
        whole[group] = layered && pieces.iter().all(|piece| cutter.is_box(piece));
        for piece in pieces {
            for tet in piece {
                slabs[tet as usize] = next;
            }
            next += 1;
        }
    }
    join_pieces(mesh, &groups, &mut slabs);
    let mut parts = slabs;
    if whole.contains(&false) {
        let slabs = std::mem::take(&mut parts);
        parts = compact(mesh, &groups, &centres, &slabs);
        // boxes stay: their faces are plane, and along ragged ones long cells hang loose
        for tet in (0..tets).filter(|&tet| whole[groups[tet] as usize]) {
            parts[tet] = tets as u32 + slabs[tet];
        }
    }
    Ok(split_at_cracks(mesh, &parts))
}

/// Whether cells are graded so strongly along all axes that many are flat.
#[doc(hidden)]
pub fn is_strongly_graded(mesh: &TetMesh) -> bool {
    let all: Vec<u32> = (0..mesh.tets().len() as u32).collect();
    let shares: Vec<Vec3> = all.iter().map(|&tet| shares(mesh, None, tet as usize)).collect();
    grading(&shares, &all).iter().all(|ratio| *ratio > STRONGLY)
}

/// Power of the length of a cell with which it counts in a cut across that: between equal numbers and equal lengths.
const SHARE: f64 = 0.75;

/// What a tetrahedron counts in cuts across the axes of a frame, by its lengths relative to itself: cells that are small
/// all round count alike.
fn shares(mesh: &TetMesh, frame: Option<&Frame>, tet: usize) -> Vec3 {
    let (low, high) = extent(corners(mesh, frame, tet));
    let lengths = vec3::sub(high, low);
    lengths.map(|length| (length / lengths.iter().product::<f64>().cbrt()).powf(SHARE))
}

/// How strongly these cells are graded along each axis.
fn grading(shares: &[Vec3], tets: &[u32]) -> Vec3 {
    [0, 1, 2].map(|d| {
        let mut sorted: Vec<f64> = tets.iter().map(|&tet| shares[tet as usize][d]).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |part: f64| sorted[(part * (sorted.len() - 1) as f64) as usize];
        (at(0.95) / at(0.05)).powf(SHARE.recip())
    })
}

/// Corners of a tetrahedron along the axes of a frame.
fn corners(mesh: &TetMesh, frame: Option<&Frame>, tet: usize) -> [Vec3; 4] {
    let points = mesh.tet_points(tet);
    frame.map_or(points, |frame| points.map(|p| frame.place(p)))
}

struct Cutter<'a> {
    mesh: &'a TetMesh,
    frame: Option<&'a Frame>,
    centres: &'a [Vec3],
    shares: &'a [Vec3],
    volumes: &'a [f64],
    /// Along which axes cells of different lengths count differently.
    graded: [bool; 3],
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
        let steps = (-EDGE_STEPS..=EDGE_STEPS).map(|k| edge * (1.0 + 0.02 * f64::from(k)));
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

    /// How many pieces, twice as long as thick, these tetrahedra make if they are a rod; else one.
    fn lengths(&self, tets: &[u32], [volume, surface]: [f64; 2]) -> usize {
        let mut edges = self.size(tets).0;
        edges.sort_by(f64::total_cmp);
        let [_, width, longest] = edges;
        let thickness = 4.0 * volume / surface;
        let bend = if width < ROUND * longest { STRAP_BEND } else { ROD_BEND };
        let is_rod = volume < bend * longest * thickness.powi(2);
        let times = volume / thickness.powi(3);
        let least = if self.mesh.order() == 2 { ROD_QUADRATIC } else { ROD_TETS };
        if is_rod && times > ROD {
            ((times / 2.0) as usize).min(tets.len() / least).max(1)
        } else {
            1
        }
    }

    /// Cuts these tetrahedra into `count` parts, 1 at least and one a tetrahedron at most.
    fn pieces(&self, tets: &[u32], count: usize) -> Vec<Vec<u32>> {
        let mut out = Vec::with_capacity(count);
        self.cut(&mut tets.to_vec(), count, &mut out);
        out
    }

    fn cut(&self, tets: &mut [u32], count: usize, out: &mut Vec<Vec<u32>>) {
        if count == 1 {
            out.push(tets.to_vec());
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
                let graded = self.middle(rest, axis, own as f64 / left as f64);
                let plane = graded.and_then(|middle| self.plane(rest, axis, middle, own, most));
                let middle = graded.unwrap_or(middle).clamp(own, most);
                plane.unwrap_or_else(|| self.gap(rest, axis, middle, own, most))
            };
            let (here, next) = rest.split_at_mut(end);
            self.cut(here, own, out);
            (rest, left) = (next, left - own);
        }
    }

    /// How many of these sorted tetrahedra have a part of all their shares; `None` where all count alike.
    fn middle(&self, tets: &[u32], axis: usize, part: f64) -> Option<usize> {
        if !self.graded[axis] {
            return None;
        }
        let share = |tet: &u32| self.shares[*tet as usize][axis];
        let wanted = part * tets.iter().map(share).sum::<f64>();
        let mut sum = 0.0;
        tets.iter().position(|tet| {
            sum += share(tet);
            sum >= wanted
        })
    }

    /// The plane between layers of sorted tetrahedra that is nearest to `middle`.
    fn plane(&self, tets: &[u32], axis: usize, middle: usize, least: usize, most: usize) -> Option<usize> {
        let far = (PLANE * middle.min(tets.len() - middle) as f64) as usize;
        let places = middle.saturating_sub(far).max(least)..=(middle + far).min(most);
        let ends = |k: usize| {
            let (low, high) = extent(corners(self.mesh, self.frame, tets[k] as usize));
            [low[axis], high[axis]]
        };
        let mut next = vec![f64::MAX; tets.len() + 1];
        (0..tets.len())
            .rev()
            .for_each(|k| next[k] = next[k + 1].min(ends(k)[0]));
        let mut last = f64::MIN;
        let parted = (1..tets.len()).filter(|&k| {
            last = last.max(ends(k - 1)[1]);
            last <= next[k] && places.contains(&k)
        });
        parted.min_by_key(|k| k.abs_diff(middle))
    }

    /// Whether these tetrahedra are all of a box.
    fn is_box(&self, tets: &[u32]) -> bool {
        let (lengths, volume) = self.size(tets);
        volume >= BOX * lengths.iter().product::<f64>()
    }

    /// Edges of the box around these tetrahedra, and their volume.
    fn size(&self, tets: &[u32]) -> (Vec3, f64) {
        let volume = tets.iter().map(|&tet| self.volumes[tet as usize]).sum();
        let (low, high) = extent(
            tets.iter()
                .flat_map(|&tet| corners(self.mesh, self.frame, tet as usize)),
        );
        (vec3::sub(high, low), volume)
    }

    fn box_surface(&self, tets: &[u32]) -> f64 {
        let ([a, b, c], _) = self.size(tets);
        2.0 * (a * b + b * c + c * a)
    }

    /// The axis along which these tetrahedra reach farthest, and how many slabs across it are as thick as cubes that
    /// share the volume.
    fn slabs(&self, tets: &[u32], count: usize) -> (usize, usize) {
        let (lengths, volume) = self.size(tets);
        let longest = (1..3).fold(0, |best, d| if lengths[d] > lengths[best] { d } else { best });
        let edge = (volume / count as f64).cbrt();
        let slabs = (lengths[longest] / edge).round().max(2.0) as usize;
        (longest, slabs.min(count))
    }

    /// The widest gap between neighbours near `middle` in sorted tetrahedra: a plane between layers of a structured
    /// mesh.
    fn gap(&self, tets: &[u32], axis: usize, middle: usize, least: usize, most: usize) -> usize {
        let reach = (SNAP * middle.min(tets.len() - middle) as f64) as usize;
        let from = middle.saturating_sub(reach).max(least).max(1);
        let to = (middle + reach).min(most);
        let width = |k: usize| self.centres[tets[k] as usize][axis] - self.centres[tets[k - 1] as usize][axis];
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
