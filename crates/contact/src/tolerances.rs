//! Thresholds that more than one room asks: numerical judgements, each with what it is relative to and why.

/// Forces are measured against this part of displacement times stiffness at least: what is left of a rigid motion are rounding
/// errors, 1e-16 of that product.
pub(crate) const ROUNDED: f64 = 1e-8;

/// Part of the earlier sizes that a vanishing quantity is measured against.
pub(crate) const REST: f64 = 1e-3;

/// Tolerance of the first solve of the first step where estimates choose. A looser one saves little and may end before slip
/// bounds have settled.
pub(crate) const LOOSEST: f64 = 1e-3;

/// Solves of one step where estimates choose.
pub(crate) const ROUNDS: usize = 8;

/// Largest certificate of a converged step over the tolerance.
pub(crate) const CERTIFIED: f64 = 30.0;

/// Aim of a second round, as a fraction of the tolerance.
pub(crate) const NEXT_AIM: f64 = 0.3;

/// Most by which the tolerance of a round falls below that of the round before.
pub(crate) const NEXT_TOLERANCE: f64 = 0.01;

/// Smallest tolerance that is tried for a certificate, and the certificate that rounding leaves.
pub(crate) const LEAST_TOLERANCE: f64 = 1e-10;

/// Differences of runs are time error, and not the solver's, from this many times the solver's errors on.
pub(crate) const ABOVE_SOLVER: f64 = 3.0;

/// Orders of the time steps that are believed: below, the steps have not settled into a sequence of sticking and sliding, and
/// no more than the upper one is in the formulas.
pub(crate) const ORDERS: [f64; 2] = [0.5, 2.5];
