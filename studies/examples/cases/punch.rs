//! A punch with a rounded edge on a larger foundation (NAFEMS contact benchmark 2; Code_Aster SSNA122).
//!
//! Axisymmetric: punch of diameter and height 100, fillet 10, E 210,000; foundation of diameter and height 200, fixed
//! below, E 70,000; nu 0.3; pressure 100 on the punch. On the axis the contact goes down by 0.13294 without friction
//! and by 0.13079 with a coefficient of 0.1 (theirs with quadratic elements; 0.13073 and 0.12858 with linear ones). A
//! slice of five degrees is meshed, with linear elements, graded towards the end of the flat part.

use super::meshes::{graded, series, slice, symmetric};
use super::{Failure, Finding, second, solve};
use signorini::prelude::*;

const ANGLE: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// End of the flat part of the punch, where the contact ends nearby.
const FLAT: f64 = 40.0;
const FILLET: f64 = 10.0;

/// The distance of the punch from the plane.
fn profile(r: f64) -> f64 {
    let over = (r - FLAT).clamp(0.0, FILLET);
    FILLET - (FILLET * FILLET - over * over).sqrt()
}

/// Radii of nodes: cells of `size` around the end of the flat part, growing inwards and outwards to `end`.
fn radii(size: f64, end: f64, inside: usize, outside: usize) -> Vec<f64> {
    let fine = [FLAT - 4.0, FLAT + 4.0];
    let count = (8.0 / size).round() as usize;
    let inner = series(size, inside, fine[0]);
    let outer = series(size, outside, end - fine[1]);
    let before = (0..inside).map(|k| fine[0] - inner((inside - k) as f64));
    let within = (0..=count).map(|k| fine[0] + 8.0 * k as f64 / count as f64);
    let after = (1..=outside).map(|k| fine[1] + outer(k as f64));
    let mut all: Vec<f64> = before.chain(within).chain(after).collect();
    all[0] = 0.0;
    all
}

/// Cells of `size` at the end of the contact, and so many from there to the sides.
fn pressed(size: f64, layers: usize, coefficient: f64, target: f64) -> Result<Finding, Failure> {
    let heights = graded([2.0 * size, 100.0], [2, layers]);
    let column = |r: f64| {
        let low = profile(r);
        (0..layers + 3)
            .map(move |j| [r, low + (100.0 - low) * heights(j as f64) / 100.0])
            .collect()
    };
    let punch: Vec<Vec<[f64; 2]>> = radii(size, 50.0, layers, 6).into_iter().map(column).collect();
    let depths = graded([2.0 * size, 200.0], [2, layers]);
    let column = |r: f64| (0..layers + 3).rev().map(move |j| [r, -depths(j as f64)]).collect();
    let below: Vec<Vec<[f64; 2]>> = radii(1.3 * size, 100.0, layers, layers)
        .into_iter()
        .map(column)
        .collect();
    let (punch, below) = (slice(&punch, ANGLE)?, slice(&below, ANGLE)?.map_tags(second));
    let mesh = punch.append(&below)?;
    let regions = mesh.components();
    let laws = [(0, 210e3), (1, 70e3)].map(|(k, young)| Ok((k, Hooke::isotropic(young, 0.3)?)));
    let laws = laws.into_iter().collect::<Result<Vec<_>, Failure>>()?;
    let contact = Contact::between(brick::Z_MIN, second(brick::Z_MAX))
        .with_normal([0.0, 0.0, -1.0])
        .with_gap_field(|[x, y, _]| profile(x.hypot(y)))
        .with_friction(Friction::coulomb(coefficient));
    let scene = Scene::new(mesh.with_regions(regions)?, Materials::new(laws)?)
        .with_support(Support::fixed(second(brick::Z_MIN)))
        .with_load(Load::pressure(brick::Z_MAX, 100.0))
        .with_contact(contact)
        .with_subdomains(2);
    let scene = symmetric(symmetric(scene, ANGLE, |tag| tag), ANGLE, second);
    let mut sink = 0.0;
    let run = solve(scene, Settings::default(), |result| {
        let mesh = result.scene().mesh();
        let own = mesh.points().iter().position(|p| *p == [0.0; 3]);
        sink = own.map_or(f64::NAN, |node| -result.displacement()[node][2]);
    })?;
    Ok(Finding {
        case: format!("punch with rounded edge, coefficient {coefficient}"),
        quantity: "displacement on the axis",
        value: sink,
        target,
        asked: 1e-2,
        run,
    })
}

/// Without friction and with it.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let (size, layers) = if short { (1.0, 10) } else { (0.7, 24) };
    let cases = [(0.0, 0.13294), (0.1, 0.13079)].into_iter();
    cases
        .map(|(coefficient, target)| pressed(size, layers, coefficient, target))
        .collect()
}
