//! A rigid sphere pressed into an elastic half-space, up to nearly incompressible material.
//!
//! R 100, E 1000, approach 0.01: force `4/3 E / (1 - nu^2) sqrt(R) d^(3/2)`: 14.6520, 17.5462, 17.7541, 17.7754 for
//! nu = 0.3, 0.49, 0.499, 0.4999. A slice of a block of 150 contact radii, graded, with quadratic elements.

use super::meshes::{graded, slice, symmetric};
use super::{Failure, Finding, RunFacts, solve};
use signorini::prelude::*;
use std::f64::consts::PI;

const RADIUS: f64 = 100.0;
const YOUNG: f64 = 1000.0;
const APPROACH: f64 = 0.01;
/// Size of the block.
const SIZE: f64 = 150.0;
/// Of the slice, degrees.
const ANGLE: f64 = 15.0;

/// The force for four Poisson's ratios on three meshes, and what products grow by towards 1/2.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    if short {
        on_mesh([4, 8], &[0.3, 0.4999])
    } else {
        let meshes = [[8, 12], [10, 15], [12, 18]].into_iter();
        let each = meshes.map(|cells| on_mesh(cells, &[0.3, 0.49, 0.499, 0.4999]));
        Ok(each.collect::<Result<Vec<_>, _>>()?.concat())
    }
}

/// With cells of one size in 1.4 contact radii, then in a geometric series.
fn on_mesh([near, far]: [usize; 2], ratios: &[f64]) -> Result<Vec<Finding>, Failure> {
    let angle = ANGLE.to_radians();
    let places = graded([1.4, SIZE], [near, far]);
    let column = |i: usize| (0..=near + far).map(|j| [places(i as f64), places(j as f64)]).collect();
    let grid: Vec<Vec<[f64; 2]>> = (0..=near + far).map(column).collect();
    let mesh = slice(&grid, angle)?.raise_order()?;
    let mut all: Vec<Finding> = Vec::new();
    for &poisson in ratios {
        // the half-space is above the plane z = 0, the sphere below
        let sphere = Obstacle::sphere([0.0, 0.0, APPROACH - RADIUS], RADIUS);
        let scene = Scene::new(mesh.clone(), Hooke::isotropic(YOUNG, poisson)?.into())
            .with_contact(Contact::obstacle(brick::Z_MIN, sphere))
            .with_support(Support::components(brick::Z_MAX, [false, false, true]))
            .with_subdomains(1);
        let mut force = 0.0;
        let run = solve(symmetric(scene, angle, |tag| tag), Settings::default(), |result| {
            force = 2.0 * PI / angle * result.summary().resultant[2];
        })?;
        let target = 4.0 / 3.0 * YOUNG / (1.0 - poisson * poisson) * RADIUS.sqrt() * APPROACH.powf(1.5);
        all.push(Finding {
            case: format!("rigid sphere, {near} cells, Poisson's ratio {poisson}"),
            quantity: "force",
            value: force,
            target,
            asked: 1e-2,
            run,
        });
    }
    let products = |run: RunFacts| run.products as f64;
    if let [first, .., last] = &all[..] {
        all.push(Finding {
            case: format!("rigid sphere, {near} cells"),
            quantity: "products at the largest ratio over those at 0.3",
            value: products(last.run) / products(first.run),
            target: 0.0,
            asked: 2.5,
            run: last.run,
        });
    }
    Ok(all)
}
