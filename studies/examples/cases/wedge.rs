//! A block pushed up a wedge (NAFEMS CGS-4), meshes turned against each other.
//!
//! It slides at `F/G = (tan a + mu) / (1 - mu tan a)` with `tan a = 0.1`.

use super::{Failure, Finding, second, solve};
use signorini::prelude::*;

const SLOPE: f64 = 0.1;

/// A block of 1 x 1 x 0.5 on a wedge of 3 x 2 with the slope along x; the block's mesh is turned by 30 degrees.
fn mesh(n: usize) -> Result<TetMesh, Failure> {
    let wedge = Brick::new([3.0, 2.0, 1.0], [3 * n, 2 * n, n]).build()?;
    let wedge = wedge.map_points(|[x, y, z]| [x - 1.5, y - 1.0, z * (1.0 + SLOPE * (x - 1.5)) - 1.0])?;
    let block = Brick::new([1.0, 1.0, 0.5], [n + 1, n + 1, n]).build()?;
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    let block = block.map_points(|[x, y, z]| {
        let [x, y] = [x - 0.5, y - 0.5];
        let x = cos * x - sin * y - 0.2;
        [x, sin * (x + 0.2) / cos + y / cos, z + SLOPE * x]
    })?;
    Ok(wedge.append(&block.map_tags(second))?)
}

/// The force that moves the block, for four coefficients.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let n = if short { 3 } else { 6 };
    let mesh = mesh(n)?;
    let mut all = Vec::new();
    for coefficient in [0.0, 0.1, 0.2, 0.3] {
        let gravity = 1e3;
        let ramp = History::ramp(1.0, 1.0)?;
        let pushed = Support::components(second(brick::Z_MAX), [true, true, false]).with_motion([1e-3, 0.0, 0.0], ramp);
        let contact =
            Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(coefficient));
        let regions = mesh.components();
        let material = |young| Hooke::isotropic(young, 0.3);
        let materials = Materials::new(vec![(0, material(1e9)?), (1, material(1e9)?)])?;
        // gravity on the block alone, as a pressure on its top
        let scene = Scene::new(mesh.clone().with_regions(regions)?, materials)
            .with_support(Support::fixed(brick::Z_MIN))
            .with_support(pushed)
            .with_load(Load::force(second(brick::Z_MAX), [0.0, 0.0, -gravity]))
            .with_contact(contact)
            .with_analysis(Analysis::quasistatic(1.0, 2));
        let mut ratio = 0.0;
        let run = solve(scene, Settings::default(), |result| {
            let reactions = result.reactions();
            ratio = reactions.supports[1].resultant.force[0] / gravity;
        })?;
        all.push(Finding {
            case: format!("wedge, coefficient {coefficient}"),
            quantity: "F/G",
            value: ratio,
            target: (SLOPE + coefficient) / (1.0 - coefficient * SLOPE),
            asked: 2e-4,
            run,
        });
    }
    Ok(all)
}
