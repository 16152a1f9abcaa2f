//! What a step cost.

signorini_qp::counts! {
    /// Cost of one step.
    #[non_exhaustive]
    Counters {
        /// Products with F, including recoveries of the displacement.
        products,
        /// Products with F spent on estimating norms, counted apart.
        setup_products,
        /// F as a matrix, formed once for all later steps.
        formed_operators,
        /// Applications of the preconditioner.
        preconditionings,
        /// Applications of projectors by SMALSE.
        projections,
        /// Factorisations of the coarse problem.
        coarse_factorisations,
        /// Quadratic programs (Tresca problems) solved by SMALSE.
        quadratic_programs,
        /// Active sets on which a linear problem was solved.
        active_sets,
        /// Steps of interior points, with a dense factorisation each, for starts where active sets run in circles.
        interior_steps,
        /// Updates of the slip bounds.
        slip_bound_updates,
        /// Computations of slip rates.
        rate_updates,
        /// Calls of a solver for inequalities.
        inequality_solves,
        /// Increments that failed and were halved, see
        /// [`with_step_halving`](crate::Settings::with_step_halving).
        halvings,
        /// States solved for between the times of the analysis.
        between,
    }
}
