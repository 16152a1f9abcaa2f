//! Several processes, here threads, solve a scene together: the same bits, each with its part of the matrices.

use crate::common::*;
use signorini_tfeti::internal::on_ranks;
use signorini_tfeti::{CommunicationError, Communicator, Traffic};
use std::sync::Arc;

/// Bits of all steps with their counters and estimates, the state at the end, bytes of inverses, and the traffic.
pub(crate) type Run = (Vec<(Vec<u64>, Counters, AlgebraicError)>, State, u64, Traffic);

fn solved(scene: &Scene, settings: Settings) -> Run {
    let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
    let mut steps = Vec::new();
    while !simulation.is_finished() {
        let own = step(&mut simulation);
        let result = simulation.result().expect("a step");
        steps.push((bits(&own), result.report().counters, result.algebraic_error()));
    }
    let tfeti = simulation.tfeti();
    let bytes = tfeti.report().inverse_bytes;
    (steps, simulation.state().clone(), bytes, tfeti.traffic())
}

/// Runs of 1, 2, 3 and 4 ranks, of which all ranks have the same bits as one process; by rank.
pub(crate) fn the_same_on(ranks: &[usize], scene: &Scene, settings: Settings, what: &str) -> Vec<Vec<Run>> {
    let plain = solved(scene, settings.clone());
    assert_eq!(plain.3, Traffic::default(), "{what}: one process sends nothing");
    let run = |&count: &usize| {
        let all = on_ranks(count, |c| solved(scene, settings.clone().with_communicator(c)));
        let all: Vec<Run> = all.into_iter().map(|run| run.expect("no panic")).collect();
        for (rank, run) in all.iter().enumerate() {
            assert!(run.0 == plain.0 && run.1 == plain.1, "{what}: rank {rank} of {count}");
        }
        all
    };
    ranks.iter().map(run).collect()
}

/// The benchmark of 50 steps, and its products as they have always been.
#[test]
fn the_benchmark_has_the_same_bits_on_any_number_of_ranks() {
    let scene = benchmark(ramp(), 50);
    let runs = the_same_on(&[1, 2, 3, 4], &scene, Settings::default(), "benchmark");
    let products: usize = runs[1][0].0.iter().map(|(_, counters, _)| counters.products).sum();
    assert_eq!(products, 639);
}

/// A part cut along its graph: no two subdomains share matrices, each rank holds its own.
#[test]
fn parts_have_the_same_bits_and_each_rank_its_matrices() {
    let scene = perturbed().with_subdomains(13);
    for preconditioner in [Preconditioner::Lumped, Preconditioner::Dirichlet] {
        let settings = Settings::default().with_preconditioner(preconditioner);
        let whole = solved(&scene, settings.clone()).2;
        let runs = the_same_on(&[2, 3, 4], &scene, settings, "parts");
        for all in runs {
            let shares: Vec<u64> = all.iter().map(|run| run.2).collect();
            assert_eq!(shares.iter().sum::<u64>(), whole, "nothing is held twice");
            let largest = shares.iter().max().expect("ranks");
            assert!(
                *largest as f64 <= 1.35 * whole as f64 / shares.len() as f64,
                "{shares:?}"
            );
        }
    }
}

#[test]
fn other_scenes_and_methods_have_the_same_bits() {
    let mesh = |cells: [usize; 3]| {
        Brick::new([3.0, 1.0, 1.0], cells)
            .perturbed(0.1, 2)
            .build()
            .expect("brick")
    };
    let paper = small_benchmark(weakening(), 3).with_subdomains(7);
    for method in [Method::paper(), Method::one_loop()] {
        the_same_on(&[2, 3], &paper, by(method), "the paper's methods");
    }
    let linear = loaded_brick(mesh([9, 3, 3]), ramp()).with_subdomains(9);
    the_same_on(&[2, 4], &linear, Settings::default(), "linear");
    let held = linear.with_support(Support::components(brick::Z_MIN, [false, false, true]));
    the_same_on(&[2, 3], &held, Settings::default(), "held across the cuts");
    let quadratic = loaded_brick(mesh([6, 2, 2]).raise_order().expect("quadratic"), ramp())
        .with_contact(foundation(Friction::coulomb(0.3)))
        .with_subdomains(6);
    the_same_on(&[2, 3], &quadratic, Settings::default(), "quadratic");
    let balanced = Settings::default().with_accuracy(Accuracy::Balanced { fraction: 0.1 });
    the_same_on(
        &[2],
        &small_benchmark(weakening(), 2).with_subdomains(5),
        balanced,
        "balanced accuracy",
    );
    // two bodies whose meshes do not match
    let bodies = with_second(&block([1.0; 3], [3; 3]), &lifted(&block([1.0; 3], [4; 3]), 1.0));
    let bodies = Scene::new(bodies, steel())
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::traction(second(brick::Z_MAX), [2e8, 0.0, -1e9]).with_history(up_down_up()))
        .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(weakening()))
        .with_subdomains(10)
        .with_analysis(paper_steps(1.0, 3));
    the_same_on(&[2, 3, 4], &bodies, Settings::default(), "bodies");
    // one body between plates that close, where nothing tells the size of forces; another whose load is on one rank
    let plate = |tag, way| Contact::rigid(tag).with_motion([0.0, 0.0, way], ramp());
    let squeezed = with_second(&block([1.0; 3], [3; 3]), &lifted(&block([1.0; 3], [3; 3]), 3.0));
    let squeezed = Scene::new(squeezed, steel())
        .with_contact(plate(brick::Z_MIN, 0.0))
        .with_contact(plate(brick::Z_MAX, -1e-3))
        .with_support(Support::fixed(second(brick::Z_MIN)))
        .with_subdomains(8)
        .with_analysis(paper_steps(1.0, 2));
    let pulled = Load::traction(second(brick::Z_MAX), [1e6, 0.0, 0.0]).with_history(ramp());
    the_same_on(&[2, 3], &squeezed, Settings::default(), "nothing but motions");
    the_same_on(
        &[2, 3],
        &squeezed.with_load(pulled),
        Settings::default(),
        "a load on one rank",
    );
}

/// Exchanges of a step: for each product, preconditioning, projection and dot product one.
#[test]
fn a_step_tells_the_other_rank_little() {
    let scene = small_benchmark(weakening(), 2).with_subdomains(6);
    let runs = on_ranks(2, |communicator| {
        let settings = Settings::default().with_communicator(communicator);
        let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
        let before = simulation.tfeti().traffic();
        let counters = step(&mut simulation).report.counters;
        let tfeti = simulation.tfeti();
        (
            before,
            tfeti.traffic(),
            counters,
            8 * (tfeti.dual_dim() + tfeti.torn_dim()),
        )
    });
    let [first, second] = [0, 1].map(|rank| runs[rank].expect("no panic"));
    let (before, after, counters, whole) = first;
    let applied = (counters.products + counters.preconditionings) as u64;
    let exchanges = after.exchanges - before.exchanges;
    assert!(
        (3 * applied..5 * applied).contains(&exchanges),
        "{exchanges} for {applied}"
    );
    // besides, whole vectors: multipliers and their product, displacements
    let bytes = after.sent + after.received - before.sent - before.received;
    assert!(bytes < (applied + 2) * whole as u64, "{bytes} of {whole}");
    assert_eq!((second.1.sent, second.1.received), (after.received, after.sent));
}

/// A rank that ends before the others is an error on those, soon and named; so is a rank with another scene.
#[test]
fn a_rank_that_is_lost_ends_the_others() {
    let scene = small_benchmark(weakening(), 4).with_subdomains(6);
    let lost = |ranks: usize, method: &Method, work: &(dyn Fn(usize, &mut Simulation) + Sync)| {
        on_ranks(ranks, |c| {
            let rank = c.rank();
            let settings = by(method.clone()).with_communicator(c);
            let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
            work(rank, &mut simulation);
            simulation.run(&mut Silent).expect_err("lost").to_string()
        })
    };
    for method in methods() {
        let found = lost(3, &method, &|rank, simulation| {
            let _ = simulation.step().expect("step");
            assert!(rank != 1, "this rank dies");
        });
        assert_eq!(found[1], None);
        for rank in [0, 2] {
            let error = found[rank].as_ref().expect("an error, not a panic");
            assert!(
                error.starts_with("rank ") && error.contains("has ended before the others"),
                "{error}"
            );
        }
    }
    // out of step: one rank has solved a step more
    let found = on_ranks(2, |c| {
        let wide = if c.rank() == 0 { 6 } else { 7 };
        let scene = small_benchmark(weakening(), 1).with_subdomains(wide);
        Simulation::new(scene, Settings::default().with_communicator(c)).map(|_| ())
    });
    let error = found.into_iter().flatten().find_map(Result::err).expect("an error");
    assert!(matches!(
        error,
        ContactError::Tfeti(signorini_tfeti::TfetiError::Communication(
            CommunicationError::OutOfStep { .. } | CommunicationError::Lost { .. }
        ))
    ));
}

/// What an observer of any rank wants is what all do.
#[test]
fn ranks_stop_and_fail_together() {
    let scene = small_benchmark(weakening(), 4);
    let run = |wish: fn() -> Flow| {
        on_ranks(3, |c: Arc<dyn Communicator>| {
            let rank = c.rank();
            let settings = Settings::default().with_communicator(c);
            let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
            let mut observer = |r: &StepResult| match (rank, r.step()) {
                (2, 1) => wish(),
                _ => Flow::Continue,
            };
            let first = simulation.run(&mut observer).map(|report| report.stopped);
            let rest = simulation.run(&mut Silent).expect("goes on");
            assert_eq!(rest.steps, 2);
            first.map_err(|e| e.to_string())
        })
    };
    assert!(run(|| Flow::Stop).into_iter().all(|stopped| stopped == Some(Ok(true))));
    let failed = run(|| Flow::Fail("the disk is full".into()));
    for (rank, error) in failed.into_iter().enumerate() {
        let error = error.expect("no panic").expect_err("failed");
        let expected = if rank == 2 { "the disk is full" } else { "that of rank 2 failed" };
        assert!(error.contains(expected), "{error}");
    }
}
