//! Two equal spheres pressed together (Hertz): the pressure on a curved interface of unequal meshes.
//!
//! Radius R 8, E 200, nu 0.3, force 10: `a^3 = 3 P R' / (4 E')` with `R' = R/2`, `E' = E / (2 (1 - nu^2))`, pressure
//! `p0 sqrt(1 - r^2/a^2)` with `p0 = 3 P / (2 pi a^2)`. A quarter of a block with a paraboloid on either side is
//! meshed, graded towards the contact.

use super::meshes::graded;
use super::{Failure, Finding, RunFacts, below, second, solve};
use signorini::prelude::*;
use std::f64::consts::PI;

const RADIUS: f64 = 8.0;
const YOUNG: f64 = 200.0;
const POISSON: f64 = 0.3;
const FORCE: f64 = 10.0;
/// Edge of the blocks.
const SIZE: f64 = 7.0;

/// A quarter of a body above z = 0 whose lower side is a paraboloid; cells of one size around the contact.
fn body(near: usize, far: usize) -> Result<TetMesh, Failure> {
    let cells = near + far;
    let brick = Brick::new([cells as f64; 3], [cells; 3]).build()?;
    let places = graded([0.9, SIZE], [near, far]);
    Ok(brick.map_points(|p| {
        let [x, y, z] = p.map(places);
        let lift = (x * x + y * y) / (2.0 * RADIUS);
        [x, y, 1.5 * z + lift * (1.0 - z / SIZE)]
    })?)
}

/// What a pair of meshes gives.
struct Found {
    /// Largest pressure, radius of contact, and way of the upper body.
    values: [f64; 3],
    /// Largest error of the pressure within 0.8 contact radii over the largest pressure, and its root mean square.
    errors: [f64; 2],
    run: RunFacts,
}

/// Largest pressure and contact radius of the formula.
fn formula() -> [f64; 2] {
    let modulus = YOUNG / (2.0 * (1.0 - POISSON * POISSON));
    let radius = (0.75 * FORCE * 0.5 * RADIUS / modulus).cbrt();
    [1.5 * FORCE / (PI * radius * radius), radius]
}

/// Pressed together, with so many cells around the contact above and below, and outside. Quadratic bodies stay in one
/// piece each, with the preconditioner for large subdomains: cuts through their flat cells cost products.
fn pressed([upper, lower]: [usize; 2], far: usize, quadratic: bool) -> Result<Found, Failure> {
    let mut mesh = body(upper, far)?.append(&below(&body(lower, far)?)?)?;
    if quadratic {
        mesh = mesh.raise_order()?;
    }
    let axis = |c: usize| [c == 0, c == 1, c == 2];
    let gap = |[x, y, _]: [f64; 3]| (x * x + y * y) / RADIUS;
    let mut scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(YOUNG, POISSON)?))
        .with_support(Support::components(second(brick::Z_MAX), axis(2)))
        .with_load(Load::force(brick::Z_MAX, [0.0, 0.0, -0.25 * FORCE]))
        .with_contact(
            Contact::between(brick::Z_MIN, second(brick::Z_MIN))
                .with_normal([0.0, 0.0, -1.0])
                .with_gap_field(gap),
        );
    for (tag, c) in [(brick::X_MIN, 0), (brick::Y_MIN, 1)] {
        for tag in [tag, second(tag)] {
            scene = scene.with_support(Support::components(tag, axis(c)));
        }
    }
    let mut settings = Settings::default();
    if quadratic {
        scene = scene.without_subdomains();
        settings = settings.with_preconditioner(Preconditioner::Dirichlet);
    }
    let [peak, radius] = formula();
    let (mut largest, mut worst, mut squares, mut touching, mut way) = (0.0_f64, 0.0_f64, [0.0; 2], 0.0, 0.0);
    let run = solve(scene, settings, |result| {
        let field = result.contact_pressure(0).unwrap_or_default();
        let (surface, mesh) = (&result.surfaces()[0], result.scene().mesh());
        for p in result.points() {
            let [x, y, _] = mesh.points()[p.node as usize];
            let r = x.hypot(y) / radius;
            if p.normal_force < 0.0 {
                touching += p.area;
            }
            let Some(pressure) = surface.local(p.node).and_then(|local| field.get(local)) else {
                continue;
            };
            largest = largest.max(*pressure);
            if r < 0.8 {
                let off = pressure - peak * (1.0 - r * r).sqrt();
                worst = worst.max(off.abs() / peak);
                squares = [squares[0] + off * off, squares[1] + 1.0];
            }
        }
        let top = mesh.nodes_on(brick::Z_MAX);
        let displacement = result.displacement();
        way = -top.iter().map(|&n| displacement[n as usize][2]).sum::<f64>() / top.len() as f64;
    })?;
    Ok(Found {
        values: [largest, (4.0 * touching / PI).sqrt(), way],
        errors: [worst, (squares[0] / squares[1]).sqrt() / peak],
        run,
    })
}

/// The largest pressure, and how far pressures are from the formula; orders of convergence where all cells are halved.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let finest = if short { pressed([6, 5], 5, false)? } else { pressed([22, 17], 9, false)? };
    let of = |quantity, value, target, asked, run| Finding::new("two spheres", quantity, value, target, asked, run);
    let ([peak, radius], run) = (formula(), finest.run);
    let mut all = vec![
        of("largest pressure", finest.values[0], peak, 2e-2, run),
        of(
            "pressure within 0.8 a, largest error over p0",
            finest.errors[0],
            0.0,
            2e-2,
            run,
        ),
        of("the same, root mean square", finest.errors[1], 0.0, 0.0, run),
        of("radius of contact", finest.values[1], radius, 0.0, run),
    ];
    if !short {
        let series = [1, 2, 4].map(|k| pressed([4 * k, 3 * k], 4 * k, false));
        let [coarse, middle, fine] = series;
        let (coarse, middle, fine) = (coarse?, middle?, fine?);
        let way = [&coarse, &middle, &fine].map(|f| f.values[2]);
        let order = ((way[0] - way[1]) / (way[1] - way[2])).abs().log2();
        all.push(of(
            "order of the way under the force, 8/6 to 32/24 cells",
            order,
            2.0,
            0.0,
            fine.run,
        ));
        let order = (coarse.errors[1] / fine.errors[1]).log2() / 2.0;
        all.push(of(
            "order of the pressure (root mean square)",
            order,
            2.0,
            0.0,
            fine.run,
        ));
    }
    let cells = if short { [3, 2] } else { [8, 6] };
    let quadratic = pressed(cells, if short { 2 } else { 6 }, true)?;
    let of = |quantity, value, target, asked| {
        Finding::new(
            "two spheres, quadratic elements",
            quantity,
            value,
            target,
            asked,
            quadratic.run,
        )
    };
    all.push(of("largest pressure", quadratic.values[0], peak, 2e-2));
    all.push(of(
        "pressure within 0.8 a, largest error over p0",
        quadratic.errors[0],
        0.0,
        0.0,
    ));
    Ok(all)
}
