//! Consistent loads: exact resultants and moments, and histories.

use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use signorini_fem_mesh::brick::{Brick, X_MAX, Z_MAX, Z_MIN};
use signorini_fem_mesh::{Decomposition, History, LoadDensity, LoadError, TetMesh, assemble_load};

/// Sum of forces and of moments about the origin.
fn resultant(mesh: &TetMesh, boxes: [usize; 3], load: &LoadDensity) -> ([f64; 3], [f64; 3]) {
    let parts = Decomposition::boxes(mesh, boxes).unwrap();
    let vectors = assemble_load(mesh, &parts, load).unwrap();
    let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
    for (subdomain, vector) in parts.subdomains().iter().zip(&vectors) {
        assert_eq!(vector.len(), subdomain.dofs());
        for (p, f) in subdomain.points(mesh).iter().zip(vector.chunks(3)) {
            for i in 0..3 {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                force[i] += f[i];
                moment[i] += p[j] * f[k] - p[k] * f[j];
            }
        }
    }
    (force, moment)
}

fn check(found: ([f64; 3], [f64; 3]), force: [f64; 3], moment: [f64; 3]) {
    for i in 0..3 {
        assert!((found.0[i] - force[i]).abs() < 1e-12, "force {found:?}");
        assert!((found.1[i] - moment[i]).abs() < 1e-12, "moment {found:?}");
    }
}

fn brick() -> TetMesh {
    Brick::new([3.0, 1.0, 2.0], [6, 2, 4])
        .perturbed(0.15, 11)
        .build()
        .unwrap()
}

#[test]
fn constant_loads() {
    let mesh = brick();
    for boxes in [[1, 1, 1], [3, 1, 2]] {
        // Volume 6 with centre (1.5, 0.5, 1); top of area 3 at z = 2.
        let body = LoadDensity::Body([0.0, 0.0, -2.0]);
        check(resultant(&mesh, boxes, &body), [0.0, 0.0, -12.0], [-6.0, 18.0, 0.0]);
        let top = LoadDensity::Traction(Z_MAX, [1.0, 0.0, -1.0]);
        check(resultant(&mesh, boxes, &top), [3.0, 0.0, -3.0], [-1.5, 10.5, -1.5]);
        let sum = LoadDensity::Force(Z_MAX, [3.0, 0.0, -3.0]);
        check(resultant(&mesh, boxes, &sum), [3.0, 0.0, -3.0], [-1.5, 10.5, -1.5]);
        let pressed = LoadDensity::Pressure(X_MAX, 4.0);
        check(resultant(&mesh, boxes, &pressed), [-8.0, 0.0, 0.0], [0.0, -8.0, 4.0]);
    }
}

/// Forces per volume of a region act there alone, in both orders.
#[test]
fn loads_of_regions() {
    let mesh = brick();
    let low = |tet: usize| u32::from(mesh.tet_points(tet).iter().all(|p| p[2] <= 1.0 + 1e-9));
    let regions: Vec<u32> = (0..mesh.tets().len()).map(low).collect();
    let volume: f64 = (0..regions.len())
        .filter(|t| regions[*t] == 1)
        .map(|t| mesh.volume(t))
        .sum();
    assert!(volume > 0.5 && volume < 5.5, "{volume}");
    let mesh = mesh.with_regions(regions).unwrap();
    for mesh in [mesh.clone(), mesh.raise_order().unwrap()] {
        let of = |load: LoadDensity| resultant(&mesh, [3, 1, 2], &load);
        let own = of(LoadDensity::BodyIn(1, [0.0, 0.0, -2.0]));
        assert_abs_diff_eq!(own.0[2], -2.0 * volume, epsilon = 1e-12);
        let field = |x: [f64; 3]| [x[0], 0.0, 0.0];
        let parts = [0, 1].map(|region| of(LoadDensity::body_field_in(region, field)).0[0]);
        assert_abs_diff_eq!(
            parts[0] + parts[1],
            of(LoadDensity::body_field(field)).0[0],
            epsilon = 1e-12
        );
        let parts = Decomposition::whole(&mesh);
        let error = assemble_load(&mesh, &parts, &LoadDensity::BodyIn(7, [1.0; 3])).unwrap_err();
        assert_eq!(
            error,
            LoadError::UnknownRegion {
                region: 7,
                known: vec![0, 1]
            }
        );
    }
}

#[test]
fn varying_loads() {
    let mesh = brick();
    // Integrals of polynomials over the box and its sides, exact for the rules of degree 5.
    let body = LoadDensity::body_field(|[x, y, z]| [x * x, y * z, 0.0]);
    let found = resultant(&mesh, [3, 1, 1], &body);
    assert_abs_diff_eq!(found.0[0], 9.0 * 2.0, epsilon = 1e-12);
    assert_abs_diff_eq!(found.0[1], 3.0 * 0.5 * 2.0, epsilon = 1e-12);
    // Moment about x: - integral of z (y z) = -3 (1/2) (8/3).
    assert!((found.1[0] + 4.0).abs() < 1e-12);
    let side = LoadDensity::traction_field(X_MAX, |[_, y, z], n| [n[0] * y * y, 0.0, z]);
    let found = resultant(&mesh, [3, 1, 2], &side);
    assert_abs_diff_eq!(found.0[0], 2.0 / 3.0, epsilon = 1e-12);
    assert_abs_diff_eq!(found.0[2], 2.0, epsilon = 1e-12);
    // The same pressure as a function and as a constant.
    let by_function = LoadDensity::traction_field(Z_MIN, |_, n| n.map(|c| -7.0 * c));
    let by_value = LoadDensity::Pressure(Z_MIN, 7.0);
    let (a, b) = (
        resultant(&mesh, [1; 3], &by_function),
        resultant(&mesh, [1; 3], &by_value),
    );
    check(a, b.0, b.1);
    assert_abs_diff_eq!(b.0[2], 21.0, epsilon = 1e-12);
}

/// A moment about any axis on flat and curved sides, linear and quadratic: no force, and the moment to rounding.
#[test]
fn moments_have_no_force() {
    let bend = |[x, y, z]: [f64; 3]| {
        let (sin, cos) = (0.6 * y).sin_cos();
        [(1.0 + z) * sin + 5.0, (1.0 + z) * cos - 2.0, x]
    };
    let linear = brick().map_points(bend).unwrap();
    let quadratic = brick().raise_order().unwrap().map_points(bend).unwrap();
    let moment = [0.7, -2.0, 3.0];
    for mesh in [brick(), linear, quadratic] {
        for tag in [X_MAX, Z_MIN, Z_MAX] {
            let found = resultant(&mesh, [3, 1, 2], &LoadDensity::Moment(tag, moment));
            check(found, [0.0; 3], moment);
        }
    }
    // pure bending of a side of 1 x 2: the tractions of the beam, M z / (b h^3 / 12) along x
    let bending = LoadDensity::Moment(X_MAX, [0.0, 4.0, 0.0]);
    let beam = LoadDensity::traction_field(X_MAX, |[_, _, z], _| [4.0 * (z - 1.0) * 1.5, 0.0, 0.0]);
    let straight = Brick::new([3.0, 1.0, 2.0], [6, 2, 4]).build().unwrap();
    let parts = Decomposition::whole(&straight);
    let of = |load| assemble_load(&straight, &parts, &load).unwrap().remove(0);
    for (a, b) in of(bending).into_iter().zip(of(beam)) {
        assert!((a - b).abs() < 1e-13, "{a} {b}");
    }
}

#[test]
fn nodal_forces_act_once() {
    let mesh = brick();
    let shared = (0..mesh.points().len() as u32).collect::<Vec<_>>();
    let forces = shared.iter().map(|&n| (n, [1.0, 2.0, 3.0])).collect();
    let n = shared.len() as f64;
    let (force, _) = resultant(&mesh, [3, 1, 2], &LoadDensity::NodalForces(forces));
    assert_eq!(force, [n, 2.0 * n, 3.0 * n]);
    let twice = LoadDensity::NodalForces(vec![(4, [1.0; 3]), (4, [1.0; 3])]);
    assert_eq!(resultant(&mesh, [3, 1, 2], &twice).0, [2.0; 3]);
}

#[test]
fn a_third_of_each_triangle_goes_to_its_nodes() {
    let mesh = brick();
    let parts = Decomposition::whole(&mesh);
    let load = &assemble_load(&mesh, &parts, &LoadDensity::Pressure(Z_MIN, 1.0)).unwrap()[0];
    let surface = signorini_fem_mesh::Surface::new(&mesh, &[Z_MIN]).unwrap();
    for (&node, area) in surface.nodes().iter().zip(surface.areas()) {
        assert_abs_diff_eq!(load[3 * node as usize + 2], area, epsilon = 1e-15);
    }
}

#[test]
fn histories() {
    let ramp = History::ramp(2.0, 3.0).unwrap();
    assert_eq!(
        [-1.0, 0.0, 1.0, 2.0, 5.0].map(|t| ramp.value(t)),
        [0.0, 0.0, 1.5, 3.0, 3.0]
    );
    let constant = History::constant(4.0);
    assert_eq!([-9.0, 0.0, 9.0].map(|t| constant.value(t)), [4.0; 3]);
    let function = History::function(|t| t * t);
    assert_eq!(function.value(3.0), 9.0);
    let points = vec![(0.0, 0.0), (0.4, 1.0), (0.7, 0.0), (1.0, 1.0)];
    let phi_c = History::table(points.clone()).unwrap();
    for (time, value) in points {
        assert_eq!(phi_c.value(time), value);
    }
    assert_abs_diff_eq!(phi_c.value(0.55), 0.5, epsilon = 1e-15);
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        rng_seed: RngSeed::Fixed(4),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn histories_stay_between_their_points(
        values in prop::collection::vec(-5.0f64..5.0, 1..8),
        gaps in prop::collection::vec(1e-3f64..2.0, 8),
        time in -1.0f64..20.0,
    ) {
        let mut at = 0.0;
        let points: Vec<_> = values.iter().zip(gaps).map(|(&v, gap)| { at += gap; (at, v) }).collect();
        let value = History::table(points).unwrap().value(time);
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        prop_assert!((low - 1e-14..=high + 1e-14).contains(&value));
    }
}
