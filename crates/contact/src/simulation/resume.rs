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
    /// What gives stored numbers their meaning must be the same: mesh, decomposition, nodes and directions of supports, contact points with
    /// their normals and areas, difference formula, and the times of the levels solved so far. Free to change are loads, motions of supports, materials,
    /// gap, coefficients, times to come, settings and method: the state is then where the changed scene goes on from. A start from
    /// a scene that is another one on purpose needs [`State::without_origin`]; sizes must fit in any case.
    ///
    /// States do not depend on [`Screening`](crate::Screening): one stored with it can be continued without, and the other
    /// way round; bit for bit the same only with the same setting.
    ///
    /// # Errors
    /// [`ContactError::Checkpoint`] if the state does not fit; it says which part differs.
    pub fn resume(&mut self, mut state: State) -> Result<(), ContactError> {
        let refuse = |reason| Err(ContactError::Checkpoint { reason });
        let analysis = &self.model.scene.analysis;
        if state.level() > analysis.levels() {
            return refuse("it has more levels than this scene".to_owned());
        }
        let origin = self.origin.after(analysis, state.level());
        let known = state.origin().filter(|_| state.level() > 0);
        if let Some(part) = known.and_then(|known| known.difference(&origin)) {
            return refuse(format!(
                "it belongs to another scene, with other {part}; continue with the scene that it was stored with, or, if \
                 another one is meant, from State::without_origin"
            ));
        }
        let tfeti = &self.model.tfeti;
        let own = (tfeti.dual_dim(), self.model.tangential_rows());
        let (rows, tangential) = self.screen.as_ref().map_or(own, Screen::sizes);
        let (coarse, points) = (tfeti.coarse().rows(), self.touch_points().len());
        state.fits(rows, coarse, tangential, points)?;
        state.set_origin(origin);
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
