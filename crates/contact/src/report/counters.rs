//! What a step cost.

/// What one step cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Counters {
    /// Products with F, recoveries included.
    pub products: usize,
    /// Products with F spent on estimating norms and on forming it, counted apart.
    pub setup_products: usize,
    /// Applications of the preconditioner.
    pub preconditionings: usize,
    /// Applications of projectors by SMALSE.
    pub projections: usize,
    /// Factorisations of the coarse problem.
    pub coarse_factorisations: usize,
    /// Quadratic programs (Tresca problems) solved by SMALSE.
    pub quadratic_programs: usize,
    /// Active sets that were solved on.
    pub active_sets: usize,
    /// Times the slip bounds were rewritten.
    pub slip_bound_updates: usize,
    /// Times slip rates were computed.
    pub rate_updates: usize,
    /// Entries into an inequality solver.
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
        self.preconditionings += other.preconditionings;
        self.projections += other.projections;
        self.coarse_factorisations += other.coarse_factorisations;
        self.quadratic_programs += other.quadratic_programs;
        self.active_sets += other.active_sets;
        self.slip_bound_updates += other.slip_bound_updates;
        self.rate_updates += other.rate_updates;
        self.inequality_solves += other.inequality_solves;
        self.halvings += other.halvings;
        self.between += other.between;
    }
}
