//! Assembly of `G W G^T` in blocks of six.

use crate::class::Classes;
use crate::coarse_tree::CoarseTree;
use crate::gluing::Gluing;
use crate::kernel::Kernel;
use crate::matrices::ClassBase;
use crate::row_weights::RowWeights;
use crate::sparse::Columns;
use rayon::prelude::*;
use signorini_fem_mesh::internal::buckets;

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
    bases: &'a [ClassBase],
    classes: &'a Classes,
}

impl<'a> ModeTable<'a> {
    pub(crate) fn new(bases: &'a [ClassBase], classes: &'a Classes) -> Self {
        let table = |base: &ClassBase| {
            (0..base.kernel.nodes())
                .map(|n| base.kernel.node_modes(n))
                .collect()
        };
        Self {
            tables: bases.iter().map(table).collect(),
            bases,
            classes,
        }
    }

    fn kernel(&self, subdomain: u32) -> &Kernel {
        &self.bases[self.classes.place(subdomain as usize).0].kernel
    }

    fn at(&self, subdomain: u32, local: u32) -> &Modes {
        &self.tables[self.classes.place(subdomain as usize).0][local as usize]
    }

    /// Row of `G^T`: `(subdomain, six coefficients)`, times `factor`, added to `out`.
    pub(crate) fn row(
        &self,
        gluing: &Gluing,
        special: usize,
        factor: f64,
        out: &mut Vec<(u32, [f64; 6])>,
    ) {
        for e in gluing.special(special) {
            let modes = self.at(e.subdomain, e.local);
            let at = match out.iter().position(|v| v.0 == e.subdomain) {
                Some(at) => at,
                None => {
                    out.push((e.subdomain, [0.0; 6]));
                    out.len() - 1
                }
            };
            for m in 0..6 {
                out[at].1[m] += factor * (0..3).map(|c| e.vector[c] * modes[c][m]).sum::<f64>();
            }
        }
    }
}

/// Rows of each subdomain, by their buckets.
struct Touching {
    starts: Vec<u32>,
    rows: Vec<u32>,
}

impl Touching {
    /// From pairs of a subdomain and a row, in the order of the rows.
    fn new(subdomains: usize, pairs: impl Iterator<Item = (u32, u32)>) -> Self {
        let (keys, numbers): (Vec<u32>, Vec<u32>) = pairs.unzip();
        let (starts, positions) = buckets(subdomains, &keys);
        let rows = positions.into_iter().map(|k| numbers[k as usize]).collect();
        Self { starts, rows }
    }

    fn blocks(gluing: &Gluing, subdomains: usize) -> Self {
        let pairs = (0..gluing.blocks()).flat_map(|b| {
            let entries = gluing.block(b).iter();
            entries.map(move |e| (e.subdomain, b as u32))
        });
        Self::new(subdomains, pairs)
    }

    fn specials(gluing: &Gluing, subdomains: usize) -> Self {
        let pairs = (0..gluing.specials()).flat_map(|k| {
            let entries = gluing.special(k).iter();
            entries.map(move |e| (e.subdomain, k as u32))
        });
        Self::new(subdomains, pairs)
    }

    fn of(&self, subdomain: usize) -> &[u32] {
        &self.rows[self.starts[subdomain] as usize..self.starts[subdomain + 1] as usize]
    }
}

impl CoarseMatrix {
    pub(crate) fn new(gluing: &Gluing, modes: &ModeTable<'_>, subdomains: usize) -> Self {
        let touching = [
            Touching::blocks(gluing, subdomains),
            Touching::specials(gluing, subdomains),
        ];
        let columns: Vec<(Vec<u32>, Vec<f64>)> = (0..subdomains)
            .into_par_iter()
            .map(|s| block_column(gluing, modes, &touching, s))
            .collect();
        let mut matrix = Self {
            pointers: vec![0],
            neighbours: Vec::new(),
            interface: Columns {
                dim: 6 * subdomains,
                pointers: vec![0],
                rows: Vec::new(),
                values: Vec::new(),
            },
        };
        for (list, values) in columns {
            for _ in 0..6 {
                matrix.interface.rows.extend(
                    list.iter()
                        .flat_map(|&i| (0..6).map(move |r| 6 * i as usize + r)),
                );
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

    /// Adds the entries of the columns of node `k` of a tree of this `graph`.
    pub(crate) fn load(
        &self,
        tree: &CoarseTree,
        graph: &[Vec<u32>],
        k: usize,
        values: &[f64],
        columns: &mut [f64],
    ) {
        let node = &tree.nodes[k];
        let height = node.height();
        for q in node.columns.clone() {
            let a = tree.blocks[q];
            for &b in graph[a as usize].iter().chain([&a]) {
                let p = tree.place[b as usize];
                if (p as usize) < q {
                    continue;
                }
                let target = &mut columns[tree.place_in(k, p, q as u32)..];
                let (start, stride) = self.place(a.max(b), a.min(b));
                for c in 0..6 {
                    for r in 0..6 {
                        let (row, column) = if a <= b { (r, c) } else { (c, r) };
                        target[c * height + r] += values[start + column * stride + row];
                    }
                }
            }
        }
    }

    pub(crate) fn pattern(&self) -> &Columns {
        &self.interface
    }

    /// Position of entry (0, 0) of a block and the distance between its columns.
    fn place(&self, i: u32, j: u32) -> (usize, usize) {
        let list = &self.neighbours[self.pointers[j as usize]..self.pointers[j as usize + 1]];
        let k = list.partition_point(|&n| n < i);
        (36 * self.pointers[j as usize] + 6 * k, 6 * list.len())
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
    pub(crate) fn assemble(
        &self,
        gluing: &Gluing,
        modes: &ModeTable<'_>,
        weights: Option<&RowWeights>,
    ) -> Columns {
        let mut matrix = self.interface.clone();
        let values = &mut matrix.values;
        let start = gluing.ranges().interface.start;
        if let Some(weights) = weights {
            for block in 0..gluing.blocks() {
                let triple = &weights.diagonal[start + 3 * block..][..3];
                if triple == [1.0; 3] {
                    continue;
                }
                self.add_block_components(gluing, block, triple, modes, values);
            }
        }
        let mut row = Vec::new();
        for special in 0..gluing.specials() {
            let number = gluing.special_row(special);
            let weight = weights.map_or(1.0, |w| w.diagonal[number]);
            let in_line = weights.is_some_and(|w| w.in_line(number));
            if weight != 0.0 && !in_line {
                row.clear();
                modes.row(gluing, special, 1.0, &mut row);
                self.add_row(&row, weight, values);
            }
        }
        for line in weights.iter().flat_map(|w| &w.lines) {
            row.clear();
            // Pairs of tangential rows stand before the interface, where row and special number agree.
            modes.row(gluing, line.row, line.direction[0], &mut row);
            modes.row(gluing, line.row + 1, line.direction[1], &mut row);
            self.add_row(&row, line.weight, values);
        }
        matrix
    }

    /// Corrects one interface block for weights other than one.
    fn add_block_components(
        &self,
        gluing: &Gluing,
        block: usize,
        weights: &[f64],
        modes: &ModeTable<'_>,
        values: &mut [f64],
    ) {
        for (c, weight) in weights.iter().enumerate() {
            let row: Vec<(u32, [f64; 6])> = gluing
                .block(block)
                .iter()
                .map(|e| {
                    (
                        e.subdomain,
                        modes.at(e.subdomain, e.local)[c].map(|v| v * e.coefficient),
                    )
                })
                .collect();
            self.add_row(&row, weight - 1.0, values);
        }
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
    [blocks, specials]: &[Touching; 2],
    subdomain: usize,
) -> (Vec<u32>, Vec<f64>) {
    let own = subdomain as u32;
    let kernel = modes.kernel(own);
    let mut moments: Vec<(u32, Moments)> = vec![(own, Moments::default())];
    for &block in blocks.of(subdomain) {
        let entries = gluing.block(block as usize);
        for b in entries.iter().filter(|e| e.subdomain == own) {
            for a in entries.iter().filter(|e| e.subdomain >= own) {
                let at = match moments.iter().position(|m| m.0 == a.subdomain) {
                    Some(at) => at,
                    None => {
                        moments.push((a.subdomain, Moments::default()));
                        moments.len() - 1
                    }
                };
                moments[at].1.add(
                    a.coefficient * b.coefficient,
                    modes.kernel(a.subdomain).arm(a.local as usize),
                    kernel.arm(b.local as usize),
                );
            }
        }
    }
    for &special in specials.of(subdomain) {
        for e in gluing.special(special as usize) {
            if e.subdomain > own && moments.iter().all(|m| m.0 != e.subdomain) {
                moments.push((e.subdomain, Moments::default()));
            }
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
