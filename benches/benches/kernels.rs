//! Criterion benches of every kernel of an iteration and of the set-up.
//!
//! `cargo bench -p signorini-benches --bench kernels`; with `-- --test` everything runs once.
#![allow(missing_docs)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use signorini::fem_mesh::recovery::StrainRecovery;
use signorini::fem_mesh::{Hooke, assemble_stiffness};
use signorini::qp::{Equality, EqualityProjector, SymmetricOperator};
use signorini::tfeti::ActiveSetProjector;
use signorini::tfeti::internal::{ActiveSetFactor, InverseKind};
use signorini_benches::{Body, Failure, wave};
use signorini_studies::brick::{POISSON, YOUNG};
use std::hint::black_box;

const SIZES: [usize; 5] = [1, 2, 3, 4, 5];

fn set_up(c: &mut Criterion) -> Result<(), Failure> {
    let mut group = c.benchmark_group("set-up");
    group.sample_size(10);
    let hooke = Hooke::isotropic(YOUNG, POISSON)?;
    for n in SIZES {
        let body = Body::new(n)?;
        group.bench_function(BenchmarkId::new("assembly of the whole body", n), |b| {
            b.iter(|| {
                let mesh = &body.mesh;
                black_box(assemble_stiffness(mesh.points(), mesh.tets(), |_| &hooke))
            });
        });
        group.bench_function(BenchmarkId::new("system", n), |b| {
            b.iter(|| black_box(body.system(true, InverseKind::Auto)));
        });
    }
    for (name, kind) in [("sparse", InverseKind::Sparse), ("dense", InverseKind::Dense)] {
        let body = Body::new(2)?;
        group.bench_function(BenchmarkId::new("24 different subdomains", name), |b| {
            b.iter(|| black_box(body.system(false, kind)));
        });
    }
    group.finish();
    Ok(())
}

fn products(c: &mut Criterion) -> Result<(), Failure> {
    let mut group = c.benchmark_group("products");
    group.sample_size(20);
    for n in SIZES {
        let system = Body::new(n)?.system(true, InverseKind::Auto)?;
        let (f, x) = (system.dual(), wave(system.dual_dim()));
        let mut y = x.clone();
        let mut scratch = f.scratch();
        group.bench_function(BenchmarkId::new("F x", n), |b| {
            b.iter(|| f.apply(black_box(&x), &mut y, &mut scratch));
        });
        for (name, m) in [("lumped", system.lumped()?), ("Dirichlet", system.dirichlet()?)] {
            let mut scratch = m.scratch();
            group.bench_function(BenchmarkId::new(name, n), |b| {
                b.iter(|| m.apply(black_box(&x), &mut y, &mut scratch));
            });
        }
    }
    group.finish();
    Ok(())
}

fn coarse(c: &mut Criterion) -> Result<(), Failure> {
    let mut group = c.benchmark_group("coarse");
    group.sample_size(20);
    for n in SIZES {
        let system = Body::new(n)?.system(true, InverseKind::Auto)?;
        let mut x = wave(system.dual_dim());
        let mut alpha = wave(system.coarse().rows());
        let factor = system.coarse_factor()?;
        let mut scratch = factor.scratch();
        group.bench_function(BenchmarkId::new("solve", n), |b| {
            b.iter(|| factor.solve(black_box(&mut alpha), &mut scratch));
        });
        group.bench_function(BenchmarkId::new("G x", n), |b| {
            b.iter(|| system.coarse().apply(black_box(&x), &mut alpha, &mut scratch));
        });
        group.bench_function(BenchmarkId::new("G^T y", n), |b| {
            b.iter(|| system.coarse().apply_transpose(black_box(&alpha), &mut x, &mut scratch));
        });
        if let Some(rows) = factor.orthonormal() {
            group.bench_function(BenchmarkId::new("P = I - C^T C", n), |b| {
                b.iter(|| {
                    rows.apply(black_box(&x), &mut alpha, &mut scratch);
                    rows.apply_transpose(&alpha, &mut x, &mut scratch);
                });
            });
        }
        let contact = system.gluing().ranges().contact().end;
        for (name, kind) in [("split", ActiveSetFactor::Split), ("sparse", ActiveSetFactor::Sparse)] {
            let mut space = ActiveSetProjector::with_factor(system.coarse(), contact, None, kind)?;
            let mut w = vec![1.0; x.len()];
            let mut k = 0;
            group.bench_function(BenchmarkId::new(format!("change of active set, {name}"), n), |b| {
                b.iter(|| {
                    k += 1;
                    w[k % contact] = 1.0 - w[k % contact];
                    space.set_weights(black_box(&w))
                });
            });
            group.bench_function(BenchmarkId::new(format!("projector, {name}"), n), |b| {
                b.iter(|| space.project(black_box(&mut x)));
            });
            group.bench_function(BenchmarkId::new(format!("projector of a step, {name}"), n), |b| {
                b.iter(|| space.project_step(black_box(&mut x)))
            });
            let (change, mut to) = (wave(contact), x.clone());
            group.bench_function(BenchmarkId::new(format!("compensation, {name}"), n), |b| {
                b.iter(|| space.compensate(black_box(&x), &change, &mut to));
            });
        }
    }
    group.finish();
    Ok(())
}

fn once_a_step(c: &mut Criterion) -> Result<(), Failure> {
    let mut group = c.benchmark_group("once a step");
    group.sample_size(20);
    for n in SIZES {
        let body = Body::new(n)?;
        let system = body.system(true, InverseKind::Auto)?;
        let u = wave(system.torn_dim());
        let mut f = u.clone();
        group.bench_function(BenchmarkId::new("K u", n), |b| {
            b.iter(|| system.stiffness_times(black_box(&u), &mut f));
        });
        group.bench_function(BenchmarkId::new("K+ f", n), |b| {
            b.iter(|| system.generalised_inverse(black_box(&u), &mut f));
        });
        group.bench_function(BenchmarkId::new("recovery of strains, fits", n), |b| {
            b.iter(|| StrainRecovery::new(black_box(&body.mesh)));
        });
        let recovery = StrainRecovery::new(&body.mesh);
        let nodal = wave(3 * body.mesh.points().len());
        group.bench_function(BenchmarkId::new("recovery of strains, error", n), |b| {
            b.iter(|| recovery.error(&body.mesh, &body.materials, black_box(&nodal)));
        });
    }
    group.finish();
    Ok(())
}

fn all(c: &mut Criterion) {
    for run in [set_up, products, coarse, once_a_step] {
        if let Err(error) = run(c) {
            panic!("{error}");
        }
    }
}

criterion_group!(benches, all);
criterion_main!(benches);
