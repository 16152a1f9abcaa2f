//! Two equal spheres pressed together (Hertz): the pressure on a curved interface of unequal meshes.
//!
//! Radius R 8, E 200, nu 0.3, force 10: `a^3 = 3 P R' / (4 E')` with `R' = R/2`, `E' = E / (2 (1 - nu^2))`, pressure
//! `p0 sqrt(1 - r^2/a^2)` with `p0 = 3 P / (2 pi a^2)`. A quarter of a block with a paraboloid on either side is meshed,
//! graded towards the contact.

use super::{Failure, Finding, second, solve};
use signorini::prelude::*;
use std::f64::consts::PI;

const RADIUS: f64 = 8.0;
const YOUNG: f64 = 200.0;
const POISSON: f64 = 0.3;
const FORCE: f64 = 10.0;
/// Edge of the blocks.
const SIZE: f64 = 7.0;

/// A quarter of a body above z = 0 whose lower side is a paraboloid; half of the cells within 1.5 of the axis.
fn body(cells: usize) -> Result<TetMesh, Failure> {
    let brick = Brick::new([1.0; 3], [cells, cells, cells]).build()?;
    // linear at first, then a cubic with the same slope
    let (inner, part) = (1.3, 0.6);
    let graded = |t: f64| {
        let s = ((t - part) / (1.0 - part)).max(0.0);
        let slope = inner * (1.0 - part) / part;
        inner * t.min(part) / part + slope * s + (SIZE - inner - slope) * s.powi(3)
    };
    Ok(brick.map_points(|p| {
        let [x, y, z] = p.map(graded);
        let lift = (x * x + y * y) / (2.0 * RADIUS);
        [x, y, 1.5 * z + lift * (1.0 - z / SIZE)]
    })?)
}

/// Force against approach, the largest pressure, and how far pressures are from the formula.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let [upper, lower] = if short { [10, 8] } else { [24, 19] };
    let above = body(upper)?;
    let below = body(lower)?;
    let points = below.points().iter().map(|[x, y, z]| [*x, *y, -z]).collect();
    let tets = below.tets().iter().map(|[a, b, c, d]| [*b, *a, *c, *d]).collect();
    let below = TetMesh::new(points, tets, below.facets().to_vec())?;
    let mesh = above.append(&below.map_tags(second))?;
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
    let modulus = YOUNG / (2.0 * (1.0 - POISSON * POISSON));
    let radius = (0.75 * FORCE * 0.5 * RADIUS / modulus).cbrt();
    let peak = 1.5 * FORCE / (PI * radius * radius);
    let (mut largest, mut worst, mut squares, mut touching) = (0.0_f64, 0.0_f64, [0.0; 2], 0.0);
    let run = solve(scene, Settings::default(), |result| {
        let field = result.contact_pressure(0).unwrap_or_default();
        let surface = &result.surfaces()[0];
        for p in result.points() {
            let [x, y, _] = result.scene().mesh().points()[p.node as usize];
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
    })?;
    let of = |quantity, value, target, asked| Finding {
        case: "two spheres".to_owned(),
        quantity,
        value,
        target,
        asked,
        run,
    };
    Ok(vec![
        of("largest pressure", largest, peak, 2e-2),
        of("pressure within 0.8 a, largest error over p0", worst, 0.0, 2e-2),
        of(
            "the same, root mean square",
            (squares[0] / squares[1]).sqrt() / peak,
            0.0,
            0.0,
        ),
        of("radius of contact", (4.0 * touching / PI).sqrt(), radius, 0.0),
    ])
}
