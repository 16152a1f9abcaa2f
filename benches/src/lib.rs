//! Shared parts of the benches: the brick of the benchmark, a clock, and the machine's own limits.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use rayon::prelude::*;
use signorini::fem_mesh::{Decomposition, Materials, SurfaceFrame, TetMesh, brick};
use signorini::tfeti::internal::InverseKind;
use signorini::tfeti::{ContactConstraint, InverseSettings, NodeSupport, Tfeti, TfetiBuilder, TfetiError};
use signorini_studies::brick::{Block, Loading, steel};
use std::time::Instant;

pub use signorini_studies::Failure;

/// The brick of the benchmark: `3n x n x n` subdomains of 5 x 5 x 5 cubes, clamped at one end, with a rough floor.
#[derive(Debug)]
pub struct Body {
    /// The mesh.
    pub mesh: TetMesh,
    /// The subdomains.
    pub decomposition: Decomposition,
    /// Steel.
    pub materials: Materials,
    supports: Vec<NodeSupport>,
    contact: Vec<ContactConstraint>,
}

impl Body {
    /// The brick for `n`.
    pub fn new(n: usize) -> Result<Self, Failure> {
        let block = Block::benchmark(n, Loading::B);
        let mesh = block.mesh()?;
        let decomposition = Decomposition::boxes(&mesh, block.boxes)?;
        let bottom = mesh.nodes_on(brick::Z_MIN);
        let frame = SurfaceFrame {
            normal: [0.0, 0.0, -1.0],
            tangents: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        };
        Ok(Self {
            supports: vec![NodeSupport::fixed(mesh.nodes_on(brick::X_MIN))],
            contact: bottom
                .iter()
                .map(|&node| ContactConstraint::new(node, frame).with_friction(true))
                .collect(),
            materials: steel()?,
            mesh,
            decomposition,
        })
    }

    /// The T-FETI system.
    pub fn system(&self, share_translates: bool, kind: InverseKind) -> Result<Tfeti, TfetiError> {
        TfetiBuilder::new(&self.mesh, &self.decomposition, &self.materials)
            .with_supports(&self.supports)
            .with_contact(&self.contact)
            .with_share_translates(share_translates)
            .with_inverse(InverseSettings::default().with_kind(kind))
            .build()
    }
}

/// A vector without structure.
pub fn wave(length: usize) -> Vec<f64> {
    (0..length).map(|i| (0.7 * i as f64).sin()).collect()
}

/// Seconds of one run: the fifth percentile of many, so that other work on the machine disturbs little. Once if
/// `quick`.
pub fn seconds(quick: bool, mut body: impl FnMut()) -> f64 {
    let mut times = Vec::new();
    let started = Instant::now();
    while times.is_empty() || (!quick && (times.len() < 7 || started.elapsed().as_secs_f64() < 0.7)) {
        let t = Instant::now();
        body();
        times.push(t.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    times[times.len() / 20]
}

/// Seconds of a dense product of `flops` operations with a square matrix of `size`: the better of `A X` and `X A`, the
/// columns (rows) of `X` shared by `threads`.
pub fn gemm(quick: bool, flops: u64, size: usize, threads: usize) -> Result<[f64; 2], Failure> {
    let members = (flops as f64 / (2 * size * size) as f64 / threads as f64).ceil() as usize;
    let a = Mat::<f64>::from_fn(size, size, |i, j| 1.0 / (1.0 + (i + j) as f64));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let time = |left: bool| {
        let (rows, columns) = if left { (size, members) } else { (members, size) };
        let mut pairs: Vec<(Mat<f64>, Mat<f64>)> = (0..threads)
            .map(|_| {
                let x = Mat::from_fn(rows, columns, |i, j| ((i * 7 + j) % 13) as f64);
                (x, Mat::zeros(rows, columns))
            })
            .collect();
        let product = |(x, y): &mut (Mat<f64>, Mat<f64>)| {
            let (l, r) = if left { (&a, &*x) } else { (&*x, &a) };
            matmul(y.as_mut(), Accum::Replace, l.as_ref(), r.as_ref(), 1.0, Par::Seq);
        };
        pool.install(|| seconds(quick, || pairs.par_iter_mut().for_each(product)))
    };
    Ok([time(true), time(false)])
}

/// Bytes of the three arrays of [`triad`] that stand for memory.
pub const MEMORY: u64 = 3 << 26;

/// Bytes per second of the triad `a = b + s c` on three arrays of so many `bytes` in all, counting two reads and one
/// write.
pub fn triad(quick: bool, threads: usize, bytes: u64) -> Result<f64, Failure> {
    let length = (bytes / 24).clamp(1, if quick { 1 << 18 } else { 1 << 32 }) as usize;
    let chunk = length.div_ceil(8 * threads).min(1 << 16);
    let (mut a, b, c) = (vec![0.0; length], wave(length), wave(length));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let time = pool.install(|| {
        seconds(quick, || {
            a.par_chunks_mut(chunk)
                .zip(b.par_chunks(chunk).zip(c.par_chunks(chunk)))
                .for_each(|(a, (b, c))| {
                    for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                        *a = b + 3.0 * c;
                    }
                });
        })
    });
    Ok(24.0 * length as f64 / time)
}
