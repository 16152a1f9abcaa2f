//! Two blocks whose meshes do not match: the patch test, and what the ratio of the meshes and of the stiffnesses costs.

use super::{Failure, Finding, second, solve};
use signorini::prelude::*;

/// A unit cube on a unit cube, of so many cells an edge.
fn cubes(lower: usize, upper: usize) -> Result<TetMesh, Failure> {
    let below = Brick::new([1.0; 3], [lower; 3]).build()?;
    let above = Brick::new([1.0; 3], [upper; 3]).build()?;
    let above = above.map_points(|[x, y, z]| [x, y, z + 1.0])?.map_tags(second);
    let mesh = below.append(&above)?;
    let bodies = mesh.components();
    Ok(mesh.with_regions(bodies)?)
}

fn materials(young: [f64; 2]) -> Result<Materials, Failure> {
    let [below, above] = young.map(|young| Hooke::isotropic(young, 0.3));
    Ok(Materials::new(vec![(0, below?), (1, above?)])?)
}

/// Uniform pressure: the largest error of pressure, relative.
fn patch([lower, upper]: [usize; 2]) -> Result<Finding, Failure> {
    let pressure = 25.0;
    let axis = |c: usize| [c == 0, c == 1, c == 2];
    let mut scene = Scene::new(cubes(lower, upper)?, materials([2000.0; 2])?)
        .with_support(Support::components(brick::Z_MIN, axis(2)))
        .with_load(Load::pressure(second(brick::Z_MAX), pressure))
        .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX));
    for (tag, c) in [(brick::X_MIN, 0), (brick::Y_MIN, 1)] {
        for tag in [tag, second(tag)] {
            scene = scene.with_support(Support::components(tag, axis(c)));
        }
    }
    let mut worst = 0.0;
    let run = solve(scene, Settings::default().with_tolerance(1e-10), |result| {
        let off = |p: &PointState| (-p.normal_force / p.area / pressure - 1.0).abs();
        worst = result.points().iter().map(off).fold(0.0, f64::max);
    })?;
    Ok(Finding {
        case: format!("patch test, {lower} on {upper} cells"),
        quantity: "pressure, error",
        value: worst,
        target: 0.0,
        asked: 1e-9,
        run,
    })
}

/// Pressed and pulled, with friction 0.2: products with F, beside those of matching meshes.
fn pulled([lower, upper]: [usize; 2], ratio: f64, boxes: usize) -> Result<Finding, Failure> {
    let scene = Scene::new(cubes(lower, upper)?, materials([1e9, 1e9 * ratio])?)
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::traction(second(brick::Z_MAX), [1e5, 0.0, -1e6]))
        .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(0.2)))
        .with_boxes([boxes, boxes, 2 * boxes]);
    let mut force = 0.0;
    let run = solve(scene, Settings::default(), |result| {
        force = result.summary().resultant[0]
    })?;
    Ok(Finding {
        case: format!(
            "pulled, {lower} below {upper} cells, stiffness 1 : {ratio}, {} subdomains",
            run.subdomains
        ),
        quantity: "friction force, N",
        value: force,
        target: -1e5,
        asked: 1e-6,
        run,
    })
}

/// Both, for several ratios.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let n = if short { 4 } else { 8 };
    let mut all = Vec::new();
    for [a, b] in [[n, 3 * n], [3 * n, n], [n, n + 1], [3 * n / 2, n]] {
        if !short || a.max(b) < 3 * n {
            all.push(patch([a, b])?);
        }
    }
    let ratios: &[f64] = if short { &[1.0] } else { &[1.0, 1e3, 1e-3] };
    for &ratio in ratios {
        for [a, b] in [
            [n, n],
            [2 * n, 2 * n],
            [3 * n, 3 * n],
            [n, n + 1],
            [n, 3 * n / 2],
            [n, 2 * n],
            [3 * n / 2, n],
            [2 * n, n],
            [n, 3 * n],
            [3 * n, n],
        ] {
            if !short || a.max(b) < 3 * n {
                all.push(pulled([a, b], ratio, 2)?);
            }
        }
    }
    // cells a subdomain stay, subdomains grow
    for boxes in if short { 1..2 } else { 1..9 }.filter(|b| usize::is_power_of_two(*b)) {
        for [a, b] in [[4, 4], [4, 6], [6, 4]] {
            all.push(pulled([a * boxes, b * boxes], 1.0, boxes)?);
        }
    }
    Ok(all)
}
