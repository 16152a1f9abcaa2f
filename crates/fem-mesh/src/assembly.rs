//! Assembly of the stiffness matrix in time linear in the number of tetrahedra.
//!
//! First the pattern: which nodes share a tetrahedron. Then every node sums up its own column
//! block over the tetrahedra around it, in ascending order. Nothing is written by two threads and
//! no sum depends on their number, so the result is the same bit for bit for any thread count.

use crate::element::{Block, TetNodes};
use crate::material::Hooke;
use crate::mesh::MeshError;
use crate::tables::{Lists, distinct};
use rayon::prelude::*;
use sprs::CsMat;

/// Assembles the stiffness of linear tetrahedra, given by four nodes, or of quadratic ones, given by ten.
///
/// `points` and `tets` are those of a mesh or of a subdomain (local numbers), `hooke(tet)` is the
/// law of a tetrahedron. Row and column 3 n + i belong to component i at node n. Returns the full
/// symmetric matrix in compressed columns with sorted indices; symmetric bit for bit. Every pair
/// of nodes that share a tetrahedron has a stored 3 x 3 block, zeros included.
///
/// # Errors
/// [`MeshError::NodeOutOfRange`] if a tetrahedron names a node that does not exist, [`MeshError::TooLarge`] for more
/// tetrahedra than the 32-bit table of those around the nodes takes.
pub fn assemble_stiffness<'h, const N: usize>(
    points: &[[f64; 3]],
    tets: &[[u32; N]],
    hooke: impl Fn(usize) -> &'h Hooke + Sync,
) -> Result<CsMat<f64>, MeshError>
where
    [u32; N]: TetNodes,
{
    let (nodes, count, limit) = (points.len(), tets.len(), u32::MAX as usize / N);
    if count > limit {
        let what = "tetrahedra";
        return Err(MeshError::TooLarge { what, count, limit });
    }
    for (tet, t) in tets.iter().enumerate() {
        if let Some(&node) = t.iter().find(|&&n| n as usize >= nodes) {
            return Err(MeshError::NodeOutOfRange { tet, node, nodes });
        }
    }
    let pattern = Pattern::new(nodes, tets);
    // Blocks on and below the diagonal first, then the full matrix from them, so that it is
    // symmetric bit for bit.
    let lower: Vec<Vec<Block>> = (0..nodes)
        .into_par_iter()
        .map(|node| pattern.lower_blocks(node, points, tets, &hooke))
        .collect();

    let mut data = vec![0.0; 9 * pattern.nodes.len()];
    let mut indices = vec![0; 9 * pattern.nodes.len()];
    let columns = split(&mut data, &pattern.start).into_par_iter();
    columns
        .zip(split(&mut indices, &pattern.start))
        .enumerate()
        .for_each(|(node, (values, rows))| {
            let column = pattern.column(node);
            for (place, &other) in column.iter().enumerate() {
                let (other, below) = (other as usize, other as usize >= node);
                let (from, to) = if below { (node, other) } else { (other, node) };
                let block = &lower[from][pattern.place(from, to)];
                for i in 0..3 {
                    for k in 0..3 {
                        let at = 3 * (k * column.len() + place) + i;
                        rows[at] = 3 * other + i;
                        values[at] = if below { block[i][k] } else { block[k][i] };
                    }
                }
            }
        });
    let column_ends = (0..nodes).flat_map(|n| {
        let height = 3 * pattern.column(n).len();
        let before = 9 * pattern.start[n];
        (1..=3).map(move |k| before + k * height)
    });
    let indptr = std::iter::once(0).chain(column_ends).collect();
    Ok(CsMat::new_csc((3 * nodes, 3 * nodes), indptr, indices, data))
}

/// Which nodes share a tetrahedron, and which tetrahedra surround each node.
struct Pattern {
    /// Neighbours of node n, itself included, ascending: `nodes[start[n]..start[n + 1]]`.
    start: Vec<usize>,
    nodes: Vec<u32>,
    /// Tetrahedra around each node, ascending.
    tets: Lists<u32>,
}

impl Pattern {
    fn new<const N: usize>(nodes: usize, tets: &[[u32; N]]) -> Self {
        let around = Lists::by_key(nodes, tets.as_flattened()).map(|place| place / N as u32);
        let columns: Vec<Vec<u32>> = (0..nodes)
            .into_par_iter()
            .map(|node| {
                let own = around.of(node);
                distinct(own.iter().flat_map(|&t| tets[t as usize]).chain([node as u32]))
            })
            .collect();
        let mut start = vec![0; nodes + 1];
        for (n, column) in columns.iter().enumerate() {
            start[n + 1] = start[n] + column.len();
        }
        Self {
            start,
            nodes: columns.concat(),
            tets: around,
        }
    }

    fn column(&self, node: usize) -> &[u32] {
        &self.nodes[self.start[node]..self.start[node + 1]]
    }

    /// Place of `row >= node` among the blocks on and below the diagonal of column `node`.
    fn place(&self, node: usize, row: usize) -> usize {
        let before = |limit: usize| self.column(node).partition_point(|&n| (n as usize) < limit);
        before(row) - before(node)
    }

    fn lower_blocks<'h, T: TetNodes>(
        &self,
        node: usize,
        points: &[[f64; 3]],
        tets: &[T],
        hooke: &impl Fn(usize) -> &'h Hooke,
    ) -> Vec<Block> {
        let height = self.column(node).iter().filter(|&&n| n as usize >= node).count();
        let mut blocks = vec![[[0.0; 3]; 3]; height];
        for &t in self.tets.of(node) {
            let law = hooke(t as usize);
            tets[t as usize].lower_column(points, law, node, |row, block| {
                let sum = &mut blocks[self.place(node, row)];
                for i in 0..3 {
                    for k in 0..3 {
                        sum[i][k] += block[i][k];
                    }
                }
            });
        }
        // The diagonal block comes first.
        for i in 0..3 {
            for k in 0..i {
                blocks[0][k][i] = blocks[0][i][k];
            }
        }
        blocks
    }
}

/// Cuts the storage of the matrix into the three columns of each node.
fn split<'a, T>(mut storage: &'a mut [T], start: &[usize]) -> Vec<&'a mut [T]> {
    let mut parts = Vec::with_capacity(start.len() - 1);
    for n in 0..start.len() - 1 {
        let (part, rest) = storage.split_at_mut(9 * (start[n + 1] - start[n]));
        parts.push(part);
        storage = rest;
    }
    parts
}
