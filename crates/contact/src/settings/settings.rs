//! Settings of a simulation: how, not what.

use super::accuracy::Accuracy;
use super::method::Method;
use crate::error::ContactError;
use signorini_qp::ActiveSetSettings;
use signorini_tfeti::{Alone, Communicator, InverseSettings};
use std::sync::Arc;

/// The preconditioner of the default method.
///
/// Thin bodies between two planes, whose supports touch most nodes in one direction, have the Schur complement in either
/// case, on the unknowns that rows touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Preconditioner {
    /// A multiple of the identity; only to measure what the others are worth.
    None,
    /// Lumped: the stiffness of the glued unknowns. Cheapest in time for small subdomains.
    #[default]
    Lumped,
    /// Dirichlet: the Schur complement on the glued unknowns. Fewer products for large subdomains.
    Dirichlet,
}

signorini_qp::settings! {
    /// How a scene is solved. Each setting stands in the doc of its `with_*`, with its range and default.
    ///
    /// ```
    /// use signorini_contact::{Method, Settings};
    ///
    /// let settings = Settings::default().with_method(Method::paper()).with_tolerance(1e-8);
    /// ```
    #[derive(Debug, Clone)]
    Settings or ContactError {
        /// The solver of a step.
        method, with_method: Method = Method::ActiveSet(ActiveSetSettings::default());
        /// Relative accuracy of the multipliers at every step, and of the fixed point: `eps` of the paper.
        tolerance, with_tolerance: f64 = 1e-6, in "[1e-12, 0.1]";
        /// Whether a step ends at that tolerance or by an estimate of its error.
        accuracy, with_accuracy: Accuracy = Accuracy::Tolerance;
        /// Whether a step starts from the line through the last two, or from the last one.
        extrapolate, with_extrapolation: bool = true;
        /// Whether equal subdomains share factors.
        share_translates, with_share_translates: bool = true;
        /// How the generalised inverse is held, by cost unless told otherwise.
        inverse, with_inverse: InverseSettings = InverseSettings::default();
        /// Preconditioner of the default method.
        preconditioner, with_preconditioner: Preconditioner = Preconditioner::Lumped;
        /// Most products with F of one call of the active-set method's fall-back (SMALSE), after which a step ends as
        /// [`IterationLimit`](crate::StepStatus::IterationLimit).
        max_fallback_products, with_max_fallback_products: usize = 20_000, in "[1, inf)";
        /// How often a step that fails or does not converge may be halved.
        ///
        /// Loads, motions and obstacles are taken at the times between, where their histories have kinks they are seen.
        /// What was short becomes longer again as steps converge: parts of a step join two by two, and the next step
        /// begins with parts twice as long as the last one ended with. Results are reported at the times of the
        /// analysis only. What lies between is counted ([`halvings`](crate::report::Counters::halvings),
        /// [`between`](crate::report::Counters::between)), works of friction and obstacles are its sums. With a
        /// difference formula of three displacements unequal increments have weights of their own. Where the shortest
        /// increment does not converge either, the step ends with its status. Static scenes have nothing to halve.
        step_halving, with_step_halving: u32 = 0, in "[0, 20]";
        /// The processes that solve the scene together.
        ///
        /// The same program runs as every *rank* with the same scene and settings, makes the same calls in the same
        /// order, and has the same results, bit for bit, as one process. The matrices of the subdomains and the work
        /// with them are spread over the ranks. Observers are told on every rank; a run ends where any of them ends it.
        /// The library's own files (`ResultWriter`, checkpoints) and lines ([`Progress`](crate::Progress)) are those of
        /// rank 0; checkpoints are read by all.
        communicator, with_communicator: Arc<dyn Communicator> = Arc::new(Alone);
    }
    and accuracy, method
}

impl Settings {
    /// The relative accuracy of a step.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }
}
