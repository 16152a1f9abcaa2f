//! Flat subdomains, slivers, units, size of the loads.

use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::{Block, END, GAP, TOP};

use super::case::{Case, Setup, ToSetup};

fn sliver(quality: f64) -> Result<Setup, Failure> {
    let block = Block {
        gap: 0.0,
        ..Block::default()
    };
    // one inner node in each subdomain is pushed onto its neighbour
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    let mesh = block.mesh()?.map_points(|[x, y, z]| {
        let middle = [0.5, 1.5, 2.5].iter().any(|m| near(x, *m));
        let inner = middle && near(y, 0.5) && near(z, 0.5);
        [x, y, if inner { z - 0.25 * (1.0 - quality) } else { z }]
    })?;
    let materials = Materials::uniform(block.material()?);
    block.setup_on(mesh, materials)
}

/// A plate of 50 times its thickness, clamped along one edge, that a load presses on the floor below, and one drags
/// along.
fn plate() -> Result<Setup, Failure> {
    let mesh = Brick::new([1.0, 1.0, 0.02], [32, 32, 1]).build()?;
    let loads = vec![
        (
            LoadDensity::Traction(brick::Z_MAX, [0.0, 0.0, -1e4]),
            History::constant(1.0),
        ),
        (
            LoadDensity::Traction(brick::X_MAX, [0.0, 1e5, 0.0]),
            History::ramp(1.0, 1.0)?,
        ),
    ];
    let floor = Contact::rigid(brick::Z_MIN).with_gap(1e-4);
    let scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(2e11, 0.3)?))
        .with_support(Support::fixed(brick::X_MIN))
        .with_contact(floor.with_friction(Friction::coulomb(0.3)))
        .with_analysis(Analysis::quasistatic(1.0, 5));
    Ok(Setup::new(scene, loads))
}

/// Shapes, units and loads.
pub(crate) fn cases() -> Vec<Case> {
    const SHAPE: &str = "Shapes";
    let mut cases = Vec::new();
    for squeeze in [10.0, 100.0] {
        let lying = |lengths, end| Block {
            lengths,
            gap: 0.0,
            top: [0.0, 0.0, -1e8],
            end: [end, 0.0, 0.0],
            ..Block::default()
        };
        cases.push(Case::brick(
            SHAPE,
            format!("squeezed 1:{squeeze} to the floor"),
            "flat subdomains and flat tetrahedra, lying on the floor",
            lying([3.0, 1.0, 1.0 / squeeze], 1e8),
        ));
        cases.push(Case::brick(
            SHAPE,
            format!("squeezed 1:{squeeze} along the interface normal"),
            "thin slices between interfaces",
            lying([3.0 / squeeze, 1.0, 1.0], 1e6),
        ));
    }
    cases.push(Case::new(
        SHAPE,
        "plate 1:50 lies down",
        "one cell over the thickness; of the points that come near the floor many pull on some set",
        plate,
    ));
    for quality in [1e-2, 1e-4] {
        cases.push(Case::new(
            SHAPE,
            format!("slivers {quality:e}"),
            "an inner node of every subdomain lies that close (in cells) to its neighbour",
            move || sliver(quality),
        ));
    }
    let wild = Block {
        perturbation: 0.15,
        boxes: [6, 2, 2],
        cells: [2; 3],
        ..Block::default()
    };
    cases.push(Case::brick(SHAPE, "perturbed nodes", "all subdomains differ", wild));
    for (name, metre, pascal) in [
        ("mm, MPa", 1e3, 1e-6),
        ("km, GPa", 1e-3, 1e-9),
        ("m, GPa", 1.0, 1e-9),
        ("nm, Pa", 1e9, 1.0),
    ] {
        let block = Block {
            metre,
            pascal,
            ..Block::default()
        };
        let case = Case::brick("Units", name, "other units must give the same digits", block);
        cases.push(case.same_as("coefficient 0.3", 1e-6));
    }
    for factor in [1e-6, 1e-3, 1e3, 1e6] {
        let loaded = Block {
            top: TOP.map(|v| factor * v),
            end: END.map(|v| factor * v),
            ..Block::default()
        };
        cases.push(Case::brick(
            "Size of the loads",
            format!("loads and gap x {factor:e}"),
            "everything is linear in loads and gap together; absolute thresholds show here",
            Block {
                gap: factor * GAP,
                ..loaded.clone()
            },
        ));
        cases.push(Case::brick(
            "Size of the loads",
            format!("loads x {factor:e}"),
            "the gap stays: no contact at all, or contact everywhere",
            loaded,
        ));
    }
    cases
}
