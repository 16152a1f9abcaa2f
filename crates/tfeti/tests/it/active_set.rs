//! The split coarse factor of the projector gives the projectors of the full one.

use crate::common::{Brick, distance, noise, norm};
use signorini_fem_mesh::Decomposition;
use signorini_qp::{EqualityProjector, QpError};
use signorini_tfeti::internal::ActiveSetFactor;
use signorini_tfeti::{ActiveSetProjector, CoarseFactor, NodeSupport, Tfeti, TfetiBuilder};
use std::ops::{Deref, DerefMut};

fn system(n: usize, cells: usize) -> Tfeti {
    let b = Brick::new(n, cells);
    b.system()
}

/// A projector and the factor of its repairs.
struct Space(ActiveSetProjector, CoarseFactor);

impl Space {
    fn new(system: &Tfeti, rows: usize, kind: ActiveSetFactor, metric: Option<Vec<f64>>) -> Self {
        let space = ActiveSetProjector::with_factor(system.coarse(), rows, metric, kind).unwrap();
        let always = space.factor().clone();
        Self(space, always)
    }
}

impl Deref for Space {
    type Target = ActiveSetProjector;

    fn deref(&self) -> &ActiveSetProjector {
        &self.0
    }
}

impl DerefMut for Space {
    fn deref_mut(&mut self) -> &mut ActiveSetProjector {
        &mut self.0
    }
}

fn space(system: &Tfeti, kind: ActiveSetFactor, metric: Option<Vec<f64>>) -> Space {
    Space::new(system, system.gluing().ranges().contact().end, kind, metric)
}

/// Weights of an active set: a share of the contact rows is free.
fn active_set(system: &Tfeti, share: f64, seed: u64) -> Vec<f64> {
    let contact = system.gluing().ranges().contact().end;
    let mut w = vec![1.0; system.dual_dim()];
    for (w, v) in w[..contact].iter_mut().zip(noise(contact, seed)) {
        *w = f64::from(u8::from(0.5 * (v + 1.0) < share));
    }
    w
}

/// All that a projector does, as one list of vectors.
fn results(system: &Tfeti, space: &mut Space) -> Vec<Vec<f64>> {
    let (x, e) = (noise(system.dual_dim(), 5), noise(system.coarse().rows(), 6));
    let (mut p, mut t, mut r) = (x.clone(), x.clone(), x.clone());
    let mut alpha = e.clone();
    space.project(&mut p);
    space.project_transpose(&mut t);
    space.amplitudes(&x, &mut alpha);
    if !space.loose().is_empty() {
        // what repairs cannot do is not compared
        return vec![p, t, alpha];
    }
    space.repair(&mut r, &e);
    // the leading rows of x, zero behind them, brought back to the kernel of G
    let contact = system.gluing().ranges().contact().end;
    let mut parts = [contact, contact / 2].map(|count| {
        let (zero, mut part) = (vec![0.0; x.len()], x.clone());
        let always = &space.1;
        always.compensate(&zero, &x[..count], &mut part, &mut always.scratch());
        part
    });
    for (part, count) in parts.iter().zip([contact, contact / 2]) {
        let mut repaired = x.clone();
        repaired[count..].fill(0.0);
        space.repair(&mut repaired, &vec![0.0; e.len()]);
        assert!(distance(part, &repaired) <= 1e-12 * norm(&repaired));
    }
    let [a, b] = parts.each_mut().map(std::mem::take);
    vec![p, t, alpha, r, a, b]
}

fn compare(system: &Tfeti, a: &mut Space, b: &mut Space) {
    for (x, y) in results(system, a).iter().zip(&results(system, b)) {
        assert!(distance(x, y) < 1e-12 * norm(y), "{}", distance(x, y) / norm(y));
    }
}

#[test]
fn projectors_agree_with_the_full_factor() {
    // All subdomains carry contact rows (n = 1), some do, and enough do not that these are cut in two halves.
    for (n, cells) in [(1, 3), (2, 3), (4, 1)] {
        let system = system(n, cells);
        let mut split = space(&system, ActiveSetFactor::Split, None);
        let mut sparse = space(&system, ActiveSetFactor::Sparse, None);
        compare(&system, &mut split, &mut sparse);
        for (share, seed) in [(0.5, 1), (0.5, 2), (0.02, 3), (1.0, 4), (0.0, 5)] {
            let w = active_set(&system, share, seed);
            assert_eq!(split.set_weights(&w), sparse.set_weights(&w));
            assert_eq!(split.set_weights(&w), Ok(false), "the same set again");
            compare(&system, &mut split, &mut sparse);
        }
        // Weights of rows that no active set holds are served as well.
        let mut w = active_set(&system, 0.3, 6);
        let last = w.len() - 1;
        w[last] = 0.5;
        w[last / 2] = 0.25;
        assert_eq!(split.set_weights(&w), Ok(true));
        assert_eq!(sparse.set_weights(&w), Ok(true));
        compare(&system, &mut split, &mut sparse);
    }
}

#[test]
fn repairs_do_all_but_loose_modes() {
    let b = Brick::new(2, 3);
    for (supports, count) in [
        (vec![], 6),
        (vec![NodeSupport::fixed(vec![b.fixed[0]])], 3),
        (vec![NodeSupport::fixed(b.fixed.clone())], 0),
    ] {
        let contact = b.contact(true);
        let system = TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials)
            .with_supports(&supports)
            .with_contact(&contact)
            .build()
            .unwrap();
        let mut space = space(&system, ActiveSetFactor::Auto, None);
        assert_eq!(space.loose().len(), count);
        let (x, e) = (noise(system.dual_dim(), 5), noise(system.coarse().rows(), 6));
        let mut repaired = x.clone();
        space.repair(&mut repaired, &e);
        let rows = system.gluing().ranges().contact().end;
        assert_eq!(x[..rows], repaired[..rows]);
        // G x - e has no part outside of the loose modes, and z (G x) is what the mode's row says
        let mut left = vec![0.0; e.len()];
        let mut scratch = system.coarse().scratch();
        system.coarse().apply(&repaired, &mut left, &mut scratch);
        for mode in space.loose() {
            let along: f64 = left.iter().zip(&mode.amplitudes).map(|(g, a)| g * a).sum();
            let row: f64 = mode.row.iter().map(|(i, c)| x[*i] * c).sum();
            assert!((along - row).abs() <= 1e-10 * norm(&left), "{along} {row}");
        }
        if count == 0 {
            assert!(distance(&left, &e) <= 1e-10 * norm(&e));
        }
    }
}

#[test]
fn a_metric_of_the_rows_is_kept() {
    let system = system(2, 3);
    let metric: Vec<f64> = noise(system.dual_dim(), 9).iter().map(|v| 0.6 + 0.4 * v).collect();
    let mut split = space(&system, ActiveSetFactor::Split, Some(metric.clone()));
    let mut sparse = space(&system, ActiveSetFactor::Sparse, Some(metric));
    for (share, seed) in [(0.5, 1), (0.1, 2)] {
        let w = active_set(&system, share, seed);
        assert_eq!(split.set_weights(&w), sparse.set_weights(&w));
        compare(&system, &mut split, &mut sparse);
    }
}

#[test]
fn one_subdomain_and_no_or_only_contact() {
    // All three subdomains of the first brick touch the floor.
    let (few, many) = (system(1, 3), system(3, 2));
    let b = Brick::new(1, 3);
    let (supports, contact) = (b.supports(), b.contact(true));
    let one = TfetiBuilder::new(&b.mesh, &Decomposition::whole(&b.mesh), &b.materials)
        .with_supports(&supports)
        .with_contact(&contact)
        .build()
        .unwrap();
    for system in [&few, &many, &one] {
        let all = system.gluing().ranges().contact().end;
        for rows in [0, all] {
            let new = |kind| Space::new(system, rows, kind, None);
            let (mut split, mut sparse) = (new(ActiveSetFactor::Split), new(ActiveSetFactor::Sparse));
            compare(system, &mut split, &mut sparse);
            let w = match rows {
                0 => vec![1.0; system.dual_dim()],
                _ => active_set(system, 0.5, 4),
            };
            assert_eq!(split.set_weights(&w), sparse.set_weights(&w));
            compare(system, &mut split, &mut sparse);
        }
    }
}

#[test]
fn the_last_set_leaves_no_trace() {
    let system = system(2, 3);
    let w = active_set(&system, 0.4, 7);
    let mut fresh = space(&system, ActiveSetFactor::Split, None);
    fresh.set_weights(&w).unwrap();
    let mut used = space(&system, ActiveSetFactor::Split, None);
    for seed in 10..14 {
        used.set_weights(&active_set(&system, 0.7, seed)).unwrap();
    }
    used.set_weights(&w).unwrap();
    assert_eq!(results(&system, &mut fresh), results(&system, &mut used));
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    // Large enough that all loops and both halves run in parallel.
    let system = system(5, 3);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut space = space(&system, ActiveSetFactor::Split, None);
            space.set_weights(&active_set(&system, 0.5, 3)).unwrap();
            // both sides of the first cut read enough for a thread each
            assert!(space.factor().stored() >= 8 * 25_000);
            results(&system, &mut space)
        })
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(3));
}

#[test]
fn a_body_held_by_contact_only_is_deficient_on_open_sets() {
    let b = Brick::new(2, 3);
    for supports in [vec![], vec![NodeSupport::fixed(vec![b.fixed[0]])]] {
        let contact = b.contact(true);
        let system = TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials)
            .with_supports(&supports)
            .with_contact(&contact)
            .build()
            .unwrap();
        let mut split = space(&system, ActiveSetFactor::Split, None);
        let mut sparse = space(&system, ActiveSetFactor::Sparse, None);
        let e = noise(system.coarse().rows(), 3);
        let closed = active_set(&system, 0.6, 1);
        let open = active_set(&system, 0.0, 1);
        for space in [&mut split, &mut sparse] {
            space.set_coarse_rhs(&e);
            assert_eq!(space.set_weights(&closed), Ok(true));
            assert!(matches!(space.set_weights(&open), Err(QpError::CoarseDeficient { .. })));
            assert_eq!(space.set_weights(&active_set(&system, 0.5, 2)), Ok(true));
        }
        compare(&system, &mut split, &mut sparse);
    }
}
