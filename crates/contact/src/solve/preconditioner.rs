//! The preconditioner of the default method, chosen by the settings.

use crate::error::ContactError;
use crate::model::Model;
use crate::settings::Preconditioner as Choice;
use signorini_qp::active_set::{ActiveSetPreconditioner, ActiveSetView};
use signorini_qp::{SymmetricOperator, vector};
use signorini_tfeti::internal::{DualPreconditionerScratch, ExplicitScratch, SystemPart};
use signorini_tfeti::{DualPreconditioner, ExplicitInverse};

/// A preconditioner of the dual problem.
#[derive(Debug)]
pub(crate) enum SelectedPreconditioner {
    /// A multiple of the identity, for measuring what the others are worth.
    Scalar { dim: usize, factor: f64 },
    /// Lumped or Dirichlet.
    Stiffness(Box<DualPreconditioner>),
    /// Of a formed F.
    Explicit(Box<ExplicitInverse>),
}

/// Work memory of the one that it is of.
#[derive(Debug)]
pub(crate) enum Scratch {
    Scalar,
    Stiffness(DualPreconditionerScratch),
    Explicit(ExplicitScratch),
}

impl SelectedPreconditioner {
    /// For whole vectors, or for the `part` that each rank keeps.
    pub(crate) fn new(model: &Model, choice: Choice, part: Option<&SystemPart>) -> Result<Self, ContactError> {
        let tfeti = &model.tfeti;
        Ok(match choice {
            Choice::None => {
                // the mean stiffness of some rows turns displacements into forces
                let dim = tfeti.dual_dim();
                let mut sample = vec![0.0; dim.min(SAMPLE)];
                let start = dim - sample.len();
                tfeti.row_stiffness(start..dim, &mut sample);
                let factor = sample.iter().sum::<f64>() / sample.len().max(1) as f64;
                let dim = part.map_or(dim, SystemPart::rows);
                Self::Scalar { dim, factor }
            }
            Choice::Lumped => Self::stiffness(tfeti.lumped()?, part),
            Choice::Dirichlet => Self::stiffness(tfeti.dirichlet()?, part),
        })
    }

    /// The inverse of F, which is formed; `None` if that fails.
    pub(crate) fn explicit(model: &Model, part: Option<&SystemPart>) -> Option<Self> {
        let own = model.tfeti.explicit_inverse()?;
        Some(Self::Explicit(Box::new(match part {
            Some(part) => own.of_part(part),
            None => own,
        })))
    }

    fn stiffness(own: DualPreconditioner, part: Option<&SystemPart>) -> Self {
        Self::Stiffness(Box::new(match part {
            Some(part) => own.of_part(part),
            None => own,
        }))
    }
}

/// Rows whose stiffness scales the identity.
const SAMPLE: usize = 300;

impl SymmetricOperator for SelectedPreconditioner {
    type Scratch = Scratch;

    fn dim(&self) -> usize {
        match self {
            Self::Scalar { dim, .. } => *dim,
            Self::Stiffness(p) => p.dim(),
            Self::Explicit(p) => p.dim(),
        }
    }

    fn scratch(&self) -> Self::Scratch {
        match self {
            Self::Scalar { .. } => Scratch::Scalar,
            Self::Stiffness(p) => Scratch::Stiffness(p.scratch()),
            Self::Explicit(p) => Scratch::Explicit(p.scratch()),
        }
    }

    fn apply(&self, x: &[f64], y: &mut [f64], s: &mut Self::Scratch) {
        match (self, s) {
            (Self::Stiffness(p), Scratch::Stiffness(s)) => p.apply(x, y, s),
            (Self::Explicit(p), Scratch::Explicit(s)) => p.apply(x, y, s),
            (Self::Scalar { factor, .. }, _) => {
                vector::copy(x, y);
                vector::scale(*factor, y);
            }
            // a scratch of another preconditioner: none is one, too
            _ => vector::copy(x, y),
        }
    }
}

impl ActiveSetPreconditioner for SelectedPreconditioner {
    fn enter(&self, set: &ActiveSetView<'_>, s: &mut Self::Scratch) {
        match (self, s) {
            (Self::Stiffness(p), Scratch::Stiffness(s)) => p.enter(set, s),
            (Self::Explicit(p), Scratch::Explicit(s)) => p.enter(set, s),
            _ => {}
        }
    }

    fn knows_added(&self) -> bool {
        matches!(self, Self::Explicit(_))
    }
}
