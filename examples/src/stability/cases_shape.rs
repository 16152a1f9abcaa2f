//! Flat subdomains, slivers, units, size of the loads.

use super::block::Block;
use super::case::{Case, Failure, Setup};
use signorini::prelude::*;

fn sliver(quality: f64) -> Result<Setup, Failure> {
    let block = Block {
        gap: 0.0,
        ..Block::default()
    };
    // one inner node in each subdomain is pushed onto its neighbour
    let mesh = block.mesh()?.map_points(|x| {
        let inner = [0.5, 1.5, 2.5].iter().any(|m| {
            (x[0] - m).abs() < 1e-6 && (x[1] - 0.5).abs() < 1e-6 && (x[2] - 0.5).abs() < 1e-6
        });
        if inner {
            [x[0], x[1], x[2] - 0.25 * (1.0 - quality)]
        } else {
            x
        }
    })?;
    let materials = Materials::uniform(block.material()?);
    block.setup_on(mesh, materials)
}

/// Shapes, units and loads.
#[must_use]
pub fn cases() -> Vec<Case> {
    const SHAPE: &str = "Shapes";
    const UNITS: &str = "Units";
    const LOADS: &str = "Size of the loads";
    let mut cases = Vec::new();
    for squeeze in [10.0, 100.0] {
        let flat = Block {
            lengths: [3.0, 1.0, 1.0 / squeeze],
            gap: 0.0,
            top: [0.0, 0.0, -1e8],
            end: [1e8, 0.0, 0.0],
            ..Block::default()
        };
        cases.push(Case::new(
            SHAPE,
            format!("squeezed 1:{squeeze} to the floor"),
            "flat subdomains and flat tetrahedra, lying on the floor",
            move || flat.setup(),
        ));
        let slices = Block {
            lengths: [3.0 / squeeze, 1.0, 1.0],
            gap: 0.0,
            top: [0.0, 0.0, -1e8],
            end: [1e6, 0.0, 0.0],
            ..Block::default()
        };
        cases.push(Case::new(
            SHAPE,
            format!("squeezed 1:{squeeze} along the interface normal"),
            "thin slices between interfaces",
            move || slices.setup(),
        ));
    }
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
    cases.push(Case::new(
        SHAPE,
        "perturbed nodes",
        "all subdomains differ",
        move || wild.setup(),
    ));
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
        cases.push(
            Case::new(
                UNITS,
                name,
                "other units must give the same digits",
                move || block.setup(),
            )
            .same_as("coefficient 0.3", 1e-6),
        );
    }
    for factor in [1e-6, 1e-3, 1e3, 1e6] {
        let block = Block {
            top: Block::default().top.map(|v| factor * v),
            end: Block::default().end.map(|v| factor * v),
            gap: factor * Block::default().gap,
            ..Block::default()
        };
        cases.push(Case::new(
            LOADS,
            format!("loads and gap x {factor:e}"),
            "everything is linear in loads and gap together; absolute thresholds show here",
            move || block.setup(),
        ));
        let block = Block {
            top: Block::default().top.map(|v| factor * v),
            end: Block::default().end.map(|v| factor * v),
            ..Block::default()
        };
        cases.push(Case::new(
            LOADS,
            format!("loads x {factor:e}"),
            "the gap stays: no contact at all, or contact everywhere",
            move || block.setup(),
        ));
    }
    cases
}
