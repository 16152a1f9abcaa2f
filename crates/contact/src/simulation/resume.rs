//! Continuing from a stored state.

use super::simulation::Simulation;
use crate::error::ContactError;
use crate::state::{NOT_FINITE, State};
use signorini_qp::SymmetricOperator;
use std::sync::Arc;

impl Simulation {
    /// Continues from a stored state of the same scene.
    ///
    /// These must be the same: mesh, decomposition, nodes and directions of supports, contact points with their normals
    /// and areas, difference formula, and the times of the steps already solved. Loads, motions of supports, materials,
    /// gaps, coefficients of friction (but not to or from zero everywhere), future times, settings and method may
    /// change, as long as rough points have the same directions of slip (a support that begins to move them along
    /// their surface gives them others); the changed scene then continues from the state. What starts, ends or is
    /// locked may have other times later on; what has started is held where it was then. To start from the state of a
    /// different scene on purpose, call [`State::without_origin`]; sizes must match in any case.
    ///
    /// # Errors
    /// [`ContactError::Checkpoint`] if the state does not fit; it says which part differs.
    pub fn resume(&mut self, mut state: State) -> Result<(), ContactError> {
        let refuse = |reason| Err(ContactError::Checkpoint { reason });
        let analysis = &self.model.scene.analysis;
        if state.step() > analysis.steps() || state.stage.first >= analysis.steps() {
            return refuse("it has more steps than this scene".to_owned());
        }
        // what acts and what is locked belongs to the state
        if self.model.scene.stage() != state.stage {
            if !state.is_finite() {
                return refuse(NOT_FINITE.to_owned());
            }
            let fresh = self.set_up_stage(self.model.scene.clone(), &state.stage, state.step());
            let mut fresh = fresh.map_err(|error| self.model.scene.names.tell(error))?;
            // those of all stages are known already
            if let Some(model) = Arc::get_mut(&mut fresh.model) {
                model.plan.warn(std::slice::from_ref(&self.model.plan));
            }
            state.stage = fresh.model.scene.stage();
            fresh.take(state)?;
            *self = fresh;
            return Ok(());
        }
        self.take(state)
    }

    /// Takes a state of the stage at hand.
    fn take(&mut self, mut state: State) -> Result<(), ContactError> {
        let refuse = |reason| Err(ContactError::Checkpoint { reason });
        let analysis = &self.model.scene.analysis;
        let origin = self.origin.after(analysis, state.step());
        let known = state.origin.filter(|_| state.step() > 0);
        if let Some(part) = known.and_then(|known| known.difference(&origin)) {
            return refuse(format!(
                "it belongs to another scene, with other {part}; continue with the scene that it was stored with, or, if \
                 another one is meant, from State::without_origin"
            ));
        }
        let tfeti = &self.model.tfeti;
        let (rows, coarse) = (tfeti.dual_dim(), tfeti.coarse().rows());
        state.fits(
            rows,
            coarse,
            self.model.tangential_rows().len(),
            self.model.points.len(),
        )?;
        state.origin = Some(origin);
        self.check_products(&mut state);
        self.result = None;
        self.state = Arc::new(state);
        Ok(())
    }

    /// `F lambda` is made anew where it was stored with another F, or is not what was stored: solvers take it at its
    /// word.
    pub(super) fn check_products(&self, state: &mut State) {
        let dual = self.model.tfeti.dual();
        state.renew_products(self.operator, |lambda, f_lambda| {
            dual.apply(lambda, f_lambda, &mut dual.scratch());
        });
    }
}

#[cfg(test)]
mod tests {
    use crate::{Analysis, Contact, Friction, Load, Scene, Settings, Simulation, Support};
    use signorini_fem_mesh::{Brick, History, Hooke, Materials, brick};
    use signorini_qp::{SymmetricOperator, vector};

    fn simulation(young: f64) -> Simulation {
        Simulation::new(scene(young), Settings::default()).expect("set-up")
    }

    fn scene(young: f64) -> Scene {
        let mesh = Brick::new([2.0, 1.0, 1.0], [2, 1, 1]).build().expect("mesh");
        let hooke = Hooke::isotropic(young, 0.3).expect("Hooke");
        let ramp = History::ramp(1.0, 1.0).expect("ramp");
        Scene::new(mesh, Materials::uniform(hooke))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e6]).with_history(ramp))
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
            .with_boxes([2, 1, 1])
            .with_analysis(Analysis::quasistatic(1.0, 4))
    }

    /// Equal steps of a longer analysis end elsewhere by rounding; what starts where the first one ended is held there.
    #[test]
    fn longer_analyses_go_on() {
        let with = |end: f64, steps: usize, holds: bool| {
            let scene = scene(1e9).with_analysis(Analysis::quasistatic(end, steps));
            let support = Support::fixed(brick::X_MAX).with_start(1.0);
            let scene = if holds { scene.with_support(support) } else { scene };
            Simulation::new(scene, Settings::default()).expect("set-up")
        };
        let mut short = with(1.0, 10, false);
        for _ in 0..10 {
            let _ = short.step().expect("step");
        }
        assert_ne!(1.0 * 3.0 / 10.0, 1.1 * 3.0 / 11.0);
        let mut longer = with(1.1, 11, true);
        longer.resume(short.state().clone()).expect("resume");
        let last = longer.step().expect("step").displacement();
        let before = short.result().expect("a step").displacement();
        let largest = vector::max_abs(before.as_flattened());
        for node in longer.scene().mesh().nodes_on(brick::X_MAX) {
            let [from, to] = [&before, &last].map(|u| u[node as usize]);
            assert!(
                (0..3).all(|c| (to[c] - from[c]).abs() <= 1e-6 * largest),
                "{node}: {from:?} {to:?}"
            );
        }
        let mut other = with(2.0, 10, false);
        assert!(other.resume(short.state().clone()).is_err());
    }

    /// A support that moves from now on leaves another K+.
    #[test]
    fn products_are_of_what_supports_hold_at_zero() {
        let ramp = History::ramp(1.0, 1.0).expect("ramp");
        let roller = Support::components(brick::X_MAX, [true, false, false]);
        let [rests, moves] = [roller.clone(), roller.with_motion([1e-3, 0.0, 0.0], ramp)].map(|roller| {
            let scene = scene(1e9).with_support(roller);
            Simulation::new(scene, Settings::default()).expect("set-up")
        });
        assert_ne!(rests.operator, moves.operator);
    }

    /// A state with damaged places of a support that starts: it was set up for without end.
    #[test]
    fn damaged_stages_are_refused() {
        let scene = || {
            let mesh = Brick::new([2.0, 1.0, 1.0], [2, 1, 1]).build().expect("mesh");
            let hooke = Hooke::isotropic(1e9, 0.3).expect("Hooke");
            Scene::new(mesh, Materials::uniform(hooke))
                .with_support(Support::fixed(brick::X_MIN))
                .with_support(Support::fixed(brick::X_MAX).with_start(1.0))
                .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e6]))
                .with_analysis(Analysis::quasistatic(3.0, 3))
        };
        let simulation = || Simulation::new(scene(), Settings::default()).expect("set-up");
        let mut run = simulation();
        for _ in 0..2 {
            let _ = run.step().expect("step");
        }
        let mut state = run.state().clone();
        assert!(simulation().resume(state.clone()).is_ok());
        state.stage.left[1][0][2] = f64::NAN;
        let error = simulation().resume(state).unwrap_err().to_string();
        assert!(error.contains("it contains NaN"), "{error}");
    }

    /// Products of another material, and such as are none, are made anew, by name of the scene or without it; those of
    /// the same one keep every bit.
    #[test]
    fn products_of_another_operator_are_made_anew() {
        let mut stored = simulation(1e9);
        for _ in 0..2 {
            let _ = stored.step().expect("step");
        }
        let state = stored.state().clone();
        for state in [state.clone(), state.clone().without_origin()] {
            let mut same = simulation(1e9);
            same.resume(state.clone()).expect("resume");
            assert_eq!(same.state().f_lambda, state.f_lambda);
            // twice as stiff: half the displacement by the same forces
            let mut other = simulation(2e9);
            other.resume(state.clone()).expect("resume");
            let (dual, found) = (other.tfeti().dual(), other.state());
            for k in 0..2 {
                let mut product = vec![0.0; dual.dim()];
                dual.apply(&found.lambda[k], &mut product, &mut dual.scratch());
                assert_eq!(found.f_lambda[k], product, "step {k} ago");
                let [new, old] = [&product, &state.f_lambda[k]].map(|v| vector::norm(v));
                assert!((new / old - 0.5).abs() < 1e-6, "{new} {old}");
            }
            // stored once more it is a state of the stiffer body
            let mut again = simulation(2e9);
            again.resume(found.clone()).expect("resume");
            assert_eq!(again.state(), found);
        }
        // garbage in the place of a product of the same scene
        let mut garbage = state;
        garbage.renew_products(0, |_, f_lambda| f_lambda.fill(1.0));
        let mut same = simulation(1e9);
        same.resume(garbage).expect("resume");
        let (dual, found) = (same.tfeti().dual(), same.state());
        let mut product = vec![0.0; dual.dim()];
        dual.apply(&found.lambda[0], &mut product, &mut dual.scratch());
        assert_eq!(found.f_lambda[0], product);
    }
}
