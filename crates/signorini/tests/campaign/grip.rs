//! Rigid couplings of bodies meshed apart, and their words in the library.

use crate::recipe::Course;
use crate::vec3::{Vec3, add, cross, norm, scale, sub};
use signorini::prelude::*;

/// A rigid coupling: nodes that move as one.
#[derive(Debug, Clone)]
pub(crate) struct Grip {
    pub(crate) nodes: Vec<u32>,
    pub(crate) reference: Vec3,
    /// Displacements along x, y, z, and rotations about them.
    pub(crate) held: [bool; 6],
    /// What is held moves so, m and radians.
    pub(crate) motion: Option<([f64; 6], Course)>,
    /// Force and moment.
    pub(crate) load: Option<([Vec3; 2], Course)>,
}

impl Grip {
    /// Displacement and rotation of what is held.
    pub(crate) fn told(&self, time: f64) -> [f64; 6] {
        match &self.motion {
            Some((motion, course)) => motion.map(|m| m * course.value(time)),
            None => [0.0; 6],
        }
    }

    /// Force and moment about the reference point.
    pub(crate) fn applied(&self, time: f64) -> [Vec3; 2] {
        match &self.load {
            Some((load, course)) => load.map(|l| scale(course.value(time), l)),
            None => [[0.0; 3]; 2],
        }
    }

    /// How far its nodes are from its reference point at most, m.
    pub(crate) fn far(&self, points: &[Vec3]) -> f64 {
        let arms = self
            .nodes
            .iter()
            .map(|n| norm(sub(points[*n as usize], self.reference)));
        arms.fold(0.0, f64::max)
    }

    /// Displacement of a place by the motion of the reference point.
    pub(crate) fn moved(&self, [displacement, rotation]: [Vec3; 2], x: Vec3) -> Vec3 {
        add(displacement, cross(rotation, sub(x, self.reference)))
    }
}

/// The couplings in the words of the library.
pub(crate) fn scene(grips: &[Grip], mut scene: Scene) -> Result<Scene, Error> {
    for (index, grip) in grips.iter().enumerate() {
        let mut coupling = Coupling::rigid(grip.nodes.clone(), grip.reference).with_held(grip.held);
        if let Some((motion, course)) = &grip.motion {
            coupling = coupling.with_motion(*motion, crate::say::history(course)?);
        }
        scene = scene.with_coupling(coupling);
        if let Some(([force, moment], course)) = &grip.load {
            let load = Load::on_coupling(index, *force, *moment);
            scene = scene.with_load(load.with_history(crate::say::history(course)?));
        }
    }
    Ok(scene)
}
