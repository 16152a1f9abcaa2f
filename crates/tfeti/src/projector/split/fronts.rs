//! What the contact rows add to the fronts of the coarse matrix.

use signorini_qp::internal::LineWeight;

/// The terms `w_r g_r g_r^T` of the contact rows `r`, by the front to whose columns they belong.
#[derive(Debug)]
pub(crate) struct ContactTerms {
    /// Coefficients `g_r` on one subdomain each.
    vectors: Vec<[f64; 6]>,
    terms: Vec<Term>,
    /// First term of each front.
    pointers: Vec<usize>,
    /// Whether the row after a row stands on the same subdomains.
    paired: Vec<bool>,
}

/// Weights of the contact rows: a diagonal, and `c c^T` on some pairs of rows, whose diagonal counts nothing.
#[derive(Debug, Default)]
pub(crate) struct ContactWeights {
    diagonal: Vec<f64>,
    /// `c` for the first row of a pair, else zero; empty without pairs.
    lines: Vec<[f64; 2]>,
}

impl ContactWeights {
    pub(crate) fn set(&mut self, diagonal: &[f64], lines: &[LineWeight]) {
        self.diagonal.clear();
        self.diagonal.extend_from_slice(diagonal);
        self.lines.clear();
        if lines.is_empty() {
            return;
        }
        self.lines.resize(diagonal.len(), [0.0; 2]);
        for line in lines {
            self.diagonal[line.row..line.row + 2].fill(0.0);
            self.lines[line.row] = line.direction.map(|c| c * line.weight.sqrt());
        }
    }
}

/// A block of one row's term.
#[derive(Debug, Clone, Copy)]
struct Term {
    row: u32,
    /// Coefficients along its rows and its columns.
    vectors: [u32; 2],
    /// From them to those of the next row.
    next: u32,
    /// Its first entry in the columns of the front.
    place: usize,
}

/// Appends the entries of a contact row: six coefficients a block.
pub(crate) type ContactRow<'a> = dyn Fn(usize, &mut Vec<(u32, [f64; 6])>) + 'a;

/// Front and first entry of the block of two subdomains.
pub(crate) type ContactPlace<'a> = dyn Fn(u32, u32) -> Option<(usize, usize)> + 'a;

impl ContactTerms {
    /// `write` appends the entries of one of the leading `rows` of `G^T`; `place` tells in which of `count` fronts the
    /// block of two subdomains stands, if it is stored, and where.
    pub(crate) fn new(count: usize, rows: usize, place: &ContactPlace<'_>, write: &ContactRow<'_>) -> Self {
        let mut vectors: Vec<[f64; 6]> = Vec::new();
        let mut terms: Vec<(usize, Term)> = Vec::new();
        let (mut row, mut before) = (Vec::new(), Vec::new());
        let mut paired = vec![false; rows];
        for nodal in 0..rows {
            row.clear();
            write(nodal, &mut row);
            let subdomains: Vec<u32> = row.iter().map(|(s, _)| *s).collect();
            if nodal > 0 {
                paired[nodal - 1] = subdomains == before;
            }
            before = subdomains;
            let first = vectors.len();
            vectors.extend(row.iter().map(|(_, g)| *g));
            for (i, &(a, _)) in row.iter().enumerate() {
                for (j, &(b, _)) in row.iter().enumerate() {
                    let Some((k, place)) = place(a, b) else {
                        continue;
                    };
                    let term = Term {
                        row: nodal as u32,
                        vectors: [i, j].map(|v| (first + v) as u32),
                        next: row.len() as u32,
                        place,
                    };
                    terms.push((k, term));
                }
            }
        }
        terms.sort_by_key(|(k, term)| (*k, term.place));
        let pointers = (0..=count).map(|k| terms.partition_point(|t| t.0 < k));
        Self {
            pointers: pointers.collect(),
            terms: terms.into_iter().map(|(_, term)| term).collect(),
            vectors,
            paired,
        }
    }

    /// Whether pairs of rows may stand in these lines.
    pub(crate) fn allow(&self, lines: &[LineWeight]) -> bool {
        lines.iter().all(|l| self.paired.get(l.row) == Some(&true))
    }

    /// Adds the terms of one front to its columns of the given height.
    pub(crate) fn add(&self, front: usize, height: usize, weights: &ContactWeights, columns: &mut [f64]) {
        for term in &self.terms[self.pointers[front]..self.pointers[front + 1]] {
            let row = term.row as usize;
            let weight = weights.diagonal[row];
            let [mut a, mut b] = term.vectors.map(|v| self.vectors[v as usize]);
            match weights.lines.get(row) {
                Some(&[c, d]) if c != 0.0 || d != 0.0 => {
                    let both = term.vectors.map(|v| &self.vectors[(v + term.next) as usize]);
                    for k in 0..6 {
                        a[k] = c * a[k] + d * both[0][k];
                        b[k] = c * b[k] + d * both[1][k];
                    }
                }
                _ if weight == 0.0 => continue,
                _ => b.iter_mut().for_each(|b| *b *= weight),
            }
            for c in 0..6 {
                let target = &mut columns[term.place + c * height..][..6];
                for r in 0..6 {
                    target[r] += b[c] * a[r];
                }
            }
        }
    }
}
