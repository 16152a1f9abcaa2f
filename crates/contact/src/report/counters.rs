//! What a step cost.

/// Cost of one step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Counters {
    /// Products with F, including recoveries of the displacement.
    pub products: usize,
    /// Products with F spent on estimating norms, counted apart.
    pub setup_products: usize,
    /// F as a matrix, formed once for all later steps.
    pub formed_operators: usize,
    /// Applications of the preconditioner.
    pub preconditionings: usize,
    /// Applications of projectors by SMALSE.
    pub projections: usize,
    /// Factorisations of the coarse problem.
    pub coarse_factorisations: usize,
    /// Quadratic programs (Tresca problems) solved by SMALSE.
    pub quadratic_programs: usize,
    /// Active sets on which a linear problem was solved.
    pub active_sets: usize,
    /// Steps of interior points, with a dense factorisation each, for starts where active sets run in circles.
    pub interior_steps: usize,
    /// Updates of the slip bounds.
    pub slip_bound_updates: usize,
    /// Computations of slip rates.
    pub rate_updates: usize,
    /// Calls of a solver for inequalities.
    pub inequality_solves: usize,
    /// Increments that failed and were halved, see
    /// [`with_step_halving`](crate::Settings::with_step_halving).
    pub halvings: usize,
    /// States solved for between the times of the analysis.
    pub between: usize,
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.products += other.products;
        self.setup_products += other.setup_products;
        self.formed_operators += other.formed_operators;
        self.preconditionings += other.preconditionings;
        self.projections += other.projections;
        self.coarse_factorisations += other.coarse_factorisations;
        self.quadratic_programs += other.quadratic_programs;
        self.active_sets += other.active_sets;
        self.interior_steps += other.interior_steps;
        self.slip_bound_updates += other.slip_bound_updates;
        self.rate_updates += other.rate_updates;
        self.inequality_solves += other.inequality_solves;
        self.halvings += other.halvings;
        self.between += other.between;
    }
}
