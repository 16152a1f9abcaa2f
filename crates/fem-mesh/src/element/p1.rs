//! The linear tetrahedron.

use crate::vec3::{cross, dot, scale, sub};

/// A linear tetrahedron with the gradients of its four shape functions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Volume, positive for a tetrahedron of a [`TetMesh`](crate::TetMesh).
    pub volume: f64,
    /// Gradient of each shape function, constant in the element.
    pub gradients: [[f64; 3]; 4],
}

impl Element {
    /// Volume and gradients from the four nodes. Flat tetrahedra, which a
    /// [`TetMesh`](crate::TetMesh) does not contain, give infinite or undefined gradients.
    pub fn new(points: &[[f64; 3]; 4]) -> Self {
        let [a, b, c] = [1, 2, 3].map(|i| sub(points[i], points[0]));
        let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
        let six_volumes = dot(a, bc);
        let [ga, gb, gc] = [bc, ca, ab].map(|g| scale(1.0 / six_volumes, g));
        let g0 = [0, 1, 2].map(|i| -(ga[i] + gb[i] + gc[i]));
        Self {
            volume: six_volumes / 6.0,
            gradients: [g0, ga, gb, gc],
        }
    }

    /// Forces of the nodes that a stress does work with.
    pub(crate) fn forces(&self, stress: &[f64; 6]) -> [[f64; 3]; 4] {
        self.gradients.map(|g| scale(self.volume, traction(stress, g)))
    }
}

/// A stress times a vector.
pub(crate) fn traction(stress: &[f64; 6], g: [f64; 3]) -> [f64; 3] {
    let [xx, yy, zz, yz, xz, xy] = *stress;
    [dot([xx, xy, xz], g), dot([xy, yy, yz], g), dot([xz, yz, zz], g)]
}

/// Gradient of a displacement, `h[i][j]` = d u_i / d x_j, from those of the shape functions and its nodal values.
pub(crate) fn displacement_gradient<const N: usize>(gradients: &[[f64; 3]; N], u: &[[f64; 3]; N]) -> [[f64; 3]; 3] {
    let entry = |i: usize, j: usize| (0..N).map(|a| u[a][i] * gradients[a][j]).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// Strain of a displacement gradient `h[i][j]` = d u_i / d x_j, in Voigt order xx, yy, zz, yz, xz, xy with engineering
/// shear.
pub(crate) fn strain_of(h: &[[f64; 3]; 3]) -> [f64; 6] {
    let shear = |i: usize, j: usize| h[i][j] + h[j][i];
    [h[0][0], h[1][1], h[2][2], shear(1, 2), shear(0, 2), shear(0, 1)]
}

/// Stress of unit displacements of one node, times the volume: C B_b as a 6 x 3 matrix by rows.
pub(crate) fn nodal_stress(c: &[[f64; 6]; 6], g: [f64; 3], volume: f64) -> [[f64; 3]; 6] {
    let [x, y, z] = [g[0] * volume, g[1] * volume, g[2] * volume];
    std::array::from_fn(|i| {
        let c = &c[i];
        [
            c[0] * x + c[4] * z + c[5] * y,
            c[1] * y + c[3] * z + c[5] * x,
            c[2] * z + c[3] * y + c[4] * x,
        ]
    })
}

/// What unit displacements of one node do to another one, by rows.
pub(crate) type Block = [[f64; 3]; 3];

/// Block B_a^T (C B_b) of the stiffness, 3 x 3 by rows.
pub(crate) fn stiffness_block(g: [f64; 3], s: &[[f64; 3]; 6]) -> Block {
    let row = |i0: usize, i1: usize, i2: usize| [0, 1, 2].map(|k| g[0] * s[i0][k] + g[1] * s[i1][k] + g[2] * s[i2][k]);
    [row(0, 5, 4), row(5, 1, 3), row(4, 3, 2)]
}
