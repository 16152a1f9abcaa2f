//! Continuing from a stored state.

use super::Simulation;
use crate::error::ContactError;
use crate::screening::Screen;
use crate::state::State;
use signorini_qp::{SymmetricOperator, vector};
use std::sync::Arc;

/// Relative error of a stored `F lambda` above which it belongs to another scene.
const FOREIGN: f64 = 1e-6;

impl Simulation {
    /// Continues from a stored state of the same scene.
    ///
    /// States do not depend on [`Screening`](crate::Screening): one stored with it can be continued without, and the other
    /// way round; bit for bit the same only with the same setting.
    ///
    /// # Errors
    /// [`ContactError::Checkpoint`] if the state does not fit.
    pub fn resume(&mut self, mut state: State) -> Result<(), ContactError> {
        let tfeti = &self.model.tfeti;
        let own = (tfeti.dual_dim(), self.model.tangential_rows());
        let (rows, tangential) = self.screen.as_ref().map_or(own, Screen::sizes);
        let (coarse, points) = (tfeti.coarse().rows(), self.touch_points().len());
        state.fits(rows, coarse, tangential, points)?;
        if state.level() > self.model.scene.analysis.levels() {
            return Err(ContactError::Checkpoint {
                reason: "it has more levels than this scene".to_owned(),
            });
        }
        if self.screen.is_some() {
            let active = match (state.level(), state.active()) {
                (0, _) => vec![false; points],
                (_, []) => vec![true; points],
                (_, active) => active.to_vec(),
            };
            self.admit(active)?;
        } else if !state.active().is_empty() {
            state.forget_products();
            state.set_active(&[]);
        }
        self.solved = false;
        self.state = Arc::new(state);
        self.check_products();
        Ok(())
    }

    /// Recomputes `F lambda` of a state that another scene left: solvers take it at its word.
    fn check_products(&mut self) {
        let dual = self.model.tfeti.dual();
        let mut scratch = dual.scratch();
        let mut product = vec![0.0; dual.dim()];
        let mut foreign = |lambda: &[f64], f_lambda: &[f64]| {
            if lambda.len() != product.len() || f_lambda.len() != product.len() {
                return None;
            }
            dual.apply(lambda, &mut product, &mut scratch);
            let off = vector::distance(&product, f_lambda);
            let same = off <= FOREIGN * vector::norm(&product);
            (!same).then(|| product.clone())
        };
        if let Some(screen) = &self.screen {
            let view = screen.view(&self.state);
            let pairs = view.lambda().iter().zip(view.f_lambda());
            if pairs.filter_map(|(l, f)| foreign(l, f)).next().is_some() {
                Arc::make_mut(&mut self.state).forget_products();
            }
            return;
        }
        for (lambda, f_lambda) in Arc::make_mut(&mut self.state).products_mut() {
            if let Some(product) = foreign(lambda, f_lambda) {
                *f_lambda = product;
            }
        }
    }
}
