//! The six rigid motions of a subdomain, orthonormal, without eigenvalue computation.

use crate::error::TfetiError;
use crate::tolerances::PIVOT;
use signorini_fem_mesh::vec3::{add, dot, sub};

/// Orthonormal basis of the kernel of a subdomain's stiffness matrix.
///
/// The motions are `t + omega x (p - centroid) / radius`; `transform` turns amplitudes of the orthonormal modes
/// into `(t, omega)`. Everything is relative to the mean of the nodes, so that translates share one kernel up to the
/// centroid.
#[derive(Debug, Clone)]
pub struct Kernel {
    radius: f64,
    /// Positions of the nodes relative to their mean, divided by `radius`.
    arms: Vec<[f64; 3]>,
    /// `(t, omega) = transform * amplitudes`, row-major.
    transform: Block,
    inverse: Block,
}

/// Six rows of six.
pub(crate) type Block = [[f64; 6]; 6];

/// Mean of some points.
pub(crate) fn mean(points: impl Iterator<Item = [f64; 3]> + Clone) -> [f64; 3] {
    let count = points.clone().count().max(1) as f64;
    // The first point is taken off first, so that bodies far from the origin lose nothing.
    let first = points.clone().next().unwrap_or([0.0; 3]);
    let sum = points.fold([0.0; 3], |sum, p| add(sum, sub(p, first)));
    std::array::from_fn(|c| first[c] + sum[c] / count)
}

/// The motion `t + omega x arm` of `motion = (t, omega)`.
#[inline]
pub(crate) fn displacement(motion: &[f64; 6], arm: &[f64; 3]) -> [f64; 3] {
    let [tx, ty, tz, wx, wy, wz] = *motion;
    let [rx, ry, rz] = *arm;
    [tx + wy * rz - wz * ry, ty + wz * rx - wx * rz, tz + wx * ry - wy * rx]
}

/// Adds the work conjugate of [`displacement`]: force and moment of `force` at `arm`.
#[inline]
pub(crate) fn add_wrench(wrench: &mut [f64; 6], arm: &[f64; 3], force: [f64; 3]) {
    let [fx, fy, fz] = force;
    let [rx, ry, rz] = *arm;
    wrench[0] += fx;
    wrench[1] += fy;
    wrench[2] += fz;
    wrench[3] += ry * fz - rz * fy;
    wrench[4] += rz * fx - rx * fz;
    wrench[5] += rx * fy - ry * fx;
}

impl Kernel {
    /// Kernel of a subdomain with these nodes.
    ///
    /// # Errors
    /// [`TfetiError::Collinear`], naming the `subdomain`, if the nodes lie on one line.
    pub fn new(points: &[[f64; 3]], subdomain: usize) -> Result<Self, TfetiError> {
        let count = points.len().max(1) as f64;
        let centre = mean(points.iter().copied());
        let mut arms: Vec<[f64; 3]> = points.iter().map(|p| sub(*p, centre)).collect();
        let radius = (arms.iter().map(|r| dot(*r, *r)).sum::<f64>() / count).sqrt();
        let collinear = TfetiError::Collinear { subdomain };
        if !(radius.is_finite() && radius > 0.0) {
            return Err(collinear);
        }
        arms.as_flattened_mut().iter_mut().for_each(|c| *c /= radius);
        let mut kernel = Self {
            radius,
            arms,
            transform: identity(),
            inverse: identity(),
        };
        // Cholesky of the Gram matrix, twice: the second pass removes what rounding left for slender subdomains.
        for _ in 0..2 {
            let lower = cholesky6(&kernel.gram()).ok_or_else(|| collinear.clone())?;
            let inverse_transposed = transposed(&invert_lower(&lower));
            kernel.transform = product(&kernel.transform, &inverse_transposed);
            kernel.inverse = product(&transposed(&lower), &kernel.inverse);
        }
        Ok(kernel)
    }

    fn gram(&self) -> Block {
        let mut gram = [[0.0; 6]; 6];
        for node in 0..self.arms.len() {
            let block = self.node_modes(node);
            for i in 0..6 {
                for j in 0..6 {
                    gram[i][j] += (0..3).map(|c| block[c][i] * block[c][j]).sum::<f64>();
                }
            }
        }
        gram
    }

    pub(crate) fn nodes(&self) -> usize {
        self.arms.len()
    }

    /// Root mean square distance of the nodes from their mean, in metres. Rotations are measured by the displacement
    /// at this distance.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    pub(crate) fn arm(&self, node: usize) -> &[f64; 3] {
        &self.arms[node]
    }

    /// The rows of `R` at one node: `[component][mode]`.
    pub fn node_modes(&self, node: usize) -> [[f64; 6]; 3] {
        let motion = |mode: usize| self.transform.map(|row| row[mode]);
        let u: [[f64; 3]; 6] = std::array::from_fn(|mode| displacement(&motion(mode), &self.arms[node]));
        std::array::from_fn(|c| u.map(|u| u[c]))
    }

    /// The whole `R`, column-major, `3 nodes x 6`.
    pub fn modes(&self) -> Vec<f64> {
        let blocks: Vec<_> = (0..self.nodes()).map(|node| self.node_modes(node)).collect();
        let column = |mode: usize| blocks.iter().flat_map(move |block| block.map(|row| row[mode]));
        (0..6).flat_map(column).collect()
    }

    /// Motion `(t, omega)` about the centroid of given amplitudes, `omega` in displacement at [`Kernel::radius`].
    pub(crate) fn motion(&self, amplitudes: &[f64]) -> [f64; 6] {
        std::array::from_fn(|i| (0..6).map(|j| self.transform[i][j] * amplitudes[j]).sum())
    }

    /// Amplitudes of a motion: the inverse of [`Kernel::motion`].
    pub(crate) fn amplitudes(&self, motion: &[f64; 6]) -> [f64; 6] {
        std::array::from_fn(|i| (0..6).map(|j| self.inverse[i][j] * motion[j]).sum())
    }

    /// `R^T f` of forces whose wrench about the centroid is given.
    pub(crate) fn project_wrench(&self, wrench: &[f64; 6]) -> [f64; 6] {
        std::array::from_fn(|i| (0..6).map(|j| self.transform[j][i] * wrench[j]).sum())
    }

    /// `R^T f` for a local vector of length `3 nodes`.
    pub fn transpose_times(&self, f: &[f64]) -> [f64; 6] {
        let mut wrench = [0.0; 6];
        for (arm, force) in self.arms.iter().zip(f.chunks_exact(3)) {
            add_wrench(&mut wrench, arm, [force[0], force[1], force[2]]);
        }
        self.project_wrench(&wrench)
    }

    /// `u += factor R amplitudes` for a local vector of length `3 nodes`.
    pub fn add_motion(&self, factor: f64, amplitudes: &[f64], u: &mut [f64]) {
        let motion = self.motion(amplitudes);
        for (arm, target) in self.arms.iter().zip(u.chunks_exact_mut(3)) {
            let v = displacement(&motion, arm);
            for c in 0..3 {
                target[c] += factor * v[c];
            }
        }
    }
}

fn identity() -> Block {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))
}

pub(crate) fn transposed(a: &Block) -> Block {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

pub(crate) fn product(a: &Block, b: &Block) -> Block {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|k| a[i][k] * b[k][j]).sum()))
}

fn cholesky6(a: &Block) -> Option<Block> {
    let mut l = [[0.0; 6]; 6];
    let scale = (0..6).map(|i| a[i][i]).fold(0.0, f64::max);
    for j in 0..6 {
        for i in j..6 {
            let sum: f64 = a[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            if i == j {
                if sum.is_nan() || sum <= PIVOT * scale {
                    return None;
                }
                l[i][i] = sum.sqrt();
            } else {
                l[i][j] = sum / l[j][j];
            }
        }
    }
    Some(l)
}

fn invert_lower(l: &Block) -> Block {
    let mut x = [[0.0; 6]; 6];
    for j in 0..6 {
        x[j][j] = 1.0 / l[j][j];
        for i in j + 1..6 {
            x[i][j] = -(j..i).map(|k| l[i][k] * x[k][j]).sum::<f64>() / l[i][i];
        }
    }
    x
}
