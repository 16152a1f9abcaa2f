//! The solvers of a step.

use signorini_qp::{ActiveSetSettings, QpError, SmalseSettings};

/// How the inequality-constrained problem of a step is solved.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub enum Method {
    /// The default: active sets predicted by the natural map, projected preconditioned conjugate gradients on
    /// each, slip bounds updated once the contact set has settled. Falls back to
    /// [`SuccessiveApproximations`](Self::SuccessiveApproximations) if the prediction makes no progress. The tolerance
    /// and the floors are those of the [`Settings`](crate::Settings), as in all methods, and the patience is chosen.
    ActiveSet(ActiveSetSettings),
    /// The paper's method (3.17): Tresca problems by SMALSE and KPRGP, repeated with new slip bounds.
    SuccessiveApproximations {
        /// Settings of SMALSE.
        smalse: SmalseSettings,
        /// How accurately each Tresca problem is solved.
        accuracy: InnerAccuracy,
    },
    /// The paper's one inexact loop: slip bounds are updated after each outer step of SMALSE.
    OneLoop {
        /// Settings of SMALSE.
        smalse: SmalseSettings,
    },
}

impl Method {
    /// The paper's method with the settings that served best on the brick.
    pub fn paper() -> Self {
        Self::SuccessiveApproximations {
            smalse: paper_smalse(),
            accuracy: InnerAccuracy::default(),
        }
    }

    /// The paper's one inexact loop with the same settings.
    pub fn one_loop() -> Self {
        Self::OneLoop { smalse: paper_smalse() }
    }

    pub(crate) fn validate(&self) -> Result<(), QpError> {
        match self {
            Self::ActiveSet(settings) => settings.validate(),
            Self::OneLoop { smalse } | Self::SuccessiveApproximations { smalse, .. } => smalse.validate(),
        }
    }

    /// Which method it is, without its settings.
    pub fn kind(&self) -> MethodKind {
        match self {
            Self::ActiveSet(_) => MethodKind::ActiveSet,
            Self::SuccessiveApproximations { .. } => MethodKind::SuccessiveApproximations,
            Self::OneLoop { .. } => MethodKind::OneLoop,
        }
    }
}

/// A method by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MethodKind {
    /// Conjugate gradients: scenes without contact.
    Linear,
    /// The default.
    ActiveSet,
    /// The paper's fixed-point loop.
    SuccessiveApproximations,
    /// The paper's one inexact loop.
    OneLoop,
}

impl std::fmt::Display for MethodKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Linear => "linear",
            Self::ActiveSet => "active-set",
            Self::SuccessiveApproximations => "paper",
            Self::OneLoop => "one-loop",
        })
    }
}

impl Default for Method {
    fn default() -> Self {
        Self::ActiveSet(ActiveSetSettings::default())
    }
}

pub(crate) fn paper_smalse() -> SmalseSettings {
    // a step that starts from nothing takes many short outer steps on large problems
    SmalseSettings::default().with_max_outer(5000)
}

/// Accuracy of the Tresca problems inside the fixed-point loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum InnerAccuracy {
    /// The final tolerance each time, and up to a thousandth of it where changes stall above it.
    Fixed,
    /// A tenth of the last relative change of the normal multipliers, at most 1e-3, until that is as tight as
    /// [`Fixed`](Self::Fixed), which it stays.
    #[default]
    Adaptive,
}
