//! Generalised inverses of the stiffness matrix of one class.
//!
//! `K` plus six springs on three nodes (the 3-2-1 rule) is positive definite, and its inverse `K^-` is a generalised
//! inverse of `K`: the springs stop the rigid motions and carry no force when the loads are in balance. Between two
//! projections `I - R R^T` it becomes the Moore-Penrose inverse. Products with many columns use the dense block of it
//! on the boundary.

use crate::error::TfetiError;
use crate::linalg::dense;
use crate::linalg::sparse::{Columns, FactorError, MemoryNeed, SolveMemory, SparseCholesky, Symbolic};
use crate::subdomain::kernel::Kernel;
use crate::subdomain::packed::PackedFactor;
use crate::tolerances::{COLUMNS, CONTRAST, FURTHER_MOTION, LEFT_OF_IT};
use signorini_fem_mesh::vec3::{cross, dot, norm, sub};

/// A generalised inverse of the whole matrix of one subdomain.
#[derive(Debug)]
pub(crate) enum Inverse {
    /// A factor of the regularised matrix for many columns at once.
    Sparse(SparseCholesky),
    /// For one column.
    Packed(PackedFactor),
}

/// The largest entry of the diagonal over the smallest one.
fn contrast(matrix: &Columns) -> f64 {
    let diagonal = (0..matrix.dim).map(|i| matrix.diagonal(i));
    let (low, high) = diagonal.fold((f64::INFINITY, 0.0_f64), |(low, high), d| (low.min(d), high.max(d)));
    high / low
}

impl Inverse {
    /// Factorises a [`regularised`] matrix of this symbolic factor.
    pub(crate) fn new(matrix: &Columns, symbolic: &Symbolic, subdomain: usize) -> Result<Self, TfetiError> {
        let singular = |pivot| match contrast(matrix) {
            ratio if ratio > CONTRAST => TfetiError::Contrast { subdomain, ratio },
            _ => TfetiError::Singular { subdomain, pivot },
        };
        let factor = SparseCholesky::new(symbolic, matrix).map_err(|error| match error {
            FactorError::Pivot(pivot) => singular(pivot),
            error => TfetiError::pattern(error, subdomain),
        })?;
        let (smallest, pivot, largest) = factor.pivots();
        let stiff = matrix.diagonal(factor.order()[pivot] as usize);
        // what is soft beside other materials has little of the largest, but not of its own
        let rounding = smallest <= largest * matrix.dim as f64 * f64::EPSILON;
        let vanishes = smallest <= FURTHER_MOTION * largest && smallest <= LEFT_OF_IT * stiff;
        if smallest.is_nan() || rounding || vanishes {
            return Err(singular(pivot));
        }
        Ok(Self::Sparse(factor))
    }

    /// Whether it is stored for products with one column.
    pub(crate) fn is_packed(&self) -> bool {
        matches!(self, Self::Packed(_))
    }

    /// The same, stored for products with one column.
    pub(crate) fn packed(self, stiffness: &Columns) -> Self {
        match self {
            Self::Sparse(factor) => Self::Packed(PackedFactor::new(&factor, stiffness)),
            packed => packed,
        }
    }

    /// Work memory that products with so many columns need.
    pub(crate) fn need(&self, columns: usize) -> MemoryNeed {
        match self {
            Self::Sparse(factor) => factor.need(columns),
            Self::Packed(factor) => factor.need(),
        }
    }

    /// Numbers stored.
    pub(crate) fn stored(&self) -> usize {
        match self {
            Self::Sparse(factor) => factor.stored(),
            Self::Packed(factor) => factor.stored(),
        }
    }

    fn solve(&self, x: &mut [f64], columns: usize, memory: &mut SolveMemory) {
        match self {
            Self::Sparse(factor) => factor.solve(x, columns, memory),
            Self::Packed(factor) => factor.solve(x, &mut memory.numbers),
        }
    }

    /// `X = K+ X` in place for column-major blocks.
    pub(crate) fn apply(&self, kernel: &Kernel, x: &mut [f64], columns: usize, memory: &mut SolveMemory) {
        remove_rigid(kernel, x);
        self.solve(x, columns, memory);
        remove_rigid(kernel, x);
    }

    /// Rows and columns of the Moore-Penrose inverse that belong to the boundary nodes, column-major.
    ///
    /// With `Z = K^- R` and `S = R^T Z`, `(I - R R^T) K^- (I - R R^T) = K^- - R W^T - W R^T`, `W = Z - R S / 2`.
    pub(crate) fn boundary_block(&self, kernel: &Kernel, boundary: &[u32]) -> Vec<f64> {
        let (dim, size) = (3 * kernel.nodes(), 3 * boundary.len());
        let dof = |b: usize| 3 * boundary[b / 3] as usize + b % 3;
        let columns = COLUMNS;
        let mut memory = SolveMemory::new(self.need(columns));
        let mut out = vec![0.0; size * size];
        let mut x = vec![0.0; dim * columns];
        for start in (0..size).step_by(columns) {
            let count = columns.min(size - start);
            let x = &mut x[..dim * count];
            x.fill(0.0);
            (0..count).for_each(|j| x[j * dim + dof(start + j)] = 1.0);
            self.solve(x, count, &mut memory);
            for (column, target) in x.chunks_exact(dim).zip(out[start * size..].chunks_exact_mut(size)) {
                target.iter_mut().enumerate().for_each(|(i, v)| *v = column[dof(i)]);
            }
        }
        // The rank-six correction by the rigid motions.
        let modes = kernel.modes();
        let z = &mut x[..6 * dim];
        z.copy_from_slice(&modes);
        self.solve(z, 6, &mut memory);
        let mut s = [[0.0; 6]; 6];
        for (m, z) in z.chunks_exact(dim).enumerate() {
            let products = kernel.transpose_times(z);
            (0..6).for_each(|k| s[k][m] = products[k]);
        }
        let (mut r, mut w) = (vec![0.0; 6 * size], vec![0.0; 6 * size]);
        for m in 0..6 {
            for i in 0..size {
                r[m * size + i] = modes[m * dim + dof(i)];
                let half: f64 = (0..6).map(|k| modes[k * dim + dof(i)] * s[k][m]).sum();
                w[m * size + i] = z[m * dim + dof(i)] - 0.5 * half;
            }
        }
        dense::add_product_transposed(&mut out, -1.0, &r, &w, size, 6, size);
        dense::add_product_transposed(&mut out, -1.0, &w, &r, size, 6, size);
        // Rounding makes the solved columns unsymmetric in the last digits.
        for j in 0..size {
            for i in j + 1..size {
                out[i + j * size] = 0.5 * (out[i + j * size] + out[j + i * size]);
            }
        }
        dense::mirror_lower(&mut out, size);
        out
    }
}

/// `x = (I - R R^T) x` for every column.
fn remove_rigid(kernel: &Kernel, x: &mut [f64]) {
    for column in x.chunks_exact_mut(3 * kernel.nodes()) {
        let amplitudes = kernel.transpose_times(column);
        kernel.add_motion(-1.0, &amplitudes, column);
    }
}

/// Mean of the diagonal: the scale of the matrix.
pub(super) fn scale(stiffness: &Columns) -> f64 {
    let trace: f64 = (0..stiffness.dim).map(|i| stiffness.diagonal(i)).sum();
    trace / stiffness.dim.max(1) as f64
}

/// Three nodes that span the subdomain, for the springs of the 3-2-1 rule.
fn anchors(kernel: &Kernel) -> [usize; 3] {
    let farthest = |distance: &dyn Fn(&[f64; 3]) -> f64| {
        let mut best = (0, f64::NEG_INFINITY);
        for node in 0..kernel.nodes() {
            let d = distance(kernel.arm(node));
            if d > best.1 {
                best = (node, d);
            }
        }
        best.0
    };
    let square = |v| dot(v, v);
    let first = farthest(&|p| square(*p));
    let a = *kernel.arm(first);
    let second = farthest(&|p| square(sub(*p, a)));
    let axis = unit(sub(*kernel.arm(second), a));
    let third = farthest(&|p| square(cross(axis, sub(*p, a))));
    [first, second, third]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = norm(v);
    if length > 0.0 { v.map(|c| c / length) } else { [1.0, 0.0, 0.0] }
}

/// `K` plus springs of mean stiffness that stop the six rigid motions and nothing else.
pub(crate) fn regularised(stiffness: &Columns, kernel: &Kernel) -> Columns {
    let mut matrix = stiffness.clone();
    let strength = scale(stiffness);
    let [first, second, third] = anchors(kernel);
    let from_first = |node: usize| sub(*kernel.arm(node), *kernel.arm(first));
    let axis = unit(from_first(second));
    let normal = unit(cross(axis, from_first(third)));
    let identity = |i: usize, j: usize| f64::from(u8::from(i == j));
    matrix.add_to_node(first, |i, j| strength * identity(i, j));
    matrix.add_to_node(second, |i, j| strength * (identity(i, j) - axis[i] * axis[j]));
    matrix.add_to_node(third, |i, j| strength * (normal[i] * normal[j]));
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_fem_mesh::decomposition::split_disconnected;
    use signorini_fem_mesh::{Brick, Decomposition, Hooke, assemble_stiffness};

    fn inverse(points: &[[f64; 3]], tets: &[[u32; 4]]) -> Result<(Columns, Kernel, Inverse), TfetiError> {
        let hooke = Hooke::isotropic(2.0e11, 0.3).unwrap();
        let stiffness = Columns::from_symmetric(&assemble_stiffness(points, tets, |_| &hooke).unwrap());
        let kernel = Kernel::new(points, 4).unwrap();
        let matrix = regularised(&stiffness, &kernel);
        let inverse = Inverse::new(&matrix, &Symbolic::new(&matrix, 3).unwrap(), 4)?;
        Ok((stiffness, kernel, inverse))
    }

    const TET: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    /// The four laws of Moore and Penrose, on the whole matrix.
    #[test]
    fn dense_block_of_all_nodes_is_the_moore_penrose_inverse() {
        let points: Vec<[f64; 3]> = TET.into_iter().chain([[1.0, 1.0, 1.0]]).collect();
        let (stiffness, kernel, inverse) = inverse(&points, &[[0, 1, 2, 3], [4, 2, 1, 3]]).unwrap();
        let n = stiffness.dim;
        let block = inverse.boundary_block(&kernel, &[0, 1, 2, 3, 4]);
        let mut k = vec![0.0; n * n];
        for j in 0..n {
            let (rows, values) = stiffness.column(j);
            rows.iter().zip(values).for_each(|(&i, v)| k[i + j * n] = *v);
        }
        let times = |a: &[f64], b: &[f64]| {
            let mut out = vec![0.0; n * n];
            dense::multiply(&mut out, a, b, n, n, n);
            out
        };
        let close = |a: &[f64], b: &[f64]| {
            let size = b.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-11 * size)
        };
        let (left, right) = (times(&k, &block), times(&block, &k));
        assert!(close(&times(&left, &k), &k) && close(&times(&right, &block), &block));
        assert!(close(&left, &right), "K K+ = K+ K is symmetric");
        // The solver gives the same columns.
        let mut memory = SolveMemory::new(inverse.need(1));
        let mut x = vec![0.0; n];
        x[7] = 1.0;
        inverse.apply(&kernel, &mut x, 1, &mut memory);
        assert!(close(&x, &block[7 * n..8 * n]));
    }

    #[test]
    fn a_pattern_error_names_the_subdomain() {
        let text = TfetiError::pattern(FactorError::Pattern, 7).to_string();
        assert!(text.starts_with("subdomain 7: "), "{text}");
    }

    #[test]
    fn a_hinge_is_named() {
        // Two tetrahedra that share one edge turn about it without strain.
        let points: Vec<[f64; 3]> = TET.into_iter().chain([[-1.0, -1.0, 0.2], [-1.0, 0.1, -1.0]]).collect();
        let error = inverse(&points, &[[0, 1, 2, 3], [0, 1, 4, 5]]).unwrap_err();
        assert!(matches!(error, TfetiError::Singular { subdomain: 4, .. }), "{error}");
    }

    /// Materials too far apart are no hinge.
    #[test]
    fn materials_that_rounding_hides_are_named() {
        let mesh = Brick::new([1.0; 3], [6, 2, 2]).build().unwrap();
        let soft = Hooke::isotropic(1.0, 0.3).unwrap();
        for (stiff, refused) in [(1e3, false), (1e16, true)] {
            let hard = Hooke::isotropic(stiff, 0.3).unwrap();
            let law = |t: usize| if mesh.tet_points(t).iter().all(|x| x[0] < 0.51) { &hard } else { &soft };
            let stiffness = assemble_stiffness(mesh.points(), mesh.tets(), law).unwrap();
            let matrix = regularised(
                &Columns::from_symmetric(&stiffness),
                &Kernel::new(mesh.points(), 0).unwrap(),
            );
            let found = Inverse::new(&matrix, &Symbolic::new(&matrix, 3).unwrap(), 5).err();
            let is_contrast = matches!(found, Some(TfetiError::Contrast { subdomain: 5, ratio }) if ratio > 1e12);
            assert_eq!((is_contrast, found.is_some()), (refused, refused), "{found:?}");
        }
    }

    /// Three quadratic tetrahedra that are nearly incompressible have a motion without strain at their points of
    /// pressure. Rounding leaves more of its pivot than of that of a hinge.
    #[test]
    fn three_quadratic_tetrahedra_without_compression_are_singular() {
        let (mut tried, mut passed) = (0, Vec::new());
        for seed in 0..40 {
            let lengths = [1.0, 0.5 + 0.02 * seed as f64, 1.3];
            let mesh = Brick::new(lengths, [2, 1, 2]).perturbed(0.1, seed).build().unwrap();
            let mesh = mesh.raise_order().unwrap();
            for first in 0..mesh.tets().len() {
                let beside: Vec<usize> = mesh.neighbours(first).into_iter().flatten().collect();
                let &[a, b, ..] = &beside[..] else { continue };
                let own = |t: usize| u32::from(t == first || t == a || t == b);
                let parts: Vec<u32> = (0..mesh.tets().len()).map(own).collect();
                let torn = Decomposition::from_parts(&mesh, &split_disconnected(&mesh, &parts).unwrap()).unwrap();
                let three = &torn.subdomains()[torn.parts()[first] as usize];
                let hooke = Hooke::isotropic(1e10, [0.49, 0.499, 0.4999][first % 3]).unwrap();
                let points = three.points(&mesh);
                let stiffness = assemble_stiffness(&points, &three.quadratic_tets(), |_| &hooke).unwrap();
                let stiffness = Columns::from_symmetric(&stiffness);
                let kernel = Kernel::new(&points, 0).unwrap();
                let matrix = regularised(&stiffness, &kernel);
                tried += 1;
                if Inverse::new(&matrix, &Symbolic::new(&matrix, 3).unwrap(), 0).is_ok() {
                    passed.push((seed, first));
                }
            }
        }
        assert!(
            tried > 500 && passed.is_empty(),
            "{tried} tried, not refused: {passed:?}"
        );
    }
}
