//! With work memory made before, products, preconditioners and projectors allocate nothing.
//!
//! The counter sees the calling thread only, and a parallel loop may make it wait on others: the systems are small
//! enough that everything stays on the calling thread.

use common::{Brick, build, noise};
#[path = "it/common.rs"]
#[allow(dead_code)]
mod common;

use allocation_counter::measure;
use signorini_qp::active_set::{ActiveSetPoint, ActiveSetProblem, ActiveSetWorkspace};
use signorini_qp::{
    ActiveSetSettings, Equality, EqualityProjector, MovingSet, ProductSet, Segment, SymmetricOperator, active_set,
};
use signorini_tfeti::ActiveSetProjector;
use signorini_tfeti::internal::{ActiveSetFactor, InverseKind};

#[test]
fn products_and_projectors_allocate_nothing() {
    let b = Brick::of(1, 3, 0.1);
    for (kind, sharing) in [(InverseKind::Dense, true), (InverseKind::Sparse, false)] {
        let system = build(&b, kind, sharing);
        let (f, x) = (system.dual(), noise(system.dual_dim(), 1));
        let (mut y, mut s) = (x.clone(), f.scratch());
        assert_eq!(measure(|| f.apply(&x, &mut y, &mut s)).count_total, 0);
        for m in [system.lumped().unwrap(), system.dirichlet().unwrap()] {
            let mut s = m.scratch();
            assert_eq!(measure(|| m.apply(&x, &mut y, &mut s)).count_total, 0);
        }
        let c = system.coarse_factor().unwrap().orthonormal().unwrap();
        let (mut s, mut beta) = (c.scratch(), noise(c.rows(), 2));
        let count = measure(|| {
            c.apply(&x, &mut beta, &mut s);
            c.apply_transpose(&beta, &mut y, &mut s);
        });
        assert_eq!(count.count_total, 0);
        let contact = system.gluing().ranges().contact().end;
        for kind in [ActiveSetFactor::Split, ActiveSetFactor::Sparse] {
            let mut space = ActiveSetProjector::with_factor(system.coarse(), contact, None, kind).unwrap();
            let count = measure(|| {
                space.project(&mut y);
                space.project_transpose(&mut y);
                space.amplitudes(&x, &mut beta);
                space.repair(&mut y, &beta);
                space.compensate(&x, &x[..contact], &mut y);
            });
            assert_eq!(count.count_total, 0, "{kind:?}");
        }
    }
}

/// Conjugate gradients on one active set: what a run allocates does not grow with its iterations.
#[test]
fn iterations_of_the_active_set_method_allocate_nothing() {
    let b = Brick::new(1, 3);
    let system = b.system();
    let (n, contact) = (system.dual_dim(), system.gluing().ranges().contact().end);
    let response = system.load_response(&b.loads()).unwrap();
    let lumped = system.lumped().unwrap();
    let (linear, scale) = (noise(n, 3), vec![1.0; n]);
    let problem = ActiveSetProblem {
        operator: system.dual(),
        preconditioner: &lumped,
        scale: &scale,
        linear: &linear,
        rhs: &response.coarse,
    };
    let run = |products: usize| {
        let mut space = ActiveSetProjector::new(system.coarse(), contact, None).unwrap();
        let mut work = ActiveSetWorkspace::new(system.dual(), &lumped);
        let mut set = ProductSet::new(vec![Segment::Free(n)]).unwrap();
        let (mut x, mut ax) = (vec![0.0; n], vec![0.0; n]);
        let settings = ActiveSetSettings::default()
            .with_tolerance(1e-12)
            .with_forcing(1e-10)
            .with_max_products(products);
        let mut steps = 0;
        let count = measure(|| {
            let (x, ax, known) = (&mut x[..], &mut ax[..], false);
            let (set, point) = (MovingSet::fixed(&mut set), ActiveSetPoint { x, ax, known });
            let report = active_set(&problem, &mut space, set, point, &settings, &mut work);
            steps = report.unwrap().cg_steps;
        });
        (steps, count.count_total)
    };
    // The first run also fills tables of the dense kernels.
    run(4);
    let (few, many) = (run(4), run(14));
    assert!(many.0 >= few.0 + 8, "{few:?} {many:?}");
    assert_eq!(few.1, many.1);
}
