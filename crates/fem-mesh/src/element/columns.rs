//! The stiffness of elements by columns of nodes.

use crate::material::Hooke;

use super::p1::{Block, Element, nodal_stress, stiffness_block};
use super::p2::QuadraticElement;

/// Node numbers of a tetrahedron: four of a linear one, ten of a quadratic one.
pub trait TetNodes: Copy + Sync {
    /// Hands out the blocks in the column of mesh node `node` that are in the rows of nodes not before it.
    #[doc(hidden)]
    fn lower_column(&self, points: &[[f64; 3]], law: &Hooke, node: usize, add: impl FnMut(usize, &[[f64; 3]; 3]));
}

impl TetNodes for [u32; 4] {
    fn lower_column(&self, points: &[[f64; 3]], law: &Hooke, node: usize, mut add: impl FnMut(usize, &Block)) {
        let tet = self.map(|n| n as usize);
        let element = Element::new(&tet.map(|n| points[n]));
        for b in (0..4).filter(|&b| tet[b] == node) {
            let stress = nodal_stress(law.voigt(), element.gradients[b], element.volume);
            for a in (0..4).filter(|&a| tet[a] >= node) {
                add(tet[a], &stiffness_block(element.gradients[a], &stress));
            }
        }
    }
}

impl TetNodes for [u32; 10] {
    fn lower_column(&self, points: &[[f64; 3]], law: &Hooke, node: usize, mut add: impl FnMut(usize, &Block)) {
        let tet = self.map(|n| n as usize);
        let element = QuadraticElement::new(&tet.map(|n| points[n]), law);
        for b in (0..10).filter(|&b| tet[b] == node) {
            let blocks = element.column(law, b, |a| tet[a] >= node);
            for a in (0..10).filter(|&a| tet[a] >= node) {
                add(tet[a], &blocks[a]);
            }
        }
    }
}
