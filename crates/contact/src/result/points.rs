//! What each contact point does at the end of a step, and sums over them.

use crate::model::{ConstrainedPoint, Model, PointRow};
use crate::step::{StepProblem, entry_or_zero};
use crate::tolerances::ON_BOUND;
use signorini_tfeti::TangentialRows;

/// What a contact point does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum ContactState {
    /// No normal force. Tresca friction does not depend on pressure and acts even so.
    Open,
    /// Pressed, and without tangential difference or without a friction law; where the slip bound is zero all slides.
    Stick,
    /// Pressed and sliding.
    Slip,
}

/// State of one contact point at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct PointState {
    /// Mesh node. At edges and corners of obstacles a node has several states, one for each normal.
    pub node: u32,
    /// Its partner on another body, on which the opposite forces act; `None` for a rigid obstacle. If meshes do not
    /// match, it is the node with the largest weight of several
    /// ([`ConstrainedPoint::nodes`](crate::ConstrainedPoint::nodes)).
    pub partner: Option<u32>,
    /// Position of the contact surface in [`Scene::contacts`](crate::Scene::contacts).
    pub surface: usize,
    /// Open, sticking or sliding.
    pub state: ContactState,
    /// Unit normal out of the body, into the obstacle or the partner: the direction in which gap and normal force are
    /// measured.
    pub normal: [f64; 3],
    /// Normal force `lambda_nu` on the body, N, not positive.
    pub normal_force: f64,
    /// Friction force on the body, N, as a vector in space.
    pub friction_force: [f64; 3],
    /// Slip bound, N; 0 without friction. For [orthotropic friction](crate::Contact::with_friction_axis) the bound
    /// along the axis.
    pub slip_bound: f64,
    /// Distance to the obstacle or the partner, m; negative for a [compliant](crate::Contact::with_normal_compliance)
    /// contact under pressure.
    pub gap: f64,
    /// Tangential displacement, m, as a vector in space; relative to the partner, if there is one.
    pub tangential_displacement: [f64; 3],
    /// Tangential difference `alpha u + beta u' + gamma u''` of (2.9), m, in space; the displacement itself in a static
    /// scene. Without [elastic slip](crate::Contact::with_tangential_compliance). Of a step that was taken in parts the
    /// sum of theirs.
    pub difference: [f64; 3],
    /// Slip rate: length of the difference over the step length, m/s; 0 in a static scene. Of a step that was taken in
    /// parts that of the last one.
    pub slip_rate: f64,
    /// Area, m².
    pub area: f64,
}

impl PointState {
    /// The whole contact force on the body, pressure and friction, N, in space. A partner has the opposite one.
    pub fn force(&self) -> [f64; 3] {
        [0, 1, 2].map(|c| self.friction_force[c] + self.normal_force * self.normal[c])
    }
}

/// Evaluates the contact points: in row units what rows measure, and what is compliance in it.
pub(crate) fn point_states(
    model: &Model,
    problem: &StepProblem,
    lambda: &[f64],
    rows: (&[f64], &[f64]),
) -> Vec<PointState> {
    let states = model.points.iter().enumerate();
    states
        .map(|(k, point)| {
            let bound = problem.slip_bound(k, point, lambda);
            point_state(problem, point, (lambda, rows), bound)
        })
        .collect()
}

/// Evaluates one point with its slip bound.
fn point_state(
    problem: &StepProblem,
    point: &ConstrainedPoint,
    (lambda, (rows, gives_way)): (&[f64], (&[f64], &[f64])),
    bound: f64,
) -> PointState {
    let alpha = problem.formula.map_or(1.0, |f| f.weights()[0]);
    let normal_force = point.scale * lambda[point.row];
    let space = |values: [f64; 2]| match point.tangential {
        TangentialRows::Disc { .. } => point.contact.frame.vector(0.0, values),
        TangentialRows::Interval { direction, .. } => direction.map(|d| d * values[0]),
        _ => [0.0; 3],
    };
    let (mut friction, mut displacement, mut difference) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    let mut on_bound = false;
    for (j, PointRow { row: k, scale, .. }) in point.along().enumerate() {
        friction[j] = scale * lambda[k];
        let elastic = entry_or_zero(gives_way, k);
        displacement[j] = (rows[k] - elastic - entry_or_zero(&problem.prescribed, k)) / scale;
        difference[j] = alpha * (rows[k] - problem.offset[k]) / scale;
        let [a, b] = point.stretch;
        on_bound = (friction[0] / a).hypot(friction[1] / b) >= bound * ON_BOUND;
    }
    let opposed = difference[0] * friction[0] + difference[1] * friction[1] <= 0.0;
    let state = if normal_force >= 0.0 {
        ContactState::Open
    } else if on_bound && opposed {
        ContactState::Slip
    } else {
        ContactState::Stick
    };
    let slip = difference[0].hypot(difference[1]);
    PointState {
        node: point.node(),
        partner: point.partner(),
        surface: point.surface(),
        state,
        normal: point.contact.frame.normal,
        normal_force,
        friction_force: space(friction),
        slip_bound: bound,
        gap: (problem.offset[point.row] - rows[point.row] + entry_or_zero(gives_way, point.row)) / point.scale,
        tangential_displacement: space(displacement),
        difference: space(difference),
        slip_rate: problem.step.map_or(0.0, |dt| slip / dt),
        area: point.area(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Friction;
    use crate::step::example::{block, first_step};

    /// Sliding is friction on its bound, against the slip; friction along it is a wrong one, not sliding.
    #[test]
    fn friction_along_the_slip_is_no_sliding() {
        let (model, problem) = first_step(block(0.0, Friction::coulomb(0.5)));
        let point = &model.points[4];
        let row = point.along().next().expect("friction").row;
        for (pressed, friction, slip, expected) in [
            (1.0, 0.5, -1e-3, ContactState::Slip),
            (1.0, 0.5, 1e-3, ContactState::Stick),
            (1.0, 0.4, -1e-3, ContactState::Stick),
            (0.0, 0.0, -1e-3, ContactState::Open),
        ] {
            let mut lambda = vec![0.0; model.tfeti.dual_dim()];
            let mut rows = problem.offset.clone();
            (lambda[point.row], lambda[row]) = (-pressed, friction);
            rows[row] += slip;
            let states = point_states(&model, &problem, &lambda, (&rows, &[]));
            assert_eq!(states[4].state, expected, "{friction} N, {slip} m");
        }
    }
}
