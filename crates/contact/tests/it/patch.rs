//! Uniform stress states, which linear elements hold exactly on every mesh and decomposition.

use crate::common::*;

const YOUNG: f64 = 1000.0;
const PRESSURE: f64 = 10.0;

/// Cuts across the grid: four slanted layers, so that subdomains have ragged faces.
fn slanted_parts(mesh: &TetMesh) -> Vec<u32> {
    let part = |tet: usize| {
        let p = mesh.tet_points(tet);
        let s: f64 = p.iter().map(|p| p[0] + 0.5 * p[1] + 0.25 * p[2]).sum::<f64>() / 4.0;
        (s / 1.3 * 3.0).floor().min(2.0) as u32
    };
    let parts: Vec<u32> = (0..mesh.tets().len()).map(part).collect();
    signorini_fem_mesh::decomposition::split_disconnected(mesh, &parts).expect("parts")
}

fn meshes() -> Vec<(&'static str, TetMesh)> {
    let build = |b: Brick| b.build().expect("brick");
    let cells = [6, 4, 4];
    vec![
        ("regular", build(Brick::new([1.5, 1.0, 0.5], cells))),
        (
            "perturbed",
            build(Brick::new([1.5, 1.0, 0.5], cells).perturbed(0.15, 7)),
        ),
        (
            "graded",
            build(Brick::new([1.5, 1.0, 0.5], cells).graded([3.0, 0.5, 4.0])),
        ),
        (
            "quadratic",
            build(Brick::new([1.5, 1.0, 0.5], [3, 2, 2]).perturbed(0.15, 7))
                .raise_order()
                .expect("quadratic"),
        ),
    ]
}

fn cuts(scene: &Scene) -> Vec<(&'static str, Scene)> {
    vec![
        ("whole", scene.clone()),
        ("3 boxes", scene.clone().with_boxes([3, 1, 1])),
        ("24 boxes", scene.clone().with_boxes([3, 4, 2])),
        (
            "slanted parts",
            scene.clone().with_parts_as_given(slanted_parts(scene.mesh())),
        ),
    ]
}

fn node_at(mesh: &TetMesh, place: [f64; 3]) -> u32 {
    let at = |p: &[f64; 3]| (0..3).all(|c| (p[c] - place[c]).abs() < 1e-12);
    mesh.points().iter().position(at).expect("node") as u32
}

/// Uniform pressure, closed form.
#[test]
fn normal_patch_on_any_mesh_and_decomposition() {
    let poisson = 0.3;
    for (mesh_name, mesh) in meshes() {
        // statically determinate in the plane: no reaction
        let scene = Scene::new(mesh.clone(), uniform(YOUNG, poisson))
            .with_support(Support::components(vec![node_at(&mesh, [0.0; 3])], [true, true, false]))
            .with_support(Support::components(
                vec![node_at(&mesh, [1.5, 0.0, 0.0])],
                [false, true, false],
            ))
            .with_load(Load::pressure(brick::Z_MAX, PRESSURE))
            .with_contact(Contact::rigid(brick::Z_MIN));
        let exact: Vec<f64> = mesh
            .points()
            .iter()
            .flat_map(|x| {
                let s = PRESSURE / YOUNG;
                [poisson * s * x[0], poisson * s * x[1], -s * x[2]]
            })
            .collect();
        for (cut, scene) in cuts(&scene) {
            let what = format!("{mesh_name}, {cut}");
            let result = solve(scene, tight());
            assert_close(&result.displacement, &exact, 1e-9, &what);
            let area: f64 = result.points.iter().map(|p| p.area).sum();
            assert!((area - 1.5).abs() < 1e-12);
            for p in &result.points {
                let error = p.normal_force / (-PRESSURE * p.area) - 1.0;
                assert!(error.abs() <= 1e-9, "{what}, node {}: {error:e}", p.node);
            }
        }
    }
}

/// Uniform shear `t` in the direction `angle` under uniform pressure, in equilibrium with friction alone.
fn sheared(mesh: TetMesh, t: f64, angle: f64, coefficient: f64) -> Scene {
    let (s, c) = angle.sin_cos();
    let (tx, ty) = (t * c, t * s);
    Scene::new(mesh, uniform(YOUNG, 0.0))
        .with_load(Load::traction(brick::Z_MAX, [tx, ty, -PRESSURE]))
        .with_load(Load::traction(brick::X_MAX, [0.0, 0.0, tx]))
        .with_load(Load::traction(brick::X_MIN, [0.0, 0.0, -tx]))
        .with_load(Load::traction(brick::Y_MAX, [0.0, 0.0, ty]))
        .with_load(Load::traction(brick::Y_MIN, [0.0, 0.0, -ty]))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(coefficient)))
}

/// Uniform shear below the threshold, closed form; there is no support at all.
#[test]
fn friction_patch_in_all_directions() {
    let (t, coefficient) = (2.5, 0.3);
    let shear = YOUNG / 2.0;
    for (mesh_name, mesh) in meshes() {
        for (k, angle) in [0.0_f64, 0.7, 2.0, 4.4].into_iter().enumerate() {
            let (s, c) = angle.sin_cos();
            let scene = sheared(mesh.clone(), t, angle, coefficient);
            let (cut, scene) = cuts(&scene).swap_remove(k);
            let what = format!("{mesh_name}, {cut}, {angle}");
            let result = solve(scene, at(1e-11));
            let exact: Vec<f64> = mesh
                .points()
                .iter()
                .flat_map(|x| {
                    let g = t / shear * x[2];
                    [c * g, s * g, -PRESSURE / YOUNG * x[2]]
                })
                .collect();
            assert_close(&result.displacement, &exact, 1e-9, &what);
            assert_eq!(
                count(&result.points, ContactState::Stick),
                result.points.len(),
                "{what}"
            );
            for p in &result.points {
                let expected = [-t * c * p.area, -t * s * p.area, 0.0];
                let error =
                    distance(&p.friction_force, &expected).max((p.normal_force / (-PRESSURE * p.area) - 1.0).abs());
                assert!(error <= 1e-9, "{what}, node {}: {error:e}", p.node);
            }
        }
    }
}

/// The threshold F p, bracketed to 1e-6 in several directions. The top is moved, so that there is
/// equilibrium on both sides of it.
#[test]
fn the_threshold_of_sliding_is_bracketed_to_a_millionth() {
    let (coefficient, shear) = (0.3, YOUNG / 2.0);
    let limit = coefficient * PRESSURE;
    let mesh = block([1.0; 3], [2, 2, 2]);
    for method in methods() {
        for angle in [0.0, 1.1] {
            let (s, c) = f64::sin_cos(angle);
            let at = |t: f64| {
                let top = [t / shear * c, t / shear * s, -PRESSURE / YOUNG];
                // the sides carry the stress that friction can hold
                let scene = sheared(mesh.clone(), t.min(limit), angle, coefficient)
                    .with_support(Support::fixed(brick::Z_MAX).with_motion(top, History::constant(1.0)))
                    .with_boxes([2, 1, 1]);
                solve(scene, at(1e-9).with_method(method.clone()))
            };
            // the state is reported to 1e-5 of the bound, the difference itself is sharper
            let clear = at(limit * (1.0 - 2e-5));
            assert_eq!(count(&clear.points, ContactState::Stick), 9, "{}", method.kind());
            let below = at(limit * (1.0 - 1e-6));
            let above = at(limit * (1.0 + 1e-6));
            assert_eq!(count(&above.points, ContactState::Slip), 9, "{}", method.kind());
            for (a, b) in above.points.iter().zip(&below.points) {
                let slip = norm(&a.difference);
                assert!((slip / (1e-6 * limit / shear) - 1.0).abs() < 1e-2, "{slip:e}");
                let stick = norm(&b.difference);
                assert!(stick < 1e-9 * limit / shear, "{stick:e}");
            }
        }
    }
}

/// Driven by forces alone: above the threshold nothing holds the body, and no method may claim that it
/// found an equilibrium.
#[test]
fn above_the_threshold_no_equilibrium_is_claimed() {
    for method in methods() {
        for (angle, excess) in [(0.0, 1e-6), (1.1, 1e-6), (0.0, 1e-2), (2.0, 0.5)] {
            let t = 0.3 * PRESSURE * (1.0 + excess);
            let scene = sheared(block([1.0; 3], [2, 2, 2]), t, angle, 0.3).with_boxes([2, 1, 1]);
            // an excess of a millionth is seen by a tolerance below it only
            let settings = by(method.clone()).with_tolerance(1e-8);
            let mut simulation = match Simulation::new(scene, settings) {
                Ok(simulation) => simulation,
                // known before anything is solved
                Err(ContactError::NotHeld { .. }) => continue,
                Err(error) => panic!("{error}"),
            };
            if let Ok(frame) = simulation.step() {
                assert!(
                    !frame.report().status.converged(),
                    "{}, {angle}, {excess:e}: {:?}",
                    method.kind(),
                    frame.report()
                );
            }
        }
    }
}

/// Driven by forces alone, below the threshold: the body is held by friction only, so that the first slip
/// bounds (those of no contact force) hold nothing.
fn held_by_friction(margin: f64) {
    for angle in [0.0, 1.1, 3.0] {
        let t = 0.3 * PRESSURE * (1.0 - margin);
        let scene = sheared(block([1.0; 3], [2, 2, 2]), t, angle, 0.3).with_boxes([2, 1, 1]);
        let result = solve(scene, Settings::default());
        assert_eq!(count(&result.points, ContactState::Stick), 9, "{angle}, {margin:e}");
    }
}

#[test]
fn friction_alone_holds_the_body_at_half_the_threshold() {
    held_by_friction(0.5);
}

#[test]
fn friction_alone_holds_the_body_up_to_the_threshold() {
    for margin in [0.1, 1e-2, 1e-4] {
        held_by_friction(margin);
    }
}

/// A quarter of a tube: x of the brick becomes the radius, y the angle.
fn tube(inner: f64, cells: [usize; 3]) -> TetMesh {
    block([10.0, std::f64::consts::FRAC_PI_2, 4.0], cells)
        .map_points(|[x, y, z]| {
            let radius = inner + x;
            [radius * y.cos(), radius * y.sin(), z]
        })
        .expect("tube")
}

/// A tube tied in a tube under pressure from everywhere: where facets match the displacement is exact, elsewhere its
/// error is that of facets that are apart, and falls with the square of their size, whichever side is named first.
#[test]
fn tied_curved_sides_pass_pressure_up_to_their_facets() {
    let error = |[inside, outside]: [usize; 2], swap: bool, factor: usize| {
        let cells = |along: usize| [2 * factor, along * factor, factor];
        let mesh = with_second(&tube(10.0, cells(inside)), &tube(20.0, cells(outside)));
        let (inner, outer) = (brick::X_MAX, second(brick::X_MIN));
        let tie = if swap { Contact::tied(outer, inner) } else { Contact::tied(inner, outer) };
        let mut scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3)).with_contact(tie);
        for (tag, axis) in [(brick::Y_MIN, 1), (brick::Y_MAX, 0), (brick::Z_MIN, 2)] {
            for tag in [tag, second(tag)] {
                scene = scene.with_support(Support::components(tag, [0, 1, 2].map(|c| c == axis)));
            }
        }
        for tag in [brick::X_MIN, second(brick::X_MAX), brick::Z_MAX, second(brick::Z_MAX)] {
            scene = scene.with_load(Load::pressure(tag, PRESSURE));
        }
        let result = solve(scene, at(1e-9));
        let strain = -PRESSURE / YOUNG * (1.0 - 2.0 * 0.3);
        let off = mesh.points().iter().zip(result.displacement.chunks(3));
        let off = off.flat_map(|(x, u)| (0..3).map(|c| (u[c] - strain * x[c]).abs()).collect::<Vec<_>>());
        off.fold(0.0, f64::max) / (30.0 * strain.abs())
    };
    for swap in [false, true] {
        let matching = error([4, 4], swap, 1);
        assert!(matching < 1e-8, "{matching:e}");
        for cells in [[4, 5], [4, 6], [2, 6], [6, 2]] {
            let [coarse, fine] = [1, 2].map(|factor| error(cells, swap, factor));
            println!(
                "{cells:?} {swap}: {coarse:e} {fine:e}, order {}",
                (coarse / fine).log2()
            );
        }
    }
}
