//! The scenes: each has one effect more than the one before.

use signorini::prelude::*;

use crate::brick::{self as benchmark, DURATION, FRICTION, GAP, LENGTHS, POISSON, YOUNG};
use crate::error::ExampleError;

/// What is computed from every level besides the solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extra {
    /// Nothing.
    None,
    /// Stresses.
    Stress,
    /// Stresses are not needed, error estimates are.
    Errors,
}

/// A scene with a name.
#[derive(Debug, Clone)]
pub struct Case {
    /// What is new.
    pub name: String,
    /// The scene.
    pub scene: Scene,
    /// Settings.
    pub settings: Settings,
    /// What is computed from a level.
    pub extra: Extra,
}

/// Bound of the given friction stress, Pa.
const BOUND: f64 = 3e8;

/// The brick of the benchmark with `cells` cells along the edge of each of three subdomains, and `steps` steps where it has a
/// history.
///
/// # Errors
/// [`ExampleError`] for sizes that are 0 or too large.
pub fn cases(cells: usize, steps: usize) -> Result<Vec<Case>, ExampleError> {
    let mesh = Brick::new(LENGTHS, [3 * cells, cells, cells]).build()?;
    let steel = Hooke::isotropic(YOUNG, POISSON)?;
    let ramp = History::ramp(DURATION, 1.0)?;
    let load = |tag, value: [f64; 3]| {
        let value = value.map(|v| v * benchmark::TRACTION_UNIT);
        Load::traction(tag, value).with_history(ramp.clone())
    };
    let elastic = Scene::new(mesh, Materials::uniform(steel))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(load(brick::Z_MAX, benchmark::TOP))
        .with_load(load(brick::X_MAX, benchmark::END));
    let floor = || Contact::rigid(brick::Z_MIN);
    let rough = |friction| {
        elastic
            .clone()
            .with_contact(floor().with_gap(GAP).with_friction(friction))
    };
    let (fixed, kinetic, decay) = FRICTION;
    let weakening = Friction::Coulomb(Coefficient::Exponential {
        fixed,
        kinetic,
        decay,
    });
    let history = |scene: Scene| scene.with_analysis(Analysis::quasistatic(DURATION, steps));
    let full = || history(rough(weakening.clone())).with_boxes([3, 1, 1]);
    let case = |name: &str, scene| Case {
        name: name.to_owned(),
        scene,
        settings: Settings::default(),
        extra: Extra::None,
    };
    let mut out = vec![
        case("elastic only", elastic.clone()),
        case("+ contact", elastic.clone().with_contact(floor())),
        case("+ gap", rough(Friction::None)),
        case("+ given friction", rough(Friction::tresca(BOUND))),
        case("Coulomb instead", rough(Friction::coulomb(fixed))),
        case("+ history", history(rough(Friction::coulomb(fixed)))),
        case("+ rate dependence", history(rough(weakening.clone()))),
        case("+ several subdomains", full()),
        case("+ stress output", full()),
        case("+ error estimates", full()),
    ];
    for case in &mut out {
        match case.name.as_str() {
            "+ stress output" => case.extra = Extra::Stress,
            "+ error estimates" => case.extra = Extra::Errors,
            _ => {}
        }
    }
    Ok(out)
}
