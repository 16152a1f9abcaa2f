//! A ring shrunk on a hollow shaft, and pulled off along the axis.
//!
//! Diameters 20, 40, 60 mm, interference 0.005 mm on the diameter, E 210,000 MPa, coefficient 0.1. After Lame the
//! pressure is `E d / (b (A + B))` with the radial interference `d`, the radius `b` of the joint,
//! `A = (c^2 + b^2) / (c^2 - b^2)` and `B = (b^2 + a^2) / (b^2 - a^2)`: 6.15234 MPa. A quarter is meshed.
//!
//! Whole, it carries torque up to the coefficient times the pressure times `2 pi b^2 l`.

use super::meshes::ring;
use super::{Failure, Finding, RunFacts, second, solve};
use signorini::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

const RADII: [f64; 3] = [10.0, 20.0, 30.0];
const WIDTH: f64 = 4.0;

/// A quarter of a tube: x of the brick becomes the radius, y the angle.
pub fn quarter(inner: f64, outer: f64, cells: [usize; 3]) -> Result<TetMesh, Failure> {
    let brick = Brick::new([outer - inner, FRAC_PI_2, WIDTH], cells).build()?;
    Ok(brick.map_points(|[x, y, z]| {
        let radius = inner + x;
        [radius * y.cos(), radius * y.sin(), z]
    })?)
}

/// Pressure and, sliding, the axial force.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let n = if short { 1 } else { 5 };
    let [a, b, c] = RADII;
    let (young, radial, coefficient) = (210_000.0, 0.0025, 0.1);
    let shaft = quarter(a, b, [3 * n, 7 * n, 2])?;
    let ring = quarter(b, c, [3 * n, 11 * n, 3])?.map_tags(second);
    let mesh = shaft.append(&ring)?;
    let factor = |inner: f64, outer: f64| (outer * outer + inner * inner) / (outer * outer - inner * inner);
    let pressure = young * radial / (b * (factor(a, b) + factor(b, c)));
    let axis = |k: usize| [k == 0, k == 1, k == 2];
    let joint = |friction| {
        Contact::between(brick::X_MAX, second(brick::X_MIN))
            .with_gap(-radial)
            .with_friction(friction)
    };
    let scene = |contact: Contact| -> Result<Scene, Failure> {
        let mut scene =
            Scene::new(mesh.clone(), Materials::uniform(Hooke::isotropic(young, 0.3)?)).with_contact(contact);
        for (tag, k) in [(brick::Y_MIN, 1), (brick::Y_MAX, 0)] {
            for tag in [tag, second(tag)] {
                scene = scene.with_support(Support::components(tag, axis(k)));
            }
        }
        Ok(scene.with_support(Support::components(brick::Z_MIN, axis(2))))
    };
    // pressed only
    let still = scene(joint(Friction::None))?.with_support(Support::components(second(brick::Z_MIN), axis(2)));
    let mut found = (0.0, 0.0);
    let run = solve(still, Settings::default(), |result| {
        let area: f64 = result.points().iter().map(|p| p.area).sum();
        let mean = result.summary().normal_force / area;
        let off = |p: &PointState| (-p.normal_force / p.area / mean - 1.0).abs();
        found = (mean, result.points().iter().map(off).fold(0.0, f64::max));
    })?;
    let of = |quantity, value, target, asked, run| Finding::new("press fit", quantity, value, target, asked, run);
    let mut all = vec![
        of("pressure, mean, MPa", found.0, pressure, 5e-3, run),
        of("pressure, largest deviation from its mean", found.1, 0.0, 2e-2, run),
    ];
    // pulled: the ring is moved along the axis until all slides
    let ramp = History::ramp(1.0, 1.0)?;
    let moved = Support::components(second(brick::Z_MIN), axis(2)).with_motion([0.0, 0.0, 0.01], ramp);
    let pulled = scene(joint(Friction::coulomb(coefficient)))?
        .with_support(moved)
        .with_analysis(Analysis::quasistatic(1.0, 4));
    let mut force = 0.0;
    let run = solve(pulled, Settings::default(), |result| {
        force = result.summary().friction_force[2]
    })?;
    let whole = 4.0 * force / WIDTH;
    all.push(of(
        "axial force of full slip, N/mm",
        whole,
        coefficient * pressure * 2.0 * PI * b,
        5e-3,
        run,
    ));
    let full = coefficient * pressure * 2.0 * PI * b * b * WIDTH;
    all.push(torque(if short { 1 } else { 2 }, (young, radial, coefficient), full)?);
    Ok(all)
}

/// The largest torque on the ring that the shaft holds, between two that are a thousandth of the target apart. The mesh
/// is of quadratic elements, whose joint is round.
fn torque(n: usize, (young, radial, coefficient): (f64, f64, f64), full: f64) -> Result<Finding, Failure> {
    let [a, b, c] = RADII;
    let shaft = ring([a, b], WIDTH, [n, 12 * n, 1])?;
    let hub = ring([b, c], WIDTH, [n, 16 * n, 1])?.map_tags(second);
    let mesh = shaft.append(&hub)?;
    // pressed first, then turned
    let turned = |torque: f64| -> Result<RunFacts, Failure> {
        let later = History::table(vec![(1.0, 0.0), (2.0, 1.0)])?;
        let scene = Scene::new(mesh.clone(), Materials::uniform(Hooke::isotropic(young, 0.3)?))
            .with_support(Support::components(brick::X_MIN, [false, true, false]).with_axis([0.0; 3], [0.0, 0.0, 1.0]))
            .with_support(Support::components(brick::Z_MIN, [false, false, true]))
            .with_support(Support::components(second(brick::Z_MIN), [false, false, true]))
            .with_load(Load::moment(second(brick::X_MAX), [0.0, 0.0, torque]).with_history(later))
            .with_contact(
                Contact::between(brick::X_MAX, second(brick::X_MIN))
                    .with_gap(-radial)
                    .with_friction(Friction::coulomb(coefficient)),
            )
            .with_analysis(Analysis::quasistatic(2.0, 2));
        solve(scene, Settings::default(), |_| ())
    };
    let (mut least, mut most, mut facts) = (0.9 * full, 1.1 * full, RunFacts::default());
    while most - least > 1e-3 * full {
        let middle = 0.5 * (least + most);
        match turned(middle) {
            Ok(run) => (least, facts) = (middle, run),
            Err(_) => most = middle,
        }
    }
    let held = 0.5 * (least + most);
    Ok(Finding::new(
        "shrink fit, turned",
        "torque of full slip, N mm",
        held,
        full,
        5e-3,
        facts,
    ))
}
