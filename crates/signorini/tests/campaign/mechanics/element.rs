//! Functions of a tetrahedron, and its law.

use crate::recipe::Elastic;
use crate::vec3::{Vec3, add, cross, dot, scale, sub};

/// Gradients of the barycentric coordinates, and the volume.
pub(super) fn shape(x: [Vec3; 4]) -> ([Vec3; 4], f64) {
    let mut gradients = [[0.0; 3]; 4];
    let mut volume = 0.0;
    for a in 0..4 {
        // the gradient is the normal of the opposite face over the height
        let [b, c, d] = [1, 2, 3].map(|k| x[(a + k) % 4]);
        let normal = cross(sub(c, b), sub(d, b));
        let height = dot(normal, sub(x[a], b));
        gradients[a] = scale(1.0 / height, normal);
        volume = height.abs() / 6.0;
    }
    (gradients, volume)
}

/// Gradients of the ten quadratic functions at the point of the rule of degree 2 that is nearest to a corner, and the
/// quarter of the volume there.
pub(super) fn quadratic(places: &[Vec3], corner: usize) -> (f64, Vec<Vec3>) {
    let near = (5.0 + 3.0 * 5f64.sqrt()) / 20.0;
    let l = |k: usize| if k == corner { near } else { (1.0 - near) / 3.0 };
    let edges = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];
    // the tetrahedron that is tangent to the element there
    let mut tangents = [0, 1, 2, 3].map(|k| scale(4.0 * l(k) - 1.0, places[k]));
    for ([a, b], mid) in edges.into_iter().zip(&places[4..]) {
        tangents[a] = add(tangents[a], scale(4.0 * l(b), *mid));
        tangents[b] = add(tangents[b], scale(4.0 * l(a), *mid));
    }
    let (linear, volume) = shape(tangents);
    let corners = (0..4).map(|k| scale(4.0 * l(k) - 1.0, linear[k]));
    let mids = edges.map(|[a, b]| add(scale(4.0 * l(b), linear[a]), scale(4.0 * l(a), linear[b])));
    (0.25 * volume, corners.chain(mids).collect())
}

pub(super) fn matrix(elastic: &Elastic) -> [[f64; 6]; 6] {
    match elastic {
        Elastic::Matrix(matrix) => **matrix,
        Elastic::Isotropic(young, poisson) => {
            // from the compliance: strain_i = (s_i - nu (s_j + s_k)) / E
            let factor = young / (1.0 + poisson) / (1.0 - 2.0 * poisson);
            let mut out = [[0.0; 6]; 6];
            for i in 0..3 {
                for j in 0..3 {
                    out[i][j] = factor * if i == j { 1.0 - poisson } else { *poisson };
                }
                out[i + 3][i + 3] = 0.5 * factor * (1.0 - 2.0 * poisson);
            }
            out
        }
    }
}
