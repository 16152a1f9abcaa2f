//! The numerical judgements of this crate, in one table: what each is relative to, and why it has this value.
//!
//! A number that follows from an algorithm (a factor of a formula, a default of a setting) stands where it is used.

// Common ideas

/// A measure below this part of the smallest so far is progress: less is noise of conjugate gradients.
pub(crate) const PROGRESS: f64 = 0.9;
/// Curvature `p·Ap` below minus this part of the norm of the operator times `p·p` makes it indefinite; above it is
/// rounding.
pub(crate) const NEGATIVE_CURVATURE: f64 = 1e-10;
/// Curvature `p·Ap` over `p·p` times the largest `|Ap| / |p|` so far that is rounding: there is none along `p`.
pub(crate) const FLAT: f64 = 1e-13;
/// A step of conjugate gradients over the shortest one from which on its direction is asked whether it has curvature.
pub(crate) const LONG: f64 = 1e4;
/// Curvature over the largest one that a direction without any is given, so that steps along it lead to the boundary.
pub(crate) const LENT: f64 = 1e-2;
/// Gradient over `|b| + |A x|` that is rounding.
pub(crate) const FLAT_GRADIENT: f64 = 1e-10;
/// The same from which on `x` is no solution, however small the error is against it.
pub(crate) const RUNAWAY: f64 = 1e-2;

// Data of a problem

/// Distance of a point from its circle, over the radius, below which it lies on it. The sum of two squares has 1e-16.
pub(crate) const ON_CIRCLE: f64 = 1e-12;
/// Difference of transposed entries over the largest entry that makes a matrix not symmetric.
pub(crate) const ASYMMETRY: f64 = 1e-12;
/// Part of a row orthogonal to the rows before, over its norm, below which it depends on them. Gram-Schmidt is done
/// twice.
pub(crate) const DEPENDENT_ROW: f64 = 1e-10;
/// Pivot of `G W Gᵀ` over its largest diagonal entry that counts as zero.
pub(crate) const SINGULAR_PIVOT: f64 = 1e-12;

// Checks

/// Estimate of a norm: most products, residual over the Ritz value at which it stops, factor on its upper value.
pub(crate) const NORM_PRODUCTS: usize = 20;
pub(crate) const NORM_ACCURACY: f64 = 0.02;
pub(crate) const NORM_MARGIN: f64 = 1.02;
/// Off-diagonal entry of Lanczos over the largest Ritz value at which the space is exhausted.
pub(crate) const EXHAUSTED: f64 = 1e-14;
/// Distance from a bound, over `|x|`, at which the independent check counts a component as on it.
pub(crate) const KKT_ON_BOUND: f64 = 1e-10;
/// Distance from a circle, over its radius, at which the independent check counts a point as on it.
pub(crate) const KKT_ON_CIRCLE: f64 = 1e-9;
/// Rounding allowed in the laws of a set, relative to the vectors; wider where a point next to a circle counts as on
/// it.
pub(crate) const LAW: f64 = 1e-10;
pub(crate) const LAW_ON_CIRCLE: f64 = 1e-6;

// KPRGP

/// Share of the decrease of a small gradient step that a long step has to reach.
pub(crate) const LONG_STEP: f64 = 1e-6;
/// Gradient over `norm(A) |x|` that is rounding.
pub(crate) const ROUNDED_GRADIENT: f64 = 1e3 * f64::EPSILON;
/// Progress of the projected gradient; steps without it after which rounding is looked for.
pub(crate) const KPRGP_PROGRESS: f64 = 0.99;
pub(crate) const KPRGP_PATIENCE: usize = 60;
/// Estimated drift of the recurrence, over the tolerance, above which the gradient is computed afresh.
pub(crate) const DRIFTED: f64 = 0.1;
/// Fresh gradients above the tolerance after which the recurrence is taken to be at the level of rounding.
pub(crate) const FAILED_CHECKS: usize = 4;
/// Rise of the cost by a fixed step, over `|step|² / length`, which only a norm that is too small explains.
pub(crate) const COST_RISE: f64 = 0.01;

// SMALSE

/// Least precision control `M` over the norm: it need not fall below `sqrt(rho lambda_min)`.
pub(crate) const LEAST_PRECISION: f64 = 1e-4;
/// Least reference of the tolerance, over the unprojected load: below it the projected load is rounding.
pub(crate) const PROJECTED_LOAD: f64 = 1e-7;
/// Least reference of the tolerance, over the norm of the operator times the size of `x` that counts as nothing.
pub(crate) const LEAST_RESPONSE: f64 = 0.01;
/// Outer steps with a stagnating inner solver after which the solve ends.
pub(crate) const STAGNATIONS: usize = 3;

// Active set: the point

/// Step of the natural map, in units of the preconditioner's diagonal.
pub(crate) const NATURAL_STEP: f64 = 0.4;
/// Share of the free bounded components that may change for the hook to be called.
pub(crate) const SETTLED: f64 = 0.3;
/// Distance from a circle, over the radius, at which a point may slide. Wider than [`ON_CIRCLE`]: projectors round
/// more.
pub(crate) const MAY_SLIDE: f64 = 1e-9;
/// The same for points that a solve begins with: radii that follow a balance leave them a little inside.
pub(crate) const SLID: f64 = 1e-6;
/// Part of `x`, or of what the natural map moves `x = 0` by, that is rounding, in `x` and in its errors.
pub(crate) const ROUNDED: f64 = 1e-14;
/// Way inwards by the natural map, over the radius, that takes a point across its circle. Points that give way together
/// give way more than one alone: flat elements by as much.
pub(crate) const ACROSS: f64 = 100.0;
/// Least size of the constrained part, over `|x|`, that its errors are relative to.
pub(crate) const SMALL_PART: f64 = 1e-4;
/// Largest `|x|` so far over the present one from which on `A x` is computed afresh.
pub(crate) const SHRUNK: f64 = 1e5;
/// Part of the tolerance that `x` may be off the equality after steps that round, and `A x` off `x` at the end.
pub(crate) const NEGLIGIBLE: f64 = 0.03;

// Active set: conjugate gradients on one set

/// Most steps: where more are needed, rounding has taken over or the set is not worth it.
pub(crate) const MOST_STEPS: usize = 500;
/// The same on the path of compliant constraints: its problems are badly conditioned, and need not be solved well. And
/// with a preconditioner that is nearly an inverse: where a few steps do not do, radii that follow lead astray.
pub(crate) const FEW_STEPS: usize = 50;
/// Error over that at the start of a set from which on steps may lead away for good, and the longest step then, over
/// `|x|`. Small enough that the rest of the set still tells something.
pub(crate) const ASTRAY: f64 = 4.0;
pub(crate) const ASTRAY_STEP: f64 = 0.1;
/// Part of the tolerance below which further steps buy nothing: the move after them brings some of it back.
pub(crate) const ENOUGH: f64 = 0.6;
/// Share of the free bounded components whose change, most of it one way, makes a set not worth it: one step leads over
/// it to the next.
pub(crate) const PASSING: f64 = 0.05;
/// Constrained part over `|x|` below which sets change without an end: nothing is on its way then.
pub(crate) const PASSING_PART: f64 = 0.01;
/// Length of that step over the last one that was measured: of a fixed length, it must not magnify what is stiff.
pub(crate) const PASSING_STEP: f64 = 0.9;
/// `|x|` over its value at the start of a set from which on limits relative to it are set anew.
pub(crate) const GROWN: f64 = 2.0;
/// Decrease of the error that steps which round can make.
pub(crate) const ROUNDED_STEPS: f64 = 1e-5;
/// Error over the jump and the error before it that comes from bad conditioning, and has to fall further.
pub(crate) const MAGNIFIED: f64 = 10.0;

// Active set: radii that follow

/// Coupled steps on one set, and growth of the error, from which on the coupling is too strong.
pub(crate) const COUPLED_STEPS: usize = 40;
pub(crate) const COUPLED_GROWTH: f64 = 2.0;
/// Largest error, over the constrained part, with which a coupled set begins: before, the active set changes too much.
pub(crate) const COUPLED_NEAR: f64 = 0.1;
/// Sets without progress after which coupling is tried far from the solution.
pub(crate) const COUPLED_WAIT: usize = 4;
/// Decrease on a coupled set: this many times the part of the last error that the move brought back, and the least.
pub(crate) const COUPLED_LOST: f64 = 10.0;
pub(crate) const COUPLED_LEAST: f64 = 0.03;

// Active set: the path of compliant constraints

/// Estimated error over the first one from which on predictions lead away, and on so many sets in a row.
pub(crate) const LED_AWAY: f64 = 100.0;
pub(crate) const AWAY: f64 = 20.0;
pub(crate) const AWAY_SETS: usize = 3;
/// The first compliance, in units of that of one component alone: plates of 20 to 50 times their thickness settle with
/// it, or with the next.
pub(crate) const START_COMPLIANCE: f64 = 1e3;
pub(crate) const MORE_COMPLIANT: f64 = 100.0;
/// Paths that are tried.
pub(crate) const PATHS: i32 = 2;
/// Factor from one compliance to the next, and below which there is none.
pub(crate) const LESS_COMPLIANT: f64 = 0.1;
pub(crate) const LEAST_COMPLIANCE: f64 = 0.3;
/// Error, relative, to which a problem on the path is solved, and forcing at most on sets without progress behind it.
pub(crate) const ON_PATH: f64 = 0.1;
pub(crate) const BEHIND_PATH: f64 = 0.01;

// Active set: without progress

/// Sets without a better error after which predictions run in circles: another path is tried, or the solve ends.
pub(crate) const PATIENCE: usize = 12;
/// Sets without progress after which the solved set tells what is active next, not the point moved to.
pub(crate) const UNSURE: usize = 4;
/// Times that a body which constraints alone hold is balanced with a set that follows.
pub(crate) const BALANCE_ROUNDS: usize = 3;
/// Part of a round's way that the next one goes back, from which on they swing about their limit; rounds then, and the
/// least part of a way that is gone.
pub(crate) const SWING: f64 = 0.3;
pub(crate) const SWINGING_ROUNDS: usize = 8;
pub(crate) const LEAST_PART: f64 = 0.1;
/// Factor on `PATIENCE` for moves in a row that find no balance, from which on there seems to be none.
pub(crate) const UNBALANCED: usize = 2;
/// Factor on the most active sets once a path has led to another set.
pub(crate) const LONGER: usize = 5;

// Active set: the start of bodies that constraints alone hold

/// Rounds in which springs under a body and the number of those that are pressed follow each other.
pub(crate) const SINK_ROUNDS: usize = 3;
/// Share of the bounded components above which most are pressed from the start, and gaps tell nothing.
pub(crate) const PRESSED: f64 = 0.5;

// Active set: the balance of modes that constraints alone hold

/// Most Newton steps, and most halvings of one.
pub(crate) const NEWTON_STEPS: usize = 50;
pub(crate) const HALVINGS: usize = 30;
/// Work of the right side on a mode, over the norms of both, that is rounding.
pub(crate) const ROUNDED_WORK: f64 = 1e-12;
/// Imbalance, over the absolute values of its terms, that is rounding, and up to which a point counts as balanced.
pub(crate) const NO_IMBALANCE: f64 = 1e-14;
pub(crate) const BALANCED: f64 = 1e-10;
/// Share of the largest second derivative that is added to the diagonal, for modes that nothing holds.
pub(crate) const SHIFT: f64 = 1e-12;
/// Share of the linear decrease that a Newton step has to keep.
pub(crate) const NEWTON_DECREASE: f64 = 1e-4;

// Interior points

/// Part of the way to the boundary that a step goes, and the least part of complementarity that it aims at.
pub(crate) const SHORT_OF_BOUNDARY: f64 = 0.95;
pub(crate) const CENTRED: f64 = 1e-4;
/// Steps for which the same inequalities have to become active, and steps behind the target after which they need not.
pub(crate) const SETTLED_STEPS: usize = 3;
pub(crate) const MORE_STEPS: usize = 8;
/// Gradient that pushes a component off the bound on which it rests, over the largest of all, each over the root of its
/// diagonal entry.
pub(crate) const PUSHES: f64 = 1e-9;
/// Part of the diagonal that keeps the solution without bounds small, where the method begins: rows that depend on one
/// another may contradict each other without them.
pub(crate) const CONTRADICTING: f64 = 1e-6;
/// Rounds of letting go after which all goes, and halvings of the way inwards to a start.
pub(crate) const ROUNDS: usize = 6;
pub(crate) const DEPTHS: usize = 20;
/// A point on a circle is put this much of the radius from its centre: rounding of radii leaves it on the circle then.
pub(crate) const BEYOND: f64 = 1.0 + 1e-13;
/// Most steps; part of the least complementarity so far that a step leaves at most, so many in a row that fail to and
/// end it, and complementarity up to which that is rounding.
pub(crate) const INTERIOR_STEPS: usize = 100;
pub(crate) const FALLS: f64 = 0.9;
pub(crate) const STUCK: usize = 5;
pub(crate) const ROUGH: f64 = 1e-9;
/// Work of the residual, likewise, up to which the equations are solved, or over what its parts work: the rounding of
/// factors that vanishing circles spoil.
pub(crate) const SOLVED: f64 = 1e-9;
pub(crate) const FACTOR_ROUNDING: f64 = 10.0 * f64::EPSILON;
/// A step so short is held up by products that have fallen behind: multipliers bring them back to this part of the
/// mean.
pub(crate) const HELD_UP: f64 = 0.2;
pub(crate) const BEHIND: f64 = 0.1;

// Fixed points

/// Ratios of changes that enter the estimate of the rate.
pub(crate) const RATE_WINDOW: usize = 5;
/// Evaluations without progress after which a map may be called not contractive, if the rate is above the other one.
pub(crate) const MAP_PATIENCE: usize = 12;
pub(crate) const NO_CONTRACTION: f64 = 0.98;
