//! Stresses, recovery and error norms.

use crate::norms::{h1_seminorm_error, l2_error};
use approx::assert_abs_diff_eq;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use signorini_fem_mesh::fields::{nodal_average, principal, strains, von_mises};
use signorini_fem_mesh::{Brick, TetMesh};

fn interpolate(mesh: &TetMesh, u: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    mesh.points().iter().flat_map(|&p| u(p)).collect()
}

fn quadratic([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x * x, x * y, z * z - y]
}

fn quadratic_gradient([x, y, z]: [f64; 3]) -> [[f64; 3]; 3] {
    [[2.0 * x, 0.0, 0.0], [y, x, 0.0], [0.0, -1.0, 2.0 * z]]
}

#[test]
fn von_mises_of_plain_states() {
    assert_abs_diff_eq!(von_mises(&[5.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 5.0, epsilon = 1e-14);
    assert_eq!(von_mises(&[-3.0, -3.0, -3.0, 0.0, 0.0, 0.0]), 0.0);
    assert_abs_diff_eq!(
        von_mises(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0]),
        12f64.sqrt(),
        epsilon = 1e-14
    );
}

/// Principal stresses have the invariants of their tensor, also where two agree.
#[test]
fn principal_stresses_have_the_invariants() {
    assert_eq!(principal(&[0.0; 6]), [0.0; 3]);
    assert!(principal(&[f64::NAN; 6]).iter().all(|p| p.is_nan()));
    for (stress, exact) in [
        ([1.0, -3.0, 2.0, 0.0, 0.0, 0.0], [2.0, 1.0, -3.0]),
        ([0.0, 0.0, 0.0, 2.0, 0.0, 0.0], [2.0, 0.0, -2.0]),
        ([0.0, 0.0, 0.0, 0.0, -2.0, 0.0], [2.0, 0.0, -2.0]),
        ([1.0, 1.0, 1.0, 0.0, 0.0, 2.0], [3.0, 1.0, -1.0]),
    ] {
        for (found, exact) in principal(&stress).into_iter().zip(exact) {
            assert_abs_diff_eq!(found, exact, epsilon = 1e-14);
        }
    }
    let mut dice = Pcg64Mcg::new(7);
    for k in 0..1000 {
        let mut s = [0; 6].map(|_| 2.0 * dice.random::<f64>() - 1.0);
        if k % 2 == 0 {
            // 1 + v vᵀ
            let [x, y, z, ..] = s;
            s = [1.0 + x * x, 1.0 + y * y, 1.0 + z * z, y * z, x * z, x * y];
        }
        let [xx, yy, zz, yz, xz, xy] = s;
        let [a, b, c] = principal(&s);
        assert!(a >= b && b >= c);
        let second = xx * yy + yy * zz + zz * xx - yz * yz - xz * xz - xy * xy;
        let third = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
        for (own, exact) in [
            (a + b + c, xx + yy + zz),
            (a * b + b * c + c * a, second),
            (a * b * c, third),
        ] {
            assert_abs_diff_eq!(own, exact, epsilon = 1e-13);
        }
        assert_abs_diff_eq!(von_mises(&[a, b, c, 0.0, 0.0, 0.0]), von_mises(&s), epsilon = 1e-13);
    }
}

#[test]
fn norms_of_known_functions() {
    let mesh = Brick::new([1.0; 3], [2; 3]).perturbed(0.1, 1).build().unwrap();
    let zero = vec![0.0; 3 * mesh.points().len()];
    // Integrals of x^4 + x^2 y^2 + (z^2 - y)^2 and of the squared gradient over the unit cube.
    let l2 = l2_error(&mesh, &zero, quadratic).unwrap();
    let exact: f64 = 1.0 / 5.0 + 1.0 / 9.0 + 1.0 / 5.0 - 1.0 / 3.0 + 1.0 / 3.0;
    assert_abs_diff_eq!(l2, exact.sqrt(), epsilon = 1e-13);
    let h1 = h1_seminorm_error(&mesh, &zero, quadratic_gradient).unwrap();
    let exact: f64 = 4.0 / 3.0 + 1.0 / 3.0 + 1.0 / 3.0 + 1.0 + 4.0 / 3.0;
    assert_abs_diff_eq!(h1, exact.sqrt(), epsilon = 1e-13);
}

#[test]
fn linear_functions_have_no_error() {
    let mesh = Brick::new([1.0, 2.0, 3.0], [3; 3]).perturbed(0.1, 1).build().unwrap();
    let linear = |[x, y, z]: [f64; 3]| [x - y, 2.0 * z, 1.0 + x + y + z];
    let gradient = |_| [[1.0, -1.0, 0.0], [0.0, 0.0, 2.0], [1.0, 1.0, 1.0]];
    let u = interpolate(&mesh, linear);
    assert!(l2_error(&mesh, &u, linear).unwrap() < 1e-13);
    assert!(h1_seminorm_error(&mesh, &u, gradient).unwrap() < 1e-12);
    let expected = [1.0, 0.0, 1.0, 3.0, 1.0, -1.0];
    for strain in strains(&mesh, &u).unwrap() {
        assert!((0..6).all(|i| (strain[i] - expected[i]).abs() < 1e-12));
    }
    let nodal = nodal_average(&mesh, &strains(&mesh, &u).unwrap()).unwrap();
    assert!(nodal.iter().all(|s| (0..6).all(|i| (s[i] - expected[i]).abs() < 1e-12)));
}

#[test]
fn interpolation_converges_with_orders_two_and_one() {
    let errors = |n: usize| {
        let mesh = Brick::new([1.0; 3], [n; 3]).build().unwrap();
        let u = interpolate(&mesh, quadratic);
        let l2 = l2_error(&mesh, &u, quadratic).unwrap();
        (l2, h1_seminorm_error(&mesh, &u, quadratic_gradient).unwrap())
    };
    let (coarse, fine) = (errors(4), errors(8));
    assert_abs_diff_eq!((coarse.0 / fine.0).log2(), 2.0, epsilon = 0.05);
    assert_abs_diff_eq!((coarse.1 / fine.1).log2(), 1.0, epsilon = 0.05);
}
