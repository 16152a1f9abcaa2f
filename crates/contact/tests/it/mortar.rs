//! Contact between bodies whose meshes do not match.

use crate::common::*;

const PRESSURE: f64 = 2.5e7;
const YOUNG: f64 = 2e9;
const POISSON: f64 = 0.3;

/// Two blocks of unit size in units of length `unit`, one on the other, of so many cells each; tags of the upper one are
/// those of the [`second`] body.
fn blocks(lower: [usize; 3], upper: [usize; 3], unit: f64) -> TetMesh {
    let below = block([unit; 3], lower);
    let above = block([unit; 3], upper)
        .map_points(|[x, y, z]| [x, y, z + unit])
        .expect("lifted");
    with_second(&below, &above)
}

/// Supports along x, y at the planes of symmetry of both, along z below; pressure on top.
fn pressed_blocks(mesh: TetMesh, unit: f64) -> Scene {
    let axis = |c: usize| [c == 0, c == 1, c == 2];
    let sides = [
        (brick::X_MIN, 0),
        (second(brick::X_MIN), 0),
        (brick::Y_MIN, 1),
        (second(brick::Y_MIN), 1),
    ];
    let scene = Scene::new(mesh, uniform(YOUNG / unit.powi(2), POISSON));
    let scene = scene.with_support(Support::components(brick::Z_MIN, axis(2)));
    sides
        .into_iter()
        .fold(scene, |scene, (tag, c)| {
            scene.with_support(Support::components(tag, axis(c)))
        })
        .with_load(Load::pressure(second(brick::Z_MAX), PRESSURE / unit.powi(2)))
}

/// Largest error of a displacement of uniform compression along z, relative.
fn patch_error(mesh: &TetMesh, displacement: &[f64], unit: f64) -> f64 {
    let strain = PRESSURE / YOUNG;
    let error = mesh.points().iter().zip(displacement.chunks(3)).map(|([x, y, z], u)| {
        let exact = [POISSON * strain * x, POISSON * strain * y, -strain * z];
        (0..3).map(|c| (u[c] - exact[c]).abs()).fold(0.0, f64::max)
    });
    error.fold(0.0, f64::max) / (strain * unit)
}

/// Uniform pressure passes exactly, for any ratio of meshes, either order of sides, with friction and without, any cut,
/// in metres and millimetres.
#[test]
fn uniform_pressure_passes_exactly() {
    let both = |x: FacetTag, y: FacetTag, swap: bool| {
        if swap {
            Contact::between(y, x)
        } else {
            Contact::between(x, y)
        }
    };
    for (lower, upper, boxes, unit) in [
        ([2, 2, 2], [6, 6, 2], [1, 1, 2], 1.0),
        ([6, 6, 2], [2, 2, 2], [2, 1, 2], 1.0),
        ([3, 4, 2], [4, 3, 2], [2, 2, 2], 1000.0),
        ([3, 3, 3], [4, 4, 2], [3, 2, 2], 1.0),
        ([5, 5, 2], [2, 3, 2], [1, 1, 1], 1e-3),
    ] {
        for swap in [false, true] {
            for friction in [Friction::None, Friction::coulomb(0.3)] {
                let mesh = blocks(lower, upper, unit);
                let contact = both(second(brick::Z_MIN), brick::Z_MAX, swap).with_friction(friction.clone());
                let scene = pressed_blocks(mesh.clone(), unit)
                    .with_contact(contact)
                    .with_boxes(boxes);
                let result = solve(scene, tight());
                let what = format!("{lower:?} {upper:?} {swap} {friction:?}");
                let error = patch_error(&mesh, &result.displacement, unit);
                assert!(error < 1e-9, "{what}: {error:e}");
                let force: f64 = result.points.iter().map(|p| p.normal_force).sum();
                assert!((force + PRESSURE).abs() < 1e-9 * PRESSURE, "{what}: {force}");
                let area: f64 = result.points.iter().map(|p| p.area).sum();
                assert!((area / unit.powi(2) - 1.0).abs() < 1e-12, "{what}: {area}");
                for point in &result.points {
                    let pressure = -point.normal_force / point.area * unit.powi(2);
                    assert!((pressure - PRESSURE).abs() < 1e-7 * PRESSURE, "{what}: {pressure}");
                    let friction = point.friction_force.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
                    assert!(point.gap.abs() < 1e-9 * unit, "{what}: {:e}", point.gap);
                    // at nodes that supports hold friction may be anything that cancels on the other side
                    let [x, y, _] = mesh.points()[point.node as usize];
                    let free = x > 0.0 && y > 0.0;
                    assert!(
                        !free || friction < 1e-6 * PRESSURE * point.area / area,
                        "{what}: {friction:e}"
                    );
                }
            }
        }
    }
}
