//! How large the bodies are.

use rstar::{AABB, Envelope};
use signorini_fem_mesh::decomposition::volumes_and_surfaces;
use signorini_fem_mesh::internal::{DisjointSets, count_of};
use signorini_fem_mesh::{Decomposition, TetMesh};
use std::collections::BTreeSet;

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
        // rigid ones are no bodies of their own
        let subdomains: Vec<_> = decomposition.subdomains().iter().filter(|s| !s.is_rigid()).collect();
        let mut sets = DisjointSets::new(subdomains.len());
        for (tet, &own) in decomposition.parts().iter().enumerate() {
            let others = mesh.neighbours(tet).into_iter().flatten();
            let others = others.map(|t| decomposition.parts()[t]).filter(|other| *other > own);
            others.for_each(|other| sets.join(own as usize, other as usize));
        }
        let numbers = sets.numbers();
        let mut body = vec![0; mesh.points().len()];
        let mut boxes = vec![AABB::new_empty(); count_of(&numbers)];
        for (subdomain, number) in subdomains.iter().zip(numbers) {
            boxes[number as usize].merge(&around(mesh, &subdomain.nodes));
            subdomain.nodes.iter().for_each(|&node| body[node as usize] = number);
        }
        Self {
            body,
            extents: boxes.iter().map(longest).collect(),
        }
    }

    /// The length of the longest subdomain with one of some nodes over its thickness: the longest side of the box
    /// around it, and its hydraulic diameter, four times volume over surface.
    pub(crate) fn slenderness(mesh: &TetMesh, decomposition: &Decomposition, nodes: impl Iterator<Item = u32>) -> f64 {
        let sizes = volumes_and_surfaces(mesh, decomposition.parts());
        let copies = nodes.flat_map(|node| decomposition.copies(node as usize));
        let elastic = copies.filter(|copy| !decomposition.subdomains()[copy.subdomain as usize].is_rigid());
        let touched: BTreeSet<u32> = elastic.map(|copy| copy.subdomain).collect();
        let slenderness = touched.into_iter().map(|part| {
            let ([volume, surface], part) = (sizes[part as usize], &decomposition.subdomains()[part as usize]);
            longest(&around(mesh, &part.nodes)) * surface / (4.0 * volume)
        });
        slenderness.fold(0.0, f64::max)
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

    /// Length a, width and thickness t: four times volume over surface is a t / (a + t / 2).
    #[test]
    fn parts_are_as_long_as_they_are_cut() {
        let thin = Brick::new([0.5, 12.0, 0.5], [1, 24, 1]).build().expect("brick");
        for cuts in [1, 3, 12] {
            let cut = Decomposition::boxes(&thin, [1, cuts, 1]).expect("boxes");
            let found = Extents::slenderness(&thin, &cut, [0].into_iter());
            let long = 12.0 / cuts as f64;
            assert!((found - (long + 0.25) / 0.5).abs() < 1e-9, "{cuts}: {found}");
        }
    }

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
