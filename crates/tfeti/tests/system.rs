//! Laws of the operators and agreement with a direct solve.

mod common;

use common::{Brick, distance, dot, noise, norm};
use signorini_fem_mesh::{Decomposition, Hooke, LoadDensity, Materials, assemble_load, brick};
use signorini_qp::{Equality, SymmetricOperator};
use signorini_tfeti::{
    CoarseFactor, Directions, InverseKind, InverseSettings, Motion, Preconditioner, RowRule,
    RowWeights, Sharing, Support, Tfeti, TfetiBuilder, TfetiError,
};

fn build(b: &Brick, kind: InverseKind, sharing: Sharing, rule: RowRule) -> Tfeti {
    let (supports, contact) = (b.supports(), b.contact(true));
    TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials)
        .supports(&supports)
        .contact(&contact)
        .rule(rule)
        .sharing(sharing)
        .inverse(InverseSettings::default().with_kind(kind))
        .build()
        .unwrap()
}

fn product(system: &Tfeti, x: &[f64]) -> Vec<f64> {
    let f = system.dual();
    let mut y = vec![0.0; f.dim()];
    f.apply(x, &mut y, &mut f.scratch());
    y
}

#[test]
fn generalised_inverse_laws() {
    let b = Brick::of(1, 3, 0.1);
    for kind in [InverseKind::Dense, InverseKind::Sparse] {
        for shared in [Sharing::Translates, Sharing::Never] {
            let system = build(&b, kind, shared, RowRule::Orthonormal);
            // K K+ K = K on a random vector, K+ R = 0, K R = 0.
            let x = noise(system.torn_dim(), 3);
            let mut k = vec![0.0; x.len()];
            for s in 0..system.subdomains() {
                let range = system.torn_range(s);
                system.stiffness_times(s, &x[range.clone()], &mut k[range]);
            }
            let mut inverse = vec![0.0; x.len()];
            system.generalised_inverse(&k, &mut inverse);
            let mut again = vec![0.0; x.len()];
            for s in 0..system.subdomains() {
                let range = system.torn_range(s);
                system.stiffness_times(s, &inverse[range.clone()], &mut again[range.clone()]);
                assert!(
                    norm(&system.kernel(s).transpose_times(&inverse[range]))
                        < 1e-9 * norm(&inverse)
                );
            }
            assert!(distance(&again, &k) < 1e-10 * norm(&k), "{kind:?}");
            let mut rigid = vec![0.0; x.len()];
            for s in 0..system.subdomains() {
                system.kernel(s).add_motion(
                    1.0,
                    &[1.0, -2.0, 0.5, 0.3, 1.0, -0.7],
                    &mut rigid[system.torn_range(s)],
                );
            }
            for s in 0..system.subdomains() {
                let range = system.torn_range(s);
                system.stiffness_times(s, &rigid[range.clone()], &mut again[range]);
            }
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
fn dual_operator_is_symmetric_and_the_same_for_all_inverses() {
    let b = Brick::new(2, 3);
    let reference = build(
        &b,
        InverseKind::Dense,
        Sharing::Translates,
        RowRule::Orthonormal,
    );
    assert_eq!(reference.classes().classes().len(), 2);
    let (x, y) = (
        noise(reference.dual_dim(), 1),
        noise(reference.dual_dim(), 2),
    );
    let fx = product(&reference, &x);
    assert!(dot(&x, &fx) > 0.0);
    for kind in [InverseKind::Dense, InverseKind::Sparse, InverseKind::Auto] {
        for sharing in [Sharing::Translates, Sharing::Never] {
            let system = build(&b, kind, sharing, RowRule::Orthonormal);
            let expected = if sharing == Sharing::Never { 24 } else { 2 };
            assert_eq!(system.classes().classes().len(), expected);
            let other = product(&system, &x);
            assert!(
                distance(&other, &fx) < 1e-11 * norm(&fx),
                "{kind:?} {sharing:?}: {:e}",
                distance(&other, &fx) / norm(&fx)
            );
            assert!(
                (dot(&y, &other) - dot(&x, &product(&system, &y))).abs()
                    < 1e-11 * norm(&fx) * norm(&y)
            );
        }
    }
}

#[test]
fn product_agrees_with_torn_vectors_and_rows() {
    let b = Brick::new(1, 3);
    let system = build(
        &b,
        InverseKind::Auto,
        Sharing::Translates,
        RowRule::Orthonormal,
    );
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
        for (s, column) in coarse.column(r) {
            (0..6).for_each(|m| expected[6 * s + m] += value * column[m]);
        }
    }
    assert!(distance(&g, &expected) < 1e-13 * norm(&expected));
}

#[test]
fn coarse_projectors_and_particular_solutions() {
    let b = Brick::new(2, 3);
    for rule in [RowRule::Orthonormal, RowRule::Chained] {
        let system = build(&b, InverseKind::Auto, Sharing::Translates, rule);
        let coarse = system.coarse();
        let (dim, rows) = (coarse.dim(), coarse.rows());
        let mut s = coarse.scratch();
        let ranges = system.gluing().ranges().clone();
        let weights = |row: usize| {
            if ranges.contact().contains(&row) {
                0.0
            } else {
                1.0
            }
        };
        let weighted = coarse
            .factor_weighted(RowWeights::diagonal((0..dim).map(weights).collect()))
            .unwrap();
        for factor in [system.coarse_factor(), &weighted] {
            assert!(factor.free_motions().is_empty());
            let x = noise(dim, 9);
            let e = noise(rows, 4);
            let mut g = vec![0.0; rows];
            // G P x = 0, P P = P, and the affine version reaches G x = e.
            let mut p = x.clone();
            factor.project(&mut p, None, &mut s);
            coarse.apply(&p, &mut g, &mut s);
            assert!(norm(&g) < 1e-11 * norm(&x));
            let mut pp = p.clone();
            factor.project(&mut pp, None, &mut s);
            assert!(distance(&pp, &p) < 1e-11 * norm(&p));
            let mut affine = x.clone();
            factor.project(&mut affine, Some(&e), &mut s);
            coarse.apply(&affine, &mut g, &mut s);
            assert!(distance(&g, &e) < 1e-10 * norm(&e));
            let mut particular = vec![0.0; dim];
            factor.particular(&e, &mut particular, &mut s);
            coarse.apply(&particular, &mut g, &mut s);
            assert!(distance(&g, &e) < 1e-10 * norm(&e));
            // The transposed projector is adjoint to the projector.
            let r = noise(dim, 11);
            let (mut t, mut alpha) = (r.clone(), vec![0.0; rows]);
            factor.project_transpose(&mut t, &mut alpha, &mut s);
            assert!((dot(&t, &x) - dot(&r, &p)).abs() < 1e-11 * norm(&r) * norm(&x));
            if factor.weights().is_some() {
                assert!(particular[ranges.contact()].iter().all(|v| *v == 0.0));
            } else {
                let mut q = r.clone();
                factor.project(&mut q, None, &mut s);
                assert!(distance(&q, &t) < 1e-11 * norm(&r), "P is symmetric");
            }
        }
        check_orthonormal(system.coarse_factor());
    }
}

fn check_orthonormal(factor: &CoarseFactor) {
    let c = factor.orthonormal().unwrap();
    let mut s = c.scratch();
    let beta = noise(c.rows(), 21);
    let (mut x, mut back) = (vec![0.0; c.dim()], vec![0.0; c.rows()]);
    c.apply_transpose(&beta, &mut x, &mut s);
    c.apply(&x, &mut back, &mut s);
    assert!(distance(&beta, &back) < 1e-11 * norm(&beta), "C C^T = I");
    // C^T C = Q, G^T alpha = C^T beta, and C x = rhs(e) is G x = e.
    let y = noise(c.dim(), 22);
    c.apply(&y, &mut back, &mut s);
    c.apply_transpose(&back, &mut x, &mut s);
    let mut p = y.clone();
    factor.project(&mut p, None, &mut s);
    let q: Vec<f64> = y.iter().zip(&p).map(|(a, b)| a - b).collect();
    assert!(distance(&q, &x) < 1e-11 * norm(&y));
    let mut alpha = vec![0.0; c.rows()];
    c.amplitudes(&beta, &mut alpha, &mut s);
    let mut g = vec![0.0; c.dim()];
    factor.coarse().apply_transpose(&alpha, &mut g, &mut s);
    c.apply_transpose(&beta, &mut x, &mut s);
    assert!(distance(&g, &x) < 1e-11 * norm(&x));
    let (mut e, mut rhs) = (vec![0.0; c.rows()], vec![0.0; c.rows()]);
    factor.coarse().apply(&y, &mut e, &mut s);
    c.rhs(&e, &mut rhs, &mut s);
    c.apply(&y, &mut back, &mut s);
    assert!(distance(&rhs, &back) < 1e-11 * norm(&rhs));
}

/// Solves the linear problem (no contact) by projected conjugate gradients and returns the nodal displacement.
fn solve(system: &Tfeti, loads: &[Vec<f64>], offsets: &[f64]) -> (Vec<f64>, usize) {
    let response = system.load_response(loads).unwrap();
    let (f, factor) = (system.dual(), system.coarse_factor());
    let (mut fs, mut cs) = (f.scratch(), factor.scratch());
    let dim = f.dim();
    let d: Vec<f64> = offsets
        .iter()
        .zip(&response.dual)
        .map(|(c, b)| c - b)
        .collect();
    let mut lambda = vec![0.0; dim];
    factor.particular(&response.coarse, &mut lambda, &mut cs);
    let mut fl = vec![0.0; dim];
    let mut iterations = 0;
    // Restarted from the true residual, so that rounding does not limit the accuracy.
    for _ in 0..3 {
        f.apply(&lambda, &mut fl, &mut fs);
        let mut r: Vec<f64> = d.iter().zip(&fl).map(|(d, f)| d - f).collect();
        // Twice: what the first projection removes is larger than the rest by many orders.
        factor.project(&mut r, None, &mut cs);
        factor.project(&mut r, None, &mut cs);
        let (mut p, mut rr) = (r.clone(), dot(&r, &r));
        let stop = (1e-9 * rr.sqrt()).max(1e-13 * norm(&d));
        for _ in 0..400 {
            if rr.sqrt() <= stop {
                break;
            }
            f.apply(&p, &mut fl, &mut fs);
            factor.project(&mut fl, None, &mut cs);
            let step = rr / dot(&p, &fl);
            for k in 0..dim {
                lambda[k] += step * p[k];
                r[k] -= step * fl[k];
            }
            let new = dot(&r, &r);
            for k in 0..dim {
                p[k] = r[k] + new / rr * p[k];
            }
            rr = new;
            iterations += 1;
        }
    }
    factor.project(&mut lambda, Some(&response.coarse), &mut cs);
    f.apply(&lambda, &mut fl, &mut fs);
    let residual: Vec<f64> = fl.iter().zip(&d).map(|(f, d)| f - d).collect();
    let mut alpha = vec![0.0; factor.coarse().rows()];
    factor.amplitudes(&residual, &mut alpha, &mut cs);
    let u = system.recover(&response.force, &lambda, &alpha).unwrap();
    let mut rows = vec![0.0; dim];
    system.rows_times(&u, &mut rows);
    let mut direct = vec![0.0; dim];
    system.row_displacements(
        &lambda,
        &response.dual,
        &alpha,
        &mut direct,
        &mut fs,
        &mut cs,
    );
    assert!(
        distance(&rows, &direct) < 1e-9 * norm(&u),
        "B u without recovery: {:e} after {iterations}",
        distance(&rows, &direct) / norm(&u)
    );
    assert!(
        distance(&rows, offsets) < 1e-9 * norm(&u),
        "rows hold: {:e} after {iterations}",
        distance(&rows, offsets) / norm(&u)
    );
    assert!(system.jump(&u).largest < 1e-9 * system.jump(&u).displacement);
    let balance = system
        .equilibrium_residual(&u, &response.force, &lambda)
        .unwrap();
    let size = norm(&response.force).max(norm(&lambda));
    assert!(
        norm(&balance) < 1e-9 * size,
        "balance {:e}",
        norm(&balance) / size
    );
    (system.nodal_mean(&u), iterations)
}

/// Dense Cholesky-free reference: conjugate gradients on the undivided body with its supports eliminated.
fn direct(
    b: &Brick,
    prescribed: &dyn Fn(u32) -> Option<[f64; 3]>,
    loads: &LoadDensity,
) -> Vec<f64> {
    let whole = Decomposition::whole(&b.mesh);
    let sub = &whole.subdomains()[0];
    let hooke = b.materials.get(0).unwrap();
    let k = signorini_fem_mesh::assemble_stiffness(b.mesh.points(), &sub.tets, |_| hooke).unwrap();
    let f = assemble_load(&b.mesh, &whole, loads).unwrap().remove(0);
    let n = f.len();
    let mut u = vec![0.0; n];
    let mut fixed = vec![false; n];
    for node in 0..n / 3 {
        if let Some(value) = prescribed(node as u32) {
            for c in 0..3 {
                u[3 * node + c] = value[c];
                fixed[3 * node + c] = true;
            }
        }
    }
    let times = |x: &[f64]| -> Vec<f64> {
        k.outer_iterator()
            .map(|col| col.iter().map(|(i, v)| v * x[i]).sum::<f64>())
            .collect()
    };
    let mask = |mut v: Vec<f64>| {
        v.iter_mut().zip(&fixed).for_each(|(v, f)| {
            if *f {
                *v = 0.0
            }
        });
        v
    };
    let diagonal: Vec<f64> = (0..n).map(|i| *k.get(i, i).unwrap()).collect();
    let ku = times(&u);
    let mut r = mask(f.iter().zip(&ku).map(|(f, k)| f - k).collect());
    let precondition =
        |r: &[f64]| -> Vec<f64> { r.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
    let mut z = precondition(&r);
    let mut p = z.clone();
    let mut rz = dot(&r, &z);
    let stop = 1e-15 * norm(&f).max(norm(&r));
    for _ in 0..20 * n {
        if norm(&r) <= stop {
            break;
        }
        let q = mask(times(&p));
        let step = rz / dot(&p, &q);
        (0..n).for_each(|i| {
            u[i] += step * p[i];
            r[i] -= step * q[i];
        });
        z = precondition(&r);
        let new = dot(&r, &z);
        (0..n).for_each(|i| p[i] = z[i] + new / rz * p[i]);
        rz = new;
    }
    u
}

#[test]
fn tfeti_equals_a_direct_solve() {
    for n in [1, 2] {
        let b = Brick::new(n, 5);
        let load = LoadDensity::traction(brick::Z_MAX, [1.0e6, -2.0e6, -3.0e7]);
        let loads = assemble_load(&b.mesh, &b.decomposition, &load).unwrap();
        let reference = direct(
            &b,
            &|node| b.fixed.binary_search(&node).ok().map(|_| [0.0; 3]),
            &load,
        );
        for rule in [RowRule::Orthonormal, RowRule::Chained] {
            let supports = b.supports();
            let system = TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials)
                .supports(&supports)
                .rule(rule)
                .build()
                .unwrap();
            let (u, iterations) = solve(&system, &loads, &vec![0.0; system.dual_dim()]);
            let error = distance(&u, &reference) / norm(&reference);
            assert!(
                error < 1e-9,
                "n = {n}, {rule:?}: {error:e} after {iterations}"
            );
        }
    }
}

/// Iterations of preconditioned projected conjugate gradients to a relative residual of 1e-8.
fn preconditioned_iterations(system: &Tfeti, preconditioner: Option<&Preconditioner>) -> usize {
    let (f, factor) = (system.dual(), system.coarse_factor());
    let (mut fs, mut cs) = (f.scratch(), factor.scratch());
    let dim = f.dim();
    let mut r = noise(dim, 17);
    let mut f_r = vec![0.0; dim];
    f.apply(&r, &mut f_r, &mut fs);
    std::mem::swap(&mut r, &mut f_r);
    factor.project(&mut r, None, &mut cs);
    let start = norm(&r);
    let mut ps = preconditioner.map(SymmetricOperator::scratch);
    let mut precondition = |r: &[f64], cs: &mut signorini_tfeti::CoarseScratch| {
        let mut z = r.to_vec();
        if let (Some(m), Some(s)) = (preconditioner, ps.as_mut()) {
            m.apply(r, &mut z, s);
            factor.project(&mut z, None, cs);
        }
        z
    };
    let mut z = precondition(&r, &mut cs);
    let (mut p, mut rz) = (z.clone(), dot(&r, &z));
    let mut fp = vec![0.0; dim];
    for iteration in 1..500 {
        f.apply(&p, &mut fp, &mut fs);
        factor.project(&mut fp, None, &mut cs);
        let step = rz / dot(&p, &fp);
        (0..dim).for_each(|k| r[k] -= step * fp[k]);
        if norm(&r) < 1e-8 * start {
            return iteration;
        }
        z = precondition(&r, &mut cs);
        let new = dot(&r, &z);
        (0..dim).for_each(|k| p[k] = z[k] + new / rz * p[k]);
        rz = new;
    }
    500
}

#[test]
fn preconditioners_are_symmetric_and_help() {
    let b = Brick::new(2, 4);
    let counts = |system: &Tfeti| {
        let (lumped, dirichlet) = (system.lumped().unwrap(), system.dirichlet().unwrap());
        for m in [&lumped, &dirichlet] {
            let (x, y) = (noise(m.dim(), 1), noise(m.dim(), 2));
            let (mut mx, mut my, mut s) = (vec![0.0; m.dim()], vec![0.0; m.dim()], m.scratch());
            m.apply(&x, &mut mx, &mut s);
            m.apply(&y, &mut my, &mut s);
            assert!((dot(&mx, &y) - dot(&my, &x)).abs() < 1e-11 * norm(&mx) * norm(&y));
            assert!(dot(&mx, &x) > 0.0);
            // Masked: W M W.
            let free: Vec<bool> = (0..m.dim()).map(|k| k % 3 != 0).collect();
            let masked: Vec<f64> = x
                .iter()
                .zip(&free)
                .map(|(v, f)| if *f { *v } else { 0.0 })
                .collect();
            m.apply(&masked, &mut mx, &mut s);
            m.apply_masked(&x, &free, &mut my, &mut s);
            assert!(mx.iter().zip(&my).zip(&free).all(|((a, b), f)| if *f {
                a == b
            } else {
                *b == 0.0
            }));
        }
        [None, Some(&lumped), Some(&dirichlet)].map(|m| preconditioned_iterations(system, m))
    };
    for sharing in [Sharing::Translates, Sharing::Never] {
        let [none, lumped, dirichlet] =
            counts(&build(&b, InverseKind::Auto, sharing, RowRule::Orthonormal));
        assert!(
            dirichlet < lumped && lumped < none,
            "{none} {lumped} {dirichlet}"
        );
        assert!(dirichlet < 25, "{none} {lumped} {dirichlet}");
    }
    let chained = counts(&build(
        &b,
        InverseKind::Auto,
        Sharing::Translates,
        RowRule::Chained,
    ));
    assert!(chained[2] < 25, "{chained:?}");
}

#[test]
fn stiffness_scaling_copes_with_several_materials() {
    let mut b = Brick::new(2, 4);
    let regions: Vec<u32> = b.decomposition.parts().iter().map(|p| p % 2).collect();
    b.mesh = b.mesh.clone().with_regions(regions).unwrap();
    let law = |young| Hooke::isotropic(young, 0.3).unwrap();
    b.materials = Materials::new(vec![(0, law(1e9)), (1, law(1e12))]).unwrap();
    let system = build(
        &b,
        InverseKind::Auto,
        Sharing::Translates,
        RowRule::Orthonormal,
    );
    assert_eq!(system.classes().classes().len(), 2);
    let dirichlet = system.dirichlet().unwrap();
    let [with, without] = [Some(&dirichlet), None].map(|m| preconditioned_iterations(&system, m));
    assert!(3 * with < without, "{with} {without}");
}

#[test]
fn prescribed_displacement_is_reached() {
    let b = Brick::new(1, 3);
    let pull = [1e-3, -5e-4, 2e-4];
    let right = b.mesh.nodes_on(brick::X_MAX);
    let supports = [
        Support::fixed(b.fixed.clone()),
        Support::fixed(right.clone()).with_motion(Motion {
            case: 0,
            values: vec![pull],
        }),
    ];
    let system = TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials)
        .supports(&supports)
        .build()
        .unwrap();
    let zero: Vec<Vec<f64>> = (0..system.subdomains())
        .map(|s| vec![0.0; system.torn_range(s).len()])
        .collect();
    let (u, _) = solve(&system, &zero, &system.prescribed_offsets(&[(0, 2.0)]));
    let none = LoadDensity::body([0.0; 3]);
    let value = |node: u32| {
        let moved = right
            .binary_search(&node)
            .ok()
            .map(|_| pull.map(|v| 2.0 * v));
        moved.or_else(|| b.fixed.binary_search(&node).ok().map(|_| [0.0; 3]))
    };
    let reference = direct(&b, &value, &none);
    assert!(distance(&u, &reference) < 1e-9 * norm(&reference));
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    let b = Brick::new(3, 5);
    for kind in [InverseKind::Auto, InverseKind::Sparse] {
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                let system = build(&b, kind, Sharing::Translates, RowRule::Orthonormal);
                let x = noise(system.dual_dim(), 1);
                let y = product(&system, &x);
                let c = system.coarse_factor().orthonormal().unwrap();
                let (mut s, mut beta, mut q) =
                    (c.scratch(), vec![0.0; c.rows()], vec![0.0; c.dim()]);
                c.apply(&x, &mut beta, &mut s);
                c.apply_transpose(&beta, &mut q, &mut s);
                let mut u = vec![0.0; system.torn_dim()];
                system.add_rows_transposed(&x, &mut u);
                let mut v = vec![0.0; u.len()];
                system.generalised_inverse(&u, &mut v);
                [y, q, v]
                    .concat()
                    .iter()
                    .map(|v| v.to_bits())
                    .collect::<Vec<u64>>()
            })
        };
        assert_eq!(run(1), run(2), "{kind:?}");
    }
}

#[test]
fn spectrum_on_the_kernel_of_g() {
    let b = Brick::new(1, 5);
    let system = build(
        &b,
        InverseKind::Auto,
        Sharing::Translates,
        RowRule::Orthonormal,
    );
    let (f, factor) = (system.dual(), system.coarse_factor());
    let (dim, mut fs, mut cs) = (f.dim(), f.scratch(), factor.scratch());
    let mut matrix = nalgebra::DMatrix::<f64>::zeros(dim, dim);
    for j in 0..dim {
        let (mut x, mut y) = (vec![0.0; dim], vec![0.0; dim]);
        x[j] = 1.0;
        factor.project(&mut x, None, &mut cs);
        f.apply(&x, &mut y, &mut fs);
        factor.project(&mut y, None, &mut cs);
        matrix.column_mut(j).copy_from_slice(&y);
    }
    let matrix = (&matrix + matrix.transpose()) * 0.5;
    let mut values: Vec<f64> = nalgebra::SymmetricEigen::new(matrix)
        .eigenvalues
        .iter()
        .copied()
        .collect();
    values.sort_by(f64::total_cmp);
    let rows = factor.coarse().rows();
    let largest = values[dim - 1];
    assert!(
        values[rows - 1].abs() < 1e-12 * largest,
        "six zeros a subdomain"
    );
    let smallest = values[rows] / largest;
    assert!(
        (0.015..0.03).contains(&smallest),
        "smallest / largest = {smallest}"
    );
}

#[test]
fn free_motions_are_found_and_long_bodies_raise_no_alarm() {
    let b = Brick::new(1, 3);
    let free = |supports: &[Support], friction: Option<bool>, only_interface: bool| {
        let contact = b.contact(friction.unwrap_or(false));
        let mut builder =
            TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials).supports(supports);
        if friction.is_some() {
            builder = builder.contact(&contact);
        }
        let system = builder.build().unwrap();
        if !only_interface {
            return system.coarse_factor().free_motions().len();
        }
        let ranges = system.gluing().ranges();
        let weights = (0..ranges.total())
            .map(|r| f64::from(u8::from(!ranges.contact().contains(&r))))
            .collect();
        let factor = system
            .coarse()
            .factor_weighted(RowWeights::diagonal(weights))
            .unwrap();
        // Consistent right-hand sides are solved in spite of the free motions.
        let coarse = factor.coarse();
        let (mut s, mut x, mut e) = (
            coarse.scratch(),
            noise(coarse.dim(), 8),
            vec![0.0; coarse.rows()],
        );
        x[ranges.contact()].fill(0.0);
        coarse.apply(&x, &mut e, &mut s);
        let mut again = e.clone();
        factor.particular(&e, &mut x, &mut s);
        coarse.apply(&x, &mut again, &mut s);
        assert!(distance(&e, &again) < 1e-9 * norm(&e));
        assert!(factor.free_motions().len() < 6 || factor.orthonormal().is_none());
        factor.free_motions().len()
    };
    assert_eq!(free(&b.supports(), None, false), 0);
    assert_eq!(free(&[], None, false), 6);
    assert_eq!(free(&[], Some(false), false), 3);
    assert_eq!(free(&[], Some(true), false), 0);
    assert_eq!(free(&[], Some(true), true), 6);
    let line = Support::partial(vec![b.fixed[0]], Directions::All);
    assert_eq!(free(&[line], Some(true), true), 3);
    // A beam 200 times as long as thick in 200 subdomains.
    let mesh = brick::Brick::new([200.0, 1.0, 1.0], [400, 2, 2])
        .build()
        .unwrap();
    let decomposition = Decomposition::boxes(&mesh, [200, 1, 1]).unwrap();
    let supports = [Support::fixed(mesh.nodes_on(brick::X_MIN))];
    let system = TfetiBuilder::new(&mesh, &decomposition, &b.materials)
        .supports(&supports)
        .build()
        .unwrap();
    assert!(system.coarse_factor().free_motions().is_empty());
    assert!(system.coarse_factor().orthonormal().is_some());
}

#[test]
fn bad_systems_are_refused() {
    let b = Brick::new(1, 2);
    let other = Brick::new(1, 3);
    let error = TfetiBuilder::new(&b.mesh, &other.decomposition, &b.materials)
        .build()
        .unwrap_err();
    assert!(matches!(
        error,
        TfetiError::DecompositionMismatch { what: "nodes", .. }
    ));
    let settings = InverseSettings::default().with_memory_limit(10);
    let builder = TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials);
    assert!(matches!(
        builder.inverse(settings).build(),
        Err(TfetiError::Memory { limit: 10, .. })
    ));
    let settings = InverseSettings::default().with_expected_products(0);
    assert!(matches!(
        builder.inverse(settings).build(),
        Err(TfetiError::Setting {
            name: "expected_products",
            ..
        })
    ));
    let system = builder.build().unwrap();
    assert!(matches!(
        system.load_response(&[]),
        Err(TfetiError::Length { .. })
    ));
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
        system
            .coarse()
            .factor_weighted(RowWeights::diagonal(weights)),
        Err(TfetiError::Setting { .. })
    ));
}
