//! A rigid sphere pressed into an elastic half-space, up to nearly incompressible material.
//!
//! R 100, E 1000, approach 0.01: force `4/3 E / (1 - nu^2) sqrt(R) d^(3/2)`: 14.6520, 17.5462, 17.7541, 17.7754 for
//! nu = 0.3, 0.49, 0.499, 0.4999. A quarter of a block of 150 contact radii, graded, with quadratic elements.

use super::{Failure, Finding, solve};
use signorini::prelude::*;

const RADIUS: f64 = 100.0;
const YOUNG: f64 = 1000.0;
const APPROACH: f64 = 0.01;
/// Edge of the block, and of the part with cells of one size.
const SIZE: [f64; 2] = [150.0, 1.4];

/// Cells of one size near the origin, then in a geometric series.
fn mesh(near: usize, far: usize) -> Result<TetMesh, Failure> {
    let brick = Brick::new([(near + far) as f64; 3], [near + far; 3]).build()?;
    let [whole, part] = SIZE;
    let first = part / near as f64;
    let sum = |q: f64, k: f64| first * q * (q.powf(k) - 1.0) / (q - 1.0);
    let (mut low, mut high) = (1.0 + 1e-9, 10.0);
    for _ in 0..60 {
        let q = 0.5 * (low + high);
        if sum(q, far as f64) < whole - part {
            low = q;
        } else {
            high = q;
        }
    }
    let graded = |k: f64| {
        let over = k - near as f64;
        if over > 0.0 { part + sum(low, over) } else { k * first }
    };
    Ok(brick.map_points(|p| p.map(graded))?.raise_order()?)
}

/// The force for four Poisson's ratios.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let mesh = mesh(4, 5)?;
    let ratios: &[f64] = if short {
        &[0.3, 0.4999]
    } else {
        &[0.3, 0.49, 0.499, 0.4999]
    };
    let axis = |c: usize| [c == 0, c == 1, c == 2];
    let mut all = Vec::new();
    for &poisson in ratios {
        // the half-space is above the plane z = 0, the sphere below
        let sphere = Obstacle::sphere([0.0, 0.0, APPROACH - RADIUS], RADIUS);
        let mut scene = Scene::new(mesh.clone(), Materials::uniform(Hooke::isotropic(YOUNG, poisson)?))
            .with_contact(Contact::obstacle(brick::Z_MIN, sphere));
        for (tag, c) in [(brick::X_MIN, 0), (brick::Y_MIN, 1)] {
            scene = scene.with_support(Support::components(tag, axis(c)));
        }
        scene = scene
            .with_support(Support::components(brick::Z_MAX, axis(2)))
            .with_subdomains(1);
        let mut force = 0.0;
        let run = solve(scene, Settings::default(), |result| {
            force = 4.0 * result.summary().resultant[2];
        })?;
        let target = 4.0 / 3.0 * YOUNG / (1.0 - poisson * poisson) * RADIUS.sqrt() * APPROACH.powf(1.5);
        all.push(Finding {
            case: format!("rigid sphere, Poisson's ratio {poisson}"),
            quantity: "force",
            value: force,
            target,
            asked: 1e-2,
            run,
        });
    }
    Ok(all)
}
