//! Elastic bodies that touch each other.

use super::case::{Case, Expect, Setup};
use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::EULER;

const GROUP: &str = "Elastic bodies in contact";

/// Young's modulus of the lowest block, Pa, and pressure on the highest, Pa.
const YOUNG: f64 = 2e11;
const PRESSURE: f64 = 1e7;

/// Tag of a block of the stack.
fn of(block: usize, tag: FacetTag) -> FacetTag {
    FacetTag(tag.0 + 100 * block as u32)
}

/// A stack of unit cubes, each softer than the one below by a factor, the lowest one fixed, the highest one pressed
/// and pushed. Contact alone holds the others.
#[derive(Debug, Clone, Copy)]
struct Stack {
    blocks: usize,
    /// Cells an edge of the lowest block and of every second one, and of the others.
    cells: [usize; 2],
    softer: f64,
    /// Height of each gap over the edge of a cube.
    gap: f64,
    push: f64,
    steps: usize,
}

impl Stack {
    fn setup(self) -> Result<Setup, Failure> {
        let cube = |k: usize| Brick::new([1.0; 3], [self.cells[k % 2]; 3]).build();
        let mut mesh = cube(0)?;
        for k in 1..self.blocks {
            let up = k as f64 * (1.0 + self.gap);
            let next = cube(k)?.map_points(|[x, y, z]| [x, y, z + up])?;
            mesh = mesh.append(&next.map_tags(|tag| of(k, tag)))?;
        }
        let regions = mesh.components();
        let hooke = |k: usize| Hooke::isotropic(YOUNG / self.softer.powi(k as i32), 0.3);
        let materials = (0..self.blocks)
            .map(|k| Ok((k as u32, hooke(k)?)))
            .collect::<Result<Vec<_>, Error>>()?;
        let top = LoadDensity::Traction(
            of(self.blocks - 1, brick::Z_MAX),
            [self.push * PRESSURE, 0.0, -PRESSURE],
        );
        let loads = vec![(top, History::ramp(1.0, 1.0)?)];
        let mut scene = Scene::new(mesh.with_regions(regions)?, Materials::new(materials)?)
            .with_support(Support::fixed(brick::Z_MIN))
            .with_boxes([2, 1, self.blocks])
            .with_analysis(Analysis::quasistatic(1.0, self.steps).with_formula(EULER));
        for k in 1..self.blocks {
            let contact = Contact::between(of(k, brick::Z_MIN), of(k - 1, brick::Z_MAX));
            scene = scene.with_contact(contact.with_friction(Friction::coulomb(0.3)));
        }
        Ok(Setup::new(scene, loads))
    }
}

/// Stacks of elastic blocks.
pub(crate) fn cases() -> Vec<Case> {
    let base = Stack {
        blocks: 2,
        // even: blocks have the same diagonals where they meet
        cells: [4, 4],
        softer: 1.0,
        gap: 0.0,
        push: 0.1,
        steps: 3,
    };
    let stack = |name: &str, hard: &'static str, stack: Stack| Case::new(GROUP, name, hard, move || stack.setup());
    let mut cases = Vec::new();
    for (softer, hard) in [
        (1e3, "the upper block is softer"),
        (1e6, "the same, and the lower one all but rigid"),
        (1e-3, "the upper block is stiffer"),
        (1e-6, "a rigid block on a soft one that alone carries it"),
    ] {
        let name = format!("bodies, upper softer by {softer:e}");
        cases.push(stack(&name, hard, Stack { softer, ..base }));
    }
    cases.extend([
        stack(
            "pushed at 99 % of friction between bodies",
            "nearly all of the surface slides, friction alone holds the upper block",
            Stack { push: 0.297, ..base },
        ),
        stack(
            "pushed beyond friction between bodies",
            "nothing holds the upper block",
            Stack { push: 0.301, ..base },
        )
        .expect(Expect::Refused("body 1")),
        stack(
            "stack of five loose blocks",
            "contact alone holds all but the lowest block, each by the one below",
            Stack {
                blocks: 5,
                push: 0.05,
                ..base
            },
        ),
        stack(
            "stack of three falls together",
            "gaps between blocks that nothing holds: the first step has to close them rigidly",
            Stack {
                blocks: 3,
                gap: 1e-3,
                push: 0.05,
                ..base
            },
        ),
    ]);
    for (cells, softer, hard) in [
        ([3, 3], 1.0, "the same nodes, facets cut along other diagonals"),
        (
            [3, 4],
            1.0,
            "nearly the same mesh: thin pieces of facets lie over one another",
        ),
        ([3, 8], 1e3, "a fine soft block on a coarse one"),
        ([3, 8], 1e-3, "a fine stiff block on a coarse soft one"),
        ([9, 3], 1e3, "a coarse soft block on a fine one"),
        ([9, 3], 1e-3, "a coarse stiff block on a fine soft one"),
    ] {
        let [lower, upper] = cells;
        let name = format!("meshed apart, {lower} below {upper} cells, upper softer by {softer:e}");
        cases.push(stack(&name, hard, Stack { cells, softer, ..base }).at_most(60));
    }
    let apart = Stack { cells: [4, 3], ..base };
    cases.extend([
        stack(
            "meshed apart, pushed at 99 % of friction",
            "nearly all of the surface slides, rows share nodes",
            Stack { push: 0.297, ..apart },
        ),
        stack(
            "meshed apart, pushed beyond friction",
            "nothing holds the upper block",
            Stack { push: 0.301, ..apart },
        )
        .expect(Expect::Refused("body 1")),
        stack(
            "meshed apart, stack of five loose blocks",
            "nodes of one contact are in the sides of the next",
            Stack {
                blocks: 5,
                push: 0.05,
                ..apart
            },
        ),
        stack(
            "meshed apart, stack of three falls together",
            "gaps to close rigidly, between weighted means",
            Stack {
                blocks: 3,
                gap: 1e-3,
                push: 0.05,
                ..apart
            },
        ),
    ]);
    cases
}
