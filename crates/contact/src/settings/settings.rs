//! Settings of a simulation: how, not what.

use super::accuracy::Accuracy;
use super::method::{InnerAccuracy, Method};
use crate::error::ContactError;
use signorini_tfeti::{InverseSettings, RowScaling, Sharing};

/// The preconditioner of the default method.
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

/// Settings of a simulation.
///
/// | setting | meaning | range | default | the paper's letter |
/// |---|---|---|---|---|
/// | `method` | solver of a time level | | [`Method::ActiveSet`] | |
/// | `tolerance` | relative accuracy of the multipliers at every level, and of the fixed point | [1e-12, 0.1] | 1e-6 | `eps` |
/// | `accuracy` | whether a level ends at that tolerance or by an estimate of its error | [`Accuracy`] | `Tolerance` | |
/// | `max_fixed_point` | most evaluations of the Coulomb map a level | >= 1 | 200 | |
/// | `extrapolate` | start a level from the line through the last two | | true | |
/// | `row_scaling` | scaling of the rows of B | | orthonormal | |
/// | `sharing` | whether equal subdomains share factors | | translates | |
/// | `inverse` | how K+ is held | | by cost | |
/// | `preconditioner` | of the default method | | lumped | |
/// | `max_fallback_products` | most products with F of one call of the face method's fall-back (SMALSE), after which a level ends as `IterationLimit` | >= 1 | 20,000 | |
/// | `busy_waiting` | whether idle threads stay awake during a level | | false | |
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Settings {
    /// Solver of a time level.
    pub method: Method,
    /// Relative accuracy of a level.
    pub tolerance: f64,
    /// When the solve of a level ends.
    pub accuracy: Accuracy,
    /// Most evaluations of the Coulomb map a level.
    pub max_fixed_point: usize,
    /// Start from the line through the last two levels.
    pub extrapolate: bool,
    /// Scaling of the rows of B.
    pub row_scaling: RowScaling,
    /// Whether equal subdomains share factors.
    pub sharing: Sharing,
    /// How the generalised inverse is held.
    pub inverse: InverseSettings,
    /// Preconditioner of the default method.
    pub preconditioner: Preconditioner,
    /// Most products with F that the fall-back of the default method may take at a time.
    pub max_fallback_products: usize,
    /// Whether the threads of the pool stay awake while a level is solved, see [`Settings::with_busy_waiting`].
    pub busy_waiting: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::default(),
            tolerance: 1e-6,
            accuracy: Accuracy::default(),
            max_fixed_point: 200,
            extrapolate: true,
            row_scaling: RowScaling::default(),
            sharing: Sharing::default(),
            inverse: InverseSettings::default(),
            preconditioner: Preconditioner::default(),
            max_fallback_products: 20_000,
            busy_waiting: false,
        }
    }
}

impl Settings {
    /// Sets the solver.
    #[must_use]
    pub fn with_method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// Sets the accuracy of a level.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Sets when the solve of a level ends.
    #[must_use]
    pub fn with_accuracy(mut self, accuracy: Accuracy) -> Self {
        self.accuracy = accuracy;
        self
    }

    /// Sets the largest number of evaluations of the Coulomb map a level.
    #[must_use]
    pub fn with_max_fixed_point(mut self, max: usize) -> Self {
        self.max_fixed_point = max;
        self
    }

    /// Switches extrapolation in time on or off.
    #[must_use]
    pub fn with_extrapolation(mut self, on: bool) -> Self {
        self.extrapolate = on;
        self
    }

    /// Sets the scaling of the rows of B.
    #[must_use]
    pub fn with_row_scaling(mut self, rule: RowScaling) -> Self {
        self.row_scaling = rule;
        self
    }

    /// Sets whether equal subdomains share factors.
    #[must_use]
    pub fn with_sharing(mut self, sharing: Sharing) -> Self {
        self.sharing = sharing;
        self
    }

    /// Sets how the generalised inverse is held.
    #[must_use]
    pub fn with_inverse(mut self, inverse: InverseSettings) -> Self {
        self.inverse = inverse;
        self
    }

    /// Sets the preconditioner of the default method.
    #[must_use]
    pub fn with_preconditioner(mut self, preconditioner: Preconditioner) -> Self {
        self.preconditioner = preconditioner;
        self
    }

    /// Sets the most products of the fall-back.
    #[must_use]
    pub fn with_max_fallback_products(mut self, max: usize) -> Self {
        self.max_fallback_products = max;
        self
    }

    /// Sets whether the threads of the pool wait for their next part of a level awake. Parallel parts are short, and
    /// waking a thread takes about as long as one of them in scenes of some ten thousand unknowns. For a pool that does
    /// nothing else: all its processors are fully used, and a level waits for other work on the same pool.
    #[must_use]
    pub fn with_busy_waiting(mut self, on: bool) -> Self {
        self.busy_waiting = on;
        self
    }

    pub(crate) fn validate(&self) -> Result<(), ContactError> {
        if !(1e-12..=0.1).contains(&self.tolerance) {
            return Err(ContactError::Setting {
                name: "tolerance",
                value: self.tolerance,
                range: "[1e-12, 0.1]",
            });
        }
        self.inverse.validate()?;
        self.accuracy.validate()?;
        for (name, value) in [
            ("max_fixed_point", self.max_fixed_point),
            ("max_fallback_products", self.max_fallback_products),
        ] {
            if value == 0 {
                return Err(ContactError::Setting {
                    name,
                    value: 0.0,
                    range: "at least 1",
                });
            }
        }
        match &self.method {
            Method::ActiveSet(face) => face.validate()?,
            Method::SuccessiveApproximations { smalse, accuracy } => {
                smalse.validate()?;
                if let InnerAccuracy::Adaptive { factor, loosest } = accuracy {
                    for (name, value) in
                        [("accuracy.factor", *factor), ("accuracy.loosest", *loosest)]
                    {
                        if !(value > 0.0 && value < 1.0) {
                            return Err(ContactError::Setting {
                                name,
                                value,
                                range: "(0, 1)",
                            });
                        }
                    }
                }
            }
            Method::OneLoop { smalse } => smalse.validate()?,
        }
        Ok(())
    }
}
