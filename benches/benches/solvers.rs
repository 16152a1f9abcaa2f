//! Criterion benches of solvers: KPRGP on the obstacle string, and one step of the brick.
//!
//! `cargo bench -p signorini-benches --bench solvers`; with `-- --test` everything runs once.
#![allow(missing_docs)]

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use signorini::prelude::*;
use signorini::qp::kprgp::KprgpWorkspace;
use signorini::qp::{KprgpSettings, ProductSet, QuadraticCost, Segment, SymmetricOperator, kprgp};
use signorini_benches::Failure;
use signorini_studies::brick::{Block, Loading};
use std::f64::consts::PI;
use std::hint::black_box;

/// Tridiagonal (-1, 2, -1) between fixed ends.
struct FixedString(usize);

impl SymmetricOperator for FixedString {
    type Scratch = ();
    fn dim(&self) -> usize {
        self.0
    }
    fn scratch(&self) -> Self::Scratch {}
    fn apply(&self, x: &[f64], y: &mut [f64], _: &mut ()) {
        let n = self.0;
        for i in 0..n {
            let left = if i > 0 { x[i - 1] } else { 0.0 };
            let right = if i + 1 < n { x[i + 1] } else { 0.0 };
            y[i] = 2.0 * x[i] - left - right;
        }
    }
}

fn string(c: &mut Criterion) -> Result<(), Failure> {
    let n = 98;
    let h = 1.0 / (n as f64 + 1.0);
    let obstacle = |i: usize| (4.0 * PI * i as f64 * h - PI / 6.0).sin() / 2.0 - 2.0;
    let set = ProductSet::new(vec![Segment::lower((1..=n).map(obstacle).collect())])?;
    let (operator, b) = (FixedString(n), vec![-30.0 * h * h; n]);
    let mut work = KprgpWorkspace::new(&operator);
    let (settings, limit) = (KprgpSettings::default(), 1e-8);
    c.bench_function("KPRGP, obstacle string of 98 nodes", |bench| {
        bench.iter(|| {
            let mut x = vec![0.0; n];
            black_box(kprgp(
                &QuadraticCost::new(&operator, &b, 4.0),
                &set,
                limit,
                &settings,
                &mut x,
                &mut work,
            ))
        });
    });
    Ok(())
}

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
    for run in [string, steps] {
        if let Err(error) = run(c) {
            panic!("{error}");
        }
    }
}

criterion_group!(benches, all);
criterion_main!(benches);
