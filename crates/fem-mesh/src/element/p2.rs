//! The quadratic tetrahedron, with straight or curved edges.

use crate::material::Hooke;
use crate::mesh::{EDGES, tangents};
use crate::quadrature::FOUR_POINTS;
use crate::vec3::{Vec3, add, scale, sub};

use super::p1::{Block, Element, nodal_stress, stiffness_block, traction};

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

/// Gradients at the four points that the stiffness is summed over, with a quarter of the volume there: exact where
/// edges are straight, and of the order of the element where they are curved.
pub(crate) struct QuadraticElement {
    points: [(f64, [Vec3; 10]); 4],
    /// Mean of the gradients, where the volume strain is its mean over the element.
    mean: Option<[Vec3; 10]>,
}

impl QuadraticElement {
    /// Nearly incompressible material has the mean of the volume strain in place of itself (B-bar; T. Hughes, Int. J.
    /// Numer. Methods Eng. 15, 1980): with plain quadratic strains the element locks.
    pub(crate) fn new(points: &[Vec3; 10], law: &Hooke) -> Self {
        let points = FOUR_POINTS.map(|l| {
            let (volume, gradients) = gradients(points, &l);
            (0.25 * volume, gradients)
        });
        let mean = law.is_nearly_incompressible().then(|| {
            let total: f64 = points.iter().map(|p| p.0).sum();
            let of_node = |k: usize| {
                let sum = points.iter().fold([0.0; 3], |sum, (w, g)| add(sum, scale(*w, g[k])));
                scale(1.0 / total, sum)
            };
            std::array::from_fn(of_node)
        });
        Self { points, mean }
    }

    /// Forces of the nodes that a stress at barycentric coordinates does work with.
    pub(crate) fn forces(&self, stress: impl Fn(&[f64; 4]) -> [f64; 6]) -> [Vec3; 10] {
        let mut forces = [[0.0; 3]; 10];
        for ((volume, gradients), l) in self.points.iter().zip(&FOUR_POINTS) {
            let stress = stress(l);
            let pressure = (stress[0] + stress[1] + stress[2]) / 3.0;
            for (a, force) in forces.iter_mut().enumerate() {
                let mut own = traction(&stress, gradients[a]);
                if let Some(mean) = self.mean {
                    own = add(own, scale(pressure, sub(mean[a], gradients[a])));
                }
                *force = add(*force, scale(*volume, own));
            }
        }
        forces
    }

    /// Blocks of the column of node `b` in the rows that are wanted.
    pub(crate) fn column(&self, law: &Hooke, b: usize, is_wanted: impl Fn(usize) -> bool) -> [Block; 10] {
        let mut blocks = [[[0.0; 3]; 3]; 10];
        let law = law.voigt();
        for (volume, gradients) in &self.points {
            let mut stress = nodal_stress(law, gradients[b], *volume);
            // a third of the volume strain that the mean has more, for displacements of a node
            let more = |k: usize| self.mean.map(|mean| scale(1.0 / 3.0, sub(mean[k], gradients[k])));
            if let Some(more) = more(b) {
                for (row, stress) in law.iter().zip(&mut stress) {
                    let pressure = volume * (row[0] + row[1] + row[2]);
                    (0..3).for_each(|c| stress[c] += pressure * more[c]);
                }
            }
            for (a, sum) in blocks.iter_mut().enumerate().filter(|(a, _)| is_wanted(*a)) {
                let block = stiffness_block(gradients[a], &stress);
                (0..9).for_each(|k| sum[k / 3][k % 3] += block[k / 3][k % 3]);
                if let Some(more) = more(a) {
                    let trace: Vec3 = std::array::from_fn(|c| stress[0][c] + stress[1][c] + stress[2][c]);
                    (0..9).for_each(|k| sum[k / 3][k % 3] += more[k / 3] * trace[k % 3]);
                }
            }
        }
        blocks
    }
}
