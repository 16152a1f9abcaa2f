//! The solvers of a step.

use signorini_qp::{ActiveSetSettings, SmalseSettings};

/// How the inequality-constrained problem of a time level is solved.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Method {
    /// The default: faces predicted by the natural map, projected preconditioned conjugate gradients on
    /// each, slip bounds following as soon as the contact set has settled. Falls back to
    /// [`SuccessiveApproximations`](Self::SuccessiveApproximations) where the prediction makes no progress.
    ActiveSet(ActiveSetSettings),
    /// The paper's method (3.17): given-friction problems by SMALSE and KPRGP, repeated with new slip bounds.
    SuccessiveApproximations {
        /// Settings of SMALSE.
        smalse: SmalseSettings,
        /// How accurately each given-friction problem is solved.
        accuracy: InnerAccuracy,
    },
    /// The paper's one inexact loop: the slip bounds follow the outer steps of SMALSE.
    OneLoop {
        /// Settings of SMALSE.
        smalse: SmalseSettings,
    },
}

impl Method {
    /// The paper's method with the settings that served best on the brick.
    #[must_use]
    pub fn paper() -> Self {
        Self::SuccessiveApproximations {
            smalse: paper_smalse(),
            accuracy: InnerAccuracy::default(),
        }
    }

    /// The paper's one inexact loop with the same settings.
    #[must_use]
    pub fn one_loop() -> Self {
        Self::OneLoop {
            smalse: paper_smalse(),
        }
    }

    /// A short name, as the examples print it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::ActiveSet(_) => "face",
            Self::SuccessiveApproximations { .. } => "paper",
            Self::OneLoop { .. } => "one-loop",
        }
    }
}

impl Default for Method {
    fn default() -> Self {
        Self::ActiveSet(ActiveSetSettings::default())
    }
}

fn paper_smalse() -> SmalseSettings {
    // a level that starts from nothing takes many short outer steps on large problems
    SmalseSettings::default().with_max_outer(5000)
}

/// Accuracy of the given-friction problems inside the fixed-point loop.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum InnerAccuracy {
    /// The final tolerance each time.
    Fixed,
    /// `factor` times the last relative change of the normal multipliers, never looser than `loosest` and never tighter
    /// than the final tolerance.
    Adaptive {
        /// In (0, 1).
        factor: f64,
        /// In (0, 1).
        loosest: f64,
    },
}

impl Default for InnerAccuracy {
    fn default() -> Self {
        Self::Adaptive {
            factor: 0.1,
            loosest: 1e-3,
        }
    }
}
