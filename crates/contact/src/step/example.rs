//! A scene for unit tests of what works on rows.

use super::problem::StepProblem;
use crate::model::Model;
use crate::scene::{Contact, Friction, Scene, Support};
use crate::settings::Settings;
use crate::state::State;
use signorini_fem_mesh::{Brick, Hooke, Materials, brick};

/// A block on a rough floor at a distance.
pub(crate) fn block(gap: f64, friction: Friction) -> Scene {
    let mesh = Brick::new([1.0; 3], [2; 3]).build().expect("brick");
    let elastic = Hooke::isotropic(1e6, 0.3).expect("Hooke");
    let floor = Contact::rigid(brick::Z_MIN).with_gap(gap);
    Scene::new(mesh, Materials::uniform(elastic))
        .with_support(Support::fixed(brick::Z_MAX))
        .with_contact(floor.with_friction(friction))
        .with_boxes([2, 1, 1])
}

/// Its model and first step.
pub(crate) fn first_step(scene: Scene) -> (Model, StepProblem) {
    let model = Model::new(scene, &Settings::default()).expect("model");
    let mut problem = StepProblem::default();
    let first = model.scene.analysis.increment(0).expect("a step");
    problem.prepare(&model, &State::default(), first, 0.0).expect("step");
    (model, problem)
}
