//! The preconditioner of the default method, chosen by the settings.

use crate::error::ContactError;
use crate::model::Model;
use crate::settings::Preconditioner as Choice;
use signorini_qp::active_set::{ActiveSetPreconditioner, ActiveSetView};
use signorini_qp::{SymmetricOperator, vector};
use signorini_tfeti::DualPreconditioner;
use signorini_tfeti::internal::{DualPreconditionerScratch, SystemPart};

/// A preconditioner of the dual problem.
#[derive(Debug)]
pub(crate) enum SelectedPreconditioner {
    /// A multiple of the identity, for measuring what the others are worth.
    Scalar { dim: usize, factor: f64 },
    /// Lumped or Dirichlet.
    Stiffness(Box<DualPreconditioner>),
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
    type Scratch = Option<DualPreconditionerScratch>;

    fn dim(&self) -> usize {
        match self {
            Self::Scalar { dim, .. } => *dim,
            Self::Stiffness(p) => p.dim(),
        }
    }

    fn scratch(&self) -> Self::Scratch {
        match self {
            Self::Scalar { .. } => None,
            Self::Stiffness(p) => Some(p.scratch()),
        }
    }

    fn apply(&self, x: &[f64], y: &mut [f64], s: &mut Self::Scratch) {
        match (self, s) {
            (Self::Stiffness(p), Some(s)) => p.apply(x, y, s),
            (Self::Scalar { factor, .. }, _) => {
                vector::copy(x, y);
                vector::scale(*factor, y);
            }
            // a scratch of another preconditioner
            (Self::Stiffness(_), None) => y.fill(0.0),
        }
    }
}

impl ActiveSetPreconditioner for SelectedPreconditioner {
    fn enter(&self, set: &ActiveSetView<'_>, s: &mut Self::Scratch) {
        if let (Self::Stiffness(p), Some(s)) = (self, s) {
            p.enter(set, s);
        }
    }
}
