//! Time of one product with `F` and of one projector on the brick, beside a dense product of the same operations.
//!
//! `cargo run --release -p signorini-tfeti --example product -- [n ...]`

use faer::{Accum, Mat, Par};
use signorini_fem_mesh::{Decomposition, Hooke, Materials, SurfaceFrame, brick};
use signorini_qp::{Equality, EqualityProjector, SymmetricOperator};
use signorini_tfeti::{
    ActiveSetFactor, ActiveSetProjector, ContactConstraints, InverseKind, InverseSettings,
    NodeSupport, Sharing, Tfeti, TfetiBuilder,
};
use std::time::Instant;

fn median(mut body: impl FnMut()) -> f64 {
    body();
    let started = Instant::now();
    let mut times = Vec::new();
    while times.len() < 7 || (started.elapsed().as_secs_f64() < 0.7 && times.len() < 2000) {
        let t = Instant::now();
        body();
        times.push(t.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    times[times.len() / 20]
}

/// The other parts of an iteration of the face method, on one thread.
fn parts(system: &Tfeti) -> Result<(), Box<dyn std::error::Error>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let n = system.dual_dim();
    let contact = system.gluing().ranges().contact().end;
    let mut x: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
    let mut y = x.clone();
    let lumped = system.lumped()?;
    let mut s = lumped.scratch();
    let time = pool.install(|| median(|| lumped.apply(&x, &mut y, &mut s)));
    print!("lumped {:.3} ms", 1e3 * time);
    for (name, kind) in [
        ("split", ActiveSetFactor::Split),
        ("sparse", ActiveSetFactor::Sparse),
    ] {
        let started = Instant::now();
        let mut space = ActiveSetProjector::with_factor(system.coarse(), contact, None, kind)?;
        let setup = started.elapsed().as_secs_f64();
        let mut w = vec![1.0; n];
        let mut k = 0;
        let change = pool.install(|| {
            median(|| {
                k += 1;
                w[k % contact] = 1.0 - w[k % contact];
                drop(space.set_weights(&w));
            })
        });
        let project = pool.install(|| median(|| space.project_step(&mut x)));
        let transposed = pool.install(|| median(|| space.project_step_transpose(&mut y)));
        let mut alpha = vec![1.0; system.coarse().rows()];
        let mut s = space.factor().scratch();
        let solve = pool.install(|| median(|| space.factor().solve(&mut alpha, &mut s)));
        print!(
            "; {name}: solve {:.3}, {} numbers, set-up {:.2}, change {:.3}, P {:.3}, P^T {:.3} ms",
            1e3 * solve,
            space.factor().stored(),
            1e3 * setup,
            1e3 * change,
            1e3 * project,
            1e3 * transposed
        );
    }
    println!();
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let single = arguments.iter().any(|a| a == "single");
    let sparse = arguments.iter().any(|a| a == "sparse");
    let dense = arguments.iter().any(|a| a == "dense");
    arguments.retain(|a| a.parse::<usize>().is_ok());
    let sizes: Vec<usize> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let sizes = if sizes.is_empty() {
        vec![1, 2, 3, 4, 5]
    } else {
        sizes
    };
    println!(
        "n | n_d | F ms 1 thread | F ms 2 | gemm ms 1 | gemm ms 2 | ratio 1 | ratio 2 | Cx ms | C^Ty ms | set-up ms"
    );
    for n in sizes {
        let materials = Materials::uniform(Hooke::isotropic(211.9e9, 0.277)?);
        let mesh = brick::Brick::new([3.0, 1.0, 1.0], [15 * n, 5 * n, 5 * n]).build()?;
        let decomposition = Decomposition::boxes(&mesh, [3 * n, n, n])?;
        let supports = [NodeSupport::fixed(mesh.nodes_on(brick::X_MIN))];
        let bottom = mesh.nodes_on(brick::Z_MIN);
        let frame = SurfaceFrame {
            normal: [0.0, 0.0, -1.0],
            tangents: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        };
        let contact = ContactConstraints::rigid(&bottom, &vec![frame; bottom.len()], true);
        let kind = if sparse {
            InverseKind::Sparse
        } else if dense {
            InverseKind::Dense
        } else {
            InverseKind::Auto
        };
        let builder = TfetiBuilder::new(&mesh, &decomposition, &materials)
            .with_supports(&supports)
            .with_contact(&contact)
            .with_inverse(InverseSettings::default().with_kind(kind))
            .with_sharing(if single {
                Sharing::Never
            } else {
                Sharing::Translates
            });
        let started = Instant::now();
        let system = builder.build()?;
        let setup = started.elapsed().as_secs_f64();
        let f = system.dual();
        let x: Vec<f64> = (0..f.dim()).map(|i| (i as f64).sin()).collect();
        let mut y = vec![0.0; f.dim()];
        let mut scratch = f.scratch();
        let mut row = Vec::new();
        let mut gemm = Vec::new();
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()?;
            row.push(pool.install(|| median(|| f.apply(&x, &mut y, &mut scratch))));
            let class = system
                .report()
                .classes
                .iter()
                .map(|c| c.boundary)
                .max()
                .unwrap_or(0);
            let columns = (f.flops() as f64 / (2 * class * class) as f64).ceil() as usize;
            let a = Mat::<f64>::from_fn(class, class, |i, j| 1.0 / (1.0 + (i + j) as f64));
            let b: Vec<Mat<f64>> = (0..threads)
                .map(|k| {
                    Mat::from_fn(
                        class,
                        columns / threads + usize::from(k < columns % threads),
                        |i, j| (i * j) as f64,
                    )
                })
                .collect();
            let mut c: Vec<Mat<f64>> = b.iter().map(|b| Mat::zeros(class, b.ncols())).collect();
            let multiply = |c: &mut Mat<f64>, b: &Mat<f64>| {
                faer::linalg::matmul::matmul(
                    c.as_mut(),
                    Accum::Replace,
                    a.as_ref(),
                    b.as_ref(),
                    1.0,
                    Par::Seq,
                )
            };
            gemm.push(pool.install(|| {
                median(|| match &mut c[..] {
                    [c0] => multiply(c0, &b[0]),
                    [c0, c1] => drop(rayon::join(|| multiply(c0, &b[0]), || multiply(c1, &b[1]))),
                    _ => {}
                })
            }));
        }
        let mut line = format!(
            "{n} | {} | {:.3} | {:.3} | {:.3} | {:.3} | {:.2} | {:.2}",
            f.dim(),
            1e3 * row[0],
            1e3 * row[1],
            1e3 * gemm[0],
            1e3 * gemm[1],
            row[0] / gemm[0],
            row[1] / gemm[1]
        );
        if let Some(c) = system.coarse_factor().orthonormal() {
            let mut s = c.scratch();
            let mut small = vec![0.0; c.rows()];
            let ax = median(|| c.apply(&x, &mut small, &mut s));
            let aty = median(|| c.apply_transpose(&small, &mut y, &mut s));
            let g = system.coarse();
            let gx = median(|| g.apply(&x, &mut small, &mut s));
            let gty = median(|| g.apply_transpose(&small, &mut y, &mut s));
            let solve = median(|| system.coarse_factor().solve(&mut small, &mut s));
            println!(
                "Gx {:.3} ms, G^Ty {:.3} ms, solve {:.3} ms, L {}",
                1e3 * gx,
                1e3 * gty,
                1e3 * solve,
                g.factor_size()
            );
            line += &format!(" | {:.3} | {:.3}", 1e3 * ax, 1e3 * aty);
        }
        println!("{line} | {:.1}", 1e3 * setup);
        parts(&system)?;
        println!("{}", system.report());
    }
    Ok(())
}
