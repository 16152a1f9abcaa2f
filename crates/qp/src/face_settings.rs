//! Settings, report and work memory of the face method.

use crate::coarse_space::Line;
use crate::error::QpError;
use crate::face_coupling::{Coupling, RadiusSlope};
use crate::operator::SymmetricOperator;
use crate::report::Status;

/// Settings of [`active_set`](crate::active_set()). All are dimensionless.
///
/// | setting | meaning | range | default |
/// |---|---|---|---|
/// | `tolerance` | estimated error of `x` relative to its norm, and of its constrained part relative to its own | (0, 1) | 1e-7 |
/// | `error_floor` | norm of `x` below which errors count relative to it: what a vanishing solution is measured against | >= 0 | 0 |
/// | `contact_error_floor` | the same for the constrained part, which is measured against 1e-4 of the norm of `x` in any case | >= 0 | 0 |
/// | `forcing` | decrease of the error estimate on one face before the face is looked at again | (0, 1) | 0.4 |
/// | `natural_step` | step of the natural map that predicts the next face, in units of the preconditioner's diagonal | (0, 1] | 0.4 |
/// | `joint_step_fraction` | part of the next step that is taken together with the move to the next face | [0, 1] | 1 |
/// | `settled_fraction` | share of the free bounded components that may change on a face for the hook to be called | [0, 1] | 0.3 |
/// | `max_faces` | faces; five times as many once descent is enforced | >= 1 | 100 |
/// | `max_products` | operator products | >= 1 | 10 000 |
/// | `patience` | faces without a better error estimate before every move has to descend; five times as many before giving up | >= 1 | 12 |
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ActiveSetSettings {
    /// Relative error asked for.
    pub tolerance: f64,
    /// Norm of `x` that errors are at least relative to.
    pub error_floor: f64,
    /// Norm of the constrained part of `x` that its errors are at least relative to.
    pub contact_error_floor: f64,
    /// Decrease of the error estimate on one face.
    pub forcing: f64,
    /// Step of the natural map, times the preconditioner's diagonal.
    pub natural_step: f64,
    /// Part of the next conjugate gradient step that shares the product of the move to the next face.
    pub joint_step_fraction: f64,
    /// Share of changing bounds below which the hook is called.
    pub settled_fraction: f64,
    /// Most faces before descent is enforced; five times as many with it.
    pub max_faces: usize,
    /// Most products.
    pub max_products: usize,
    /// Faces without progress before descent is enforced; five times as many before [`Status::Stagnated`].
    pub patience: usize,
}

impl Default for ActiveSetSettings {
    fn default() -> Self {
        Self {
            tolerance: 1e-7,
            error_floor: 0.0,
            contact_error_floor: 0.0,
            forcing: 0.4,
            natural_step: 0.4,
            joint_step_fraction: 1.0,
            settled_fraction: 0.3,
            max_faces: 100,
            max_products: 10_000,
            patience: 12,
        }
    }
}

impl ActiveSetSettings {
    /// Sets the relative error asked for.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Sets the norm of `x` that errors are at least relative to.
    #[must_use]
    pub fn with_error_floor(mut self, norm: f64) -> Self {
        self.error_floor = norm;
        self
    }

    /// Sets the norm of the constrained part of `x` that its errors are at least relative to.
    #[must_use]
    pub fn with_contact_error_floor(mut self, norm: f64) -> Self {
        self.contact_error_floor = norm;
        self
    }

    /// Sets the decrease of the error estimate on one face.
    #[must_use]
    pub fn with_forcing(mut self, forcing: f64) -> Self {
        self.forcing = forcing;
        self
    }

    /// Sets the step of the natural map.
    #[must_use]
    pub fn with_natural_step(mut self, step: f64) -> Self {
        self.natural_step = step;
        self
    }

    /// Sets the part of the next step taken together with the move to the next face.
    #[must_use]
    pub fn with_joint_step_fraction(mut self, part: f64) -> Self {
        self.joint_step_fraction = part;
        self
    }

    /// Sets the share of changing bounds below which the hook is called.
    #[must_use]
    pub fn with_settled_fraction(mut self, share: f64) -> Self {
        self.settled_fraction = share;
        self
    }

    /// Sets the number of faces without progress before the method gives up.
    #[must_use]
    pub fn with_patience(mut self, faces: usize) -> Self {
        self.patience = faces;
        self
    }

    /// Sets the largest number of faces.
    #[must_use]
    pub fn with_max_faces(mut self, faces: usize) -> Self {
        self.max_faces = faces;
        self
    }

    /// Sets the largest number of products.
    #[must_use]
    pub fn with_max_products(mut self, products: usize) -> Self {
        self.max_products = products;
        self
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`QpError::Setting`] naming the setting.
    pub fn validate(&self) -> Result<(), QpError> {
        let open = |name: &'static str, value: f64| {
            if value > 0.0 && value < 1.0 {
                Ok(())
            } else {
                Err(QpError::Setting {
                    name,
                    value,
                    range: "(0, 1)",
                })
            }
        };
        open("tolerance", self.tolerance)?;
        open("forcing", self.forcing)?;
        for (name, value) in [
            ("error_floor", self.error_floor),
            ("contact_error_floor", self.contact_error_floor),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(QpError::Setting {
                    name,
                    value,
                    range: "finite and not negative",
                });
            }
        }
        if !(self.natural_step > 0.0 && self.natural_step <= 1.0) {
            return Err(QpError::Setting {
                name: "natural_step",
                value: self.natural_step,
                range: "(0, 1]",
            });
        }
        for (name, value) in [
            ("joint_step_fraction", self.joint_step_fraction),
            ("settled_fraction", self.settled_fraction),
        ] {
            if !(0.0..=1.0).contains(&value) {
                return Err(QpError::Setting {
                    name,
                    value,
                    range: "[0, 1]",
                });
            }
        }
        for (name, value) in [
            ("max_faces", self.max_faces),
            ("max_products", self.max_products),
            ("patience", self.patience),
        ] {
            if value == 0 {
                return Err(QpError::Setting {
                    name,
                    value: 0.0,
                    range: "at least 1",
                });
            }
        }
        Ok(())
    }
}

/// What [`active_set`](crate::active_set()) did.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ActiveSetReport {
    /// How it ended.
    pub status: Status,
    /// Faces on which conjugate gradients ran.
    pub faces: usize,
    /// Conjugate gradient steps, one product each.
    pub cg_steps: usize,
    /// Products after a change of face and at the start, to keep `A x` exact.
    pub corrections: usize,
    /// Applications of the preconditioner.
    pub preconditionings: usize,
    /// Factorisations of `G W Gᵀ`.
    pub factorisations: usize,
    /// Calls of the hook.
    pub hook_calls: usize,
    /// Last estimated error of `x`, relative to the norm of `x`.
    pub error: f64,
    /// Last estimated error of the constrained components, relative to their norm.
    pub constrained_error: f64,
}

impl ActiveSetReport {
    pub(crate) fn new() -> Self {
        Self {
            status: Status::IterationLimit,
            faces: 0,
            cg_steps: 0,
            corrections: 0,
            preconditionings: 0,
            factorisations: 0,
            hook_calls: 0,
            error: f64::INFINITY,
            constrained_error: f64::INFINITY,
        }
    }

    /// All operator products.
    #[must_use]
    pub fn products(&self) -> usize {
        self.cg_steps + self.corrections
    }
}

/// Vectors of the face method: six of the length of `x`, a seventh where radii follow other components, three of its
/// constrained part and the classification of the blocks.
#[derive(Debug)]
pub struct ActiveSetWorkspace<A: SymmetricOperator, M: SymmetricOperator> {
    pub(crate) operator: A::Scratch,
    pub(crate) preconditioner: M::Scratch,
    /// `A x - b` without its part in the image of `Gᵀ`.
    pub(crate) residual: Vec<f64>,
    /// Constrained part of the residual on the face.
    pub(crate) face_residual: Vec<f64>,
    /// Constrained part of `residual` while that of the face stands in its place.
    pub(crate) saved: Vec<f64>,
    /// Constrained part of `x` before it moves to the next face.
    pub(crate) before: Vec<f64>,
    pub(crate) z_norm: f64,
    pub(crate) z: Vec<f64>,
    pub(crate) p: Vec<f64>,
    pub(crate) ap: Vec<f64>,
    pub(crate) w: Vec<f64>,
    pub(crate) lines: Vec<Line>,
    pub(crate) t: Vec<f64>,
    pub(crate) face: crate::face_state::Face,
    pub(crate) coupling: Coupling,
}

impl<A: SymmetricOperator, M: SymmetricOperator> ActiveSetWorkspace<A, M> {
    /// Allocates everything the method needs.
    pub fn new(operator: &A, preconditioner: &M) -> Self {
        let n = operator.dim();
        let v = || vec![0.0; n];
        Self {
            operator: operator.scratch(),
            preconditioner: preconditioner.scratch(),
            residual: v(),
            face_residual: Vec::new(),
            saved: Vec::new(),
            before: Vec::new(),
            z_norm: 0.0,
            z: v(),
            p: v(),
            ap: v(),
            w: v(),
            lines: Vec::new(),
            t: v(),
            face: crate::face_state::Face::default(),
            coupling: Coupling::default(),
        }
    }

    /// Tells how the hook moves the radii, for the solves to come: conjugate gradients then take this along instead of
    /// meeting it at each change of face. Optional; a disc without a slope is moved by the hook alone. The solution does not
    /// depend on it. Slopes in the order of the discs are found fastest.
    pub fn set_slopes(&mut self, slopes: &[RadiusSlope]) {
        self.coupling.set(slopes);
    }

    /// Makes room for `constrained` leading components with constraints.
    pub(crate) fn resize(&mut self, constrained: usize) {
        self.face_residual.resize(constrained, 0.0);
        self.saved.resize(constrained, 0.0);
        self.before.resize(constrained, 0.0);
    }

    /// `P_Wᵀ (A x - b)` at the last iterate: the gradient without the part that the multiplier of
    /// `G x = e` balances.
    #[must_use]
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// The weights `W` of the last face: 1 on components free to move in both directions, else 0.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.w
    }
}
