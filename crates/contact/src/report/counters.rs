//! What a step cost.

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
    }
}
