//! Weights of the rows of `B` in the coarse matrix.

use crate::error::TfetiError;
use crate::rows::ranges::RowRanges;
use crate::tolerances::UNIT;
use signorini_qp::internal::LineWeight;
use std::ops::Range;

/// Weights `W` of the rows of `B` in `G W G^T`: a diagonal, and for chosen pairs of tangential rows a single direction.
#[derive(Debug, Clone, PartialEq)]
pub struct RowWeights {
    /// Non-negative weights of the rows; of all, or of the contact rows alone: the others then weigh one.
    pub diagonal: Vec<f64>,
    /// Pairs of tangential rows of which one combination counts; they replace the diagonal there. Ascending by row.
    pub lines: Vec<LineWeight>,
}

/// `weight * c c^T` of a line times a pair.
pub(crate) fn along(line: &LineWeight, pair: [f64; 2]) -> [f64; 2] {
    let [c, d] = line.direction;
    let value = line.weight * (c * pair[0] + d * pair[1]);
    [value * c, value * d]
}

impl RowWeights {
    /// A diagonal only.
    pub fn diagonal(diagonal: Vec<f64>) -> Self {
        let lines = Vec::new();
        Self { diagonal, lines }
    }

    /// The weight of a row, but for lines.
    pub(crate) fn of(&self, row: usize) -> f64 {
        self.diagonal.get(row).copied().unwrap_or(1.0)
    }

    /// Whether these rows weigh one.
    pub(crate) fn are_one(&self, rows: Range<usize>) -> bool {
        let end = self.diagonal.len();
        self.diagonal[rows.start.min(end)..rows.end.min(end)]
            .iter()
            .all(|w| *w == 1.0)
    }

    pub(crate) fn in_line(&self, row: usize) -> bool {
        let next = self.lines.partition_point(|l| l.row <= row);
        next > 0 && row - self.lines[next - 1].row < 2
    }

    /// Checks lengths, signs, and order and directions of the lines against the rows of `B`.
    pub(crate) fn validate(&self, ranges: &RowRanges) -> Result<(), TfetiError> {
        if self.diagonal.len() != ranges.contact().end {
            TfetiError::check_length("row weights", self.diagonal.len(), ranges.total())?;
        }
        let refuse = |name, value, range| Err(TfetiError::Setting { name, value, range });
        let mut all = self.diagonal.iter().chain(self.lines.iter().map(|l| &l.weight));
        if let Some(&value) = all.find(|w| !(w.is_finite() && **w >= 0.0)) {
            return refuse("row weight", value, "finite and not negative");
        }
        for (k, line) in self.lines.iter().enumerate() {
            let inside = ranges.discs.contains(&line.row) && line.row < ranges.discs.end - 1;
            if !inside || k > 0 && self.lines[k - 1].row + 1 >= line.row {
                let range = "a pair of tangential rows, each pair once, ascending";
                return refuse("line row", line.row as f64, range);
            }
            let length = line.direction[0].hypot(line.direction[1]);
            if length.is_nan() || (length - 1.0).abs() > UNIT {
                return refuse("length of a line direction", length, "1 within 1e-10");
            }
        }
        Ok(())
    }

    /// `x = W x`, if the diagonal is one where there are lines.
    pub(crate) fn apply(&self, x: &mut [f64]) {
        x.iter_mut().zip(&self.diagonal).for_each(|(x, w)| *x *= w);
        for line in &self.lines {
            let pair = along(line, [x[line.row], x[line.row + 1]]);
            x[line.row..line.row + 2].copy_from_slice(&pair);
        }
    }
}
