//! The projector by two levels: exact, symmetric in its two forms, and small where subdomains are translates.

use crate::common::{Brick, distance, noise, norm};
use signorini_qp::EqualityProjector;
use signorini_qp::vector::dot;
use signorini_tfeti::internal::ActiveSetFactor;
use signorini_tfeti::{ActiveSetProjector, Tfeti};

fn space(system: &Tfeti, kind: ActiveSetFactor) -> ActiveSetProjector {
    let contact = system.gluing().ranges().contact().end;
    ActiveSetProjector::with_factor(system.coarse(), contact, None, kind).unwrap()
}

/// Weights of an active set: about that share of the contact rows is free.
fn active_set(system: &Tfeti, share: f64, seed: u64) -> Vec<f64> {
    let contact = system.gluing().ranges().contact().end;
    let mut w = vec![1.0; system.dual_dim()];
    for (w, v) in w[..contact].iter_mut().zip(noise(contact, seed)) {
        *w = f64::from(u8::from(0.5 * (v + 1.0) < share));
    }
    w
}

fn off(system: &Tfeti, x: &[f64], e: &[f64]) -> f64 {
    let (coarse, mut g) = (system.coarse(), vec![0.0; e.len()]);
    coarse.apply(x, &mut g, &mut coarse.scratch());
    distance(&g, e) / norm(x)
}

#[test]
fn it_is_a_projector_that_changes_free_rows_only() {
    // translates, cut in a grid; the last has no two subdomains that are alike
    for b in [Brick::new(2, 2), Brick::new(4, 1), Brick::of(3, 2, 0.1)] {
        let system = b.system();
        let contact = system.gluing().ranges().contact().end;
        let mut space = space(&system, ActiveSetFactor::Levels);
        let (x, y, e) = (
            noise(system.dual_dim(), 5),
            noise(system.dual_dim(), 6),
            noise(system.coarse().rows(), 7),
        );
        for (share, seed) in [(0.5, 1), (1.0, 2), (0.02, 3)] {
            let w = active_set(&system, share, seed);
            assert_eq!(space.set_weights(&w), Ok(true));
            let mut p = x.clone();
            space.project(&mut p);
            assert!(off(&system, &p, &vec![0.0; e.len()]) < 1e-12);
            for k in (0..contact).filter(|&k| w[k] == 0.0) {
                assert_eq!(p[k], x[k]);
            }
            let mut again = p.clone();
            space.project(&mut again);
            assert!(distance(&again, &p) < 1e-11 * norm(&p));
            // (P x) y = x (P^T y)
            let mut t = y.clone();
            space.project_transpose(&mut t);
            let size = norm(&x) * norm(&t) + norm(&p) * norm(&y);
            assert!((dot(&p, &y) - dot(&x, &t)).abs() < 1e-12 * size);
            // the amplitudes are those of the residual
            let mut alpha = e.clone();
            space.amplitudes(&y, &mut alpha);
            let mut motion = vec![0.0; y.len()];
            system
                .coarse()
                .apply_transpose(&alpha, &mut motion, &mut system.coarse().scratch());
            motion.iter_mut().zip(&y).for_each(|(m, y)| *m += y);
            assert!(distance(&motion, &t) < 1e-11 * norm(&t));
            for work in [ActiveSetProjector::balance, ActiveSetProjector::repair] {
                let mut b = x.clone();
                work(&mut space, &mut b, &e);
                assert!(off(&system, &b, &e) < 1e-12);
            }
        }
    }
}

/// The factor of the rows that are always free, of equal regions once, solves as the sparse factor does.
#[test]
fn equal_regions_are_eliminated_once_and_the_solution_is_that_of_the_whole() {
    let system = Brick::new(5, 1).system();
    let (mut levels, mut sparse) = (
        space(&system, ActiveSetFactor::Levels),
        space(&system, ActiveSetFactor::Sparse),
    );
    let (x, e) = (noise(system.dual_dim(), 5), noise(system.coarse().rows(), 6));
    let (mut a, mut b) = (x.clone(), x);
    levels.repair(&mut a, &e);
    sparse.repair(&mut b, &e);
    assert!(distance(&a, &b) < 1e-12 * norm(&b));
    let (shared, whole) = (levels.factor().stored(), sparse.factor().stored());
    // each tile is kept twice, once rounded
    assert!(2 * shared < 3 * whole, "{shared} of {whole}");
}

#[test]
fn threads_change_no_bit() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let system = Brick::new(4, 1).system();
            let mut space = space(&system, ActiveSetFactor::Levels);
            space.set_weights(&active_set(&system, 0.5, 1)).unwrap();
            let mut x = noise(system.dual_dim(), 5);
            space.project_step(&mut x);
            space.project_step_transpose(&mut x);
            x
        })
    };
    assert!(run(1).iter().zip(&run(2)).all(|(a, b)| a.to_bits() == b.to_bits()));
}
