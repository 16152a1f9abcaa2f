//! Stages of a scene: it is set up anew where supports or contacts start or end, or couplings are locked.

use super::simulation::{Simulation, on_pool};
use crate::error::ContactError;
use crate::scene::{Scene, Stage, is_past};
use std::sync::Arc;

impl Simulation {
    /// Enters the stage of the next step, if it is another one.
    pub(super) fn enter_due(&mut self) -> Result<(), ContactError> {
        let (scene, state) = (&self.model.scene, &self.state);
        let Some(end) = scene.analysis.time(state.step()) else {
            return Ok(());
        };
        let mut stage = scene.stage();
        let first = scene.stage_of(state.step());
        let mut due = first > stage.first;
        for (k, coupling) in scene.couplings.iter().enumerate() {
            if let Some((left, _)) = coupling.pending().filter(|(_, time)| is_past(*time, end)) {
                let motion = match state.motions.get(k) {
                    Some(motion) => *motion,
                    None if state.step() == 0 => [0.0; 6],
                    None => {
                        let reason =
                            "it does not say how couplings moved that are to be locked; continue from a state of a \
                            scene with these couplings"
                                .to_owned();
                        return Err(ContactError::Checkpoint { reason });
                    }
                };
                stage.locked.resize(scene.couplings.len(), [None; 6]);
                (0..6)
                    .filter(|&c| left[c])
                    .for_each(|c| stage.locked[k][c] = Some(motion[c]));
                due = true;
            }
        }
        if !due {
            return Ok(());
        }
        stage.first = stage.first.max(first);
        let mut next = scene.clone();
        next.enter(&stage);
        for k in (0..next.supports.len()).filter(|&k| next.has_started(k) && next.supports[k].left.is_empty()) {
            stage.left.resize(next.supports.len(), Vec::new());
            let nodes = next.support_nodes(k)?;
            let places = state.places(next.mesh.points().len())?;
            stage.left[k] = nodes.iter().map(|node| places[*node as usize]).collect();
        }
        self.enter(next, &stage)
    }

    /// Sets the scene up anew for a stage, and goes on from the state.
    fn enter(&mut self, scene: Scene, stage: &Stage) -> Result<(), ContactError> {
        let fresh = self.set_up_stage(scene, stage, self.state.step())?;
        let mut state = self.state.clone();
        let own = Arc::make_mut(&mut state);
        own.carry_over(&self.model, &fresh.model)?;
        own.stage = fresh.model.scene.stage();
        own.origin = Some(fresh.origin.after(&fresh.model.scene.analysis, own.step()));
        fresh.check_products(own);
        *self = fresh;
        self.state = state;
        Ok(())
    }

    /// The same simulation before its first step, set up for a stage, of which the steps from this one on are to come.
    pub(super) fn set_up_stage(&self, mut scene: Scene, stage: &Stage, step: usize) -> Result<Self, ContactError> {
        scene.enter(stage);
        let fresh = on_pool(|| Self::set_up(scene, self.settings.clone(), step))?;
        let (total, setup) = (self.total, self.setup + fresh.setup);
        Ok(Self { total, setup, ..fresh })
    }
}
