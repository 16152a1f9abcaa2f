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

// ---- equilibrium of free bodies (model) ----

/// Work on a free motion below this fraction of the size of the loads is rounding.
pub(crate) const FREE_WORK: f64 = 1e-9;

/// Loads over their length that differ by less have been judged already.
pub(crate) const SAME_LOADS: f64 = 1e-12;

/// What is left of loads of length one that contact forces cannot take, below which it is rounding.
pub(crate) const WRENCH_RESIDUAL: f64 = 1e-8;

/// Singular values below this part of the largest count as zero where contact forces are found.
pub(crate) const WRENCH_RANK: f64 = 1e-13;

/// Contact forces below this part of the largest leave.
pub(crate) const WRENCH_FACTOR: f64 = 1e-14;

/// Loads that would need contact forces that many times their own size count as not held.
pub(crate) const LEVERAGE: f64 = 1e5;

/// Part by which loads must exceed Tresca friction to count.
pub(crate) const TRESCA_EXCESS: f64 = 1e-6;

/// Friction so many times as large is none that a remedy could name.
pub(crate) const MOST_FRICTION: f64 = 1e3;

/// Accuracy of the factor of friction that is named, relative.
pub(crate) const FRICTION_FACTOR: f64 = 1e-4;

// ---- steps in time (scene) ----

/// A difference formula is consistent whose sums are off by less.
pub(crate) const CONSISTENT: f64 = 1e-12;

/// Steps are equal whose lengths differ by less, relative to the longer one.
pub(crate) const UNEQUAL: f64 = 1e-9;

// ---- rounds of a step and orders in time (simulation) ----

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

// ---- the duality gap (estimate) ----

/// Components of unit directions that differ by less are the same.
pub(crate) const SAME_DIRECTION: f64 = 1e-12;

/// Freedom of a node (3 without supports) that supports take counts above this.
pub(crate) const FREEDOM_TAKEN: f64 = 1e-8;

/// Positions that differ by less than this part of displacement and offset are the same.
pub(crate) const SAME_POSITION: f64 = 1e-12;

/// Relative change of a slip bound that is judged by the stiffness of the node. Larger ones move the whole body, and the gap,
/// which overrates small changes, is the safer measure.
pub(crate) const NEAR_BOUND: f64 = 0.01;

/// Planes of one node are parallel below this singular value over the largest.
pub(crate) const PARALLEL: f64 = 1e-6;

/// Imbalance of subdomains relative to their forces that is rounding.
pub(crate) const BALANCED: f64 = 1e-12;

/// Elastic energy that may be rounding, relative to that of all nodes moved alone: that of a body that moves without strain is
/// a difference of numbers this much larger, or more.
pub(crate) const NO_STRAIN: f64 = 1e-12;
