//! Loads, displacements and residuals: everything between torn and dual vectors that is not an iteration.

use crate::error::TfetiError;
use crate::linalg::{of_length, zeros};
use crate::rows::gluing::CopyEntry;
use crate::subdomain::copy_stiffness::CopyStiffness;
use crate::system::tfeti::Tfeti;
use crate::tolerances::BLOCKS;
use rayon::prelude::*;
use signorini_fem_mesh::vec3::{moved, sub};
use std::ops::Range;

/// Response of the torn body to one load: what a time step needs to combine.
///
/// For loads `f = sum h_j f_j` the dual load is `d = c - sum h_j dual_j` and `e = sum h_j coarse_j`.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LoadResponse {
    /// `B K+ f`.
    pub dual: Vec<f64>,
    /// `e = -R^T f`.
    pub coarse: Vec<f64>,
    /// The load itself, a torn vector in newtons.
    pub force: Vec<f64>,
}

impl Tfeti {
    fn check(&self, what: &'static str, x: &[f64], expected: usize) -> Result<(), TfetiError> {
        TfetiError::check_length(what, x.len(), expected)?;
        let bad = |part: &[f64]| part.iter().position(|v| !v.is_finite());
        let first = x
            .par_chunks(BLOCKS)
            .enumerate()
            .find_map_first(|(k, part)| Some(k * BLOCKS + bad(part)?));
        first.map_or(Ok(()), |index| Err(TfetiError::NotFinite { what, index }))
    }

    /// Response to a load given by local vectors (as `signorini_fem_mesh::assemble_load` returns them).
    ///
    /// # Errors
    /// [`TfetiError::Length`] and [`TfetiError::NotFinite`].
    pub fn load_response(&self, local: &[Vec<f64>]) -> Result<LoadResponse, TfetiError> {
        let mut load = self.torn_load(local)?;
        load.dual = self.row_response(&load.force);
        Ok(load)
    }

    /// The same without `B K+ f`: for a load that is [balanced](Self::balance_loads) first.
    ///
    /// # Errors
    /// As [`load_response`](Self::load_response).
    #[doc(hidden)]
    pub fn torn_load(&self, local: &[Vec<f64>]) -> Result<LoadResponse, TfetiError> {
        TfetiError::check_length("local vectors", local.len(), self.subdomains())?;
        for (s, part) in local.iter().enumerate() {
            self.check("local vector", part, self.torn_range(s).len())?;
        }
        let force = local.concat();
        let mut coarse = vec![0.0; 6 * self.subdomains()];
        let all = coarse.as_chunks_mut().0.par_iter_mut().zip(local).enumerate();
        all.for_each(|(s, out)| *out.0 = self.kernel(s).transpose_times(out.1).map(|v| -v));
        let dual = Vec::new();
        Ok(LoadResponse { dual, coarse, force })
    }

    /// Response to a load together with multipliers that balance it on every subdomain, `G lambda = e`: what is left to
    /// be found are multipliers with `G lambda = 0`.
    #[doc(hidden)]
    pub fn balance_loads(&self, load: &mut LoadResponse, lambda: &[f64]) {
        let mut force = load.force.clone();
        self.add_rows_transposed(lambda, &mut force);
        load.dual = self.row_response(&force);
        self.gluing().add_compliance(lambda, &mut load.dual);
        load.coarse.fill(0.0);
    }

    /// `B K+ f`.
    fn row_response(&self, force: &[f64]) -> Vec<f64> {
        let mut displaced = vec![0.0; self.torn_dim()];
        self.generalised_inverse(force, &mut displaced);
        let mut dual = vec![0.0; self.dual_dim()];
        self.rows_times(&displaced, &mut dual);
        dual
    }

    /// Place of the three components of a node copy in torn vectors.
    fn place(&self, subdomain: u32, local: u32) -> Range<usize> {
        let start = self.torn_range(subdomain as usize).start + 3 * local as usize;
        start..start + 3
    }

    /// `out = B u` for a torn vector.
    pub fn rows_times(&self, u: &[f64], out: &mut [f64]) {
        let gluing = self.gluing();
        let interface = gluing.ranges().interface.clone();
        let blocks = |first: usize, part: &mut [f64]| {
            for (block, target) in (first..).zip(part.chunks_exact_mut(3)) {
                target.fill(0.0);
                for e in gluing.block(block) {
                    let value = &u[self.place(e.subdomain, e.local)];
                    (0..3).for_each(|c| target[c] += e.coefficient * value[c]);
                }
            }
        };
        let parts = out[interface].par_chunks_mut(3 * BLOCKS).enumerate();
        parts.for_each(|(k, part)| blocks(k * BLOCKS, part));
        for nodal in 0..gluing.nodal_rows() {
            let entry = |e: &CopyEntry| {
                let value = &u[self.place(e.subdomain, e.local)];
                (0..3).map(|c| e.vector[c] * value[c]).sum::<f64>()
            };
            out[gluing.nodal_row(nodal)] = gluing.nodal(nodal).iter().map(entry).sum();
        }
    }

    /// `f += B^T x` for a torn vector.
    pub fn add_rows_transposed(&self, x: &[f64], f: &mut [f64]) {
        self.add_some_transposed(x, f, |_| true);
    }

    /// The same on the subdomains that are told; halves of them on two threads.
    fn add_some_transposed(&self, x: &[f64], f: &mut [f64], is_told: impl Fn(u32) -> bool + Sync) {
        if !self.dual.map.is_large() {
            return self.add_transposed(x, f, 0, is_told);
        }
        let middle = self.subdomains() as u32 / 2;
        let start = self.torn_range(middle as usize).start;
        let (low, high) = f.split_at_mut(start);
        rayon::join(
            || self.add_transposed(x, low, 0, |s| s < middle && is_told(s)),
            || self.add_transposed(x, high, start, |s| s >= middle && is_told(s)),
        );
    }

    /// The same where `f` begins at an entry of torn vectors.
    fn add_transposed(&self, x: &[f64], f: &mut [f64], first: usize, is_told: impl Fn(u32) -> bool) {
        let place = |subdomain: u32, local: u32| {
            let place = self.place(subdomain, local);
            place.start - first..place.end - first
        };
        let gluing = self.gluing();
        let interface = &x[gluing.ranges().interface.clone()];
        for (block, value) in interface.chunks_exact(3).enumerate() {
            for e in gluing.block(block).iter().filter(|e| is_told(e.subdomain)) {
                let target = &mut f[place(e.subdomain, e.local)];
                (0..3).for_each(|c| target[c] += e.coefficient * value[c]);
            }
        }
        for nodal in 0..gluing.nodal_rows() {
            let value = x[gluing.nodal_row(nodal)];
            for e in gluing.nodal(nodal).iter().filter(|e| is_told(e.subdomain)) {
                let target = &mut f[place(e.subdomain, e.local)];
                (0..3).for_each(|c| target[c] += e.vector[c] * value);
            }
        }
    }

    /// Sum of loads, `sum factor * force`, in old memory: on the subdomains of this process, zero on the others'.
    #[doc(hidden)]
    pub fn combine_forces(&self, old: Vec<f64>, loads: &[(f64, &LoadResponse)]) -> Vec<f64> {
        let mut force = zeros(old, self.torn_dim());
        for range in self.torn_here() {
            for (factor, load) in loads {
                signorini_qp::vector::axpy(*factor, &load.force[range.clone()], &mut force[range.clone()]);
            }
        }
        force
    }

    /// The torn displacement `u = K+ (f + B^T lambda) + R alpha` (5.27), and the residual of equilibrium
    /// `K u - f - B^T lambda`, a torn vector in newtons. Of several processes each has the residual of its subdomains,
    /// and of the force needs theirs only; [`complete_torn`](Self::complete_torn) tells it the others'.
    ///
    /// `force` is a torn vector in newtons, `alpha` the rigid amplitudes, for instance from
    /// [`CoarseFactor::amplitudes`](crate::CoarseFactor::amplitudes). The displacement is made in old memory, which may
    /// be empty, the residual in that of the force.
    ///
    /// # Errors
    /// [`TfetiError::Length`] and [`TfetiError::NotFinite`], also of a displacement that is not finite.
    pub fn recover(
        &self,
        [old, mut force]: [Vec<f64>; 2],
        lambda: &[f64],
        alpha: &[f64],
    ) -> Result<[Vec<f64>; 2], TfetiError> {
        self.check("force", &force, self.torn_dim())?;
        self.check("multipliers", lambda, self.dual_dim())?;
        self.check("rigid amplitudes", alpha, 6 * self.subdomains())?;
        self.add_some_transposed(lambda, &mut force, |s| self.is_here(s as usize));
        let mut u = of_length(old, force.len());
        self.displacement(&force, Some(alpha), &mut u);
        self.complete_torn(&mut u);
        self.check("displacement", &u, self.torn_dim())?;
        self.stiffness_less(&u, &mut force);
        Ok([u, force])
    }

    /// Displacement at the mesh nodes: the mean of the copies, `3 node + component`. Copies that differ count by
    /// their [stiffness](Self::copy_stiffness).
    ///
    /// # Panics
    /// As a product with an operator: unless `u` is a torn vector.
    pub fn nodal_mean(&self, u: &[f64]) -> Vec<f64> {
        self.mean_by(self.copy_stiffness(), u)
    }

    /// The same with other weights.
    #[doc(hidden)]
    pub fn mean_by(&self, copies: &CopyStiffness, u: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; 3 * self.nodes];
        let mut sums = vec![0.0; self.nodes];
        let copied = self.node_of.iter().enumerate();
        for (k, node) in copied.filter_map(|(k, node)| Some((k, (*node)?))) {
            let weight = copies.weight(k);
            sums[node as usize] += weight;
            for c in 0..3 {
                out[3 * node as usize + c] += weight * u[3 * k + c];
            }
        }
        for (value, sum) in out.chunks_exact_mut(3).zip(&sums) {
            value.iter_mut().for_each(|v| *v /= sum);
        }
        out
    }

    /// The rigid motion of a subdomain in a torn displacement, the nearest one: displacement of a point in m, and
    /// rotation in radians.
    pub fn rigid_motion(&self, subdomain: usize, u: &[f64], point: [f64; 3]) -> [[f64; 3]; 2] {
        let kernel = self.kernel(subdomain);
        let amplitudes = kernel.transpose_times(&u[self.torn_range(subdomain)]);
        let [x, y, z, a, b, c] = kernel.motion(&amplitudes);
        let rotation = [a, b, c].map(|w| w / kernel.radius());
        let arm = sub(point, self.coarse().centre(subdomain));
        [moved([[x, y, z], rotation], arm), rotation]
    }

    /// Row offsets `c` of prescribed displacements, `sum factor * offset` over `(case, factor)`, in old memory, which
    /// may be empty.
    pub fn prescribed_offsets(&self, old: Vec<f64>, factors: &[(usize, f64)]) -> Vec<f64> {
        let mut c = zeros(old, self.dual_dim());
        for &(case, factor) in factors {
            for &(row, value) in self.gluing().prescribed(case) {
                c[row as usize] += factor * value;
            }
        }
        c
    }
}
