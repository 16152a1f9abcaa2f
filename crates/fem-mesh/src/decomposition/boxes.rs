//! Subdomains that are boxes of a grid.

use crate::mesh::{TetMesh, connected_sets};
use crate::vec3;
use rayon::prelude::*;

use super::subdomains::{Decomposition, DecompositionError};

impl Decomposition {
    /// Cuts the bounding box of the mesh into a grid of equal boxes; each tetrahedron goes where
    /// its centroid lies.
    ///
    /// Subdomains are numbered as their boxes, slowest along the axis with most boxes (of equal ones
    /// z before y before x), so that consecutive ones meet others in small faces. A box without
    /// tetrahedra is dropped. A box whose tetrahedra are not connected through faces becomes
    /// several subdomains, one after the other in the order of their first tetrahedra. There may
    /// thus be fewer or more subdomains than boxes: ask [`Decomposition::subdomains`]. Boxes
    /// little larger than the tetrahedra, or faces of boxes that cut the cells of a [`crate::Brick`]
    /// apart, give many small subdomains, which are correct but slow to solve on.
    ///
    /// # Errors
    /// [`DecompositionError::NoBoxes`] if a count is zero.
    pub fn boxes(mesh: &TetMesh, boxes: [usize; 3]) -> Result<Self, DecompositionError> {
        for (d, axis) in ["x", "y", "z"].into_iter().enumerate() {
            if boxes[d] == 0 {
                return Err(DecompositionError::NoBoxes { boxes, axis });
            }
        }
        let (low, high) = mesh.extent();
        // Indices of the box, slowest first: their order is that of the boxes, and no product overflows.
        let mut axes = [2, 1, 0];
        axes.sort_by_key(|&d: &usize| std::cmp::Reverse(boxes[d]));
        let box_of = |tet: usize| {
            let centre = vec3::centroid(&mesh.tet_points(tet));
            axes.map(|d| {
                let place = (centre[d] - low[d]) / (high[d] - low[d]) * boxes[d] as f64;
                (place as usize).min(boxes[d] - 1)
            })
        };
        let boxes: Vec<[usize; 3]> = (0..mesh.tets().len()).into_par_iter().map(box_of).collect();
        let pieces = connected_sets(mesh.neighbour_table(), |a, b| boxes[a] == boxes[b]);
        // Pieces are labelled by their first tetrahedra, so each new label is the next one.
        let mut order = Vec::new();
        for (&grid, &piece) in boxes.iter().zip(&pieces) {
            if piece as usize == order.len() {
                order.push((grid, piece));
            }
        }
        order.sort_unstable();
        let mut number = vec![0; order.len()];
        for (place, &(_, piece)) in order.iter().enumerate() {
            number[piece as usize] = place as u32;
        }
        let part_of = pieces.par_iter().map(|&piece| number[piece as usize]).collect();
        Ok(Self::build(mesh, part_of))
    }
}
