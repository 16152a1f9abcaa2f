//! Couplings that are locked after a step.

use super::simulation::Simulation;
use crate::discrete::axes;
use crate::error::ContactError;
use crate::scene::Scene;
use crate::tolerances::ROUNDING;
use signorini_fem_mesh::vec3::dot;
use signorini_tfeti::RigidSupport;
use std::sync::Arc;

impl Simulation {
    /// Locks the couplings whose time has come.
    pub(super) fn lock_due(&mut self) -> Result<(), ContactError> {
        let scene = &self.model.scene;
        let last = self
            .state
            .step()
            .checked_sub(1)
            .and_then(|step| scene.analysis.time(step));
        let now = last.unwrap_or(0.0);
        let mut locked: Vec<[Option<f64>; 6]> = scene.couplings.iter().map(|c| c.locked).collect();
        let mut due = false;
        for (k, coupling) in scene.couplings.iter().enumerate() {
            if let Some((left, _)) = coupling.pending().filter(|(_, time)| *time <= now * (1.0 + ROUNDING)) {
                let motion = self.state.motions.get(k).copied().unwrap_or_default();
                for c in (0..6).filter(|&c| left[c]) {
                    locked[k][c] = Some(motion[c]);
                }
                due = true;
            }
        }
        if due { self.lock(locked) } else { Ok(()) }
    }

    /// Sets the scene up anew with these motions locked, and goes on from the state.
    fn lock(&mut self, locked: Vec<[Option<f64>; 6]>) -> Result<(), ContactError> {
        let mut state = self.state.clone();
        let before = self.model.clone();
        self.set_up_locked(&locked)?;
        let own = Arc::make_mut(&mut state);
        let [old, new] = [&before, &self.model].map(|model| &model.discrete.couplings.supports);
        let same = |a: &RigidSupport| {
            old.iter()
                .position(|b| (a.subdomain, a.direction) == (b.subdomain, b.direction))
        };
        let rows: Vec<Option<usize>> = new.iter().map(same).collect();
        own.replace_rows(before.tfeti.gluing().ranges().rigid.clone(), &rows);
        own.locked = locked;
        own.origin = Some(self.origin.after(&self.model.scene.analysis, own.step()));
        self.check_products(own);
        self.state = state;
        Ok(())
    }

    /// The same simulation before its first step, with these motions locked.
    pub(super) fn set_up_locked(&mut self, locked: &[[Option<f64>; 6]]) -> Result<(), ContactError> {
        let mut scene = self.model.scene.clone();
        for (k, coupling) in scene.couplings.iter_mut().enumerate() {
            coupling.locked = locked.get(k).copied().unwrap_or_default();
        }
        let fresh = Self::set_up(scene, self.settings.clone())?;
        let (total, setup) = (self.total, self.setup + fresh.setup);
        *self = Self { total, setup, ..fresh };
        Ok(())
    }

    /// Motions of couplings along their axes, where some are to be locked.
    pub(super) fn motions_to_lock(scene: &Scene, motion: impl Fn(usize) -> [[f64; 3]; 2]) -> Vec<[f64; 6]> {
        if scene.couplings.iter().all(|c| c.pending().is_none()) {
            return Vec::new();
        }
        let along = |(k, coupling)| {
            let axes = axes(coupling).unwrap_or_default();
            let parts = motion(k).map(|part| axes.map(|axis| dot(axis, part)));
            std::array::from_fn(|c| parts[c / 3][c % 3])
        };
        scene.couplings.iter().enumerate().map(along).collect()
    }
}
