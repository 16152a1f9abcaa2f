//! Scenes that are not the brick of the benchmark: what the plan's products are held against.

use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::{Block, EULER, LENGTHS, POISSON, RAMP, TOP, WAVES, YOUNG, by_centre, steel};

use super::cases::Case;

/// Scenes of other shapes, materials, supports, loads and decompositions, each solved in less than a second.
pub(crate) fn shapes() -> Result<Vec<Case>, Failure> {
    let rough = |coefficient| Some(Friction::coulomb(coefficient));
    let block = Block {
        steps: 10,
        cells: [5; 3],
        ..Block::default()
    };
    let down = |lengths, boxes, cells, pressure: f64, gap, steps| Block {
        lengths,
        boxes,
        cells,
        top: [0.0, 0.0, -pressure],
        end: [0.0; 3],
        gap,
        steps,
        ..Block::default()
    };
    let irregular = Block {
        perturbation: 0.15,
        top: [0.0, 1e9, -3e9],
        floor: rough(0.5),
        steps: 20,
        ..block.clone()
    };
    let long_beam = Block {
        top: [0.0; 3],
        end: [2e6, 0.0, -4e7],
        end_history: RAMP.to_vec(),
        ..down([8.0, 0.5, 0.5], [16, 1, 1], [3; 3], 0.0, 0.1, 10)
    };
    let plate = Block {
        floor: Some(Friction::None),
        ..down([4.0, 4.0, 0.5], [4, 4, 1], [4, 4, 2], 1e7, 0.01, 0)
    };
    let single = Block {
        floor: rough(0.2),
        ..down(LENGTHS, [1; 3], [18, 6, 6], -TOP[2], 0.1, 10)
    };
    let pulled = Block {
        top: [0.0, 0.0, -1e8],
        top_history: vec![(0.0, 1.0), (1.0, 1.0)],
        end: [2e8, 0.0, 0.0],
        end_history: RAMP.to_vec(),
        gap: 0.0,
        floor: Some(Friction::tresca(3e7)),
        cells: [4; 3],
        ..block.clone()
    };
    let (many, smooth) = (([9, 3, 3], [2; 3]), Some(Friction::None));
    let list = [
        ("cube sheared by its support", cube()?),
        ("long beam, bends down", long_beam.scene()?),
        ("plate, frictionless, static", plate.scene()?),
        ("arch on a cylinder", arch()?),
        ("rubber, Tresca friction", rubber()?),
        ("layers, stiffness 1 : 1000", layers()?),
        ("irregular mesh", irregular.scene()?),
        ("block held by friction", free()?),
        ("one subdomain", single.scene()?),
        (
            "81 subdomains, H/h = 2",
            Block {
                boxes: many.0,
                cells: many.1,
                ..block.clone()
            }
            .scene()?,
        ),
        ("pulled brick, Tresca friction", pulled.scene()?),
        (
            "brick, no friction, 10 steps",
            Block {
                floor: smooth,
                ..block.clone()
            }
            .scene()?,
        ),
        (
            "brick, H/h = 9",
            Block {
                cells: [9; 3],
                ..block.clone()
            }
            .scene()?,
        ),
        (
            "slab 8 : 1, one subdomain",
            down([4.0, 4.0, 0.5], [1; 3], [16, 16, 2], 1e8, 0.01, 1).scene()?,
        ),
        (
            "beam 8 : 1, one subdomain",
            down([8.0, 1.0, 1.0], [1; 3], [16, 2, 2], 1e8, 0.02, 10).scene()?,
        ),
        (
            "slab 8 : 1, 64 subdomains",
            down([4.0, 4.0, 0.5], [8, 8, 1], [2; 3], 1e8, 0.01, 1).scene()?,
        ),
    ];
    Ok(list.into_iter().map(|(name, scene)| Case::new(name, scene)).collect())
}

/// The scenes with other tolerances and with steps that end by an estimate of the error.
pub(crate) fn accuracies() -> Result<Vec<Case>, Failure> {
    let set = Settings::default;
    let ways = [
        ("1e-3", set().with_tolerance(1e-3)),
        ("1e-9", set().with_tolerance(1e-9)),
        ("relative 1e-4", set().with_accuracy(Accuracy::Relative(1e-4))),
        ("balanced", set().with_accuracy(Accuracy::balanced())),
    ];
    let mut cases = shapes()?;
    cases.retain(|c| {
        ["cube", "arch", "irregular", "pulled"]
            .iter()
            .any(|name| c.name.starts_with(name))
    });
    let other = |case: &Case, (way, settings): &(&str, Settings)| Case {
        name: format!("{}, {way}", case.name),
        settings: settings.clone(),
        ..case.clone()
    };
    Ok(cases
        .iter()
        .flat_map(|case| ways.iter().map(move |way| other(case, way)))
        .collect())
}

fn ramp() -> Result<History, Error> {
    Ok(History::table(RAMP.to_vec())?)
}

fn waves() -> Result<History, Error> {
    Ok(History::table(WAVES.to_vec())?)
}

fn steps(count: usize) -> Analysis {
    Analysis::quasistatic(1.0, count).with_formula(EULER)
}

fn floor(gap: f64, coefficient: f64) -> Contact {
    let contact = Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(coefficient));
    if gap == 0.0 { contact } else { contact.with_gap(gap) }
}

fn cube() -> Result<Scene, Failure> {
    let mesh = Brick::new([1.0; 3], [8; 3]).build()?;
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::Z_MAX).with_motion([0.002, 0.0, -0.004], ramp()?))
        .with_contact(floor(0.0001, 0.3))
        .with_boxes([2; 3])
        .with_analysis(steps(10)))
}

fn arch() -> Result<Scene, Failure> {
    let straight = Brick::new([3.0, 1.0, 0.5], [18, 6, 3]).build()?;
    let parts = by_centre(&straight, |p| (p[0].floor() as u32).min(2));
    let mesh = straight.map_points(|p| {
        let (radius, angle) = (2.0 + p[2], p[0] / 2.0);
        [radius * angle.sin(), p[1], radius * angle.cos()]
    })?;
    Ok(Scene::new(mesh, steel()?)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 4e8).with_history(ramp()?))
        .with_load(Load::traction(brick::X_MAX, [0.0, 1e8, -1e8]).with_history(waves()?))
        .with_contact(floor(0.001, 0.2))
        .with_parts_as_given(parts)
        .with_analysis(steps(10)))
}

fn rubber() -> Result<Scene, Failure> {
    let mesh = Brick::new([2.0, 1.0, 1.0], [10, 5, 5]).build()?;
    let soft = Materials::uniform(Hooke::isotropic(1e7, 0.49)?);
    Ok(Scene::new(mesh, soft)
        .with_support(Support::fixed(brick::Z_MAX).with_motion([0.0, 0.0, -0.05], ramp()?))
        .with_load(Load::traction(brick::X_MAX, [2e5, 0.0, 0.0]).with_history(ramp()?))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::tresca(2e5)))
        .with_boxes([2, 1, 1])
        .with_analysis(steps(6)))
}

fn layers() -> Result<Scene, Failure> {
    let mesh = Brick::new([3.0, 1.0, 1.0], [12, 4, 4]).build()?;
    let regions = by_centre(&mesh, |p| u32::from(p[2] > 0.5));
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

fn free() -> Result<Scene, Failure> {
    let mesh = Brick::new([2.0, 2.0, 1.0], [8, 8, 4]).build()?;
    Ok(Scene::new(mesh, steel()?)
        .with_load(Load::pressure(brick::Z_MAX, 1e8))
        .with_load(Load::traction(brick::X_MAX, [2e7, 0.0, 0.0]).with_history(ramp()?))
        .with_contact(floor(0.0, 0.4))
        .with_boxes([2, 2, 1])
        .with_analysis(steps(6)))
}
