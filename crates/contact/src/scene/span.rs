//! When supports and contacts act.

use crate::tolerances::ROUNDING;

/// A span of time: of the steps whose ends are later than its start, and not later than its end.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Span {
    /// s; `None` from the beginning.
    pub(crate) start: Option<f64>,
    /// s; `None` for ever.
    pub(crate) end: Option<f64>,
}

impl Span {
    /// Whether a step that ends at this time belongs to it.
    pub(crate) fn has(&self, step: f64) -> bool {
        self.start.is_none_or(|start| is_past(start, step)) && !self.end.is_some_and(|end| is_past(end, step))
    }

    /// Whether a step that ends at one of these times belongs to both.
    pub(crate) fn meets(&self, other: &Self, ends: &[f64]) -> bool {
        ends.iter().any(|&end| self.has(end) && other.has(end))
    }

    /// The times at which it starts and ends, s.
    pub(crate) fn times(&self) -> impl Iterator<Item = f64> + use<> {
        self.start.into_iter().chain(self.end)
    }

    /// Whether both are times, and in order.
    pub(crate) fn is_good(&self) -> bool {
        let start = self.start.unwrap_or(0.0);
        self.times().all(|time| time.is_finite() && time >= 0.0) && self.end.is_none_or(|end| start < end)
    }
}

/// Whether something has happened before a step that ends at this time.
pub(crate) fn is_past(time: f64, step: f64) -> bool {
    time * (1.0 + ROUNDING) < step
}
