//! How close the kernels are to what the machine can do, measured in the same run.
//!
//! - one product with `F` over the best dense matrix product of the same number of operations,
//! - projectors and vector work as a share of an iteration (with the product and the preconditioner),
//! - for subdomains that share nothing: one product over the time to stream their factors or blocks once.
//!
//! `cargo bench -p signorini-benches --bench ratios`; with `-- --test` everything runs once and the figures mean
//! nothing.

use signorini::qp::{EqualityProjector, SymmetricOperator, vector};
use signorini::tfeti::internal::InverseKind;
use signorini::tfeti::{ActiveSetProjector, Tfeti};
use signorini_benches::{Body, Failure, MEMORY, gemm, seconds, triad, wave};

fn product(quick: bool, system: &Tfeti, threads: usize) -> Result<f64, Failure> {
    let f = system.dual();
    let (x, mut y, mut scratch) = (wave(f.dim()), wave(f.dim()), f.scratch());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    Ok(pool.install(|| seconds(quick, || f.apply(&x, &mut y, &mut scratch))))
}

/// Seconds of the lumped preconditioner, of both projectors and of the vector work of an iteration, of what a step that
/// follows slip bounds does besides, and of a change of the active set.
fn parts(quick: bool, system: &Tfeti, threads: usize) -> Result<[f64; 5], Failure> {
    let (mut x, mut y) = (wave(system.dual_dim()), wave(system.dual_dim()));
    let mut z = x.clone();
    let contact = system.gluing().ranges().contact().end;
    let mut space = ActiveSetProjector::new(system.coarse(), contact, None)?;
    let (lumped, mut w, mut k) = (system.lumped()?, vec![1.0; x.len()], 0);
    let mut scratch = lumped.scratch();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    Ok(pool.install(|| {
        let m = seconds(quick, || lumped.apply(&x, &mut y, &mut scratch));
        let p = seconds(quick, || {
            space.project_step(&mut x);
            space.project_step_transpose(&mut y);
        });
        // what a step of `qp::active_set` does besides
        let v = seconds(quick, || {
            let step = 1e-9 * vector::dot(&x, &y).clamp(0.0, 1.0);
            vector::axpy(step, &x, &mut y);
            vector::axpy(step, &y, &mut z);
            let [rho, _] = vector::dots([(&x, &y), (&y, &y)]);
            vector::axpy(1e-9 * rho.clamp(0.0, 1.0), &x, &mut z);
            vector::axpby(-1.0, &y, 0.5, &mut z);
        });
        let growth = wave(contact);
        let follow = seconds(quick, || {
            space.compensate(&x, &growth, &mut z);
        });
        let change = seconds(quick, || {
            k += 1;
            w[k % contact] = 1.0 - w[k % contact];
            drop(space.set_weights(&w));
        });
        [m, p, v, follow, change]
    }))
}

fn main() -> Result<(), Failure> {
    // as Criterion's: once as a test, which `cargo test` runs without `--bench`
    let asked = |word: &str| std::env::args().any(|a| a == word);
    let quick = asked("--test") || !asked("--bench");
    let sizes = if quick { 1..=2 } else { 1..=5 };
    println!("Shared subdomains. Times in ms; ratio = F over the better of both dense products A X and X A.\n");
    println!(
        "| n | threads | F | A X | X A | ratio | lumped | both projectors | vectors | share of an iteration | slip \
         bounds followed | share | change of active set | set-up / F |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for n in sizes.clone() {
        let body = Body::new(n)?;
        let system = body.system(true, InverseKind::Auto)?;
        let size = system.report().classes.iter().map(|c| c.boundary).max();
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
            let time = product(quick, &system, threads)?;
            let [left, right] = gemm(quick, system.dual().flops(), size.unwrap_or(1), threads)?;
            let [m, p, v, follow, change] = parts(quick, &system, threads)?;
            let setup = pool.install(|| seconds(quick, || drop(body.system(true, InverseKind::Auto))));
            println!(
                "| {n} | {threads} | {:.3} | {:.3} | {:.3} | {:.2} | {:.3} | {:.3} | {:.3} | {:.2} | {:.3} | {:.2} | \
                 {:.3} | {:.1} |",
                1e3 * time,
                1e3 * left,
                1e3 * right,
                time / left.min(right),
                1e3 * m,
                1e3 * p,
                1e3 * v,
                (p + v) / (time + m + p + v),
                1e3 * follow,
                (p + v + follow) / (time + m + p + v + follow),
                1e3 * change,
                setup / time
            );
        }
    }
    println!(
        "\nNo shared subdomains: F over the time to read factors or blocks once, at the bandwidth of the triad on \
         arrays of 201 MB (memory) and of the same size.\n"
    );
    println!(
        "| n | inverse | threads | MB | F | GB/s of memory | ratio | GB/s of that size | ratio \
         |\n|---|---|---|---|---|---|---|---|---|"
    );
    for n in sizes.clone().take_while(|n| *n <= 4) {
        let body = Body::new(n)?;
        for (name, kind) in [("sparse", InverseKind::Sparse), ("dense", InverseKind::Dense)] {
            let system = body.system(false, kind)?;
            let bytes: u64 = match kind {
                InverseKind::Sparse => system.report().inverse_bytes,
                _ => {
                    let block = |size: usize| 8 * (size * size) as u64;
                    system.report().classes.iter().map(|c| block(c.boundary)).sum()
                }
            };
            for threads in [1, 2] {
                let once = |bandwidth: f64| bytes as f64 / bandwidth;
                let memory = triad(quick, threads, MEMORY)?;
                let own = triad(quick, threads, bytes)?;
                let time = product(quick, &system, threads)?;
                println!(
                    "| {n} | {name} | {threads} | {:.1} | {:.3} | {:.1} | {:.2} | {:.1} | {:.2} |",
                    1e-6 * bytes as f64,
                    1e3 * time,
                    1e-9 * memory,
                    time / once(memory),
                    1e-9 * own,
                    time / once(own)
                );
            }
        }
    }
    Ok(())
}
