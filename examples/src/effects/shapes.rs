//! Scenes that are not the brick of the benchmark: what the plan's products are held against.

use signorini::contact::Accuracy;
use signorini::prelude::*;

use super::cases::{Case, Extra};
use crate::brick::{LENGTHS, POISSON, YOUNG, clamped};
use crate::error::ExampleError;

type Make = fn() -> Result<Scene, Error>;

/// Scenes of other shapes, materials, supports, loads and decompositions, each solved in less than a second.
///
/// # Errors
/// [`ExampleError`] of the library.
pub fn shapes() -> Result<Vec<Case>, ExampleError> {
    let list: [(&str, Make); 16] = [
        ("cube sheared by its support", cube),
        ("long beam, bends down", beam),
        ("plate, frictionless, static", plate),
        ("arch on a cylinder", arch),
        ("rubber, given friction", rubber),
        ("layers, stiffness 1 : 1000", layers),
        ("irregular mesh", irregular),
        ("block held by friction", free),
        ("one subdomain", single),
        ("81 subdomains, H/h = 2", many),
        ("pulled brick, given friction", pulled),
        ("brick, no friction, 10 steps", smooth),
        ("brick, H/h = 9", fine),
        ("slab 8 : 1, one subdomain", slab),
        ("beam 8 : 1, one subdomain", long),
        ("slab 8 : 1, 64 subdomains", cut_slab),
    ];
    list.into_iter()
        .map(|(name, scene)| {
            Ok(Case {
                name: name.to_owned(),
                scene: scene()?,
                settings: Settings::default(),
                extra: Extra::None,
            })
        })
        .collect()
}

/// The scenes with other tolerances and with levels that end by an estimate of the error.
///
/// # Errors
/// [`ExampleError`] of the library.
pub fn accuracies() -> Result<Vec<Case>, ExampleError> {
    let set = Settings::default;
    let ways = [
        ("1e-3", set().with_tolerance(1e-3)),
        ("1e-9", set().with_tolerance(1e-9)),
        (
            "relative 1e-4",
            set().with_accuracy(Accuracy::Relative(1e-4)),
        ),
        ("balanced", set().with_accuracy(Accuracy::balanced())),
    ];
    let all = shapes()?;
    let mut cases = Vec::new();
    for name in ["cube", "arch", "irregular", "pulled"] {
        for case in all.iter().filter(|c| c.name.starts_with(name)) {
            for (way, settings) in &ways {
                cases.push(Case {
                    name: format!("{}, {way}", case.name),
                    settings: settings.clone(),
                    ..case.clone()
                });
            }
        }
    }
    Ok(cases)
}

fn steel() -> Result<Materials, Error> {
    Ok(Materials::uniform(Hooke::isotropic(YOUNG, POISSON)?))
}

fn ramp() -> Result<History, Error> {
    Ok(History::ramp(1.0, 1.0)?)
}

/// Up, down and up again.
fn waves() -> Result<History, Error> {
    Ok(History::table(vec![
        (0.0, 0.0),
        (0.4, 1.0),
        (0.7, 0.0),
        (1.0, 1.0),
    ])?)
}

fn steps(count: usize) -> Analysis {
    Analysis::quasistatic(1.0, count).with_formula(DifferenceFormula::BACKWARD_EULER)
}

fn floor(gap: f64, coefficient: f64) -> Contact {
    let contact = Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(coefficient));
    if gap == 0.0 {
        contact
    } else {
        contact.with_gap(gap)
    }
}

fn cube() -> Result<Scene, Error> {
    let mesh = Brick::new([1.0; 3], [8; 3]).build()?;
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::Z_MAX).with_motion([0.002, 0.0, -0.004], ramp()?))
        .with_contact(floor(0.0001, 0.3))
        .with_boxes([2; 3])
        .with_analysis(steps(10)))
}

fn beam() -> Result<Scene, Error> {
    let mesh = Brick::new([8.0, 0.5, 0.5], [48, 3, 3]).build()?;
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::X_MAX, [2e6, 0.0, -4e7]).with_history(ramp()?))
        .with_contact(floor(0.1, 0.3))
        .with_boxes([16, 1, 1])
        .with_analysis(steps(10)))
}

fn plate() -> Result<Scene, Error> {
    let mesh = Brick::new([4.0, 4.0, 0.5], [16, 16, 2]).build()?;
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1e7))
        .with_contact(Contact::rigid(brick::Z_MIN).with_gap(0.01))
        .with_boxes([4, 4, 1]))
}

fn arch() -> Result<Scene, Error> {
    let straight = Brick::new([3.0, 1.0, 0.5], [18, 6, 3]).build()?;
    let parts = parts(&straight, |p| (p[0].floor() as u32).min(2));
    let mesh = straight.map_points(|p| {
        let (radius, angle) = (2.0 + p[2], p[0] / 2.0);
        [radius * angle.sin(), p[1], radius * angle.cos()]
    })?;
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 4e8).with_history(ramp()?))
        .with_load(Load::traction(brick::X_MAX, [0.0, 1e8, -1e8]).with_history(waves()?))
        .with_contact(floor(0.001, 0.2))
        .with_parts(parts)
        .with_analysis(steps(10)))
}

fn rubber() -> Result<Scene, Error> {
    let mesh = Brick::new([2.0, 1.0, 1.0], [10, 5, 5]).build()?;
    let soft = Materials::uniform(Hooke::isotropic(1e7, 0.49)?);
    Ok(Scene::new(mesh, soft)
        .with_support(Support::fixed(brick::Z_MAX).with_motion([0.0, 0.0, -0.05], ramp()?))
        .with_load(Load::traction(brick::X_MAX, [2e5, 0.0, 0.0]).with_history(ramp()?))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::tresca(2e5)))
        .with_boxes([2, 1, 1])
        .with_analysis(steps(6)))
}

fn layers() -> Result<Scene, Error> {
    let mesh = Brick::new([3.0, 1.0, 1.0], [12, 4, 4]).build()?;
    let regions = parts(&mesh, |p| u32::from(p[2] > 0.5));
    let materials = Materials::new(vec![
        (0, Hooke::isotropic(YOUNG, POISSON)?),
        (1, Hooke::isotropic(1e-3 * YOUNG, POISSON)?),
    ])?;
    Ok(Scene::new(mesh.with_regions(regions)?, materials)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1e7).with_history(ramp()?))
        .with_load(Load::traction(brick::X_MAX, [1e7, 0.0, 0.0]).with_history(waves()?))
        .with_contact(floor(0.0005, 0.3))
        .with_boxes([3, 1, 2])
        .with_analysis(steps(10)))
}

fn irregular() -> Result<Scene, Error> {
    Ok(clamped(1, 5, 0.15)?
        .with_load(Load::traction(brick::Z_MAX, [0.0, 1e9, -3e9]).with_history(ramp()?))
        .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(waves()?))
        .with_contact(floor(0.1, 0.5))
        .with_analysis(steps(20)))
}

fn free() -> Result<Scene, Error> {
    let mesh = Brick::new([2.0, 2.0, 1.0], [8, 8, 4]).build()?;
    Ok(Scene::new(mesh, steel()?)
        .with_load(Load::pressure(brick::Z_MAX, 1e8))
        .with_load(Load::traction(brick::X_MAX, [2e7, 0.0, 0.0]).with_history(ramp()?))
        .with_contact(floor(0.0, 0.4))
        .with_boxes([2, 2, 1])
        .with_analysis(steps(6)))
}

fn single() -> Result<Scene, Error> {
    let mesh = Brick::new(LENGTHS, [18, 6, 6]).build()?;
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]).with_history(ramp()?))
        .with_contact(floor(0.1, 0.2))
        .with_analysis(steps(10)))
}

fn many() -> Result<Scene, Error> {
    let mesh = Brick::new(LENGTHS, [18, 6, 6]).build()?;
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]).with_history(ramp()?))
        .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(waves()?))
        .with_contact(floor(0.1, 0.3))
        .with_boxes([9, 3, 3])
        .with_analysis(steps(10)))
}

fn pulled() -> Result<Scene, Error> {
    Ok(clamped(1, 4, 0.0)?
        .with_load(Load::pressure(brick::Z_MAX, 1e8))
        .with_load(Load::traction(brick::X_MAX, [2e8, 0.0, 0.0]).with_history(ramp()?))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::tresca(3e7)))
        .with_analysis(steps(10)))
}

fn smooth() -> Result<Scene, Error> {
    Ok(clamped(1, 5, 0.0)?
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]).with_history(ramp()?))
        .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(waves()?))
        .with_contact(Contact::rigid(brick::Z_MIN).with_gap(0.1))
        .with_analysis(steps(10)))
}

fn fine() -> Result<Scene, Error> {
    Ok(clamped(1, 9, 0.0)?
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]).with_history(ramp()?))
        .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(waves()?))
        .with_contact(floor(0.1, 0.3))
        .with_analysis(steps(10)))
}

fn slab() -> Result<Scene, Error> {
    let mesh = Brick::new([4.0, 4.0, 0.5], [16, 16, 2]).build()?;
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1e8).with_history(ramp()?))
        .with_contact(floor(0.01, 0.3))
        .with_analysis(steps(1)))
}

fn cut_slab() -> Result<Scene, Error> {
    Ok(slab()?.with_boxes([8, 8, 1]))
}

fn long() -> Result<Scene, Error> {
    let mesh = Brick::new([8.0, 1.0, 1.0], [16, 2, 2]).build()?;
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1e8).with_history(ramp()?))
        .with_contact(floor(0.02, 0.3))
        .with_analysis(steps(10)))
}

/// A number for each tetrahedron from its centre.
fn parts(mesh: &TetMesh, part: impl Fn([f64; 3]) -> u32) -> Vec<u32> {
    (0..mesh.tets().len())
        .map(|tet| {
            let corners = mesh.tet_points(tet);
            part([0, 1, 2].map(|c| corners.iter().map(|p| p[c]).sum::<f64>() / 4.0))
        })
        .collect()
}
