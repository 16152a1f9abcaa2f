//! The same bits for any number of threads, in every run, and after a restart.

use crate::common;
use crate::common::{
    benchmark, bits, methods, rest, small_benchmark, state_bits, step, up_down_up, weakening,
};
use signorini_contact::{
    Analysis, Contact, DifferenceFormula, Friction, Load, Method, Scene, Settings, Simulation,
    Support,
};
use signorini_fem_mesh::{FacetTag, brick};

/// Bits of all levels and of the state at the end.
fn fingerprint(scene: Scene, settings: Settings) -> (Vec<Vec<u64>>, String) {
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let levels = rest(&mut simulation).iter().map(bits).collect();
    (levels, state_bits(simulation.state()))
}

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("pool")
        .install(work)
}

fn settings(method: Method) -> Settings {
    Settings::default().with_method(method)
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    for method in methods() {
        let run = |threads| {
            with_threads(threads, || {
                fingerprint(benchmark(up_down_up(), 5), settings(method.clone()))
            })
        };
        let one = run(1);
        assert!(one.0.iter().all(|level| !level.is_empty()) && !one.1.is_empty());
        for threads in [2, 3] {
            assert!(one == run(threads), "{}, {threads} threads", method.name());
        }
    }
}

/// Large enough that all loops are cut: over boundaries, vectors and both sides of a cut of the coarse factor.
#[test]
fn threads_change_no_bit_where_every_loop_is_cut() {
    let mesh = common::block([3.0, 1.0, 1.0], [75, 25, 25]);
    let scene = common::loaded_brick(mesh, up_down_up())
        .with_contact(common::foundation(weakening()))
        .with_boxes([15, 5, 5])
        .with_analysis(common::paper_steps(1.0, 1));
    let run = |threads| {
        with_threads(threads, || {
            let settings = Settings::default().with_tolerance(1e-3);
            let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
            let tfeti = simulation.tfeti();
            assert!(tfeti.dual_dim() >= signorini_qp::vector::PARALLEL);
            let classes = tfeti.report().classes.iter();
            assert!(classes.map(|c| c.members * c.boundary).sum::<usize>() >= 3 * 8000);
            let levels: Vec<_> = rest(&mut simulation).iter().map(bits).collect();
            (levels, state_bits(simulation.state()))
        })
    };
    assert!(run(1) == run(2));
}

/// Subdomains that share nothing go through other code than translates.
#[test]
fn threads_change_no_bit_where_every_subdomain_is_different() {
    let mesh = signorini_fem_mesh::Brick::new([3.0, 1.0, 1.0], [12, 4, 4])
        .perturbed(0.1, 2)
        .build()
        .expect("brick");
    let scene = common::loaded_brick(mesh, up_down_up())
        .with_contact(common::foundation(weakening()))
        .with_boxes([6, 2, 2])
        .with_analysis(common::paper_steps(1.0, 3));
    let run = |threads| with_threads(threads, || fingerprint(scene.clone(), Settings::default()));
    assert!(run(1) == run(2));
}

/// Contact between bodies, with partners that are looked for in parallel.
#[test]
fn threads_change_no_bit_between_bodies() {
    let other = |tag: FacetTag| FacetTag(tag.0 + 100);
    let lower = common::block([1.0; 3], [4; 3]);
    let upper = lower
        .map_points(|[x, y, z]| [x, y, z + 1.0])
        .expect("moved");
    let mesh = lower.append(&upper.map_tags(other)).expect("two bodies");
    let scene = Scene::new(mesh, common::steel())
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::traction(other(brick::Z_MAX), [2e8, 0.0, -1e9]).with_history(up_down_up()))
        .with_contact(
            Contact::between(other(brick::Z_MIN), brick::Z_MAX).with_friction(weakening()),
        )
        .with_boxes([2, 2, 4])
        .with_analysis(common::paper_steps(1.0, 4));
    let run = |threads| with_threads(threads, || fingerprint(scene.clone(), Settings::default()));
    let one = run(1);
    assert!(one.1.len() > 10_000, "all numbers of the state");
    for threads in [2, 3] {
        assert!(one == run(threads), "{threads} threads");
    }
}

#[test]
fn every_run_gives_the_same_bits() {
    for method in methods() {
        let run = || fingerprint(small_benchmark(weakening(), 6), settings(method.clone()));
        assert!(run() == run(), "{}", method.name());
    }
}

#[test]
fn waiting_awake_changes_no_bit() {
    let run = |busy, threads| {
        let settings = settings(Method::default()).with_busy_waiting(busy);
        with_threads(threads, || {
            fingerprint(small_benchmark(weakening(), 6), settings)
        })
    };
    let expected = run(false, 1);
    for threads in 1..=3 {
        assert!(run(true, threads) == expected, "{threads} threads");
    }
}

#[test]
fn a_restart_equals_the_uninterrupted_run_bit_by_bit() {
    let laws = [
        Friction::None,
        Friction::tresca(3e8),
        Friction::coulomb(0.3),
        weakening(),
    ];
    for method in methods() {
        for law in &laws {
            let scene = || small_benchmark(law.clone(), 8);
            let (whole, end) = fingerprint(scene(), settings(method.clone()));
            for cut in [0, 1, 2, 5, 7] {
                let mut first = Simulation::new(scene(), settings(method.clone())).expect("set-up");
                for _ in 0..cut {
                    step(&mut first);
                }
                let state = first.state().clone();
                drop(first);
                let mut second =
                    Simulation::new(scene(), settings(method.clone())).expect("set-up");
                second.resume(state).expect("resume");
                let tail: Vec<_> = rest(&mut second).iter().map(bits).collect();
                let what = format!("{}, {law:?}, cut after {cut}", method.name());
                assert!(tail == whole[cut..], "{what}");
                assert!(state_bits(second.state()) == end, "{what}: state");
            }
        }
    }
}

/// A step that is cut in two after it was tried equals one that was small from the beginning.
#[test]
fn a_cut_step_retried_equals_the_small_steps() {
    for method in methods() {
        let at = |times: &[f64]| {
            small_benchmark(Friction::coulomb(0.3), 1).with_analysis(Analysis::Quasistatic {
                times: times.to_vec(),
                formula: DifferenceFormula::BACKWARD_EULER,
            })
        };
        let (coarse, fine) = (at(&[0.2, 0.4, 0.8, 1.0]), at(&[0.2, 0.4, 0.6, 0.8, 1.0]));
        let (expected, _) = fingerprint(fine.clone(), settings(method.clone()));
        let mut tried = Simulation::new(coarse, settings(method.clone())).expect("set-up");
        step(&mut tried);
        step(&mut tried);
        let before = tried.state().clone();
        let rejected = step(&mut tried);
        let mut retry = Simulation::new(fine, settings(method.clone())).expect("set-up");
        retry.resume(before).expect("resume");
        let tail: Vec<_> = rest(&mut retry).iter().map(bits).collect();
        assert!(tail == expected[2..], "{}", method.name());
        // and the large step was indeed another one
        assert!(bits(&rejected) != expected[3], "{}", method.name());
    }
}

/// A law that fails in the middle of a run: the error comes every time, and the run can go on once the law is well.
#[test]
fn a_law_that_fails_or_panics_leaves_the_run_as_it_was() {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    let mode = Arc::new(AtomicUsize::new(0));
    let inner = mode.clone();
    let law = signorini_contact::Coefficient::rate_field(move |_, _| {
        match inner.load(Ordering::Relaxed) {
            0 => 0.3,
            1 => f64::NAN,
            _ => panic!("a law of the user"),
        }
    });
    let scene = small_benchmark(Friction::Coulomb(law), 4);
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    assert!(simulation.frame().is_none(), "before the first level");
    step(&mut simulation);
    let before = state_bits(simulation.state());
    for kind in [1, 1, 2, 2] {
        mode.store(kind, Ordering::Relaxed);
        let outcome = catch_unwind(AssertUnwindSafe(|| simulation.step().is_err()));
        assert!(outcome.is_err() == (kind == 2) && outcome.unwrap_or(true));
        assert!(simulation.frame().is_none() && state_bits(simulation.state()) == before);
    }
    mode.store(0, Ordering::Relaxed);
    assert_eq!(rest(&mut simulation).len(), 3);
    assert!(simulation.frame().is_some());
}
