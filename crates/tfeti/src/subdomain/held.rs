//! What supports hold of a subdomain that is thin between planes, as springs.
//!
//! Free of its supports a slice bends as a plate, softer than what it is part of by the square of its length over its
//! thickness, and conjugate gradients take as much longer. Its solution is zero where supports hold it at zero, so that
//! springs `D` there change nothing: with forces in balance `(K + D) u = f` has `Rᵀ D u = 0`, and `u` is a solution of
//! `(K + D - D R (Rᵀ D R)⁺ Rᵀ D) u = f`, whose kernel is that of `K`, for every `u` that [`Held`] makes. The
//! multipliers stay what they are.

use crate::linalg::sparse::Columns;
use crate::subdomain::class::HeldDirection;
use crate::subdomain::inverse::scale;
use crate::subdomain::kernel::Kernel;
use crate::tolerances::{FREE, HELD_MOTION, PLANE_SPRINGS};
use nalgebra::{Matrix6, SymmetricEigen, Vector6};

/// Springs of a class at the directions that supports hold, and what stops the motions that these leave free.
#[derive(Debug)]
pub(crate) struct Held {
    /// Node, direction and stiffness.
    springs: Vec<(usize, [f64; 3], f64)>,
    /// Unknowns, as many as free motions, which none of these leaves at rest.
    anchors: Vec<usize>,
}

impl Held {
    /// `None` if nothing is held, or a motion neither clearly held nor clearly free.
    pub(crate) fn new(stiffness: &Columns, kernel: &Kernel, held: &[HeldDirection]) -> Option<Self> {
        let spring = |&(node, n): &HeldDirection| {
            let node = node as usize;
            (node, n, PLANE_SPRINGS * quadratic(stiffness, node, n))
        };
        let springs: Vec<_> = held.iter().map(spring).collect();
        let mut work = Matrix6::zeros();
        for &(node, n, k) in &springs {
            let modes = kernel.node_modes(node);
            let along = Vector6::from_fn(|m, _| (0..3).map(|c| n[c] * modes[c][m]).sum());
            work += k * along * along.transpose();
        }
        let eigen = SymmetricEigen::new(work);
        let largest = eigen.eigenvalues.max();
        let is_free = |v: f64| v <= FREE * largest;
        let is_clear = |v: &f64| is_free(*v) || *v >= HELD_MOTION * largest;
        if largest <= 0.0 || !eigen.eigenvalues.iter().all(is_clear) {
            return None;
        }
        let free = (0..6).filter(|&k| is_free(eigen.eigenvalues[k]));
        let free = free.map(|k| eigen.eigenvectors.column(k).into_owned()).collect();
        Some(Self {
            springs,
            anchors: anchors(kernel, free),
        })
    }

    /// A stiffness with the springs.
    pub(crate) fn stiffened(&self, stiffness: &Columns) -> Columns {
        let mut matrix = stiffness.clone();
        for &(node, n, k) in &self.springs {
            matrix.add_to_node(node, |i, j| k * n[i] * n[j]);
        }
        matrix
    }

    /// The same, held at the anchors: positive definite.
    pub(crate) fn regularised(&self, stiffness: &Columns) -> Columns {
        let (mut matrix, strength) = (self.stiffened(stiffness), scale(stiffness));
        for &anchor in &self.anchors {
            let own = |i: usize| f64::from(u8::from(i == anchor % 3));
            matrix.add_to_node(anchor / 3, |i, j| strength * own(i) * own(j));
        }
        matrix
    }
}

/// `nᵀ K n` of a node.
fn quadratic(stiffness: &Columns, node: usize, n: [f64; 3]) -> f64 {
    let entry = |i: usize, j: usize| {
        stiffness
            .find(3 * node + i, 3 * node + j)
            .map_or(0.0, |at| stiffness.values[at])
    };
    (0..3)
        .map(|i| (0..3).map(|j| n[i] * n[j] * entry(i, j)).sum::<f64>())
        .sum()
}

/// For each free motion, of orthonormal amplitudes, the unknown that moves farthest where those before are at rest.
fn anchors(kernel: &Kernel, mut free: Vec<Vector6<f64>>) -> Vec<usize> {
    let mut out = Vec::with_capacity(free.len());
    while !free.is_empty() {
        let moves = |i: usize| {
            let modes = Vector6::from(kernel.node_modes(i / 3)[i % 3]);
            free.iter().map(|f| f * f.dot(&modes)).sum::<Vector6<f64>>()
        };
        let farther = |a: (usize, Vector6<f64>), b: (usize, Vector6<f64>)| {
            if b.1.norm_squared() > a.1.norm_squared() { b } else { a }
        };
        let all = (0..3 * kernel.nodes()).map(|i| (i, moves(i)));
        let Some((anchor, motion)) = all.reduce(farther) else {
            break;
        };
        out.push(anchor);
        let motion = motion.normalize();
        // what is left of the others; the one that is left least of is the motion itself
        let mut left: Vec<Vector6<f64>> = free.iter().map(|f| f - motion * motion.dot(f)).collect();
        left.sort_by(|a, b| b.norm_squared().total_cmp(&a.norm_squared()));
        left.pop();
        for k in 0..left.len() {
            let (before, own) = left.split_at_mut(k);
            for _ in 0..2 {
                before.iter().for_each(|b| own[0] -= *b * b.dot(&own[0]));
            }
            own[0].normalize_mut();
        }
        free = left;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use signorini_fem_mesh::{Brick, Hooke, assemble_stiffness, brick};

    /// Between parallel planes, planes at an angle, and on a curved side: forces in balance leave the anchors at rest
    /// and make no wrench of the springs.
    #[test]
    fn springs_and_anchors_are_in_balance_by_themselves() {
        let mesh = Brick::new([3.0, 0.4, 1.0], [4, 2, 2])
            .perturbed(0.1, 3)
            .build()
            .unwrap();
        let hooke = Hooke::isotropic(2.0e11, 0.3).unwrap();
        let stiffness = Columns::from_symmetric(&assemble_stiffness(mesh.points(), mesh.tets(), |_| &hooke).unwrap());
        let kernel = Kernel::new(mesh.points(), 0).unwrap();
        let on = |tag, normal: fn([f64; 3]) -> [f64; 3]| -> Vec<HeldDirection> {
            let nodes = mesh.nodes_on(tag).into_iter();
            nodes.map(|n| (n, normal(mesh.points()[n as usize]))).collect()
        };
        let along_y = |tag| on(tag, |_| [0.0, 1.0, 0.0]);
        let planes = [along_y(brick::Y_MIN), along_y(brick::Y_MAX)].concat();
        let wedge = [along_y(brick::Y_MIN), on(brick::Z_MAX, |_| [0.6, 0.0, 0.8])].concat();
        let curved = on(brick::Z_MIN, |[x, ..]| [(x - 1.0).sin(), 0.0, (x - 1.0).cos()]);
        for (held, free) in [(planes, 3), (wedge, 1), (curved, 1)] {
            let own = Held::new(&stiffness, &kernel, &held).expect("clearly held");
            assert_eq!(own.anchors.len(), free);
            let matrix = own.regularised(&stiffness);
            let mut dense = DMatrix::zeros(matrix.dim, matrix.dim);
            for j in 0..matrix.dim {
                let (rows, values) = matrix.column(j);
                rows.iter().zip(values).for_each(|(&i, v)| dense[(i, j)] = *v);
            }
            let mut force: Vec<f64> = (0..matrix.dim).map(|i| (1.7 * i as f64).sin()).collect();
            let rigid = kernel.transpose_times(&force);
            kernel.add_motion(-1.0, &rigid, &mut force);
            let u = dense.cholesky().expect("definite").solve(&DVector::from_vec(force));
            let at_rest = own.anchors.iter().all(|&i| u[i].abs() < 1e-9 * u.amax());
            let mut springs = vec![0.0; u.len()];
            for &(node, n, k) in &own.springs {
                let along: f64 = (0..3).map(|c| n[c] * u[3 * node + c]).sum();
                (0..3).for_each(|c| springs[3 * node + c] += k * along * n[c]);
            }
            let wrench = kernel
                .transpose_times(&springs)
                .into_iter()
                .fold(0.0, |m: f64, w| m.max(w.abs()));
            assert!(at_rest && wrench < 1e-9, "{free}: {wrench:e}");
        }
        // far less than a thousandth of the work of the others
        let nearly = on(brick::Y_MIN, |[x, _, z]| [1e-4 * (x + z), 1.0, 0.0]);
        assert!(Held::new(&stiffness, &kernel, &nearly).is_none());
    }
}
