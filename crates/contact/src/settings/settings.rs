//! Settings of a simulation: how, not what.

use super::accuracy::Accuracy;
use super::method::Method;
use crate::error::ContactError;
use signorini_qp::ActiveSetSettings;
use signorini_tfeti::{Alone, Communicator, InverseSettings};
use std::sync::Arc;

/// The preconditioner of the default method.
///
/// Thin bodies between two planes, whose supports fix one direction of most nodes, use the Schur complement in both
/// cases, on the unknowns that rows touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Preconditioner {
    /// A multiple of the identity; only for comparison.
    None,
    /// Lumped: the stiffness of the glued unknowns. Fastest for small subdomains.
    #[default]
    Lumped,
    /// Dirichlet: the Schur complement on the glued unknowns. Fewer products for large subdomains.
    Dirichlet,
}

signorini_qp::settings! {
    /// How a scene is solved. The documentation of each `with_*` describes the setting, its range and default.
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
        /// Whether a step starts from a linear extrapolation of the last two, or from the last one. Where nothing that
        /// acts has changed since the last one, it starts from that.
        extrapolate, with_extrapolation: bool = true;
        /// Whether equal subdomains share factors.
        share_translates, with_share_translates: bool = true;
        /// How the generalised inverse is stored; by default the cheapest way.
        inverse, with_inverse: InverseSettings = InverseSettings::default();
        /// Preconditioner of the default method.
        preconditioner, with_preconditioner: Preconditioner = Preconditioner::Lumped;
        /// Most products with F of one call of the active-set method's fall-back (SMALSE), after which a step ends as
        /// [`IterationLimit`](crate::StepStatus::IterationLimit).
        max_fallback_products, with_max_fallback_products: usize = 20_000, in "[1, inf)";
        /// How often a step that fails or does not converge may be halved.
        ///
        /// Loads, motions and obstacles are evaluated at the times between, so kinks of their histories are resolved.
        /// Increments grow again as steps converge: parts of a step join two by two, and the next step begins with
        /// parts twice as long as the last. Results are reported only at the times of the analysis. The report counts
        /// what lies between ([`halvings`](crate::report::Counters::halvings),
        /// [`between`](crate::report::Counters::between)); the work of friction and obstacles is summed over it. With a
        /// difference formula of three displacements, unequal increments have their own weights. If the shortest
        /// increment does not converge either, what is left of the step is taken in the longest ones, and the step ends
        /// with its status; with wrong slip left from it, later steps are not halved. Static scenes have nothing to
        /// halve.
        step_halving, with_step_halving: u32 = 0, in "[0, 20]";
        /// The processes that solve the scene together.
        ///
        /// Every *rank* runs the same program with the same scene and settings, and makes the same calls in the same
        /// order. Results are bit-identical to those of one process. The matrices of the subdomains and the work with
        /// them are distributed over the ranks. Observers are told on every rank; a run ends if any of them ends it.
        /// Checkpoints and the lines of [`Progress`](crate::Progress) are written by rank 0, files of results by all
        /// (`ResultWriter`); checkpoints are read by all.
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
