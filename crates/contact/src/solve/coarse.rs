//! Orthonormal coarse rows, which the paper's methods need.

use crate::error::ContactError;
use crate::model::{Model, freed};
use crate::status::FreeCoupling;
use signorini_qp::{Equality, vector};
use signorini_tfeti::internal::CoarseScratch;
use signorini_tfeti::{BodyMotion, FreeMotion, OrthonormalCoarse};

/// The rows with their right side and work memory.
pub(super) struct OrthonormalRows {
    pub(super) coarse: OrthonormalCoarse,
    /// Right side of the step, in orthonormal rows.
    pub(super) rhs: Vec<f64>,
    scratch: CoarseScratch,
}

impl OrthonormalRows {
    /// # Errors
    /// [`ContactError::NotDetermined`] if no row stops some rigid motion. The check of equilibrium has found before
    /// that the loads do not push along it.
    pub(super) fn new(model: &Model) -> Result<Self, ContactError> {
        let factor = model.tfeti.coarse_factor()?;
        let coarse = factor
            .orthonormal()
            .ok_or_else(|| not_determined(model, factor.free_motions()))?;
        Ok(Self {
            coarse,
            rhs: vec![0.0; model.tfeti.coarse().rows()],
            scratch: factor.scratch(),
        })
    }

    /// Takes the right side `e` of a step.
    pub(super) fn set_rhs(&mut self, rhs: &[f64]) {
        self.coarse.rhs(rhs, &mut self.rhs, &mut self.scratch);
    }

    /// Length of what is left of the equality.
    pub(super) fn imbalance(&mut self, lambda: &[f64]) -> f64 {
        let mut forces = vec![0.0; self.rhs.len()];
        self.coarse.apply(lambda, &mut forces, &mut self.scratch);
        vector::distance(&forces, &self.rhs)
    }

    /// Rigid amplitudes from the multiplier of the equality.
    pub(super) fn amplitudes(&mut self, multiplier: &[f64], alpha: &mut Vec<f64>) {
        alpha.resize(self.rhs.len(), 0.0);
        self.coarse.amplitudes(multiplier, alpha, &mut self.scratch);
    }
}

/// The error that some rigid motions are stopped by nothing.
pub(super) fn not_determined(model: &Model, motions: &[FreeMotion]) -> ContactError {
    let words: Vec<String> = motions.iter().map(ToString::to_string).collect();
    let body = motions.first().and_then(|m| m.bodies.first());
    ContactError::NotDetermined {
        body: body.map_or(0, |b| b.body),
        node: body.map_or(0, |b| model.discrete.decomposition.subdomains()[b.subdomain].nodes[0]),
        count: motions.len(),
        motions: words.join("; "),
        in_contact: !model.points.is_empty(),
        coupling: motions.iter().find_map(|motion| left_free(model, motion)).map(Box::new),
    }
}

/// The coupling that leaves a motion free.
fn left_free(model: &Model, motion: &FreeMotion) -> Option<FreeCoupling> {
    let size = |b: &BodyMotion| vector::norm(&b.translation).hypot(vector::norm(&b.rotation));
    let bodies = motion.bodies.iter().map(|b| (size(b), b.radius));
    freed(model, &[motion], &[1.0], bodies.max_by(|a, b| a.0.total_cmp(&b.0))?)
}
