//! Clusters of about eight subdomains that move as one: a small model of `G W G^T`.

use crate::coarse::matrix::CoarseMatrix;
use crate::coarse::mobility::Mobility;
use crate::linalg::entry;
use crate::subdomain::kernel::{Block, Kernel, displacement, mean, product, transposed};
use crate::subdomain::matrices::Subdomains;
use crate::tolerances::{BLOCKS, CLUSTER, LAYER, MOTIONS, TRANSLATE};
use rayon::prelude::*;
use signorini_fem_mesh::internal::Lists;
use signorini_fem_mesh::vec3::sub;
use std::collections::{BTreeMap, HashMap};

/// Which subdomains move together, and how.
#[derive(Debug)]
pub(crate) struct Clusters {
    of: Vec<u32>,
    members: Lists<u32>,
    /// Amplitudes of each subdomain from the motion of its cluster, row-major.
    maps: Vec<Block>,
    centres: Vec<[f64; 3]>,
}

impl Clusters {
    /// Clusters of these subdomains, each within one rigid part; in a `grid` they are alike.
    pub(crate) fn new(mobility: &Mobility, subdomains: &Subdomains, grid: Option<&[[u32; 3]]>) -> Self {
        let (at, parts) = (mobility.centres(), &mobility.part_of);
        let members = members(parts, at, grid);
        let mut of = vec![0; at.len()];
        for (k, list) in members.iter().enumerate() {
            list.iter().for_each(|&s| of[s as usize] = k as u32);
        }
        let count = at.len().max(1) as f64;
        let length = (0..at.len()).map(|s| subdomains.kernel(s).radius()).sum::<f64>() / count;
        let centre = |list: &Vec<u32>| mean(list.iter().map(|&s| at[s as usize]));
        let mut out = Self {
            members: Lists::by_key(members.len(), &of),
            of,
            maps: Vec::new(),
            centres: members.iter().map(centre).collect(),
        };
        // the same for translates, bit for bit
        let mut known: HashMap<(usize, [i64; 3]), Block> = HashMap::new();
        let each = out.of.iter().enumerate();
        out.maps = each
            .map(|(s, &cluster)| {
                let arm = sub(at[s], out.centres[cluster as usize]).map(|d| d / length);
                let key = (subdomains.class(s), arm.map(|a| (a / TRANSLATE).round() as i64));
                *(known.entry(key)).or_insert_with(|| rigid_map(subdomains.kernel(s), &arm, length))
            })
            .collect();
        out
    }

    pub(crate) fn count(&self) -> usize {
        self.centres.len()
    }

    pub(crate) fn centres(&self) -> &[[f64; 3]] {
        &self.centres
    }

    /// Clusters with subdomains that are marked.
    pub(crate) fn marks(&self, marked: &[bool]) -> Vec<bool> {
        let mut out = vec![false; self.count()];
        let both = self.of.iter().zip(marked);
        both.for_each(|(&c, marked)| out[c as usize] |= marked);
        out
    }

    /// A row of `G^T` on the clusters.
    pub(crate) fn join(&self, row: &[(u32, [f64; 6])], out: &mut Vec<(u32, [f64; 6])>) {
        for (s, g) in row {
            let sum = entry(out, self.of[*s as usize], [0.0; 6]);
            add_restricted(&self.maps[*s as usize], g, sum);
        }
    }

    /// Wrenches on the clusters from those on the subdomains.
    pub(crate) fn restrict(&self, y: &[f64], out: &mut [f64]) {
        let (y, _) = y.as_chunks::<6>();
        let clusters = out
            .as_chunks_mut::<6>()
            .0
            .par_iter_mut()
            .with_min_len(BLOCKS / CLUSTER)
            .enumerate();
        clusters.for_each(|(cluster, sum)| {
            *sum = [0.0; 6];
            for &s in self.members.of(cluster) {
                add_restricted(&self.maps[s as usize], &y[s as usize], sum);
            }
        });
    }

    /// Amplitudes of the subdomains from the motions of the clusters.
    pub(crate) fn prolong(&self, motions: &[f64], y: &mut [f64]) {
        let (motions, _) = motions.as_chunks::<6>();
        let subdomains = y.as_chunks_mut::<6>().0.par_iter_mut().with_min_len(MOTIONS);
        subdomains
            .zip(&self.maps)
            .zip(&self.of)
            .for_each(|((y, map), &cluster)| {
                let motion = &motions[cluster as usize];
                *y = std::array::from_fn(|i| (0..6).map(|j| map[i][j] * motion[j]).sum());
            });
    }

    /// The matrix of the clusters for these `values` of that of the subdomains.
    pub(crate) fn matrix(&self, fine: &CoarseMatrix, values: &[f64]) -> (CoarseMatrix, Vec<f64>) {
        let block = |a: u32, b: u32, block: &Block| {
            let right = product(block, &self.maps[b as usize]);
            product(&transposed(&self.maps[a as usize]), &right)
        };
        fine.joined(values, self.count(), &self.of, block)
    }
}

/// The subdomains of each cluster.
pub(crate) fn members(parts: &[u32], at: &[[f64; 3]], grid: Option<&[[u32; 3]]>) -> Vec<Vec<u32>> {
    let groups = Lists::by_number(parts);
    let mut out: Vec<Vec<u32>> = Vec::new();
    for group in groups.iter() {
        match grid {
            Some(grid) => boxes(group, grid, &mut out),
            None => halve(group.to_vec(), at, &mut out),
        }
    }
    out
}

/// Two subdomains of a grid along each edge.
fn boxes(group: &[u32], grid: &[[u32; 3]], out: &mut Vec<Vec<u32>>) {
    let mut all: BTreeMap<[u32; 3], Vec<u32>> = BTreeMap::new();
    for &s in group {
        all.entry(grid[s as usize].map(|layer| layer / 2)).or_default().push(s);
    }
    out.extend(all.into_values());
}

/// Halves a group along its longest extent, between layers, until each part is a cluster.
fn halve(mut group: Vec<u32>, at: &[[f64; 3]], out: &mut Vec<Vec<u32>>) {
    let range = |axis: usize| {
        let all = group.iter().map(|&s| at[s as usize][axis]);
        all.clone().fold(f64::NEG_INFINITY, f64::max) - all.fold(f64::INFINITY, f64::min)
    };
    let extents = [0, 1, 2].map(range);
    let axis = (1..3).fold(0, |best, axis| if extents[axis] > extents[best] { axis } else { best });
    if group.len() <= CLUSTER || extents[axis] <= 0.0 {
        return out.push(group);
    }
    let coordinate = |s: u32| at[s as usize][axis];
    group.sort_by(|&a, &b| coordinate(a).total_cmp(&coordinate(b)).then(a.cmp(&b)));
    let between = |k: &usize| coordinate(group[*k]) - coordinate(group[*k - 1]) > LAYER * extents[axis];
    let middle = group.len() / 2;
    let cut = (1..group.len()).filter(between).min_by_key(|k| k.abs_diff(middle));
    let right = group.split_off(cut.unwrap_or(middle));
    halve(group, at, out);
    halve(right, at, out);
}

/// Amplitudes of a subdomain from motions about a point at minus `arm`, which like rotations is in units of `length`.
fn rigid_map(kernel: &Kernel, arm: &[f64; 3], length: f64) -> Block {
    let ratio = kernel.radius() / length;
    let mut out = [[0.0; 6]; 6];
    for mode in 0..6 {
        let motion: [f64; 6] = std::array::from_fn(|k| f64::from(u8::from(k == mode)));
        let [x, y, z] = displacement(&motion, arm);
        let [.., a, b, c] = motion.map(|m| m * ratio);
        let amplitudes = kernel.amplitudes(&[x, y, z, a, b, c]);
        (0..6).for_each(|k| out[k][mode] = amplitudes[k]);
    }
    out
}

fn add_restricted(map: &Block, y: &[f64; 6], sum: &mut [f64; 6]) {
    for (row, y) in map.iter().zip(y) {
        (0..6).for_each(|j| sum[j] += row[j] * y);
    }
}
