//! A sparse factor stored for solves with one right-hand side.

use crate::linalg::elimination::{Group, grouped, patterns};
use crate::linalg::sparse::{Columns, MemoryNeed, SparseCholesky, Symbolic, quotient};
use crate::linalg::supernodes::{Supernodes, Way};
use crate::linalg::tiles::Tile;
use crate::subdomain::class::Class;
use crate::subdomain::kernel::{Kernel, add_wrench, displacement};
use crate::tolerances::GROUP;

/// Unknowns of a node.
const NODE: usize = 3;

/// A factor `P A P^T = L L^T` in tiles.
#[derive(Debug, Clone)]
pub(crate) struct PackedFactor {
    /// Old number of each unknown.
    order: Vec<u32>,
    /// Position of each block.
    place: Vec<u32>,
    groups: Supernodes,
    tiles: Vec<Tile>,
}

/// Groups blocks in the order of elimination where that saves time. The factor at hand has larger groups, which serve
/// many columns at once but hold more zeros.
fn group(matrix: &Columns, order: &[u32]) -> Vec<Group> {
    let (pointers, rows) = quotient(matrix, NODE);
    let neighbours = |pair: &[usize]| rows[pair[0]..pair[1]].iter().map(|&r| r as u32).collect();
    let graph: Vec<Vec<u32>> = pointers.windows(2).map(neighbours).collect();
    let blocks: Vec<u32> = order.iter().step_by(NODE).map(|&k| k / NODE as u32).collect();
    let cost = |width: usize, below: usize| {
        let height = width + below;
        GROUP + height / 4 + Supernodes::tiles_of(NODE * width, NODE * height)
    };
    grouped(0..blocks.len(), &patterns(&graph, &blocks), |_, _| true, cost)
}

/// Numbers stored for a factor of a class, and, if that has one member, for products with one column.
pub(crate) fn counts(class: &Class, pattern: &Columns, symbolic: &Symbolic) -> [usize; 2] {
    let single = class.members.len() == 1 && !class.is_rigid;
    [
        symbolic.stored(),
        if single { stored(pattern, &symbolic.order()) } else { 0 },
    ]
}

/// Numbers stored for a factor of a matrix with this pattern and order of elimination.
fn stored(matrix: &Columns, order: &[u32]) -> usize {
    let of = |g: &Group| {
        let (width, height) = (g.columns.len(), g.columns.len() + g.below.len());
        Supernodes::tiles_of(NODE * width, NODE * height)
    };
    Tile::NUMBERS * group(matrix, order).iter().map(of).sum::<usize>()
}

/// Orders groups such that those that do not wait for one another stand together, those of one shape side by side: one
/// short loop then serves many of them. Returns old numbers.
fn by_level(groups: &[Group], blocks: usize) -> Vec<usize> {
    let mut home = vec![0; blocks];
    for (k, g) in groups.iter().enumerate() {
        home[g.columns.clone()].fill(k);
    }
    let mut level = vec![0; groups.len()];
    for (k, g) in groups.iter().enumerate() {
        if let Some(&first) = g.below.first() {
            let parent = home[first as usize];
            level[parent] = level[parent].max(level[k] + 1);
        }
    }
    let mut order: Vec<usize> = (0..groups.len()).collect();
    order.sort_by_key(|&k| (level[k], groups[k].columns.len(), groups[k].below.len(), k));
    order
}

impl PackedFactor {
    /// Copies a factor of `matrix`, in which the unknowns of a node are fully coupled.
    pub(crate) fn new(factor: &SparseCholesky, matrix: &Columns) -> Self {
        let old = factor.order();
        let blocks = old.len() / NODE;
        let pattern = group(matrix, &old);
        let sequence = by_level(&pattern, blocks);
        // New number of each block, and the groups with their rows in the new numbering.
        let (mut new, mut next) = (vec![0_u32; blocks], 0);
        for b in sequence.iter().flat_map(|&k| pattern[k].columns.clone()) {
            new[b] = next;
            next += 1;
        }
        let (mut groups, mut order) = (Supernodes::new(NODE), Vec::with_capacity(old.len()));
        let (mut starts, mut size) = (vec![0; pattern.len()], 0);
        for &k in &sequence {
            let g = &pattern[k];
            let mut below: Vec<u32> = g.below.iter().map(|&b| new[b as usize]).collect();
            below.sort_unstable();
            let columns = order.len()..order.len() + NODE * g.columns.len();
            order.extend_from_slice(&old[NODE * g.columns.start..NODE * g.columns.end]);
            starts[k] = size;
            size += columns.len() * (columns.len() + NODE * below.len());
            groups.push(columns, below);
        }
        let mut values = vec![0.0; size];
        // Row of the current group for each unknown.
        let (mut rows_at, mut k, mut height) = (vec![usize::MAX; old.len()], 0, 0);
        let mut rows_of: Vec<u32> = Vec::new();
        factor.for_supernodes(&mut |columns, below, value| {
            for j in columns.clone() {
                let g = &pattern[k];
                let own = NODE * g.columns.start..NODE * g.columns.end;
                if j == own.start {
                    for b in rows_of.drain(..) {
                        rows_at[NODE * b as usize..][..NODE].fill(usize::MAX);
                    }
                    rows_of.extend(g.columns.clone().map(|b| b as u32));
                    rows_of.extend_from_slice(&g.below);
                    rows_of[g.columns.len()..].sort_unstable_by_key(|&b| new[b as usize]);
                    for (p, &b) in rows_of.iter().enumerate() {
                        for c in 0..NODE {
                            rows_at[NODE * b as usize + c] = NODE * p + c;
                        }
                    }
                    height = NODE * (g.columns.len() + g.below.len());
                }
                let target = &mut values[starts[k] + (j - own.start) * height..][..height];
                let rows = columns.clone().chain(below.iter().copied());
                for (i, row) in rows.enumerate().skip(j - columns.start) {
                    if let Some(target) = target.get_mut(rows_at[row]) {
                        *target = value(i, j - columns.start);
                    }
                }
                if j + 1 == own.end {
                    k += 1;
                }
            }
        });
        let mut tiles = Vec::with_capacity(groups.tiles());
        for (position, &k) in sequence.iter().enumerate() {
            groups.pack(position, &values[starts[k]..], &mut tiles);
        }
        let mut place = vec![0; blocks];
        for (position, &k) in order.iter().step_by(NODE).enumerate() {
            place[k as usize / NODE] = position as u32;
        }
        Self {
            order,
            place,
            groups,
            tiles,
        }
    }

    pub(crate) fn need(&self) -> MemoryNeed {
        MemoryNeed::numbers(self.order.len() + self.groups.buffer())
    }

    /// Numbers stored.
    pub(crate) fn stored(&self) -> usize {
        Tile::NUMBERS * self.tiles.len()
    }

    /// Solves `A X = B` in place, column by column; `memory` as [`PackedFactor::need`] says.
    pub(crate) fn solve(&self, rhs: &mut [f64], memory: &mut [f64]) {
        let dim = self.order.len();
        if dim == 0 {
            return;
        }
        let (x, buffer) = memory.split_at_mut(dim);
        for column in rhs.chunks_exact_mut(dim) {
            for (x, &old) in x.iter_mut().zip(&self.order) {
                *x = column[old as usize];
            }
            self.solve_ordered(x, buffer);
            for (&x, &old) in x.iter().zip(&self.order) {
                column[old as usize] = x;
            }
        }
    }

    fn solve_ordered(&self, x: &mut [f64], buffer: &mut [f64]) {
        for way in [Way::Forward, Way::Backward] {
            self.groups.solve(way, &self.tiles, [&mut *x, &mut [], &mut *buffer]);
        }
    }

    /// Rows `nodes` of `A^-1 f` for forces on these nodes, in a matrix of nodes of three unknowns; `memory` as in
    /// [`PackedFactor::solve`]. The rigid part of forces and displacements, taken at all nodes, is removed.
    pub(crate) fn product(&self, kernel: &Kernel, nodes: &[u32], f: &[f64], u: &mut [f64], memory: &mut [f64]) {
        let (x, buffer) = memory.split_at_mut(self.order.len());
        let at = |node: usize| 3 * self.place[node] as usize;
        let three = |v: &[f64]| [v[0], v[1], v[2]];
        let forces = nodes.iter().zip(f.chunks_exact(3));
        let motion = rigid(kernel, forces.map(|(&node, f)| (node as usize, three(f))));
        for node in 0..kernel.nodes() {
            let v = displacement(&motion, kernel.arm(node));
            x[at(node)..][..3].copy_from_slice(&v.map(|v| -v));
        }
        for (&node, f) in nodes.iter().zip(f.chunks_exact(3)) {
            let target = &mut x[at(node as usize)..][..3];
            for c in 0..3 {
                target[c] += f[c];
            }
        }
        self.solve_ordered(x, buffer);
        let all = (0..kernel.nodes()).map(|node| (node, three(&x[at(node)..][..3])));
        let motion = rigid(kernel, all);
        for (&node, u) in nodes.iter().zip(u.chunks_exact_mut(3)) {
            let node = node as usize;
            let (x, v) = (&x[at(node)..][..3], displacement(&motion, kernel.arm(node)));
            (0..3).for_each(|c| u[c] = x[c] - v[c]);
        }
    }
}

/// Motion of the rigid part of some vectors at nodes.
#[inline]
fn rigid(kernel: &Kernel, vectors: impl Iterator<Item = (usize, [f64; 3])>) -> [f64; 6] {
    // Two sums, so that additions need not wait for one another.
    let mut sums = [[0.0; 6]; 2];
    for (k, (node, v)) in vectors.enumerate() {
        add_wrench(&mut sums[k % 2], kernel.arm(node), v);
    }
    let wrench = std::array::from_fn(|i| sums[0][i] + sums[1][i]);
    kernel.motion(&kernel.project_wrench(&wrench))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::sparse::{Columns, SolveMemory, Symbolic};

    /// Chains of `links` nodes of `block` unknowns, fully coupled with their neighbours.
    fn chains(nodes: usize, links: usize, block: usize) -> Columns {
        let dim = nodes * block;
        let mut matrix = Columns::empty(dim);
        for j in 0..dim {
            let node = j / block;
            let first = node / links * links;
            let near = node.saturating_sub(1).max(first)..(node + 2).min(first + links);
            for i in near.start * block..(near.end * block).min(dim) {
                let value = if i == j { 20.0 } else { ((i + j) as f64).cos() };
                matrix.rows.push(i);
                matrix.values.push(value);
            }
            matrix.pointers.push(matrix.rows.len());
        }
        matrix
    }

    #[test]
    fn packed_solves_are_those_of_the_factor() {
        let single = [(30, 30, 3), (1, 1, 3), (7, 7, 6)];
        let several = [(4, 1, 3), (12, 3, 3), (12, 2, 6)];
        for (nodes, links, block) in single.into_iter().chain(several) {
            let matrix = chains(nodes, links, block);
            let factor = SparseCholesky::new(&Symbolic::new(&matrix, block).unwrap(), &matrix).unwrap();
            let packed = PackedFactor::new(&factor, &matrix);
            let mut x: Vec<f64> = (0..2 * matrix.dim).map(|i| (i as f64).sin()).collect();
            let mut y = x.clone();
            factor.solve(&mut x, 2, &mut SolveMemory::new(factor.need(2)));
            let mut memory = vec![f64::NAN; matrix.dim + packed.groups.buffer()];
            packed.solve(&mut y, &mut memory);
            for (x, y) in x.iter().zip(&y) {
                assert!((x - y).abs() < 1e-14, "{x} {y}");
            }
            // Some nodes only: the same numbers as with zero forces elsewhere.
            let place = |k: usize| [k as f64, (k * k % 7) as f64, (k * k % 5) as f64];
            let points: Vec<[f64; 3]> = (0..matrix.dim / 3).map(place).collect();
            let Ok(kernel) = Kernel::new(&points, 0) else {
                continue;
            };
            let dofs = [3, 4, 5, 9, 10, 11];
            let mut z = vec![0.0; matrix.dim];
            dofs.iter().for_each(|&d| z[d] = d as f64);
            let (f, mut u) = (dofs.map(|d| z[d]), [f64::NAN; 6]);
            packed.product(&kernel, &[1, 3], &f, &mut u, &mut memory);
            let remove = |z: &mut [f64]| kernel.add_motion(-1.0, &kernel.transpose_times(z), z);
            remove(&mut z);
            packed.solve(&mut z, &mut memory);
            remove(&mut z);
            assert!(dofs.iter().zip(u).all(|(&d, u)| (u - z[d]).abs() < 1e-13));
        }
    }
}
