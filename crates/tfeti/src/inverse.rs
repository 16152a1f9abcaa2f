//! Generalised inverses of the stiffness matrix of one class.
//!
//! Dense: with `R` orthonormal and `a = trace(K)/dim`, the Moore-Penrose inverse is `(K + a R R^T)^-1 - R R^T / a`.
//! Sparse: `K` plus six springs on three nodes (the 3-2-1 rule) is positive definite and its inverse a generalised
//! inverse of `K`; between two projections `I - R R^T` it becomes the Moore-Penrose inverse.

use crate::dense;
use crate::error::TfetiError;
use crate::kernel::Kernel;
use crate::sparse::{Columns, FactorError, MemoryNeed, SolveMemory, SparseCholesky, Symbolic};

/// A generalised inverse of the whole matrix of one subdomain.
#[derive(Debug, Clone)]
pub(crate) enum Inverse {
    /// Moore-Penrose inverse, column-major, `dim x dim`.
    Dense(Vec<f64>),
    /// Factor of the regularised matrix.
    Sparse {
        factor: SparseCholesky,
        /// Whether products are projected to the Moore-Penrose inverse.
        project: bool,
    },
}

/// Work memory for [`Inverse::apply`].
#[derive(Debug)]
pub(crate) struct InverseMemory(Option<SolveMemory>);

impl InverseMemory {
    /// Memory that serves each of some inverses with its number of columns.
    pub(crate) fn for_all(inverses: &[(&Inverse, usize)]) -> Self {
        let needs = inverses
            .iter()
            .filter_map(|(inverse, columns)| match inverse {
                Inverse::Dense(_) => None,
                Inverse::Sparse { factor, .. } => Some(factor.need(*columns)),
            });
        Self(needs.reduce(MemoryNeed::or).map(SolveMemory::new))
    }
}

impl Inverse {
    pub(crate) fn memory(&self, columns: usize) -> InverseMemory {
        InverseMemory::for_all(&[(self, columns)])
    }

    pub(crate) fn bytes(&self) -> u64 {
        8 * match self {
            Self::Dense(values) => values.len() as u64,
            Self::Sparse { factor, .. } => factor.stored() as u64,
        }
    }

    /// `out = K+ x` for column-major blocks; `x` is overwritten.
    pub(crate) fn apply(
        &self,
        kernel: &Kernel,
        x: &mut [f64],
        out: &mut [f64],
        columns: usize,
        memory: &mut InverseMemory,
    ) {
        let dim = 3 * kernel.nodes();
        match self {
            Self::Dense(values) => dense::multiply(out, values, x, dim, dim, columns),
            Self::Sparse { factor, project } => {
                if *project {
                    remove_rigid(kernel, x);
                }
                if let Some(memory) = &mut memory.0 {
                    factor.solve(x, columns, memory);
                }
                if *project {
                    remove_rigid(kernel, x);
                }
                out[..dim * columns].copy_from_slice(x);
            }
        }
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
fn scale(stiffness: &Columns) -> f64 {
    let trace: f64 = (0..stiffness.dim)
        .filter_map(|i| stiffness.find(i, i))
        .map(|k| stiffness.values[k])
        .sum();
    trace / stiffness.dim.max(1) as f64
}

/// Pivots below this share of the scale mean a further motion without strain.
fn threshold(dim: usize) -> f64 {
    dim as f64 * f64::EPSILON
}

/// The whole Moore-Penrose inverse as a dense matrix.
pub(crate) fn dense_inverse(
    stiffness: &Columns,
    kernel: &Kernel,
    subdomain: usize,
) -> Result<Inverse, TfetiError> {
    let dim = stiffness.dim;
    let modes = kernel.modes();
    let a = scale(stiffness);
    let mut matrix = vec![0.0; dim * dim];
    dense::add_product_transposed(&mut matrix, a, &modes, &modes, dim, 6, dim);
    for j in 0..dim {
        let (rows, values) = stiffness.column(j);
        for (&i, &v) in rows.iter().zip(values) {
            matrix[i + j * dim] += v;
        }
    }
    let mut inverse = dense::inverse(matrix, dim, a * threshold(dim))
        .map_err(|pivot| TfetiError::Singular { subdomain, pivot })?;
    dense::add_product_transposed(&mut inverse, -1.0 / a, &modes, &modes, dim, 6, dim);
    dense::mirror_lower(&mut inverse, dim);
    Ok(Inverse::Dense(inverse))
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
    let norm = |v: [f64; 3]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let first = farthest(&|p| norm(*p));
    let a = *kernel.arm(first);
    let second = farthest(&|p| norm(sub(p, &a)));
    let axis = unit(sub(kernel.arm(second), &a));
    let third = farthest(&|p| norm(cross(&axis, &sub(p, &a))));
    [first, second, third]
}

fn sub(p: &[f64; 3], q: &[f64; 3]) -> [f64; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

fn cross(p: &[f64; 3], q: &[f64; 3]) -> [f64; 3] {
    [
        p[1] * q[2] - p[2] * q[1],
        p[2] * q[0] - p[0] * q[2],
        p[0] * q[1] - p[1] * q[0],
    ]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    if length > 0.0 {
        v.map(|c| c / length)
    } else {
        [1.0, 0.0, 0.0]
    }
}

/// `K` plus springs of mean stiffness that stop the six rigid motions and nothing else.
pub(crate) fn regularised(stiffness: &Columns, kernel: &Kernel) -> Columns {
    let mut matrix = stiffness.clone();
    let strength = scale(stiffness);
    let [first, second, third] = anchors(kernel);
    let axis = unit(sub(kernel.arm(second), kernel.arm(first)));
    let normal = unit(cross(&axis, &sub(kernel.arm(third), kernel.arm(first))));
    let mut spring = |node: usize, block: &dyn Fn(usize, usize) -> f64| {
        for i in 0..3 {
            for j in 0..3 {
                if let Some(k) = matrix.find(3 * node + i, 3 * node + j) {
                    matrix.values[k] += strength * block(i, j);
                }
            }
        }
    };
    let identity = |i: usize, j: usize| f64::from(u8::from(i == j));
    spring(first, &identity);
    spring(second, &|i, j| identity(i, j) - axis[i] * axis[j]);
    spring(third, &|i, j| normal[i] * normal[j]);
    matrix
}

/// Sparse factor of the regularised matrix.
pub(crate) fn sparse_inverse(
    stiffness: &Columns,
    kernel: &Kernel,
    symbolic: &Symbolic,
    project: bool,
    subdomain: usize,
) -> Result<Inverse, TfetiError> {
    let matrix = regularised(stiffness, kernel);
    let singular = |pivot| TfetiError::Singular { subdomain, pivot };
    let factor =
        SparseCholesky::new(symbolic, &matrix).map_err(|error| pattern_error(error, subdomain))?;
    let (smallest, pivot, largest) = factor.pivots();
    if smallest.is_nan() || smallest <= largest * threshold(stiffness.dim) {
        return Err(singular(pivot));
    }
    Ok(Inverse::Sparse { factor, project })
}

/// Turns a failure of the factorisation into an error that names the subdomain.
pub(crate) fn pattern_error(error: FactorError, subdomain: usize) -> TfetiError {
    match error {
        FactorError::Pivot(pivot) => TfetiError::Singular { subdomain, pivot },
        FactorError::Pattern => TfetiError::TooLarge {
            what: "entries of a subdomain factor",
            count: subdomain,
        },
    }
}

/// The rows and columns of `K+` that belong to the boundary nodes, column-major.
pub(crate) fn boundary_block(inverse: &Inverse, kernel: &Kernel, boundary: &[u32]) -> Vec<f64> {
    let (dim, size) = (3 * kernel.nodes(), 3 * boundary.len());
    let mut out = vec![0.0; size * size];
    let dof = |b: usize| 3 * boundary[b / 3] as usize + b % 3;
    if let Inverse::Dense(values) = inverse {
        for j in 0..size {
            let column = &values[dim * dof(j)..][..dim];
            for i in 0..size {
                out[i + j * size] = column[dof(i)];
            }
        }
        return out;
    }
    const COLUMNS: usize = 64;
    let mut memory = inverse.memory(COLUMNS);
    let (mut x, mut y) = (vec![0.0; dim * COLUMNS], vec![0.0; dim * COLUMNS]);
    for start in (0..size).step_by(COLUMNS) {
        let count = COLUMNS.min(size - start);
        let (x, y) = (&mut x[..dim * count], &mut y[..dim * count]);
        x.fill(0.0);
        for j in 0..count {
            x[j * dim + dof(start + j)] = 1.0;
        }
        inverse.apply(kernel, x, y, count, &mut memory);
        for j in 0..count {
            for i in 0..size {
                out[i + (start + j) * size] = y[j * dim + dof(i)];
            }
        }
    }
    // Rounding makes the solved columns unsymmetric in the last digits.
    for j in 0..size {
        for i in j + 1..size {
            let mean = 0.5 * (out[i + j * size] + out[j + i * size]);
            out[i + j * size] = mean;
            out[j + i * size] = mean;
        }
    }
    out
}
