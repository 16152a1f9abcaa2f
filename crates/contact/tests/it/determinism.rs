//! The same bits for any number of threads and in every run.

use crate::common::*;

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("pool")
        .install(work)
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    for method in methods() {
        let run = |threads| with_threads(threads, || fingerprint(benchmark(up_down_up(), 5), by(method.clone())));
        let one = run(1);
        assert!(one.0.iter().all(|result| !result.is_empty()) && one.1.memory() > 0);
        for threads in [2, 3] {
            assert!(one == run(threads), "{}, {threads} threads", method.kind());
        }
    }
}

/// Large enough that all loops are cut: over boundaries, vectors and both sides of a cut of the coarse factor.
#[test]
fn threads_change_no_bit_where_every_loop_is_cut() {
    let mesh = block([3.0, 1.0, 1.0], [75, 25, 25]);
    let scene = loaded_brick(mesh, up_down_up())
        .with_contact(foundation(weakening()))
        .with_boxes([15, 5, 5])
        .with_analysis(paper_steps(1.0, 1));
    let run = |threads| {
        with_threads(threads, || {
            let settings = at(1e-3);
            let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
            let tfeti = simulation.tfeti();
            assert!(tfeti.dual_dim() >= signorini_qp::vector::PARALLEL);
            let classes = tfeti.report().classes.iter();
            assert!(classes.map(|c| c.members * c.boundary).sum::<usize>() >= 3 * 8000);
            let results: Vec<_> = rest(&mut simulation).iter().map(bits).collect();
            (results, simulation.state().clone())
        })
    };
    assert!(run(1) == run(2));
}

/// Subdomains that share nothing go through other code than translates.
#[test]
fn threads_change_no_bit_where_every_subdomain_is_different() {
    let scene = perturbed().with_boxes([6, 2, 2]);
    let run = |threads| with_threads(threads, || fingerprint(scene.clone(), Settings::default()));
    assert!(run(1) == run(2));
}

/// Contact between bodies, with partners that are looked for in parallel.
#[test]
fn threads_change_no_bit_between_bodies() {
    let lower = block([1.0; 3], [4; 3]);
    let mesh = with_second(&lower, &lifted(&lower, 1.0));
    let scene = Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::traction(second(brick::Z_MAX), [2e8, 0.0, -1e9]).with_history(up_down_up()))
        .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(weakening()))
        .with_boxes([2, 2, 4])
        .with_analysis(paper_steps(1.0, 4));
    let run = |threads| with_threads(threads, || fingerprint(scene.clone(), Settings::default()));
    let one = run(1);
    assert!(one.1.memory() > 10_000, "all numbers of the state");
    for threads in [2, 3] {
        assert!(one == run(threads), "{threads} threads");
    }
}

#[test]
fn every_run_gives_the_same_bits() {
    for method in methods() {
        let run = || fingerprint(small_benchmark(weakening(), 6), by(method.clone()));
        assert!(run() == run(), "{}", method.kind());
    }
}
