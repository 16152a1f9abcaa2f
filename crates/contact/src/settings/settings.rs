//! Settings of a simulation: how, not what.

use super::accuracy::Accuracy;
use super::method::Method;
use crate::error::ContactError;
use crate::tolerances::MOST_HALVINGS;
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

/// How a scene is solved. Each setting stands in the doc of its `with_*`, with its range and default.
///
/// ```
/// use signorini_contact::{Method, Settings};
///
/// let settings = Settings::default().with_method(Method::paper()).with_tolerance(1e-8);
/// ```
#[derive(Debug, Clone)]
#[must_use]
pub struct Settings {
    pub(crate) method: Method,
    pub(crate) tolerance: f64,
    pub(crate) accuracy: Accuracy,
    pub(crate) extrapolate: bool,
    pub(crate) share_translates: bool,
    pub(crate) inverse: InverseSettings,
    pub(crate) preconditioner: Preconditioner,
    pub(crate) max_fallback_products: usize,
    pub(crate) step_halving: u32,
    pub(crate) communicator: Arc<dyn Communicator>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::default(),
            tolerance: 1e-6,
            accuracy: Accuracy::default(),
            extrapolate: true,
            share_translates: true,
            inverse: InverseSettings::default(),
            preconditioner: Preconditioner::default(),
            max_fallback_products: 20_000,
            step_halving: 0,
            communicator: Arc::new(Alone),
        }
    }
}

impl Settings {
    /// The solver of a step; [`Method::ActiveSet`] by default.
    pub fn with_method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// Relative accuracy of the multipliers at every step, and of the fixed point: `eps` of the paper, in [1e-12, 0.1],
    /// 1e-6 by default.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Whether a step ends at that tolerance (the default) or by an estimate of its error.
    pub fn with_accuracy(mut self, accuracy: Accuracy) -> Self {
        self.accuracy = accuracy;
        self
    }

    /// Whether a step starts from the line through the last two, as it does by default, or from the last one.
    pub fn with_extrapolation(mut self, on: bool) -> Self {
        self.extrapolate = on;
        self
    }

    /// Whether equal subdomains share factors, as translates do by default.
    pub fn with_share_translates(mut self, share: bool) -> Self {
        self.share_translates = share;
        self
    }

    /// How the generalised inverse is held, by cost unless told otherwise.
    pub fn with_inverse(mut self, inverse: InverseSettings) -> Self {
        self.inverse = inverse;
        self
    }

    /// Preconditioner of the default method, lumped by default.
    pub fn with_preconditioner(mut self, preconditioner: Preconditioner) -> Self {
        self.preconditioner = preconditioner;
        self
    }

    /// Most products with F of one call of the active-set method's fall-back (SMALSE), after which a step ends as
    /// [`IterationLimit`](crate::StepStatus::IterationLimit); at least 1, by default 20,000.
    pub fn with_max_fallback_products(mut self, max: usize) -> Self {
        self.max_fallback_products = max;
        self
    }

    /// How often a step that fails or does not converge may be halved, at most 20; never (0) by default.
    ///
    /// Loads, motions and obstacles are taken at the times between, where their histories have kinks they are seen.
    /// What was short becomes longer again as steps converge: parts of a step join two by two, and the next step begins
    /// with parts twice as long as the last one ended with. Results are reported at the times of the analysis only.
    /// What lies between is counted ([`halvings`](crate::report::Counters::halvings),
    /// [`between`](crate::report::Counters::between)), works of friction and obstacles are its sums. With a difference
    /// formula of three displacements unequal increments have weights of their own. Where the shortest increment does
    /// not converge either, the step ends with its status. Static scenes have nothing to halve.
    pub fn with_step_halving(mut self, most: u32) -> Self {
        self.step_halving = most;
        self
    }

    /// The processes that solve the scene together; this one alone by default.
    ///
    /// The same program runs as every *rank* with the same scene and settings, makes the same calls in the same order,
    /// and has the same results, bit for bit, as one process. The matrices of the subdomains and the work with them are
    /// spread over the ranks. Observers are told on every rank; a run ends where any of them ends it. The library's own
    /// files (`ResultWriter`, checkpoints) and lines ([`Progress`](crate::Progress)) are those of
    /// rank 0; checkpoints are read by all.
    pub fn with_communicator(mut self, communicator: Arc<dyn Communicator>) -> Self {
        self.communicator = communicator;
        self
    }

    /// The relative accuracy of a step.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    pub(crate) fn validate(&self) -> Result<(), ContactError> {
        let check = ContactError::check;
        let tolerance = self.tolerance;
        let good = (1e-12..=0.1).contains(&tolerance);
        check(good, "tolerance", tolerance, "[1e-12, 0.1]")?;
        self.accuracy.validate()?;
        let products = self.max_fallback_products;
        check(products > 0, "max_fallback_products", 0.0, "at least 1")?;
        let halvings = self.step_halving;
        check(
            halvings <= MOST_HALVINGS,
            "step_halving",
            halvings.into(),
            "of at most 20",
        )?;
        match &self.method {
            Method::ActiveSet(settings) => settings.validate()?,
            Method::OneLoop { smalse } | Method::SuccessiveApproximations { smalse, .. } => smalse.validate()?,
        }
        Ok(())
    }
}
