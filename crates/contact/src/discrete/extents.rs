//! How large the bodies are.

use rstar::{AABB, Envelope};
use signorini_fem_mesh::internal::DisjointSets;
use signorini_fem_mesh::{Decomposition, TetMesh};

/// The size of each body of a mesh.
#[derive(Debug)]
pub(crate) struct Extents {
    /// Body of each node; of a hinge the one that comes last.
    body: Vec<u32>,
    /// Longest side of the box around each body, m.
    extents: Vec<f64>,
}

/// The box around some nodes.
fn around(mesh: &TetMesh, nodes: &[u32]) -> AABB<[f64; 3]> {
    AABB::from_points(nodes.iter().map(|&node| &mesh.points()[node as usize]))
}

/// The longest side of a box, m.
fn longest(around: &AABB<[f64; 3]>) -> f64 {
    let (low, high) = (around.lower(), around.upper());
    (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max)
}

impl Extents {
    /// Bodies are sets of subdomains that share faces: each of these is connected.
    pub(crate) fn new(mesh: &TetMesh, decomposition: &Decomposition) -> Self {
        let subdomains = decomposition.subdomains();
        let mut sets = DisjointSets::new(subdomains.len());
        for (tet, &own) in decomposition.parts().iter().enumerate() {
            let others = mesh.neighbours(tet).into_iter().flatten();
            let others = others.map(|t| decomposition.parts()[t]).filter(|other| *other > own);
            others.for_each(|other| sets.join(own as usize, other as usize));
        }
        let numbers = sets.numbers();
        let bodies = numbers.iter().max().map_or(0, |last| *last as usize + 1);
        let mut body = vec![0; mesh.points().len()];
        let mut boxes = vec![AABB::new_empty(); bodies];
        for (subdomain, number) in subdomains.iter().zip(numbers) {
            boxes[number as usize].merge(&around(mesh, &subdomain.nodes));
            subdomain.nodes.iter().for_each(|&node| body[node as usize] = number);
        }
        Self {
            body,
            extents: boxes.iter().map(longest).collect(),
        }
    }

    /// Longest side of the box around a subdomain of a node, m: no more than that of its body.
    pub(crate) fn of_part(mesh: &TetMesh, decomposition: &Decomposition, node: u32) -> f64 {
        let copy = decomposition.copies(node as usize).first();
        copy.map_or(0.0, |copy| {
            let subdomain = &decomposition.subdomains()[copy.subdomain as usize];
            longest(&around(mesh, &subdomain.nodes))
        })
    }

    /// How many bodies there are.
    pub(crate) fn bodies(&self) -> usize {
        self.extents.len()
    }

    /// The body of a node.
    pub(crate) fn body(&self, node: usize) -> usize {
        self.body[node] as usize
    }

    /// Longest side of the box around the body of a node, m.
    pub(crate) fn at(&self, node: u32) -> f64 {
        self.extents[self.body[node as usize] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_fem_mesh::Brick;

    /// However bodies are cut, and wherever a cut runs.
    #[test]
    fn bodies_have_the_size_of_their_boxes() {
        let small = Brick::new([1.0; 3], [2; 3]).build().expect("brick");
        let long = Brick::new([1.0, 3.0, 1.0], [2, 6, 2]).build().expect("brick");
        let apart = long.map_points(|[x, y, z]| [x + 1.0, y, z]).expect("moved");
        let mesh = small.append(&apart).expect("two bodies");
        for boxes in [[1, 1, 1], [2, 1, 1], [1, 3, 2], [4, 2, 1]] {
            let decomposition = Decomposition::boxes(&mesh, boxes).expect("boxes");
            let extents = Extents::new(&mesh, &decomposition);
            let first = small.points().len();
            for node in 0..mesh.points().len() {
                let expected = if node < first { 1.0 } else { 3.0 };
                assert_eq!(extents.at(node as u32), expected, "{boxes:?}");
            }
        }
    }
}
