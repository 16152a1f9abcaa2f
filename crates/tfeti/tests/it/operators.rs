//! Laws of the generalised inverses and of the dual operator.

use crate::common::{Brick, build, column, distance, dot, noise, norm, product};
use signorini_qp::{Equality, SymmetricOperator};
use signorini_tfeti::internal::InverseKind;
use signorini_tfeti::{InverseSettings, RowWeights, TfetiBuilder, TfetiError};

#[test]
fn generalised_inverse_laws() {
    let b = Brick::of(1, 3, 0.1);
    for kind in [InverseKind::Dense, InverseKind::Sparse] {
        for shared in [true, false] {
            let system = build(&b, kind, shared);
            // K K+ K = K on a random vector, K+ R = 0, K R = 0.
            let x = noise(system.torn_dim(), 3);
            let mut k = vec![0.0; x.len()];
            system.stiffness_times(&x, &mut k);
            let mut inverse = vec![0.0; x.len()];
            system.generalised_inverse(&k, &mut inverse);
            let mut again = vec![0.0; x.len()];
            system.stiffness_times(&inverse, &mut again);
            for s in 0..system.subdomains() {
                let range = system.torn_range(s);
                assert!(norm(&system.kernel(s).transpose_times(&inverse[range])) < 1e-9 * norm(&inverse));
            }
            assert!(distance(&again, &k) < 1e-10 * norm(&k), "{kind:?}");
            let mut rigid = vec![0.0; x.len()];
            for s in 0..system.subdomains() {
                system
                    .kernel(s)
                    .add_motion(1.0, &[1.0, -2.0, 0.5, 0.3, 1.0, -0.7], &mut rigid[system.torn_range(s)]);
            }
            system.stiffness_times(&rigid, &mut again);
            assert!(norm(&again) < 1e-12 * norm(&k));
            system.generalised_inverse(&rigid, &mut again);
            assert!(
                norm(&again) < 1e-9 * norm(&inverse) / norm(&k) * norm(&rigid),
                "K+ R = 0"
            );
        }
    }
}

#[test]
fn members_of_a_class_are_multiplied_together_with_the_same_result() {
    let b = Brick::of(2, 2, 0.0);
    let [alone, together] = [false, true].map(|share| {
        let system = build(&b, InverseKind::Auto, share);
        let x = noise(system.torn_dim(), 3);
        let mut y = vec![f64::NAN; x.len()];
        system.stiffness_times(&x, &mut y);
        let most = system.classes().classes().iter().map(|c| c.members.len());
        (y, most.max())
    });
    assert_eq!(alone.1, Some(1));
    assert!(together.1 > Some(8));
    assert!(distance(&alone.0, &together.0) <= 1e-14 * norm(&alone.0));
}

#[test]
fn dual_operator_is_symmetric_and_the_same_for_all_inverses() {
    let b = Brick::new(2, 3);
    let reference = build(&b, InverseKind::Dense, true);
    assert_eq!(reference.classes().classes().len(), 2);
    let (x, y) = (noise(reference.dual_dim(), 1), noise(reference.dual_dim(), 2));
    let fx = product(&reference, &x);
    assert!(dot(&x, &fx) > 0.0);
    for kind in [InverseKind::Dense, InverseKind::Sparse, InverseKind::Auto] {
        for share in [true, false] {
            let system = build(&b, kind, share);
            let expected = if !share { 24 } else { 2 };
            assert_eq!(system.classes().classes().len(), expected);
            let other = product(&system, &x);
            assert!(
                distance(&other, &fx) < 1e-11 * norm(&fx),
                "{kind:?} {share}: {:e}",
                distance(&other, &fx) / norm(&fx)
            );
            assert!((dot(&y, &other) - dot(&x, &product(&system, &y))).abs() < 1e-11 * norm(&fx) * norm(&y));
        }
    }
}

#[test]
fn product_agrees_with_torn_vectors_and_rows() {
    let b = Brick::new(1, 3);
    let system = b.system();
    let x = noise(system.dual_dim(), 5);
    let mut f = vec![0.0; system.torn_dim()];
    system.add_rows_transposed(&x, &mut f);
    let mut u = vec![0.0; f.len()];
    system.generalised_inverse(&f, &mut u);
    let mut y = vec![0.0; x.len()];
    system.rows_times(&u, &mut y);
    assert!(distance(&y, &product(&system, &x)) < 1e-12 * norm(&y));
    // B by its rows.
    for r in (0..x.len()).step_by(7) {
        let value: f64 = system
            .gluing()
            .row(r)
            .iter()
            .map(|&(s, d, v)| v * u[system.torn_range(s).start + d])
            .sum();
        assert!((value - y[r]).abs() < 1e-13 * norm(&y));
    }
    // G by its columns.
    let (coarse, mut g) = (system.coarse(), vec![0.0; 6 * system.subdomains()]);
    coarse.apply(&x, &mut g, &mut coarse.scratch());
    let mut expected = vec![0.0; g.len()];
    for (r, value) in x.iter().enumerate() {
        for (s, column) in column(&system, r) {
            (0..6).for_each(|m| expected[6 * s + m] += value * column[m]);
        }
    }
    assert!(distance(&g, &expected) < 1e-13 * norm(&expected));
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    let b = Brick::new(3, 5);
    for (kind, share) in [
        (InverseKind::Auto, true),
        (InverseKind::Sparse, true),
        (InverseKind::Sparse, false),
    ] {
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let system = build(&b, kind, share);
                // enough node copies on boundaries for two threads, in every loop over them
                let classes = system.report().classes.iter();
                let boundary: usize = classes.map(|c| c.members * c.boundary).sum();
                assert!(boundary >= 3 * 8000, "{boundary}");
                let x = noise(system.dual_dim(), 1);
                let y = product(&system, &x);
                let c = system.coarse_factor().unwrap().orthonormal().unwrap();
                let (mut s, mut beta, mut q) = (c.scratch(), vec![0.0; c.rows()], vec![0.0; c.dim()]);
                c.apply(&x, &mut beta, &mut s);
                c.apply_transpose(&beta, &mut q, &mut s);
                let mut u = vec![0.0; system.torn_dim()];
                system.add_rows_transposed(&x, &mut u);
                let mut v = vec![0.0; u.len()];
                system.generalised_inverse(&u, &mut v);
                let [l, d] = [system.lumped(), system.dirichlet()].map(|m| {
                    let (m, mut z) = (m.unwrap(), vec![0.0; x.len()]);
                    m.apply(&x, &mut z, &mut m.scratch());
                    z
                });
                [y, q, v, l, d]
                    .concat()
                    .iter()
                    .map(|v| v.to_bits())
                    .collect::<Vec<u64>>()
            })
        };
        assert_eq!(run(1), run(2), "{kind:?} {share}");
    }
}

#[test]
fn bad_systems_are_refused() {
    let b = Brick::new(1, 2);
    let other = Brick::new(1, 3);
    let error = TfetiBuilder::new(&b.mesh, &other.decomposition, &b.materials)
        .build()
        .unwrap_err();
    assert!(matches!(error, TfetiError::DecompositionMismatch { what: "nodes", .. }));
    let settings = InverseSettings::default().with_memory_limit(10);
    let builder = TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials);
    assert!(matches!(
        builder.with_inverse(settings).build(),
        Err(TfetiError::Memory { limit: 10, .. })
    ));
    let system = builder.build().unwrap();
    assert!(matches!(system.load_response(&[]), Err(TfetiError::Length { .. })));
    let mut loads = b.loads();
    loads[1][4] = f64::NAN;
    assert!(matches!(
        system.load_response(&loads),
        Err(TfetiError::NotFinite { .. })
    ));
    let short = RowWeights::diagonal(vec![1.0; 3]);
    assert!(matches!(
        system.coarse().factor_weighted(short),
        Err(TfetiError::Length { .. })
    ));
    let mut weights = vec![1.0; system.dual_dim()];
    weights[0] = -1.0;
    assert!(matches!(
        system.coarse().factor_weighted(RowWeights::diagonal(weights)),
        Err(TfetiError::Setting { .. })
    ));
}

/// The compliance of a row is the diagonal of `F`; without dense inverses it is estimated from below, closely.
#[test]
fn row_compliance_is_the_diagonal_of_f() {
    let b = Brick::new(1, 3);
    for kind in [InverseKind::Dense, InverseKind::Sparse] {
        let system = build(&b, kind, true);
        let rows = system.gluing().ranges().contact();
        let (mut found, mut stiffness) = (vec![0.0; rows.len()], vec![0.0; rows.len()]);
        system.row_compliance(rows.clone(), &mut found);
        system.row_stiffness(rows.clone(), &mut stiffness);
        for row in rows {
            let mut x = vec![0.0; system.dual_dim()];
            x[row] = 1.0;
            let ratio = found[row] / product(&system, &x)[row];
            if kind == InverseKind::Dense {
                assert!((ratio - 1.0).abs() < 1e-9, "{row}: {ratio}");
            } else {
                assert!((0.4..1.5).contains(&ratio), "{row}: {ratio}");
            }
            let loose = found[row] * stiffness[row];
            assert!((0.5..5.0).contains(&loose), "{row}: {loose}");
        }
    }
}
