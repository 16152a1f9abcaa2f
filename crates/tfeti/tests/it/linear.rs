//! Linear problems: agreement with a direct solve.

use crate::common::{Brick, distance, dot, norm};
use signorini_fem_mesh::{Decomposition, LoadDensity, assemble_load, brick};
use signorini_qp::SymmetricOperator;
use signorini_tfeti::{Motion, NodeSupport, Tfeti, TfetiBuilder};

/// Solves the linear problem (no contact) by projected conjugate gradients and returns the nodal displacement.
fn solve(decomposition: &Decomposition, system: &Tfeti, loads: &[Vec<f64>], offsets: &[f64]) -> (Vec<f64>, usize) {
    let response = system.load_response(loads).unwrap();
    let (f, factor) = (system.dual(), system.coarse_factor().unwrap());
    let (mut fs, mut cs) = (f.scratch(), factor.scratch());
    let dim = f.dim();
    let d: Vec<f64> = offsets.iter().zip(&response.dual).map(|(c, b)| c - b).collect();
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
    let [u, balance] = system
        .recover([Vec::new(), response.force.clone()], &lambda, &alpha)
        .unwrap();
    let mut rows = vec![0.0; dim];
    system.rows_times(&u, &mut rows);
    assert!(
        distance(&rows, offsets) < 1e-9 * norm(&u),
        "rows hold: {:e} after {iterations}",
        distance(&rows, offsets) / norm(&u)
    );
    // copies of a node move together
    let (mean, mut node) = (system.nodal_mean(&u), 0);
    let largest = mean.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    for subdomain in decomposition.subdomains() {
        for &n in &subdomain.nodes {
            let off = |c: usize| (u[3 * node + c] - mean[3 * n as usize + c]).abs();
            assert!((0..3).all(|c| off(c) < 1e-9 * largest));
            node += 1;
        }
    }
    let size = norm(&response.force).max(norm(&lambda));
    assert!(norm(&balance) < 1e-9 * size, "balance {:e}", norm(&balance) / size);
    (system.nodal_mean(&u), iterations)
}

/// Dense Cholesky-free reference: conjugate gradients on the undivided body with its supports eliminated.
fn direct(b: &Brick, prescribed: &dyn Fn(u32) -> Option<[f64; 3]>, loads: &LoadDensity) -> Vec<f64> {
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
    let precondition = |r: &[f64]| -> Vec<f64> { r.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
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
        let load = LoadDensity::Traction(brick::Z_MAX, [1.0e6, -2.0e6, -3.0e7]);
        let loads = assemble_load(&b.mesh, &b.decomposition, &load).unwrap();
        let reference = direct(&b, &|node| b.fixed.binary_search(&node).ok().map(|_| [0.0; 3]), &load);
        {
            let supports = b.supports();
            let system = TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials)
                .with_supports(&supports)
                .build()
                .unwrap();
            let (u, iterations) = solve(&b.decomposition, &system, &loads, &vec![0.0; system.dual_dim()]);
            let error = distance(&u, &reference) / norm(&reference);
            assert!(error < 1e-9, "n = {n}: {error:e} after {iterations}");
        }
    }
}

#[test]
fn prescribed_displacement_is_reached() {
    let b = Brick::new(1, 3);
    let pull = [1e-3, -5e-4, 2e-4];
    let right = b.mesh.nodes_on(brick::X_MAX);
    let supports = [
        NodeSupport::fixed(b.fixed.clone()),
        NodeSupport::fixed(right.clone()).with_motion(Motion::new(0, vec![pull])),
    ];
    let system = TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials)
        .with_supports(&supports)
        .build()
        .unwrap();
    let zero: Vec<Vec<f64>> = (0..system.subdomains())
        .map(|s| vec![0.0; system.torn_range(s).len()])
        .collect();
    let (u, _) = solve(
        &b.decomposition,
        &system,
        &zero,
        &system.prescribed_offsets(Vec::new(), &[(0, 2.0)]),
    );
    let none = LoadDensity::Body([0.0; 3]);
    let value = |node: u32| {
        let moved = right.binary_search(&node).ok().map(|_| pull.map(|v| 2.0 * v));
        moved.or_else(|| b.fixed.binary_search(&node).ok().map(|_| [0.0; 3]))
    };
    let reference = direct(&b, &value, &none);
    assert!(distance(&u, &reference) < 1e-9 * norm(&reference));
}
