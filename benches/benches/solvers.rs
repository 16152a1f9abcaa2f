//! Criterion benches of solvers: one step of the brick.
//!
//! `cargo bench -p signorini-benches --bench solvers`; with `-- --test` everything runs once.
#![allow(missing_docs)]

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use signorini::prelude::*;
use signorini_benches::Failure;
use signorini_studies::brick::{Block, Loading};

fn steps(c: &mut Criterion) -> Result<(), Failure> {
    let mut group = c.benchmark_group("last of five steps of the brick");
    group.sample_size(10);
    let paper = Settings::default().with_method(Method::paper());
    let cases = [
        ("active-set", 1, Settings::default()),
        ("active-set", 2, Settings::default()),
        ("paper", 1, paper),
    ];
    for (name, n, settings) in cases {
        let start = || {
            let block = Block {
                steps: 5,
                ..Block::benchmark(n, Loading::B)
            };
            let mut simulation = Simulation::new(block.scene()?, settings.clone())?;
            for _ in 0..4 {
                simulation.step()?;
            }
            Ok::<_, Failure>(simulation)
        };
        drop(start()?);
        group.bench_function(format!("{name} method, n = {n}"), |b| {
            b.iter_batched(
                start,
                |simulation| {
                    let mut simulation = simulation.ok()?;
                    simulation.step().ok().map(|frame| frame.time())
                },
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
    Ok(())
}

fn all(c: &mut Criterion) {
    if let Err(error) = steps(c) {
        panic!("{error}");
    }
}

criterion_group!(benches, all);
criterion_main!(benches);
