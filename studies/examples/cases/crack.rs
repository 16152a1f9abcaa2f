//! A closed crack under compression (Phan and others 2003), between two halves that are tied beside it.
//!
//! Plane strain, E 25,000 MPa, nu 0.25, pressure `s` = 100 MPa along an axis at `psi` = 20 degrees to the crack of
//! length 2 b = 2 m, friction angle `theta` = 30 degrees. Along the crack the normal traction is `s sin^2 psi` and
//! friction `tan theta` times that; the slip is `4 (1 - nu^2) / E s sin psi (cos psi - sin psi tan theta) sqrt(b^2 -
//! x^2)`. Elements are quadratic: at the tips strains are singular.

use super::meshes::series;
use super::{Failure, Finding, second, solve};
use signorini::prelude::*;

const YOUNG: f64 = 25_000.0;
const POISSON: f64 = 0.25;
const STRESS: f64 = 100.0;
/// Tags of the crack's sides and of what is tied.
const CRACK: FacetTag = FacetTag(100);

/// Thickness of the plate over the cells of the crack.
const THICK: f64 = 20.0;

/// Half of a plate: the crack at y = 0, |x| < 1, on so many cells; graded beside and above.
fn half(cells: usize, outside: usize, size: f64, thick: f64) -> Result<TetMesh, Failure> {
    let (inner, all) = (cells as f64, (cells + 2 * outside) as f64);
    let brick = Brick::new([all, outside as f64, thick], [cells + 2 * outside, outside, 1]).build()?;
    // outside a geometric series from the size of the cells at the tips
    let first = 2.0 / inner;
    let beyond = series(first, outside, size);
    let along = move |x: f64| {
        let x = x - 0.5 * all;
        let over = x.abs() - 0.5 * inner;
        if over > 0.0 { x.signum() * (1.0 + beyond(over)) } else { x * first }
    };
    let mesh = brick.map_points(|[x, y, z]| [along(x), beyond(y), z])?;
    // the part of the lower side that is the crack
    let points: Vec<[f64; 3]> = mesh.points().to_vec();
    let facets = mesh.facets().iter().map(|f| {
        let inside = f.nodes.iter().all(|&n| points[n as usize][0].abs() < 1.0 + 1e-9);
        Facet {
            tag: if f.tag == brick::Y_MIN && inside { CRACK } else { f.tag },
            ..*f
        }
    });
    Ok(TetMesh::new(points.clone(), mesh.tets().to_vec(), facets.collect())?)
}

/// Tractions along the crack and the slip in its middle.
pub fn findings(short: bool) -> Result<Vec<Finding>, Failure> {
    let [upper, lower] = if short { [10, 7] } else { [20, 14] };
    let (outside, size) = (10, 12.0);
    let thick = THICK * 2.0 / upper as f64;
    let above = half(upper, outside, size, thick)?;
    let below = half(lower, outside, size, thick)?;
    // the image of the other half
    let points = below.points().iter().map(|[x, y, z]| [*x, -y, *z]).collect();
    let tets = below.tets().iter().map(|[a, b, c, d]| [*b, *a, *c, *d]).collect();
    let below = TetMesh::new(points, tets, below.facets().to_vec())?;
    let pinned: Vec<u32> = {
        let ends = above.points().iter().enumerate().filter(|(_, p)| p[1] == 0.0);
        let far = ends.filter(|(_, p)| p[0].abs() > size);
        far.map(|(k, _)| k as u32).collect()
    };
    let left: Vec<u32> = pinned
        .iter()
        .copied()
        .filter(|&n| above.points()[n as usize][0] < 0.0)
        .collect();
    let mesh = above.append(&below.map_tags(second))?.raise_order()?;
    let (psi, friction) = (20.0_f64.to_radians(), 30.0_f64.to_radians().tan());
    let axis = [psi.cos(), psi.sin(), 0.0];
    let traction = |normal: [f64; 3]| {
        let along: f64 = (0..3).map(|c| normal[c] * axis[c]).sum();
        axis.map(|a| -STRESS * along * a)
    };
    // each half in one piece: the plate is thin, and cuts through graded cells of a thin plate cost products
    let mut scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(YOUNG, POISSON)?))
        .with_subdomains(2)
        .with_contact(
            Contact::between(CRACK, second(CRACK))
                .with_gap(0.0)
                .with_friction(Friction::coulomb(friction)),
        )
        .with_contact(Contact::tied(brick::Y_MIN, second(brick::Y_MIN)))
        .with_load(Load::traction(brick::Y_MAX, traction([0.0, 1.0, 0.0])))
        .with_load(Load::traction(second(brick::Y_MAX), traction([0.0, -1.0, 0.0])))
        .with_support(Support::components(left, [true, true, false]))
        .with_support(Support::components(pinned, [false, true, false]));
    for tag in [brick::Z_MIN, brick::Z_MAX] {
        for tag in [tag, second(tag)] {
            scene = scene.with_support(Support::components(tag, [false, false, true]));
        }
    }
    for (tag, normal) in [(brick::X_MIN, [-1.0, 0.0, 0.0]), (brick::X_MAX, [1.0, 0.0, 0.0])] {
        for tag in [tag, second(tag)] {
            scene = scene.with_load(Load::traction(tag, traction(normal)));
        }
    }
    let (sin, cos) = psi.sin_cos();
    let normal = STRESS * sin * sin;
    let slip = |x: f64| {
        4.0 * (1.0 - POISSON * POISSON) / YOUNG * STRESS * sin * (cos - sin * friction) * (1.0 - x * x).max(0.0).sqrt()
    };
    // in the middle half of the crack, weighted by area
    let (mut sums, mut middle) = ([0.0; 4], 0.0_f64);
    let run = solve(scene, Settings::default(), |result| {
        for p in result.points() {
            let x = result.scene().mesh().points()[p.node as usize][0];
            if x.abs() < 0.5 {
                sums[0] += p.area;
                sums[1] -= p.normal_force;
                sums[2] += p.friction_force.iter().map(|f| f * f).sum::<f64>().sqrt();
                let own = p.tangential_displacement[0].abs();
                sums[3] += p.area * own / slip(x);
                middle = middle.max(own);
            }
        }
    })?;
    let of = |quantity, value, target| Finding::new("crack under compression", quantity, value, target, 1e-2, run);
    Ok(vec![
        of("normal traction, MPa", sums[1] / sums[0], normal),
        of("friction, MPa", sums[2] / sums[0], normal * friction),
        of("slip over that of the formula, mean", sums[3] / sums[0], 1.0),
        of("slip in the middle, m", middle, slip(0.0)),
    ])
}
