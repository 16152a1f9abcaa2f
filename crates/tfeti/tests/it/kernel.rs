//! The rigid motions of a subdomain.

use proptest::prelude::*;
use signorini_tfeti::TfetiError;
use signorini_tfeti::internal::Kernel;

proptest! {
    #[test]
    fn modes_are_orthonormal_and_rigid(
        points in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 6..20),
        shift in -1e3..1e3_f64,
    ) {
        let points: Vec<[f64; 3]> = points.iter().map(|p| [p[0] + shift, p[1], 3.0 * p[2] - shift]).collect();
        let kernel = Kernel::new(&points, 0).unwrap();
        let modes = kernel.modes();
        let dim = 3 * points.len();
        for i in 0..6 {
            for j in 0..6 {
                let dot: f64 = (0..dim).map(|k| modes[i * dim + k] * modes[j * dim + k]).sum();
                prop_assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
        // A rigid motion changes no distance to first order: (u_a - u_b) . (p_a - p_b) = 0.
        for m in 0..6 {
            let u = |n: usize, c: usize| modes[m * dim + 3 * n + c];
            for a in 1..points.len() {
                let stretch: f64 = (0..3).map(|c| (u(a, c) - u(0, c)) * (points[a][c] - points[0][c])).sum();
                prop_assert!(stretch.abs() < 1e-10);
            }
        }
        let amplitudes = [0.3, -1.0, 2.0, 0.7, 0.1, -0.4];
        let mut motion = vec![0.0; dim];
        kernel.add_motion(1.0, &amplitudes, &mut motion);
        let back = kernel.transpose_times(&motion);
        for i in 0..6 {
            prop_assert!((back[i] - amplitudes[i]).abs() < 1e-12);
        }
    }
}

#[test]
fn nodes_on_a_line_are_refused() {
    let points: Vec<[f64; 3]> = (0..5).map(|i| [f64::from(i), 2.0 * f64::from(i), 0.0]).collect();
    assert_eq!(
        Kernel::new(&points, 7).unwrap_err(),
        TfetiError::Collinear { subdomain: 7 }
    );
}
