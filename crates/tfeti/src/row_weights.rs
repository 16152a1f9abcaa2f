//! Weights of the rows of `B` in the coarse matrix.

use crate::error::TfetiError;
use crate::rows::RowRanges;

pub use signorini_qp::internal::LineWeight;

/// Weights `W` of the rows of `B` in `G W G^T`: a diagonal, and for chosen pairs of tangential rows a single direction.
#[derive(Debug, Clone, PartialEq)]
pub struct RowWeights {
    /// One non-negative weight per row.
    pub diagonal: Vec<f64>,
    /// Pairs of tangential rows of which one combination counts; they replace the diagonal there. Ascending by row.
    pub lines: Vec<LineWeight>,
}

/// Largest error of the length of a direction.
const UNIT: f64 = 1e-10;

impl RowWeights {
    /// A diagonal only.
    #[must_use]
    pub fn diagonal(diagonal: Vec<f64>) -> Self {
        Self {
            diagonal,
            lines: Vec::new(),
        }
    }

    /// Whether all interface rows have weight one.
    pub(crate) fn is_plain(&self, ranges: &RowRanges) -> bool {
        let interface = &self.diagonal[ranges.interface.clone()];
        interface.iter().all(|w| *w == 1.0)
    }

    pub(crate) fn in_line(&self, row: usize) -> bool {
        let next = self.lines.partition_point(|l| l.row <= row);
        next > 0 && row - self.lines[next - 1].row < 2
    }

    /// Checks lengths, signs, and order and directions of the lines against the rows of `B`.
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
            let inside = ranges.discs.contains(&line.row) && line.row < ranges.discs.end - 1;
            let ordered = k == 0 || self.lines[k - 1].row + 1 < line.row;
            if !(inside && ordered) {
                let range = "a pair of tangential rows, each pair once, ascending";
                return Err(TfetiError::Setting {
                    name: "line row",
                    value: line.row as f64,
                    range,
                });
            }
            let [c, d] = line.direction;
            let length = c.hypot(d);
            // False for NaN.
            let unit = (length - 1.0).abs() <= UNIT;
            if !unit {
                return Err(TfetiError::Setting {
                    name: "length of a line direction",
                    value: length,
                    range: "1 within 1e-10",
                });
            }
        }
        Ok(())
    }

    /// `x = W x`.
    ///
    /// # Panics
    /// If `x` is longer than the weights and there are lines, or too short for a line.
    pub fn apply(&self, x: &mut [f64]) {
        if self.lines.is_empty() {
            x.iter_mut().zip(&self.diagonal).for_each(|(x, w)| *x *= w);
            return;
        }
        // Lines first: the diagonal pass would overwrite what they need.
        for line in &self.lines {
            let pair = line.along([x[line.row], x[line.row + 1]]);
            x[line.row..line.row + 2].copy_from_slice(&pair);
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
