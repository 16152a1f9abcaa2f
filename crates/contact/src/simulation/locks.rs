//! Couplings that are locked after a step.

use super::simulation::{Simulation, on_pool};
use crate::error::ContactError;
use crate::tolerances::ROUNDING;
use signorini_tfeti::RigidSupport;
use std::sync::Arc;

/// For each coupling the motions at which it is locked; may be empty.
pub(super) type Locked = Vec<[Option<f64>; 6]>;

impl Simulation {
    /// Locks the couplings whose time has come: before the end of the next step.
    pub(super) fn lock_due(&mut self) -> Result<(), ContactError> {
        let (scene, state) = (&self.model.scene, &self.state);
        let Some(end) = scene.analysis.time(state.step()) else {
            return Ok(());
        };
        let (mut locked, mut due) = (self.locked(), false);
        for (k, coupling) in scene.couplings.iter().enumerate() {
            if let Some((left, _)) = coupling.pending().filter(|(_, time)| time * (1.0 + ROUNDING) < end) {
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
                (0..6).filter(|&c| left[c]).for_each(|c| locked[k][c] = Some(motion[c]));
                due = true;
            }
        }
        if due { self.lock(locked) } else { Ok(()) }
    }

    /// Sets the scene up anew with these motions locked, and goes on from the state.
    fn lock(&mut self, locked: Locked) -> Result<(), ContactError> {
        let fresh = self.set_up_locked(&locked)?;
        let mut state = self.state.clone();
        let own = Arc::make_mut(&mut state);
        let [old, new] = [&self.model, &fresh.model].map(|model| &model.discrete.couplings.supports);
        let same = |a: &RigidSupport| {
            let is_same = |b: &RigidSupport| (a.subdomain, a.direction) == (b.subdomain, b.direction);
            old.iter().position(is_same)
        };
        let rows: Vec<Option<usize>> = new.iter().map(same).collect();
        own.replace_rows(self.model.tfeti.gluing().ranges().rigid.clone(), &rows);
        own.locked = locked;
        own.origin = Some(fresh.origin.after(&fresh.model.scene.analysis, own.step()));
        fresh.check_products(own);
        *self = fresh;
        self.state = state;
        Ok(())
    }

    /// The same simulation before its first step, with these motions locked.
    pub(super) fn set_up_locked(&self, locked: &[[Option<f64>; 6]]) -> Result<Self, ContactError> {
        let mut scene = self.model.scene.clone();
        for (k, coupling) in scene.couplings.iter_mut().enumerate() {
            let own = locked.get(k).copied().unwrap_or_default();
            let held = coupling.held;
            coupling.locked = [0, 1, 2, 3, 4, 5].map(|c| own[c].filter(|_| !held[c]));
        }
        let fresh = on_pool(|| Self::set_up(scene, self.settings.clone()))?;
        let (total, setup) = (self.total, self.setup + fresh.setup);
        Ok(Self { total, setup, ..fresh })
    }

    /// What is locked now.
    pub(super) fn locked(&self) -> Locked {
        self.model.scene.couplings.iter().map(|c| c.locked).collect()
    }
}
