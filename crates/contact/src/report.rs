//! Reports of a level: how it ended, what it cost.

use crate::accuracy::AccuracyReport;
use crate::fixed_point::FixedPointReport;
use signorini_qp::Steps;

/// How the solve of a level ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LevelStatus {
    /// The solver reached the tolerance, and the certificate is at most thirty times that (usually a tenth).
    Converged,
    /// A limit of iterations or products was reached first; the result is the last iterate.
    IterationLimit,
    /// No further progress above the tolerance.
    Stagnated,
    /// The Coulomb map is not contractive here: successive approximations have no limit from this start. The result is
    /// the last iterate, which solves the given-friction problem of the last slip bounds.
    NotContractive,
    /// The solver met its tolerance, and smaller ones, but the certificate is more than thirty times the tolerance: mostly the
    /// problem is too badly conditioned for it. The parts of the certificate name the violated condition.
    NotCertified,
}

impl LevelStatus {
    /// Whether the tolerance was reached.
    #[must_use]
    pub fn converged(self) -> bool {
        self == Self::Converged
    }
}

/// What one level cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Counters {
    /// Products with F, recoveries included.
    pub products: usize,
    /// Products with F spent on estimating norms, counted apart.
    pub setup_products: usize,
    /// Applications of the preconditioner.
    pub preconditionings: usize,
    /// Applications of projectors by SMALSE.
    pub projections: usize,
    /// Factorisations of the coarse problem.
    pub coarse_factorisations: usize,
    /// Quadratic programs (given-friction problems) solved by SMALSE.
    pub quadratic_programs: usize,
    /// Faces of the face method.
    pub faces: usize,
    /// Times the slip bounds were rewritten.
    pub slip_bound_updates: usize,
    /// Times slip rates were computed.
    pub rate_updates: usize,
    /// Entries into an inequality solver.
    pub inequality_solves: usize,
    /// Times screened contact points came back and the level was solved again.
    pub rebuilds: usize,
    /// Factorisations of the set-ups that these need.
    pub factorisations: usize,
    /// Contact points left out of the dual problem at the end of a level, summed over the levels.
    pub screened_points: usize,
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, o: Self) {
        self.products += o.products;
        self.setup_products += o.setup_products;
        self.preconditionings += o.preconditionings;
        self.projections += o.projections;
        self.coarse_factorisations += o.coarse_factorisations;
        self.quadratic_programs += o.quadratic_programs;
        self.faces += o.faces;
        self.slip_bound_updates += o.slip_bound_updates;
        self.rate_updates += o.rate_updates;
        self.inequality_solves += o.inequality_solves;
        self.rebuilds += o.rebuilds;
        self.factorisations += o.factorisations;
        self.screened_points += o.screened_points;
    }
}

/// Report of one level's solve.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LevelReport {
    /// How it ended.
    pub status: LevelStatus,
    /// Outer iterations under the method's own name: auxiliary problems of the fixed-point loop, outer steps of the
    /// one inexact loop, faces of the face method.
    pub iterations: usize,
    /// What it cost.
    pub counters: Counters,
    /// Steps of KPRGP by kind, if it ran.
    pub steps: Steps,
    /// The fixed-point loop, if there was one.
    pub fixed_point: Option<FixedPointReport>,
    /// Whether the face method gave up and SMALSE finished the level.
    pub fallback: bool,
    /// Products with F that SMALSE took for that, contained in the counters.
    pub fallback_products: usize,
    /// The solver's own estimate of the relative error of the multipliers, where it has one.
    pub estimated_error: Option<f64>,
    /// Estimates of the level's errors; only with an [`Accuracy`](crate::Accuracy) that needs them.
    pub accuracy: Option<AccuracyReport>,
}

impl LevelReport {
    pub(crate) fn new() -> Self {
        Self {
            status: LevelStatus::IterationLimit,
            iterations: 0,
            counters: Counters::default(),
            steps: Steps::default(),
            fixed_point: None,
            fallback: false,
            fallback_products: 0,
            estimated_error: None,
            accuracy: None,
        }
    }

    /// Takes over the outcome of a further solve of the same level, with the cost of both.
    pub(crate) fn resumed(self, mut next: Self) -> Self {
        next.counters += self.counters;
        next.iterations += self.iterations;
        next.steps += self.steps;
        next.fallback |= self.fallback;
        next.fallback_products += self.fallback_products;
        next
    }
}
