//! The result of a step: displacement, contact forces and states, and fields that are computed when asked for.

use crate::discrete::Extents;
use crate::error::ContactError;
use crate::estimate::{Caches, Solved};
use crate::model::Model;
use crate::plan::FrictionKind;
use crate::report::{AccumulatedError, AlgebraicError, StepReport, Warning, require};
use crate::result::{
    Certificate, ContactSummary, CouplingMotion, Lengths, PointState, Reactions, Recovered, SurfaceStress, coarse_mesh,
    is_strained, nodal_reactions, points_at_nodes, reactions_about, tied_forces, warnings,
};
use crate::scene::{LoadKind, Scene};
use crate::status::{StepFailure, StepStatus};
use crate::step::StepProblem;
use crate::tolerances::SLENDER;
use signorini_fem_mesh::recovery::{DiscretisationError, StrainRecovery};
use signorini_fem_mesh::{Decomposition, Materials, Surface, fields};
use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

/// The result of a step. It is independent of the simulation, which can take further steps meanwhile.
pub struct StepResult {
    pub(crate) model: Arc<Model>,
    pub(crate) caches: Arc<Caches>,
    pub(crate) problem: Arc<StepProblem>,
    pub(crate) report: StepReport,
    pub(crate) recovered: Recovered,
    /// Of all contacts, then, of several, of each.
    pub(crate) summaries: Vec<ContactSummary>,
}

/// What it sums up; not the megabytes of tables and vectors.
impl fmt::Debug for StepResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StepResult")
            .field("step", &self.step())
            .field("time", &self.time())
            .field("report", &self.report)
            .field("summary", self.summary())
            .finish_non_exhaustive()
    }
}

impl StepResult {
    /// Position of the step in the analysis, from 0.
    pub fn step(&self) -> usize {
        self.problem.index
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.problem.time
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.model.scene
    }

    /// The decomposition.
    pub fn decomposition(&self) -> &Decomposition {
        &self.model.discrete.decomposition
    }

    /// All contact surfaces, in the order of [`Scene::contacts`].
    pub fn surfaces(&self) -> &[Surface] {
        &self.model.discrete.surfaces
    }

    /// How the step was solved.
    pub fn report(&self) -> &StepReport {
        &self.report
    }

    /// Why the step did not converge; `None` if it did.
    pub fn failure(&self) -> Option<StepFailure> {
        (!self.report.status.converged()).then_some(StepFailure {
            step: self.step(),
            time: self.time(),
            status: self.report.status,
            certificate: self.recovered.certificate.largest(),
            condition: self.recovered.certificate.worst().0,
            slide: self.report.slide,
            slender: self.slender(),
        })
    }

    /// That of [`StepFailure::slender`].
    fn slender(&self) -> Option<f64> {
        let ended = matches!(
            self.report.status,
            StepStatus::IterationLimit | StepStatus::Stagnated | StepStatus::NotHeld
        );
        let (mesh, discrete) = (&self.model.scene.mesh, &self.model.discrete);
        let nodes = discrete.points.iter().flat_map(|p| p.sides.nodes()).map(|n| n.0);
        let found = ended.then(|| Extents::slenderness(mesh, &discrete.decomposition, nodes));
        found.filter(|slender| *slender > SLENDER)
    }

    /// An error unless this step converged, and the earlier ones on whose displacement it depends.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] and [`ContactError::UnconvergedHistory`].
    pub fn require_converged(&self) -> Result<(), ContactError> {
        let required = require(self.failure(), self.report.unconverged_history);
        required.map_err(|error| self.model.scene.names.tell(error))
    }

    /// How well all conditions are satisfied.
    pub fn certificate(&self) -> &Certificate {
        &self.recovered.certificate
    }

    /// Warnings about this result, each kind at its worst place: large displacements, rotations, strains and slips.
    /// Computed on demand; a [run](crate::Simulation::run) does so at every step.
    pub fn warnings(&self) -> Vec<Warning> {
        self.warnings_but(&[])
    }

    /// The same without kinds already known.
    pub(super) fn warnings_but(&self, known: &[Warning]) -> Vec<Warning> {
        let new = warnings(&self.model, self.lengths(), &self.problem, &self.recovered, known);
        new.into_iter().map(|w| w.told(&self.scene().names)).collect()
    }

    fn lengths(&self) -> &Lengths {
        self.caches.lengths.get_or_init(|| Lengths::new(&self.model))
    }

    /// The estimated error of the mesh, relative, and what is to be said of it; `None` where it would be noise.
    pub(super) fn mesh_error(&self) -> Option<(f64, Option<Warning>)> {
        let (model, recovered) = (&self.model, &self.recovered);
        if !is_strained(model, self.lengths(), &self.problem, recovered) {
            return None;
        }
        let error = self.discretisation_error().ok()?;
        let warning = coarse_mesh(model, &error, self.step());
        Some((error.relative(), warning.map(|w| w.told(&model.scene.names))))
    }

    /// Resultants of contact, numbers of points, and work.
    pub fn summary(&self) -> &ContactSummary {
        &self.summaries[0]
    }

    /// The same of one contact, by its position in [`Scene::contacts`]; `None` if there is no such contact. A point
    /// that two contacts share counts where its [`PointState::surface`] says.
    pub fn summary_of(&self, contact: usize) -> Option<&ContactSummary> {
        let contacts = self.scene().contacts().len();
        let place = if contacts > 1 { 1 + contact } else { 0 };
        self.summaries.get(place).filter(|_| contact < contacts)
    }

    /// States of the contact points, in the order of the rows.
    pub fn points(&self) -> &[PointState] {
        &self.recovered.points
    }

    /// The displacement of every subdomain, one after another, m.
    pub fn torn_displacement(&self) -> &[f64] {
        &self.recovered.torn
    }

    /// Displacement of each mesh node, m: the mean over its copies in the subdomains.
    pub fn displacement(&self) -> Vec<[f64; 3]> {
        let mean = self.model.tfeti.nodal_mean(&self.recovered.torn);
        mean.as_chunks().0.to_vec()
    }

    /// The motion of each [coupling](crate::Coupling), in the order of the scene.
    pub fn couplings(&self) -> Vec<CouplingMotion> {
        let motions = self.model.coupling_motions(&self.recovered.torn).into_iter();
        motions
            .map(|[displacement, rotation]| CouplingMotion { displacement, rotation })
            .collect()
    }

    /// Stress in every tetrahedron (xx, yy, zz, yz, xz, xy), Pa; NaN where the displacement is NaN.
    pub fn stress(&self) -> Vec<[f64; 6]> {
        let mesh = self.scene().mesh();
        let stresses = fields::stresses(mesh, &self.materials(), self.displacement().as_flattened());
        stresses.unwrap_or_else(|_| vec![[f64::NAN; 6]; mesh.tets().len()])
    }

    /// Stress at every node, in the same order, Pa: the mean of the tetrahedra around it
    /// ([`nodal_stresses`](fields::nodal_stresses)); NaN everywhere where the displacement is NaN.
    pub fn nodal_stress(&self) -> Vec<[f64; 6]> {
        let mesh = self.scene().mesh();
        let stresses = fields::nodal_stresses(mesh, &self.materials(), self.displacement().as_flattened());
        stresses.unwrap_or_else(|_| vec![[f64::NAN; 6]; mesh.points().len()])
    }

    /// Elastic energy, J; NaN if the displacement is.
    pub fn strain_energy(&self) -> f64 {
        let u = self.displacement();
        let energy = fields::strain_energy(self.scene().mesh(), &self.materials(), u.as_flattened());
        energy.unwrap_or(f64::NAN)
    }

    /// The materials with the eigenstrains of this step, which those of the scene do not have;
    /// [`fields`](signorini_fem_mesh::fields) needs them for stresses.
    pub fn materials(&self) -> Cow<'_, Materials> {
        materials(&self.model, &self.problem)
    }

    /// Estimated algebraic error, by the duality gap: the distance of the result from the discrete solution.
    pub fn algebraic_error(&self) -> AlgebraicError {
        self.solved().algebraic_error()
    }

    fn solved(&self) -> Solved<'_> {
        Solved {
            model: &self.model,
            caches: &self.caches,
            problem: &self.problem,
            recovered: &self.recovered,
        }
    }

    /// Estimated discretisation error, tetrahedron by tetrahedron, by recovered strains.
    ///
    /// # Errors
    /// [`ContactError::Field`] if the displacement is not finite.
    pub fn discretisation_error(&self) -> Result<DiscretisationError, ContactError> {
        self.solved().discretisation_error()
    }

    /// Reactions of the supports, with moments about the origin. See [`reactions_about`](Self::reactions_about).
    pub fn reactions(&self) -> Reactions {
        self.reactions_about([0.0; 3])
    }

    /// Forces of each support on the body, with moments about a point (m) and node by node, and the resultants of
    /// contact, springs and loads. Computed from the multipliers on demand.
    ///
    /// Forces act *on the body*: a column that stands on a support and is pressed down has an upward reaction.
    pub fn reactions_about(&self, point: [f64; 3]) -> Reactions {
        reactions_about(&self.model, &self.problem, &self.recovered, point)
    }

    /// Reactions of all supports at each mesh node, N, as a field for output. Zero at nodes without support.
    pub fn reaction_field(&self) -> Vec<[f64; 3]> {
        let mut field = vec![[0.0; 3]; self.model.scene.mesh.points().len()];
        let ties = tied_forces(&self.model, &self.recovered);
        for (node, force) in nodal_reactions(&self.model, &self.recovered, &ties) {
            field[node as usize] = force;
        }
        field
    }

    /// Contact forces at each mesh node, N, as a field for output: the sum of pressure and friction over all contact
    /// surfaces, also at edges; partners on other bodies have the opposite forces. Zero elsewhere.
    pub fn contact_force_field(&self) -> Vec<[f64; 3]> {
        let mut field = vec![[0.0; 3]; self.model.scene.mesh.points().len()];
        for (state, point) in self.recovered.points.iter().zip(self.model.points.iter()) {
            for (node, force) in point.contact.sides.forces(state.force()) {
                (0..3).for_each(|c| field[node as usize][c] += force[c]);
            }
        }
        field
    }

    /// Contact pressure at each of [`Surface::nodes`] of contact surface number `surface`, Pa; `None` if there is no
    /// such surface. It is force over area, averaged twice with the mass matrix of the facets, and so smooth on unequal
    /// triangles, where the plain quotient scatters by some per cent.
    ///
    /// Averaging preserves a constant pressure, and, to rounding, the sum of pressure times [area](PointState::area),
    /// which is the normal force. The sum is not preserved near nodes without a contact point of this surface (held by
    /// a support along the normal, or with nothing opposite), whose pressure is zero, near linear facets that are
    /// covered in part, and at nodes that two surfaces share. The edge of contact is blurred over two facets: pressures
    /// there, and on small contact zones, are unreliable. At a crease the pressure is that of the side that is pressed
    /// most, without averaging around the crease.
    pub fn contact_pressure(&self, surface: usize) -> Option<Vec<f64>> {
        self.surface_stress(surface).map(|stress| stress.pressure)
    }

    /// Friction stress on the body at each of [`Surface::nodes`] of a contact surface, Pa, in space: averaged as the
    /// [pressure](Self::contact_pressure), component by component.
    pub fn friction_stress(&self, surface: usize) -> Option<Vec<[f64; 3]>> {
        self.surface_stress(surface).map(|stress| stress.friction)
    }

    pub(crate) fn surface_stress(&self, surface: usize) -> Option<SurfaceStress> {
        let known = surface < self.surfaces().len();
        known.then(|| SurfaceStress::new(&self.model, &self.recovered.points, surface))
    }

    /// The contact point at each of [`Surface::nodes`] of a contact surface; `None` if there is no such surface. At a
    /// crease it is the point that is pressed most, or else the one nearest to contact; nodes held by a support have
    /// none.
    pub fn points_at_nodes(&self, surface: usize) -> Option<Vec<Option<&PointState>>> {
        let places = self.places_at_nodes(surface)?;
        let state = |place: Option<usize>| place.map(|k| &self.recovered.points[k]);
        Some(places.into_iter().map(state).collect())
    }

    /// The same as places among all points.
    pub(crate) fn places_at_nodes(&self, surface: usize) -> Option<Vec<Option<usize>>> {
        let known = surface < self.surfaces().len();
        known.then(|| points_at_nodes(&self.model, &self.recovered.points, surface))
    }
}

/// A line: the time, how many contact points touch and slide, its [warnings](StepResult::warnings) in a few words, and
/// the certificate; of a step that did not converge its status, too.
impl fmt::Display for StepResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // seven digits
        write!(f, "t = {} s: ", self.time() as f32)?;
        if self.model.plan.effects.contact {
            let ContactSummary { active, slip, .. } = *self.summary();
            write!(f, "{active} of {} points touch, ", self.points().len())?;
            if self.model.plan.effects.friction != FrictionKind::None {
                write!(f, "{slip} slide, ")?;
            }
        }
        let warnings: Vec<String> = self.warnings().iter().filter_map(Warning::brief).collect();
        match warnings.len() {
            0 => {}
            1 => write!(f, "warning ({}), ", warnings[0])?,
            count => write!(f, "{count} warnings ({}), ", warnings.join(", "))?,
        }
        write!(f, "certificate {:.0e}", self.certificate().largest())?;
        match self.failure() {
            Some(failure) => write!(f, ", {}", failure.status),
            None => Ok(()),
        }
    }
}

impl Solved<'_> {
    /// The error of the mesh, by recovered strains.
    pub(super) fn discretisation_error(&self) -> Result<DiscretisationError, ContactError> {
        let mesh = &self.model.scene.mesh;
        let recovery = self.caches.recovery.get_or_init(|| StrainRecovery::new(mesh));
        let u = self.model.tfeti.nodal_mean(&self.recovered.torn);
        Ok(recovery.error(mesh, &materials(self.model, self.problem), &u)?)
    }
}

/// The materials of a scene with the eigenstrains of a step.
fn materials<'a>(model: &'a Model, problem: &StepProblem) -> Cow<'a, Materials> {
    let mut all = Cow::Borrowed(&model.scene.materials);
    for (load, factor) in model.scene.loads.iter().zip(&problem.factors) {
        if let LoadKind::Eigenstrain(strain) = &load.kind {
            all = Cow::Owned(all.into_owned().with_eigenstrain(*factor, strain.clone()));
        }
    }
    all
}

impl AccumulatedError {
    /// Takes the next step: every step must be added, in order. Where steps stand alone (no friction, or a static
    /// scene) only the last one counts.
    pub fn add(&mut self, result: &StepResult) {
        *self = self.with(&result.algebraic_error(), result.model.plan.effects.history);
    }
}
