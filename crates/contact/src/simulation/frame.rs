//! The frame of a level: displacement, contact forces and states, and fields that are computed when asked for.

use crate::error::ContactError;
use crate::estimate::{Caches, Solved};
use crate::model::Model;
use crate::report::{AccumulatedError, AlgebraicError, StepReport};
use crate::result::{
    Certificate, ContactSummary, PointState, Reactions, nodal_reactions, reactions_about,
};
use crate::scene::Scene;
use crate::step::StepProblem;
use signorini_fem_mesh::{Decomposition, DiscretisationError, StrainRecovery, Surface, fields};

/// Result of one level; borrowed from the simulation.
#[derive(Debug)]
pub struct StepResult<'a> {
    pub(crate) model: &'a Model,
    pub(crate) caches: &'a Caches,
    pub(crate) level: &'a StepProblem,
    pub(crate) report: &'a StepReport,
    pub(crate) certificate: &'a Certificate,
    pub(crate) summary: &'a ContactSummary,
    pub(crate) points: &'a [PointState],
    pub(crate) torn: &'a [f64],
    pub(crate) residual: &'a [f64],
    /// Multipliers of the support rows.
    pub(crate) held: &'a [f64],
}

impl StepResult<'_> {
    /// Position of the level in the analysis, from 0.
    #[must_use]
    pub fn step(&self) -> usize {
        self.level.index
    }

    /// Time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.level.time
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.model.scene
    }

    /// The decomposition.
    #[must_use]
    pub fn decomposition(&self) -> &Decomposition {
        &self.model.decomposition
    }

    /// The first contact surface with all its nodes, fixed ones included; `None` without contact.
    #[must_use]
    pub fn surface(&self) -> Option<&Surface> {
        self.model.found.surfaces.first()
    }

    /// All contact surfaces, in the order of [`Scene::contacts`].
    #[must_use]
    pub fn surfaces(&self) -> &[Surface] {
        &self.model.found.surfaces
    }

    /// How the level was solved.
    #[must_use]
    pub fn report(&self) -> &StepReport {
        self.report
    }

    /// The first earlier level that did not converge and on whose displacement this one depends
    /// ([`StepReport::unconverged_history`]).
    #[must_use]
    pub fn unconverged_history(&self) -> Option<usize> {
        self.report.unconverged_history
    }

    /// For those who want every level to converge: an error unless this one did, and the earlier ones on whose displacement
    /// it depends.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] and [`ContactError::UnconvergedHistory`].
    pub fn require_converged(&self) -> Result<(), ContactError> {
        let certificate = self.certificate.largest();
        self.report
            .require(self.level.index, self.level.time, certificate)
    }

    /// How well all conditions hold.
    #[must_use]
    pub fn certificate(&self) -> &Certificate {
        self.certificate
    }

    /// Sums over the contact surface.
    #[must_use]
    pub fn summary(&self) -> &ContactSummary {
        self.summary
    }

    /// States of the touch points, in the order of the plan's contact nodes.
    #[must_use]
    pub fn points(&self) -> &[PointState] {
        self.points
    }

    /// The displacement of every subdomain, one after another, m.
    #[must_use]
    pub fn torn_displacement(&self) -> &[f64] {
        self.torn
    }

    /// Displacement at the mesh nodes, `3 node + component`, m: the mean of the copies.
    #[must_use]
    pub fn displacement(&self) -> Vec<f64> {
        self.model.tfeti.nodal_mean(self.torn)
    }

    /// Stress in every tetrahedron (xx, yy, zz, yz, xz, xy), Pa.
    ///
    /// # Errors
    /// [`ContactError::Field`] never for a displacement of this simulation.
    pub fn stress(&self) -> Result<Vec<[f64; 6]>, ContactError> {
        let scene = &self.model.scene;
        Ok(fields::stresses(
            &scene.mesh,
            &scene.materials,
            &self.displacement(),
        )?)
    }

    /// Elastic energy, J.
    ///
    /// # Errors
    /// As [`stress`](Self::stress).
    pub fn strain_energy(&self) -> Result<f64, ContactError> {
        let scene = &self.model.scene;
        Ok(fields::strain_energy(
            &scene.mesh,
            &scene.materials,
            &self.displacement(),
        )?)
    }

    /// Estimated algebraic error (by the duality gap): how far the solver stopped from the discrete solution.
    #[must_use]
    pub fn algebraic_error(&self) -> AlgebraicError {
        let solved = Solved {
            model: self.model,
            caches: self.caches,
            level: self.level,
            points: self.points,
            certificate: self.certificate,
            torn: self.torn,
            residual: self.residual,
        };
        solved.algebraic_error()
    }

    /// Estimated discretisation error, tetrahedron by tetrahedron (by recovered strains).
    ///
    /// # Errors
    /// As [`stress`](Self::stress).
    pub fn discretisation_error(&self) -> Result<DiscretisationError, ContactError> {
        let scene = &self.model.scene;
        let recovery = self
            .caches
            .recovery
            .get_or_init(|| StrainRecovery::new(&scene.mesh));
        Ok(recovery.error(&scene.mesh, &scene.materials, &self.displacement())?)
    }

    /// Reactions of the supports, with moments about the origin. See [`reactions_about`](Self::reactions_about).
    ///
    /// # Errors
    /// None for a frame of a simulation.
    pub fn reactions(&self) -> Result<Reactions, ContactError> {
        self.reactions_about([0.0; 3])
    }

    /// What each support does to the body, in force and moment about a point (m) and node by node; beside it what the obstacle and the
    /// loads do. Computed from the multipliers when asked for.
    ///
    /// Signs: forces *on the body*. A column that stands on a support and is pressed down has an upward reaction.
    ///
    /// ```
    /// use signorini_contact::{Load, Scene, Settings, Simulation, Support};
    /// use signorini_fem_mesh::{brick, Brick, Hooke, Materials};
    ///
    /// let mesh = Brick::new([1.0, 1.0, 3.0], [2, 2, 6]).build()?;
    /// let scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(2.1e11, 0.3)?))
    ///     .with_support(Support::fixed(brick::Z_MIN))
    ///     .with_load(Load::pressure(brick::Z_MAX, 1e6));
    /// let mut simulation = Simulation::new(scene, Settings::default())?;
    /// let reactions = simulation.step()?.reactions_about([0.5, 0.5, 0.0])?;
    /// for support in &reactions.supports {
    ///     let resultant = support.resultant;
    ///     assert!((resultant.force[2] - 1e6).abs() < 1.0);
    ///     assert!(resultant.moment.iter().all(|m| m.abs() < 1.0));
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// None for a frame of a simulation.
    pub fn reactions_about(&self, point: [f64; 3]) -> Result<Reactions, ContactError> {
        reactions_about(self.model, self.level, self.points, self.held, point)
    }

    /// Reactions of all supports at the mesh nodes, `3 node + component`, N: a field for output. Zero at nodes without support.
    #[must_use]
    pub fn reaction_field(&self) -> Vec<f64> {
        let mut field = vec![0.0; 3 * self.model.scene.mesh.points().len()];
        for (node, force) in nodal_reactions(self.model, self.points, self.held) {
            field[3 * node as usize..][..3].copy_from_slice(&force);
        }
        field
    }

    /// Contact forces at the mesh nodes, `3 node + component`, N: a field for output. Pressure and friction of all contact
    /// surfaces together, so that nodes in edges need no care; partners on other bodies have the opposite forces. Zero elsewhere.
    #[must_use]
    pub fn contact_force_field(&self) -> Vec<f64> {
        let mut field = vec![0.0; 3 * self.model.scene.mesh.points().len()];
        for point in self.points {
            let force = point.force();
            for (node, sign) in [(Some(point.node), 1.0), (point.partner, -1.0)] {
                let Some(node) = node else { continue };
                (0..3).for_each(|c| field[3 * node as usize + c] += sign * force[c]);
            }
        }
        field
    }

    /// Sum of all loads at this level, N.
    #[must_use]
    pub fn load_resultant(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (factor, load) in self.level.factors.iter().zip(&self.model.loads) {
            for node in load.force.chunks_exact(3) {
                for c in 0..3 {
                    sum[c] += factor * node[c];
                }
            }
        }
        sum
    }
}

impl AccumulatedError {
    /// Takes the next level: every level must be added, in order. Where levels stand alone (no friction, or a static scene)
    /// only the last one counts.
    pub fn add(&mut self, frame: &StepResult<'_>) {
        *self = self.with(&frame.algebraic_error(), frame.model.plan.effects.history);
    }
}
