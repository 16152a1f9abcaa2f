//! Steps of an iteration are projected with a factor in single precision: what that changes, and where it is not done.

use crate::common::{Brick, distance, noise, norm};
use signorini_qp::EqualityProjector;
use signorini_tfeti::internal::ActiveSetFactor;
use signorini_tfeti::{ActiveSetProjector, Tfeti};

fn system(brick: &Brick) -> Tfeti {
    brick.system()
}

fn space(system: &Tfeti, kind: ActiveSetFactor) -> ActiveSetProjector {
    let contact = system.gluing().ranges().contact().end;
    ActiveSetProjector::with_factor(system.coarse(), contact, None, kind).unwrap()
}

/// Every third contact row is held.
fn active_set(system: &Tfeti) -> Vec<f64> {
    let contact = system.gluing().ranges().contact().end;
    let free = |row: usize| row >= contact || !row.is_multiple_of(3);
    (0..system.dual_dim())
        .map(|row| f64::from(u8::from(free(row))))
        .collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn steps_are_rounded_symmetric_and_close_to_the_projector() {
    let system = system(&Brick::new(4, 2));
    let mut space = space(&system, ActiveSetFactor::Split);
    assert!(space.rounds_steps());
    space.set_weights(&active_set(&system)).unwrap();
    let (x, y) = (noise(system.dual_dim(), 1), noise(system.dual_dim(), 2));
    let (mut exact, mut step) = (x.clone(), x.clone());
    space.project(&mut exact);
    space.project_step(&mut step);
    let off = distance(&exact, &step) / norm(&exact);
    assert!(off > 1e-10 && off < 1e-6, "{off:e}");
    let mut transposed = y.clone();
    space.project_step_transpose(&mut transposed);
    let (a, b) = (dot(&step, &y), dot(&x, &transposed));
    assert!((a - b).abs() < 1e-13 * norm(&x) * norm(&y), "{a} {b}");
    // the multiplier and repairs keep all digits
    let e = noise(system.coarse().rows(), 3);
    let mut repaired = x.clone();
    space.repair(&mut repaired, &e);
    let mut found = e.clone();
    system
        .coarse()
        .apply(&repaired, &mut found, &mut system.coarse().scratch());
    assert!(distance(&found, &e) < 1e-12 * norm(&e));
}

#[test]
fn a_sparse_factor_rounds_nothing() {
    let system = system(&Brick::new(2, 3));
    let contact = system.gluing().ranges().contact().end;
    let x = noise(system.dual_dim(), 1);
    {
        let mut space = space(&system, ActiveSetFactor::Sparse);
        assert!(!space.rounds_steps());
        let (mut exact, mut step) = (x.clone(), x.clone());
        space.project(&mut exact);
        space.project_step(&mut step);
        assert_eq!(exact, step);
        space.project_transpose(&mut exact);
        space.project_step_transpose(&mut step);
        assert_eq!(exact, step);
        let (mut part, mut repaired) = (x.clone(), x.clone());
        repaired[contact..].fill(0.0);
        space.compensate(&vec![0.0; x.len()], &x[..contact], &mut part);
        space.repair(&mut repaired, &vec![0.0; system.coarse().rows()]);
        assert!(distance(&part, &repaired) < 1e-12 * norm(&repaired));
    }
}

/// Rows of very different weights make the matrix so badly conditioned that rounding its factor shows.
#[test]
fn a_badly_conditioned_factor_is_not_rounded() {
    let system = system(&Brick::new(4, 2));
    let contact = system.gluing().ranges().contact().end;
    let space = |least: f64| {
        let weight = |row: usize| if row.is_multiple_of(7) { 1.0 } else { least };
        let metric: Vec<f64> = (0..system.dual_dim()).map(weight).collect();
        ActiveSetProjector::with_factor(system.coarse(), contact, Some(metric), ActiveSetFactor::Split).unwrap()
    };
    assert!(space(0.5).rounds_steps());
    // supports next to nothing: the body all but floats
    let supports = system.gluing().ranges().dirichlet.clone();
    let metric = (0..system.dual_dim()).map(|row| if supports.contains(&row) { 1e-9 } else { 1.0 });
    let loose =
        ActiveSetProjector::with_factor(system.coarse(), contact, Some(metric.collect()), ActiveSetFactor::Split);
    assert!(!loose.unwrap().rounds_steps());
}
