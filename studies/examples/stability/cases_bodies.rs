//! Bodies that supports do not hold, and supports that hold too much.

use super::case::{Case, Expect, Setup, ToSetup};
use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::Block;

const HELD: Expect = Expect::Refused("cannot be in equilibrium");

/// A block on the floor without supports.
fn loose(lengths: [f64; 3], coefficient: f64, top: [f64; 3]) -> Block {
    Block {
        lengths,
        boxes: [2, 2, 1],
        cells: [2, 2, 4],
        gap: 0.0,
        top,
        end: [0.0; 3],
        clamped: false,
        floor: Some(if coefficient > 0.0 { Friction::coulomb(coefficient) } else { Friction::None }),
        steps: 3,
        ..Block::default()
    }
}

/// A clamped brick, and a loose one beside it with this part of its loads.
fn pair(part: f64) -> Result<Setup, Failure> {
    let block = Block {
        boxes: [1; 3],
        cells: [4; 3],
        end: [1e7, 0.0, 0.0],
        gap: 0.0,
        ..Block::default()
    };
    let mesh = block.mesh()?;
    let own = |tag: FacetTag| match tag {
        brick::Z_MIN => tag,
        FacetTag(t) => FacetTag(t + 70),
    };
    let other = mesh.map_points(|x| [x[0], x[1] + 2.0, x[2]])?.map_tags(own);
    let mesh = mesh.append(&other)?;
    let parts = mesh.components();
    let setup = block.setup_on(mesh, Materials::uniform(block.material()?))?;
    let traction = |tag, value: [f64; 3]| LoadDensity::Traction(own(tag), value.map(|v| part * v));
    Ok(setup
        .map(|s| s.with_parts_as_given(parts))
        .with_load(traction(brick::Z_MAX, block.top), History::table(block.top_history)?)
        .with_load(traction(brick::X_MAX, block.end), History::table(block.end_history)?))
}

fn node_near(scene: &Scene, at: [f64; 3]) -> u32 {
    let far = |p: &[f64; 3]| (0..3).map(|c| (p[c] - at[c]).powi(2)).sum::<f64>();
    let points = scene.mesh().points().iter().enumerate();
    points
        .min_by(|a, b| far(a.1).total_cmp(&far(b.1)))
        .map_or(0, |p| p.0 as u32)
}

/// Held by contact and friction only, barely, and not.
pub(crate) fn free() -> Vec<Case> {
    const GROUP: &str = "Bodies without supports";
    let flat = [2.0, 2.0, 0.5];
    let tall = [0.5, 0.5, 2.0];
    let p = 1e7;
    let block =
        |name: &str, hard, lengths, coefficient, top| Case::brick(GROUP, name, hard, loose(lengths, coefficient, top));
    let incline = |name: &str, hard, at: [f64; 3]| {
        Case::new(GROUP, name, hard, move || {
            let weight = LoadDensity::Body([3e6, 0.0, -9e6]);
            let setup = loose(flat, 0.0, [0.0; 3]).setup()?;
            let setup = setup.with_load(weight, History::constant(1.0));
            let node = vec![node_near(&setup.scene, at)];
            Ok(setup.map(|s| s.with_support(Support::components(node, [true, false, false]))))
        })
    };
    vec![
        block(
            "held by friction",
            "no support at all: contact and friction rows hold all six rigid motions",
            flat,
            0.3,
            [0.1 * p, 0.0, -p],
        ),
        block(
            "held by most of the friction",
            "shear 0.27 of the pressure, coefficient 0.3: most nodes slide",
            flat,
            0.3,
            [0.27 * p, 0.0, -p],
        ),
        block(
            "barely held by friction",
            "shear 0.299 of the pressure, coefficient 0.3: nearly all nodes must slide",
            flat,
            0.3,
            [0.299 * p, 0.0, -p],
        ),
        block(
            "not held by friction",
            "shear 0.31 of the pressure, coefficient 0.3",
            flat,
            0.3,
            [0.31 * p, 0.0, -p],
        )
        .expect(HELD),
        block(
            "barely not tipping",
            "the pressure nearly leaves the base: an edge carries the block",
            tall,
            0.3,
            [0.12 * p, 0.0, -p],
        ),
        block(
            "tipping",
            "the resultant leaves the base: no equilibrium, though no motion is free both ways",
            tall,
            0.3,
            [0.13 * p, 0.0, -p],
        )
        .expect(HELD),
        block("pulled off the floor", "contact cannot pull", flat, 0.3, [0.0, 0.0, p]).expect(HELD),
        block(
            "frictionless, balanced",
            "three motions are held by nothing, and nothing pushes them",
            flat,
            0.0,
            [0.0, 0.0, -p],
        ),
        block(
            "frictionless, pushed",
            "a motion that nothing holds, and a force along it",
            flat,
            0.0,
            [0.001 * p, 0.0, -p],
        )
        .expect(HELD),
        incline(
            "incline with one support",
            "frictionless, one node fixed along the slope; two motions free, and a corner wants to lift",
            [2.0, 1.0, 0.0],
        ),
        incline(
            "incline, support off the middle",
            "the same with the support beside the resultant: the block turns away",
            [2.0, 2.0, 0.0],
        )
        .expect(HELD),
        Case::new(
            GROUP,
            "wall that cannot pull",
            "roller at one end, pulled up at the other: contact and roller allow the motion",
            move || {
                let block = Block {
                    boxes: [3, 1, 1],
                    cells: [3; 3],
                    gap: 0.1,
                    top: [0.0; 3],
                    end: [0.0, 0.0, 1e6],
                    clamped: false,
                    ..Block::default()
                };
                Ok(block
                    .setup()?
                    .map(|s| s.with_support(Support::components(brick::X_MIN, [true, true, false]))))
            },
        )
        .expect(HELD),
        Case::brick(
            GROUP,
            "falls on the floor",
            "gap below a body that nothing holds: the first step has to close it rigidly",
            Block {
                gap: 0.01,
                ..loose(flat, 0.3, [0.05 * p, 0.0, -p])
            },
        ),
        Case::new(
            GROUP,
            "lowered by its support",
            "no load at all: a rigid motion down to the floor, forces from there on",
            || {
                let block = Block {
                    boxes: [2, 2, 1],
                    gap: 1e-3,
                    top: [0.0; 3],
                    end: [0.0; 3],
                    clamped: false,
                    steps: 10,
                    ..Block::default()
                };
                let down = History::ramp(1.0, 1.0)?;
                let support = Support::fixed(brick::Z_MAX).with_motion([2e-4, 0.0, -2e-3], down);
                Ok(block.setup()?.map(|s| s.with_support(support.clone())))
            },
        ),
        Case::new(
            GROUP,
            "two bodies, one loose",
            "one brick clamped, one that only lies on the floor",
            || pair(1.0),
        ),
        Case::new(
            GROUP,
            "two bodies, loads 1e12 apart",
            "the brick that only lies on the floor has 1e-12 of the other's loads, and is to be as accurate",
            || pair(1e-12),
        ),
    ]
}

/// Contact nodes on supports, edges, corners and crosspoints.
pub(crate) fn supports() -> Vec<Case> {
    const GROUP: &str = "Supports, edges and corners";
    let base = || Block {
        gap: 0.0,
        ..Block::default()
    };
    let on_edges = move || -> Result<Setup, Failure> {
        let block = Block {
            clamped: false,
            ..base()
        };
        Ok(block.setup()?.map(|s| {
            s.with_support(Support::components(brick::X_MIN, [true, false, false]))
                .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        }))
    };
    vec![
        Case::new(
            GROUP,
            "contact nodes on fixed edges",
            "nodes with one tangential direction left, and one with none",
            on_edges,
        ),
        Case::new(
            GROUP,
            "three normals at a corner",
            "floor, end and side touch: nodes at edges have two normals with friction, the one at the corner three",
            move || {
                let contact = Contact::rigid(brick::Z_MIN)
                    .with_tag(brick::X_MAX)
                    .with_tag(brick::Y_MIN)
                    .with_friction(Friction::coulomb(0.3));
                let block = Block {
                    end: [0.0; 3],
                    top: [1e9, -1e9, -3e9],
                    floor: None,
                    ..Block::default()
                };
                Ok(block.setup()?.map(|s| s.with_contact(contact)))
            },
        ),
        Case::brick(
            GROUP,
            "crosspoints of eight",
            "8 subdomains meet in one node, 4 in a contact node",
            Block {
                boxes: [4, 2, 2],
                cells: [3, 2, 2],
                ..Block::default()
            },
        )
        .same_as("crosspoints, whole", 1e-5),
        Case::brick(
            GROUP,
            "crosspoints, whole",
            "the same in one piece",
            Block {
                boxes: [1; 3],
                cells: [12, 4, 4],
                ..Block::default()
            },
        ),
        Case::new(
            GROUP,
            "redundant supports",
            "the clamped end is fixed three times, in turned directions too",
            || {
                Ok(Block::default().setup()?.map(|s| {
                    s.with_support(Support::fixed(brick::X_MIN))
                        .with_support(Support::components(brick::X_MIN, [true, false, true]))
                }))
            },
        )
        .same_as("coefficient 0.3", 1e-6),
        Case::new(
            GROUP,
            "contradictory supports",
            "the clamped end is fixed and moved",
            || {
                Ok(Block::default().setup()?.map(|s| {
                    s.with_support(Support::fixed(brick::X_MIN).with_motion([1e-3, 0.0, 0.0], History::constant(1.0)))
                }))
            },
        )
        .expect(Expect::Refused(
            "supports 0 and 1 prescribe different displacements in the same direction (difference 1e-3)",
        )),
        Case::new(
            GROUP,
            "held at one node",
            "all six motions held by three nodes close together: nearly free rotations",
            || {
                let block = Block {
                    clamped: false,
                    gap: 0.0,
                    ..Block::default()
                };
                let setup = block.setup()?;
                let nodes = [[0.0, 0.0, 1.0], [0.25, 0.0, 1.0], [0.0, 0.25, 1.0]].map(|at| node_near(&setup.scene, at));
                Ok(setup.map(|s| s.with_support(Support::fixed(nodes.to_vec()))))
            },
        ),
    ]
}
