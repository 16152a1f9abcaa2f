//! What the contact rows add to the fronts of the coarse matrix.

use crate::coarse_matrix::ModeTable;
use crate::coarse_tree::CoarseTree;
use crate::gluing::Gluing;

/// The terms `w_r g_r g_r^T` of the contact rows `r`, by the node to whose columns they belong.
#[derive(Debug)]
pub(crate) struct ContactFronts {
    /// Coefficients `g_r` on one subdomain each.
    vectors: Vec<[f64; 6]>,
    terms: Vec<Term>,
    /// First term of each node.
    pointers: Vec<usize>,
}

/// A block of one row's term.
#[derive(Debug, Clone, Copy)]
struct Term {
    row: u32,
    /// Coefficients along its rows and its columns.
    vectors: [u32; 2],
    /// Its first entry in the columns of the node.
    place: usize,
}

impl ContactFronts {
    pub(crate) fn new(
        tree: &CoarseTree,
        gluing: &Gluing,
        modes: &ModeTable<'_>,
        rows: usize,
    ) -> Self {
        let mut vectors: Vec<[f64; 6]> = Vec::new();
        let mut terms: Vec<(usize, Term)> = Vec::new();
        let mut row = Vec::new();
        for special in 0..rows {
            row.clear();
            modes.row(gluing, special, 1.0, &mut row);
            let first = vectors.len();
            vectors.extend(row.iter().map(|(_, g)| *g));
            for (i, &(a, _)) in row.iter().enumerate() {
                for (j, &(b, _)) in row.iter().enumerate() {
                    let (p, q) = (tree.place[a as usize], tree.place[b as usize]);
                    if p < q {
                        continue;
                    }
                    let k = tree.node_of(q as usize);
                    let term = Term {
                        row: special as u32,
                        vectors: [i, j].map(|v| (first + v) as u32),
                        place: tree.place_in(k, p, q),
                    };
                    terms.push((k, term));
                }
            }
        }
        terms.sort_by_key(|(k, term)| (*k, term.place));
        let pointers = (0..=tree.nodes.len()).map(|k| terms.partition_point(|t| t.0 < k));
        Self {
            pointers: pointers.collect(),
            terms: terms.into_iter().map(|(_, term)| term).collect(),
            vectors,
        }
    }

    /// Adds the terms of one node to its columns of the given height.
    pub(crate) fn add(&self, node: usize, height: usize, weights: &[f64], columns: &mut [f64]) {
        for term in &self.terms[self.pointers[node]..self.pointers[node + 1]] {
            let weight = weights[term.row as usize];
            if weight == 0.0 {
                continue;
            }
            let [a, b] = term.vectors.map(|v| &self.vectors[v as usize]);
            for c in 0..6 {
                let factor = weight * b[c];
                let target = &mut columns[term.place + c * height..][..6];
                for r in 0..6 {
                    target[r] += factor * a[r];
                }
            }
        }
    }
}
