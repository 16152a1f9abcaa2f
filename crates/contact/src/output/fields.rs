//! The fields of bodies and contact surfaces at the end of a step, and at rest.

use crate::error::ContactError;
use crate::result::ContactState;
use crate::simulation::StepResult;
use crate::vec3::dot;
use signorini_fem_mesh::Surface;
use signorini_fem_mesh::fields::von_mises;
use signorini_fem_mesh::output::Field;

/// A field that a [`ResultWriter`](crate::ResultWriter) can write, with its name and unit in the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ResultField {
    /// `displacement`, m, at the nodes of bodies and surfaces: warp by it.
    Displacement,
    /// `von_mises`, Pa: of each tetrahedron, and at the nodes of the stress averaged there.
    VonMises,
    /// `stress`, Pa: of each tetrahedron, and at the nodes averaged over the volumes around.
    Stress,
    /// `contact_force` on the bodies, N, at their nodes ([`StepResult::contact_force_field`]).
    ContactForce,
    /// `reaction` of all supports, N, at the nodes of the bodies ([`StepResult::reaction_field`]).
    Reaction,
    /// `subdomain` of each tetrahedron, from 0.
    Subdomain,
    /// `estimated_error` of the mesh in each tetrahedron, as a stress, Pa
    /// ([`stress_errors`](signorini_fem_mesh::recovery::DiscretisationError::stress_errors)).
    EstimatedError,
    /// `contact_pressure`, Pa, on the surfaces ([`StepResult::contact_pressure`]).
    ContactPressure,
    /// `friction_stress` on the body, Pa, on the surfaces ([`StepResult::friction_stress`]).
    FrictionStress,
    /// `gap`, m, on the surfaces: distance to the obstacle or the partner; 0 where there is no contact point.
    Gap,
    /// `slip`, m, on the surfaces: way along the obstacle or the partner since the start, touching or not.
    Slip,
    /// `slip_rate`, m/s, on the surfaces; 0 where nothing touches.
    SlipRate,
    /// `state` on the surfaces: 0 open, 1 stick, 2 slip, -1 where there is no contact point: a support holds the node
    /// along the normal, or nothing faces it. The head of the table says so, too.
    State,
}

impl ResultField {
    /// What a writer writes unless told otherwise.
    pub(super) const USUAL: [Self; 7] = [
        Self::Displacement,
        Self::VonMises,
        Self::ContactPressure,
        Self::FrictionStress,
        Self::Gap,
        Self::Slip,
        Self::State,
    ];

    /// Name in the files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::VonMises => "von_mises",
            Self::Stress => "stress",
            Self::ContactForce => "contact_force",
            Self::Reaction => "reaction",
            Self::Subdomain => "subdomain",
            Self::EstimatedError => "estimated_error",
            Self::ContactPressure => "contact_pressure",
            Self::FrictionStress => "friction_stress",
            Self::Gap => "gap",
            Self::Slip => "slip",
            Self::SlipRate => "slip_rate",
            Self::State => "state",
        }
    }
}

/// What `state` means, in one line.
pub(super) const LEGEND: &str =
    "state: -1 no contact point (held by a support, or nothing faces it), 0 open, 1 stick, 2 slip";

/// Fields at nodes and of cells.
type Fields = (Vec<Field>, Vec<Field>);

/// The chosen fields of the bodies, at the end of the step or at `rest`: before the first one, undeformed and without
/// forces.
pub(super) fn body(result: &StepResult, chosen: &[ResultField], rest: bool) -> Result<Fields, ContactError> {
    let mesh = result.scene().mesh();
    let (nodes, tets) = (mesh.points().len(), mesh.tets().len());
    let stressed = chosen
        .iter()
        .any(|f| matches!(f, ResultField::Stress | ResultField::VonMises));
    let stress = if rest || !stressed { vec![[0.0; 6]; tets] } else { result.stress() };
    let nodal = if rest || !stressed { vec![[0.0; 6]; nodes] } else { result.nodal_stress() };
    let vectors = |of: fn(&StepResult) -> Vec<[f64; 3]>| if rest { vec![[0.0; 3]; nodes] } else { of(result) };
    let (mut at_nodes, mut in_tets) = (Vec::new(), Vec::new());
    for &field in chosen {
        let name = field.name();
        match field {
            ResultField::Displacement => at_nodes.push(Field::vector(name, &vectors(StepResult::displacement))),
            ResultField::ContactForce => at_nodes.push(Field::vector(name, &vectors(StepResult::contact_force_field))),
            ResultField::Reaction => at_nodes.push(Field::vector(name, &vectors(StepResult::reaction_field))),
            ResultField::Stress => {
                at_nodes.push(Field::symmetric_tensor(name, &nodal));
                in_tets.push(Field::symmetric_tensor(name, &stress));
            }
            ResultField::VonMises => {
                at_nodes.push(Field::scalar(name, nodal.iter().map(von_mises).collect()));
                in_tets.push(Field::scalar(name, stress.iter().map(von_mises).collect()));
            }
            ResultField::Subdomain => {
                let parts = result.decomposition().parts().iter();
                in_tets.push(Field::scalar(name, parts.map(|&p| p.into()).collect()));
            }
            ResultField::EstimatedError if rest => in_tets.push(Field::scalar(name, vec![0.0; tets])),
            ResultField::EstimatedError => {
                let error = result.discretisation_error()?;
                let errors = error.stress_errors(mesh, result.scene().materials())?;
                in_tets.push(Field::scalar(name, errors));
            }
            _ => {}
        }
    }
    Ok((at_nodes, in_tets))
}

/// The same of each contact surface, and `contact`, its position in the scene, on its triangles.
pub(super) fn surfaces(result: &StepResult, chosen: &[ResultField], rest: bool) -> Vec<Fields> {
    let nodes = result.scene().mesh().points().len();
    let u = if rest { vec![[0.0; 3]; nodes] } else { result.displacement() };
    let of = |(surface, own): (usize, &Surface)| {
        let contact = Field::scalar("contact", vec![surface as f64; own.triangles().len()]);
        (on_surface(result, chosen, (surface, rest), &u), vec![contact])
    };
    result.surfaces().iter().enumerate().map(of).collect()
}

fn on_surface(
    result: &StepResult,
    chosen: &[ResultField],
    (surface, rest): (usize, bool),
    u: &[[f64; 3]],
) -> Vec<Field> {
    let nodes = result.surfaces()[surface].nodes();
    let places = result.places_at_nodes(surface).unwrap_or_default();
    let states = &result.recovered.points;
    let stressed = |f: &ResultField| matches!(f, ResultField::ContactPressure | ResultField::FrictionStress);
    let stressed = !rest && chosen.iter().any(stressed);
    let stress = stressed.then(|| result.surface_stress(surface)).flatten();
    let scalar = |of: &dyn Fn(usize) -> f64, none: f64| places.iter().map(|p| p.map_or(none, of)).collect();
    let mut out = Vec::new();
    for &field in chosen {
        let name = field.name();
        out.push(match field {
            ResultField::Displacement => {
                let own: Vec<[f64; 3]> = nodes.iter().map(|&n| u[n as usize]).collect();
                Field::vector(name, &own)
            }
            ResultField::ContactPressure => {
                let pressure = stress.as_ref().map(|s| s.pressure.clone());
                Field::scalar(name, pressure.unwrap_or(vec![0.0; nodes.len()]))
            }
            ResultField::FrictionStress => {
                let friction = stress.as_ref().map(|s| s.friction.clone());
                Field::vector(name, &friction.unwrap_or(vec![[0.0; 3]; nodes.len()]))
            }
            ResultField::Gap if rest => Field::scalar(name, scalar(&|k| gap_at_rest(result, k), 0.0)),
            ResultField::Gap => Field::scalar(name, scalar(&|k| states[k].gap, 0.0)),
            ResultField::Slip => {
                let slip = |k: usize| if rest { [0.0; 3] } else { slip(result, k, u) };
                let slips: Vec<_> = places.iter().map(|p| p.map_or([0.0; 3], slip)).collect();
                Field::vector(name, &slips)
            }
            ResultField::SlipRate => {
                let slides = |k: usize| !rest && states[k].state != ContactState::Open;
                let rate = |k: usize| if slides(k) { states[k].slip_rate } else { 0.0 };
                Field::scalar(name, scalar(&rate, 0.0))
            }
            ResultField::State => {
                let number = |k: usize| if rest { 0.0 } else { number(states[k].state) };
                Field::scalar(name, scalar(&number, -1.0))
            }
            _ => continue,
        });
    }
    out
}

fn number(state: ContactState) -> f64 {
    match state {
        ContactState::Open => 0.0,
        ContactState::Stick => 1.0,
        ContactState::Slip => 2.0,
    }
}

/// The gap of a contact point before the first step, m.
fn gap_at_rest(result: &StepResult, point: usize) -> f64 {
    let point = &result.model.points[point];
    let contact = &result.scene().contacts()[point.surface()];
    contact.gap_history.as_ref().map_or(1.0, |h| h.value(0.0)) * point.gap()
}

/// The way of a contact point along the obstacle or the partner, m.
fn slip(result: &StepResult, point: usize, u: &[[f64; 3]]) -> [f64; 3] {
    let state = &result.recovered.points[point];
    let contact = &result.model.points[point];
    let drag = result.problem.pose(contact).drag(&contact.contact.centre);
    let along = |node: u32, v: &[f64; 3]| dot(&u[node as usize], v);
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let way = [0, 1, 2].map(|c| contact.contact.sides.way(&axes[c], along) - drag[c]);
    let out: f64 = (0..3).map(|c| way[c] * state.normal[c]).sum();
    [0, 1, 2].map(|c| way[c] - out * state.normal[c])
}
