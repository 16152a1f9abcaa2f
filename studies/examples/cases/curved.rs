//! The patch test on a curved interface: a tube in a tube of the same material under pressure from everywhere.
//!
//! The stress is `-p I`, so that a traction `p` acts on any surface, and without friction the pressure of contact is
//! `p` at every point. On a flat interface it is so to rounding. Here facets of length `h` on a radius `r` are apart by
//! up to `h^2 / (8 r)` where they do not match, and turned against each other by up to `h / r`. Where they match forces
//! are exact, and their sum over the area of a node misses `p` by `1 - cos(h / 2r)`, about `h^2 / (8 r^2)`.

use super::press_fit::quarter;
use super::{Failure, Finding, RunFacts, second, solve};
use signorini::prelude::*;
use std::f64::consts::FRAC_PI_2;

const RADII: [f64; 3] = [10.0, 20.0, 30.0];
const PRESSURE: f64 = 25.0;

/// So many cells along the interface inside and outside: the largest error of the pressure, and its root mean square.
fn pressed([inside, outside]: [usize; 2]) -> Result<([f64; 2], RunFacts), Failure> {
    let [a, b, c] = RADII;
    let cells = |along: usize| [2 * along.div_ceil(6), along, along.div_ceil(7)];
    let mesh = quarter(a, b, cells(inside))?.append(&quarter(b, c, cells(outside))?.map_tags(second))?;
    let axis = |k: usize| [k == 0, k == 1, k == 2];
    let mut scene = Scene::new(mesh, Hooke::isotropic(2000.0, 0.3)?.into())
        .with_contact(Contact::between(brick::X_MAX, second(brick::X_MIN)).with_gap(0.0));
    for (tag, k) in [(brick::Y_MIN, 1), (brick::Y_MAX, 0), (brick::Z_MIN, 2)] {
        for tag in [tag, second(tag)] {
            scene = scene.with_support(Support::components(tag, axis(k)));
        }
    }
    for tag in [brick::X_MIN, second(brick::X_MAX), brick::Z_MAX, second(brick::Z_MAX)] {
        scene = scene.with_load(Load::pressure(tag, PRESSURE));
    }
    let mut errors = [0.0; 2];
    let run = solve(scene, Settings::default().with_tolerance(1e-10), |result| {
        let points = result.points().iter();
        let off: Vec<f64> = points.map(|p| -p.normal_force / p.area / PRESSURE - 1.0).collect();
        let largest = off.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let mean = off.iter().map(|v| v * v).sum::<f64>() / off.len() as f64;
        errors = [largest, mean.sqrt()];
    })?;
    Ok((errors, run))
}

/// Matching meshes, and meshes in the ratios 1/3 to 3 twice, the second time with all cells halved.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let n = if short { 4 } else { 8 };
    let mut all = Vec::new();
    for [inside, outside] in [[n, n], [n, n + 1], [n, 3 * n / 2], [n, 3 * n], [3 * n, n]] {
        let case = |k: usize| format!("curved patch, {} in {} cells", k * inside, k * outside);
        let (first, run) = pressed([inside, outside])?;
        if inside == outside {
            let between = FRAC_PI_2 / inside as f64;
            let facets = 1.0 - (0.5 * between).cos();
            all.push(Finding::new(
                &case(1),
                "pressure, error beyond that of its facets",
                (first[0] - facets).abs(),
                0.0,
                1e-9,
                run,
            ));
        } else {
            all.push(Finding::new(&case(1), "pressure, error", first[0], 0.0, 0.0, run));
            let (second, run) = pressed([2 * inside, 2 * outside])?;
            all.push(Finding::new(&case(2), "pressure, error", second[0], 0.0, 0.0, run));
            for (k, quantity) in ["order of the largest error", "order of the mean error"]
                .into_iter()
                .enumerate()
            {
                all.push(Finding::new(
                    &case(2),
                    quantity,
                    (first[k] / second[k]).log2(),
                    1.0,
                    0.0,
                    run,
                ));
            }
        }
    }
    Ok(all)
}
