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
