//! The quadratic tetrahedron, with straight or curved edges.

use crate::mesh::{EDGES, tangents};
use crate::quadrature::FOUR_POINTS;
use crate::vec3::{Vec3, add, scale};

use super::p1::{Element, nodal_stress, stiffness_block};

/// Volume of the tangent tetrahedron at barycentric coordinates, and the gradients of the ten shape functions there.
pub(crate) fn gradients(points: &[Vec3; 10], l: &[f64; 4]) -> (f64, [Vec3; 10]) {
    let Element { volume, gradients: g } = Element::new(&tangents(points, l));
    let corner = |i: usize| scale(4.0 * l[i] - 1.0, g[i]);
    let mid = |[a, b]: [usize; 2]| add(scale(4.0 * l[a], g[b]), scale(4.0 * l[b], g[a]));
    (
        volume,
        std::array::from_fn(|k| if k < 4 { corner(k) } else { mid(EDGES[k - 4]) }),
    )
}

/// Gradient of a displacement, `h[i][j]` = d u_i / d x_j, from the gradients of the shape functions.
pub(crate) fn displacement_gradient(gradients: &[Vec3; 10], u: &[Vec3; 10]) -> [[f64; 3]; 3] {
    let entry = |i: usize, j: usize| (0..10).map(|a| u[a][i] * gradients[a][j]).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// Gradients at the four points that the stiffness is summed over, with a quarter of the volume there: exact where
/// edges are straight, and of the order of the element where they are curved.
pub(crate) struct QuadraticElement([(f64, [Vec3; 10]); 4]);

impl QuadraticElement {
    pub(crate) fn new(points: &[Vec3; 10]) -> Self {
        Self(FOUR_POINTS.map(|l| {
            let (volume, gradients) = gradients(points, &l);
            (0.25 * volume, gradients)
        }))
    }

    /// Blocks of the column of node `b` in the rows that are wanted.
    pub(crate) fn column(
        &self,
        law: &[[f64; 6]; 6],
        b: usize,
        is_wanted: impl Fn(usize) -> bool,
    ) -> [[[f64; 3]; 3]; 10] {
        let mut blocks = [[[0.0; 3]; 3]; 10];
        for (volume, gradients) in &self.0 {
            let stress = nodal_stress(law, gradients[b], *volume);
            for (a, sum) in blocks.iter_mut().enumerate().filter(|(a, _)| is_wanted(*a)) {
                let block = stiffness_block(gradients[a], &stress);
                (0..9).for_each(|k| sum[k / 3][k % 3] += block[k / 3][k % 3]);
            }
        }
        blocks
    }
}
