//! Scenes in which most of the possible contact surface is far from the obstacle, as if nobody had said where it may touch.

use signorini::prelude::*;

use super::cases::{Case, Extra};
use crate::brick::{POISSON, YOUNG};
use crate::error::ExampleError;

/// The scenes; with `short` coarse ones with few levels.
///
/// # Errors
/// [`ExampleError`] of the library.
pub fn far(short: bool) -> Result<Vec<Case>, ExampleError> {
    let (cells, steps) = if short { (2, 4) } else { (5, 30) };
    let list = [
        ("long brick, end bends down", long(cells, steps)?),
        ("curved floor", curved(cells, steps)?),
        ("load that travels", travelling(cells, steps)?),
    ];
    Ok(list
        .into_iter()
        .map(|(name, scene)| Case {
            name: name.to_owned(),
            scene,
            settings: Settings::default(),
            extra: Extra::None,
        })
        .collect())
}

fn steel() -> Result<Materials, Error> {
    Ok(Materials::uniform(Hooke::isotropic(YOUNG, POISSON)?))
}

/// Ten cubes in a row, clamped at one end and pushed down at the other onto a floor 0.2 m below. All faces but the clamped one
/// are contact surface, each with an obstacle at that distance.
fn long(cells: usize, steps: usize) -> Result<Scene, Error> {
    let mesh = Brick::new([10.0, 1.0, 1.0], [10 * cells, cells, cells]).build()?;
    let ramp = History::ramp(1.0, 1.0)?;
    let contact = [brick::Z_MAX, brick::Y_MIN, brick::Y_MAX, brick::X_MAX]
        .into_iter()
        .fold(Contact::rigid(brick::Z_MIN), Contact::with_tag)
        .with_gap(0.2)
        // measured with one normal a node
        .with_crease(180.0)
        .with_friction(Friction::coulomb(0.3));
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::X_MAX, [1e8, 0.0, -3e8]).with_history(ramp))
        .with_contact(contact)
        .with_boxes([10, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, steps).with_formula(DifferenceFormula::PAPER)))
}

/// A block pressed on a floor that falls away from its middle, and pushed along it.
fn curved(cells: usize, steps: usize) -> Result<Scene, Error> {
    let mesh = Brick::new([4.0, 4.0, 1.0], [4 * cells, 4 * cells, cells]).build()?;
    let ramp = History::ramp(1.0, 1.0)?;
    let contact = Contact::rigid(brick::Z_MIN)
        .with_gap_field(|p| 0.02 * ((p[0] - 2.0).powi(2) + (p[1] - 2.0).powi(2)))
        .with_friction(Friction::coulomb(0.3));
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 3e8).with_history(ramp.clone()))
        .with_load(Load::traction(brick::X_MAX, [0.0, 2e8, 0.0]).with_history(ramp))
        .with_contact(contact)
        .with_boxes([4, 4, 1])
        .with_analysis(Analysis::quasistatic(1.0, steps).with_formula(DifferenceFormula::PAPER)))
}

/// A long slab, held at one side, on a floor 20 mm below; a pressure travels along its top.
fn travelling(cells: usize, steps: usize) -> Result<Scene, Error> {
    let (length, width) = (12, 1.5);
    let mesh = Brick::new(
        [length as f64, 1.0, 0.5],
        [length * cells, cells, cells.div_ceil(2)],
    )
    .build()?;
    // a tag for each metre of the top
    let first = 100;
    let mesh = mesh.tag_boundary(|centre, normal| {
        if normal[2] > 0.5 {
            Some(FacetTag(first + centre[0] as u32))
        } else if normal[2] < -0.5 {
            Some(brick::Z_MIN)
        } else {
            (normal[1] < -0.5).then_some(brick::Y_MIN)
        }
    });
    let contact = Contact::rigid(brick::Z_MIN)
        .with_gap(0.02)
        .with_friction(Friction::coulomb(0.3));
    let mut scene = Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::Y_MIN))
        .with_contact(contact)
        .with_boxes([length, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, steps).with_formula(DifferenceFormula::PAPER));
    for metre in 0..length {
        // a hat around the time at which the load is there
        let at = (metre as f64 + 0.5) / length as f64;
        let hat = [-1.0, 0.0, 1.0].map(|s| (at + s * width / length as f64, 1.0 - f64::abs(s)));
        let pressure = Load::pressure(FacetTag(first + metre as u32), 6e8);
        scene = scene.with_load(pressure.with_history(History::table(hat.to_vec())?));
    }
    Ok(scene)
}
