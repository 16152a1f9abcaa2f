//! What is said of the fixed-point loop (3.17).

/// What the sequence of iterates tells about the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Verdict {
    /// The relative change fell below the tolerance.
    Converged,
    /// Changes shrink, more iterations are needed.
    Contracting,
    /// Changes do not shrink: the map is not contractive here, the fixed-point form has no limit from this start.
    NotContractive,
    /// Too few iterates to tell.
    Unknown,
}

/// How the fixed-point loop of a step went.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FixedPointReport {
    /// How it ended.
    pub verdict: Verdict,
    /// Evaluations of the map.
    pub evaluations: usize,
    /// Last relative change.
    pub change: f64,
    /// Estimated contraction rate.
    pub rate: Option<f64>,
}
