//! Assembly of `G W G^T` in blocks of six.

use crate::class::Classes;
use crate::error::TfetiError;
use crate::gluing::Gluing;
use crate::matrices::ClassBase;
use crate::rows::RowRanges;
use crate::sparse::Columns;

/// Weights `W` of the rows of `B` in `G W G^T`: a diagonal, and for chosen pairs of tangential rows a single direction.
#[derive(Debug, Clone, PartialEq)]
pub struct RowWeights {
    /// One non-negative weight per row.
    pub diagonal: Vec<f64>,
    /// Pairs of tangential rows of which one combination counts; they replace the diagonal there. Ascending by row.
    pub lines: Vec<LineWeight>,
}

/// Weight `weight * c c^T` on the rows `row, row + 1`, `c` the unit `direction`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineWeight {
    /// First of the two rows.
    pub row: usize,
    /// Unit vector.
    pub direction: [f64; 2],
    /// Non-negative weight.
    pub weight: f64,
}

impl RowWeights {
    /// A diagonal only.
    #[must_use]
    pub fn diagonal(diagonal: Vec<f64>) -> Self {
        Self {
            diagonal,
            lines: Vec::new(),
        }
    }

    /// Whether all interface rows have weight one and no row stands in a line.
    pub(crate) fn is_plain(&self, ranges: &RowRanges) -> bool {
        let interface = &self.diagonal[ranges.interface.clone()];
        self.lines.is_empty() && interface.iter().all(|w| *w == 1.0)
    }

    pub(crate) fn in_line(&self, row: usize) -> bool {
        let next = self.lines.partition_point(|l| l.row <= row);
        next > 0 && row - self.lines[next - 1].row < 2
    }

    /// Checks lengths, signs and the order of the lines against the rows of `B`.
    pub(crate) fn validate(&self, ranges: &RowRanges) -> Result<(), TfetiError> {
        let (expected, found) = (ranges.total(), self.diagonal.len());
        if found != expected {
            return Err(TfetiError::Length {
                what: "row weights",
                expected,
                found,
            });
        }
        let bad = |w: &f64| !(w.is_finite() && *w >= 0.0);
        let range = "finite and not negative";
        if let Some(&value) = self
            .diagonal
            .iter()
            .chain(self.lines.iter().map(|l| &l.weight))
            .find(|w| bad(w))
        {
            return Err(TfetiError::Setting {
                name: "row weight",
                value,
                range,
            });
        }
        for (k, line) in self.lines.iter().enumerate() {
            let inside = line.row >= ranges.discs.start && line.row + 1 < ranges.discs.end;
            let ordered = k == 0 || self.lines[k - 1].row + 1 < line.row;
            if !(inside && ordered) {
                let range = "a pair of tangential rows, each pair once, ascending";
                return Err(TfetiError::Setting {
                    name: "line row",
                    value: line.row as f64,
                    range,
                });
            }
        }
        Ok(())
    }

    /// `x = W x`.
    pub fn apply(&self, x: &mut [f64]) {
        let along = |line: &LineWeight, x: &[f64]| {
            line.weight * (line.direction[0] * x[line.row] + line.direction[1] * x[line.row + 1])
        };
        if self.lines.is_empty() {
            x.iter_mut().zip(&self.diagonal).for_each(|(x, w)| *x *= w);
            return;
        }
        // Lines first: the diagonal pass would overwrite what they need.
        for line in &self.lines {
            let value = along(line, x);
            x[line.row] = value * line.direction[0];
            x[line.row + 1] = value * line.direction[1];
        }
        let mut lines = self.lines.iter().map(|l| l.row).peekable();
        let mut k = 0;
        while k < x.len() {
            if lines.peek() == Some(&k) {
                lines.next();
                k += 2;
            } else {
                x[k] *= self.diagonal[k];
                k += 1;
            }
        }
    }
}

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
    classes: &'a Classes,
}

impl<'a> ModeTable<'a> {
    pub(crate) fn new(bases: &[ClassBase], classes: &'a Classes) -> Self {
        let table = |base: &ClassBase| {
            (0..base.kernel.nodes())
                .map(|n| base.kernel.node_modes(n))
                .collect()
        };
        Self {
            tables: bases.iter().map(table).collect(),
            classes,
        }
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

impl CoarseMatrix {
    pub(crate) fn new(gluing: &Gluing, modes: &ModeTable<'_>, subdomains: usize) -> Self {
        let mut lists: Vec<Vec<u32>> = (0..subdomains as u32).map(|s| vec![s]).collect();
        let mut join = |a: u32, b: u32| {
            let list = &mut lists[a.min(b) as usize];
            if !list.contains(&a.max(b)) {
                list.push(a.max(b));
            }
        };
        for block in 0..gluing.blocks() {
            let entries = gluing.block(block);
            for (k, a) in entries.iter().enumerate() {
                entries[..k]
                    .iter()
                    .for_each(|b| join(a.subdomain, b.subdomain));
            }
        }
        for special in 0..gluing.specials() {
            let entries = gluing.special(special);
            for (k, a) in entries.iter().enumerate() {
                entries[..k]
                    .iter()
                    .for_each(|b| join(a.subdomain, b.subdomain));
            }
        }
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
        for mut list in lists {
            list.sort_unstable();
            for _ in 0..6 {
                matrix.interface.rows.extend(
                    list.iter()
                        .flat_map(|&i| (0..6).map(move |r| 6 * i as usize + r)),
                );
                matrix.interface.pointers.push(matrix.interface.rows.len());
            }
            matrix.neighbours.extend(list);
            matrix.pointers.push(matrix.neighbours.len());
        }
        let mut values = vec![0.0; matrix.interface.rows.len()];
        for block in 0..gluing.blocks() {
            matrix.add_block(gluing, block, 1.0, modes, &mut values);
        }
        matrix.interface.values = values;
        matrix
    }

    /// Neighbours of each subdomain with numbers not below its own, itself first.
    pub(crate) fn graph(&self) -> Vec<Vec<u32>> {
        let list = |pair: &[usize]| self.neighbours[pair[0]..pair[1]].to_vec();
        self.pointers.windows(2).map(list).collect()
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

    fn add_block(
        &self,
        gluing: &Gluing,
        block: usize,
        weight: f64,
        modes: &ModeTable<'_>,
        values: &mut [f64],
    ) {
        let entries = gluing.block(block);
        for a in entries {
            let ra = modes.at(a.subdomain, a.local);
            for b in entries.iter().filter(|b| a.subdomain >= b.subdomain) {
                let rb = modes.at(b.subdomain, b.local);
                let factor = weight * a.coefficient * b.coefficient;
                let (start, stride) = self.place(a.subdomain, b.subdomain);
                for c in 0..6 {
                    let column = &mut values[start + c * stride..][..6];
                    for r in 0..6 {
                        column[r] += factor
                            * (ra[0][r] * rb[0][c] + ra[1][r] * rb[1][c] + ra[2][r] * rb[2][c]);
                    }
                }
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
