//! Assembly of `G W G^T` in blocks of six.

use crate::coarse::weights::RowWeights;
use crate::linalg::entry;
use crate::linalg::sparse::Columns;
use crate::rows::gluing::{BlockEntry, Gluing};
use crate::subdomain::kernel::{Block, Kernel, transposed};
use crate::subdomain::matrices::{ClassBase, Subdomains};
use rayon::prelude::*;
use signorini_fem_mesh::internal::{Lists, distinct};

/// Pattern of the coarse matrix and the part that the interface rows contribute with weight one.
#[derive(Debug)]
pub(crate) struct CoarseMatrix {
    /// Block rows of each block column, ascending, the diagonal first.
    pointers: Vec<usize>,
    neighbours: Vec<u32>,
    interface: Columns,
}

type Modes = [[f64; 6]; 3];

/// Rows of `R` at all nodes of each class.
pub(crate) struct ModeTable<'a> {
    tables: Vec<Vec<Modes>>,
    subdomains: &'a Subdomains,
}

impl<'a> ModeTable<'a> {
    pub(crate) fn new(subdomains: &'a Subdomains) -> Self {
        let table = |base: &ClassBase| {
            let nodes = 0..base.kernel.nodes();
            nodes.map(|n| base.kernel.node_modes(n)).collect()
        };
        let tables = subdomains.bases.iter().map(table).collect();
        Self { tables, subdomains }
    }

    fn kernel(&self, subdomain: u32) -> &Kernel {
        self.subdomains.kernel(subdomain as usize)
    }

    fn at(&self, subdomain: u32, local: u32) -> &Modes {
        &self.tables[self.subdomains.class(subdomain as usize)][local as usize]
    }

    /// Row of `G^T`: `(subdomain, six coefficients)`, times `factor`, added to `out`.
    pub(crate) fn row(&self, gluing: &Gluing, nodal: usize, factor: f64, out: &mut Vec<(u32, [f64; 6])>) {
        for e in gluing.nodal(nodal) {
            let modes = self.at(e.subdomain, e.local);
            let sum = entry(out, e.subdomain, [0.0; 6]);
            for m in 0..6 {
                sum[m] += factor * (0..3).map(|c| e.vector[c] * modes[c][m]).sum::<f64>();
            }
        }
    }
}

/// Rows of each subdomain, from the subdomains of each row.
fn touching<R: Iterator<Item = u32>>(subdomains: usize, rows: impl Iterator<Item = R>) -> Lists<u32> {
    let pairs = (0..).zip(rows).flat_map(|(row, own)| own.map(move |s| (s, row)));
    let (keys, numbers): (Vec<u32>, Vec<u32>) = pairs.unzip();
    Lists::by_key(subdomains, &keys).map(|k| numbers[k as usize])
}

/// A matrix with its graph and values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entries<'a> {
    pub(crate) matrix: &'a CoarseMatrix,
    /// Neighbours of each block.
    pub(crate) graph: &'a [Vec<u32>],
    pub(crate) values: &'a [f64],
}

impl CoarseMatrix {
    pub(crate) fn entries<'a>(&'a self, graph: &'a [Vec<u32>], values: &'a [f64]) -> Entries<'a> {
        let matrix = self;
        Entries { matrix, graph, values }
    }

    pub(crate) fn new(gluing: &Gluing, modes: &ModeTable<'_>) -> Self {
        let subdomains = modes.subdomains.count();
        let blocks = (0..gluing.blocks()).map(|b| gluing.block(b).iter().map(|e| e.subdomain));
        let nodal = (0..gluing.nodal_rows()).map(|k| gluing.nodal(k).iter().map(|e| e.subdomain));
        let touching = [touching(subdomains, blocks), touching(subdomains, nodal)];
        let columns: Vec<(Vec<u32>, Vec<f64>)> = (0..subdomains)
            .into_par_iter()
            .map(|s| block_column(gluing, modes, &touching, s))
            .collect();
        Self::of_columns(columns.into_iter())
    }

    /// From the block rows of each block column, ascending, the diagonal first, and its values.
    pub(crate) fn of_columns(columns: impl ExactSizeIterator<Item = (Vec<u32>, Vec<f64>)>) -> Self {
        let mut matrix = Self {
            pointers: vec![0],
            neighbours: Vec::new(),
            interface: Columns::empty(6 * columns.len()),
        };
        for (list, values) in columns {
            for _ in 0..6 {
                matrix
                    .interface
                    .rows
                    .extend(list.iter().flat_map(|&i| (0..6).map(move |r| 6 * i as usize + r)));
                matrix.interface.pointers.push(matrix.interface.rows.len());
            }
            matrix.neighbours.extend(list);
            matrix.pointers.push(matrix.neighbours.len());
            matrix.interface.values.extend(values);
        }
        matrix
    }

    /// Neighbours of each subdomain, without itself, ascending.
    pub(crate) fn graph(&self) -> Vec<Vec<u32>> {
        let mut graph: Vec<Vec<u32>> = vec![Vec::new(); self.pointers.len() - 1];
        for (a, pair) in self.pointers.windows(2).enumerate() {
            for &b in &self.neighbours[pair[0] + 1..pair[1]] {
                graph[a].push(b);
                graph[b as usize].push(a as u32);
            }
        }
        graph.iter_mut().for_each(|list| list.sort_unstable());
        graph
    }

    /// The diagonal of a matrix with these values.
    pub(crate) fn diagonal<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        // Columns hold the rows from those of the diagonal block on.
        let pointers = self.interface.pointers.iter().enumerate();
        let columns = pointers.take(self.interface.dim);
        columns.map(|(column, &start)| values[start + column % 6])
    }

    pub(crate) fn pattern(&self) -> &Columns {
        &self.interface
    }

    /// Position of entry (0, 0) of a block and the distance between its columns.
    pub(crate) fn place(&self, i: u32, j: u32) -> (usize, usize) {
        let list = &self.neighbours[self.pointers[j as usize]..self.pointers[j as usize + 1]];
        let k = list.partition_point(|&n| n < i);
        (36 * self.pointers[j as usize] + 6 * k, 6 * list.len())
    }

    /// Hands each stored block of a matrix with these values to `each(row, column, block)`.
    pub(crate) fn for_blocks(&self, values: &[f64], mut each: impl FnMut(u32, u32, &Block)) {
        for (j, pair) in self.pointers.windows(2).enumerate() {
            let list = &self.neighbours[pair[0]..pair[1]];
            for (k, &i) in list.iter().enumerate() {
                let start = 36 * pair[0] + 6 * k;
                let at = |r: usize, c: usize| values[start + 6 * list.len() * c + r];
                each(i, j as u32, &std::array::from_fn(|r| std::array::from_fn(|c| at(r, c))));
            }
        }
    }

    /// A matrix of `count` parts to which the subdomains belong, with the sums of what `block` makes of the blocks of a
    /// matrix with these values.
    pub(crate) fn joined(
        &self,
        values: &[f64],
        count: usize,
        parts: &[u32],
        block: impl Fn(u32, u32, &Block) -> Block,
    ) -> (Self, Vec<f64>) {
        let mut lower: Vec<Vec<u32>> = (0..count as u32).map(|c| vec![c]).collect();
        self.for_blocks(values, |a, b, _| {
            let [a, b] = [a, b].map(|s| parts[s as usize]);
            lower[a.min(b) as usize].push(a.max(b));
        });
        let columns = lower.into_iter().map(|list| {
            let list = distinct(list);
            let values = vec![0.0; 36 * list.len()];
            (list, values)
        });
        let matrix = Self::of_columns(columns);
        let mut sums = vec![0.0; matrix.pattern().values.len()];
        self.for_blocks(values, |a, b, own| {
            let [p, q] = [a, b].map(|s| parts[s as usize]);
            let own = block(a, b, own);
            matrix.add_block(p, q, &own, &mut sums);
            if p == q && a != b {
                matrix.add_block(p, p, &transposed(&own), &mut sums);
            }
        });
        (matrix, sums)
    }

    /// Adds a block with rows of `i` and columns of `j`, or its transpose where that is stored.
    pub(crate) fn add_block(&self, i: u32, j: u32, block: &Block, values: &mut [f64]) {
        let (start, stride) = self.place(i.max(j), i.min(j));
        for r in 0..6 {
            for c in 0..6 {
                values[start + c * stride + r] += if i >= j { block[r][c] } else { block[c][r] };
            }
        }
    }

    /// Adds `weight g g^T`.
    pub(crate) fn add_row(&self, row: &[(u32, [f64; 6])], weight: f64, values: &mut [f64]) {
        for (i, gi) in row {
            for (j, gj) in row.iter().filter(|(j, _)| i >= j) {
                let (start, stride) = self.place(*i, *j);
                for c in 0..6 {
                    let column = &mut values[start + c * stride..][..6];
                    for r in 0..6 {
                        column[r] += weight * gi[r] * gj[c];
                    }
                }
            }
        }
    }

    /// `G W G^T`; weight one for all rows if there are no weights.
    pub(crate) fn assemble(&self, gluing: &Gluing, modes: &ModeTable<'_>, weights: Option<&RowWeights>) -> Columns {
        let mut matrix = self.interface.clone();
        let values = &mut matrix.values;
        let start = gluing.ranges().interface.start;
        if let Some(weights) = weights.filter(|w| !w.are_one(gluing.ranges().interface.clone())) {
            for block in 0..gluing.blocks() {
                let triple = &weights.diagonal[start + 3 * block..][..3];
                if triple == [1.0; 3] {
                    continue;
                }
                // corrects weights other than one, row by row
                for (c, weight) in triple.iter().enumerate() {
                    let part = |e: &BlockEntry| modes.at(e.subdomain, e.local)[c].map(|v| v * e.coefficient);
                    let entries = gluing.block(block).iter();
                    let row: Vec<(u32, [f64; 6])> = entries.map(|e| (e.subdomain, part(e))).collect();
                    self.add_row(&row, weight - 1.0, values);
                }
            }
        }
        let mut row = Vec::new();
        for nodal in 0..gluing.nodal_rows() {
            let number = gluing.nodal_row(nodal);
            let weight = weights.map_or(1.0, |w| w.of(number));
            let in_line = weights.is_some_and(|w| w.in_line(number));
            if weight != 0.0 && !in_line {
                row.clear();
                modes.row(gluing, nodal, 1.0, &mut row);
                self.add_row(&row, weight, values);
            }
        }
        for line in weights.iter().flat_map(|w| &w.lines) {
            row.clear();
            // Pairs of tangential rows stand before the interface, where row and number among nodal rows agree.
            modes.row(gluing, line.row, line.direction[0], &mut row);
            modes.row(gluing, line.row + 1, line.direction[1], &mut row);
            self.add_row(&row, line.weight, values);
        }
        matrix
    }
}

/// `sum f`, `sum f a`, `sum f b` and `sum f a b^T` over pairs of copies of nodes with the arms `a` and `b`.
#[derive(Clone, Copy, Default)]
struct Moments {
    sum: f64,
    first: [f64; 3],
    second: [f64; 3],
    both: [[f64; 3]; 3],
}

impl Moments {
    fn add(&mut self, factor: f64, a: &[f64; 3], b: &[f64; 3]) {
        self.sum += factor;
        for i in 0..3 {
            let scaled = factor * a[i];
            self.first[i] += scaled;
            self.second[i] += factor * b[i];
            for j in 0..3 {
                self.both[i][j] += scaled * b[j];
            }
        }
    }

    /// `sum f Q_a Q_b^T`, by columns: `Q` takes a force to its wrench.
    fn wrenches(&self) -> [[f64; 6]; 6] {
        let mut out = [[0.0; 6]; 6];
        let trace = self.both[0][0] + self.both[1][1] + self.both[2][2];
        for i in 0..3 {
            out[i][i] = self.sum;
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            // Moments of unit forces, and their transpose.
            out[j][3 + k] = self.first[i];
            out[k][3 + j] = -self.first[i];
            out[3 + k][j] = self.second[i];
            out[3 + j][k] = -self.second[i];
            for (r, row) in self.both.iter().enumerate() {
                out[3 + r][3 + i] = -row[i];
            }
        }
        for i in 0..3 {
            out[3 + i][3 + i] += trace;
        }
        out
    }
}

/// Neighbours of a subdomain with numbers not below its own, and what the interface rows contribute to its columns.
fn block_column(
    gluing: &Gluing,
    modes: &ModeTable<'_>,
    [blocks, nodal]: &[Lists<u32>; 2],
    subdomain: usize,
) -> (Vec<u32>, Vec<f64>) {
    let own = subdomain as u32;
    let kernel = modes.kernel(own);
    let mut moments: Vec<(u32, Moments)> = vec![(own, Moments::default())];
    for &block in blocks.of(subdomain) {
        let entries = gluing.block(block as usize);
        for b in entries.iter().filter(|e| e.subdomain == own) {
            for a in entries.iter().filter(|e| e.subdomain >= own) {
                let sums = entry(&mut moments, a.subdomain, Moments::default());
                let arm = modes.kernel(a.subdomain).arm(a.local as usize);
                let factor = a.coefficient * b.coefficient;
                sums.add(factor, arm, kernel.arm(b.local as usize));
            }
        }
    }
    for &nodal in nodal.of(subdomain) {
        for e in gluing.nodal(nodal as usize).iter().filter(|e| e.subdomain > own) {
            entry(&mut moments, e.subdomain, Moments::default());
        }
    }
    moments.sort_unstable_by_key(|m| m.0);
    let stride = 6 * moments.len();
    let mut values = vec![0.0; 6 * stride];
    for (k, (other, sums)) in moments.iter().enumerate() {
        let other = modes.kernel(*other);
        let columns = sums.wrenches().map(|column| other.project_wrench(&column));
        for r in 0..6 {
            let row = kernel.project_wrench(&std::array::from_fn(|c| columns[c][r]));
            for c in 0..6 {
                values[6 * k + r + c * stride] = row[c];
            }
        }
    }
    (moments.into_iter().map(|m| m.0).collect(), values)
}
