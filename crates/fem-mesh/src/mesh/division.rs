//! Hexahedra, prisms and pyramids as tetrahedra.
//!
//! A cell is the union of the tetrahedra between its corner of the smallest number and the faces without that corner; a
//! quadrilateral is cut along the diagonal from its smallest corner. Cells that share a face so cut it alike
//! (J. Dompierre et al., How to subdivide pyramids, prisms, and hexahedra into tetrahedra, 1999).

use std::collections::HashMap;
use std::ops::Range;

use crate::tables::ascending;
use crate::vec3::{Vec3, add, scale};

use super::cells::{Cell, CellShape};
use super::curved::EDGES;
use super::error::MeshError;

/// Cells divided into tetrahedra.
///
/// ```
/// use signorini_fem_mesh::TetMesh;
/// use signorini_fem_mesh::mesh::{Cell, CellShape, Division};
///
/// let mut points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// points.extend(points.clone().iter().map(|[x, y, _]| [*x, *y, 1.0]));
/// let cube = Cell { shape: CellShape::Hexahedron, nodes: &[0, 1, 2, 3, 4, 5, 6, 7] };
/// let division = Division::new(&mut points, &[cube])?;
/// let mesh = TetMesh::new(points, division.tets, Vec::new())?;
/// assert_eq!((mesh.tets().len(), mesh.total_volume()), (6, 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Division {
    /// Corners of the tetrahedra, cell by cell; a tetrahedron stays as it is.
    pub tets: Vec<[u32; 4]>,
    /// Nodes on the edges of each, if the cells have some.
    pub mids: Vec<[u32; 6]>,
    /// For the face of each that lacks its corner 3, 2, 0 and 1, in this order, the number of the face of the cell that it
    /// is a part of, from 1; 0 inside the cell.
    pub faces: Vec<[u8; 4]>,
    /// Tetrahedra of each cell.
    pub of_cell: Vec<Range<u32>>,
    /// Nodes that are added behind all others, in faces and in the middle of hexahedra that have nodes on their edges only:
    /// the nodes of the face or the cell, between which their place is interpolated.
    pub added: Vec<Vec<u32>>,
}

/// Corners of the faces of a tetrahedron, as [`Division::faces`] counts them.
const TET_FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

impl Division {
    /// Divides cells all of which have nodes on their edges, or none; new nodes are added to the points.
    ///
    /// # Errors
    /// [`MeshError::CellNodes`] for a number of nodes that a cell does not take, [`MeshError::CellNode`] for a node that
    /// there is not, [`MeshError::MixedOrder`] for cells with and without nodes on their edges, [`MeshError::TooLarge`]
    /// for more nodes or tetrahedra than can be numbered.
    pub fn new(points: &mut Vec<[f64; 3]>, cells: &[Cell<'_>]) -> Result<Self, MeshError> {
        let order = |cell: &Cell| 1 + usize::from(cell.nodes.len() > cell.shape.corners());
        let first = cells.first().map_or(1, order);
        for (number, cell) in cells.iter().enumerate() {
            if !cell.shape.takes(cell.nodes.len()) {
                let (shape, nodes) = (cell.shape, cell.nodes.len());
                return Err(MeshError::CellNodes {
                    cell: number,
                    shape,
                    nodes,
                });
            }
            if let Some(&node) = cell.nodes.iter().find(|&&n| n as usize >= points.len()) {
                let nodes = points.len();
                return Err(MeshError::CellNode {
                    cell: number,
                    node,
                    nodes,
                });
            }
            let second = order(cell);
            if first != second {
                return Err(MeshError::MixedOrder { first, second });
            }
        }
        let mut out = Self::default();
        let mut inside = Inside {
            first: points.len() as u32,
            known: HashMap::new(),
        };
        for cell in cells {
            out.add(cell, &mut inside);
            super::check::numbered("nodes", points.len() + out.added.len())?;
            super::check::numbered("tetrahedra", out.tets.len())?;
        }
        let new: Vec<_> = out.added.iter().map(|nodes| middle(points, nodes)).collect();
        points.extend(new);
        Ok(out)
    }

    fn add(&mut self, cell: &Cell, inside: &mut Inside) {
        let start = self.tets.len() as u32;
        for tet in cell.tetrahedra() {
            self.tets.push(tet.map(|k| cell.nodes[k]));
            self.faces
                .push(TET_FACES.map(|face| cell.face_of(face.map(|k| tet[k]))));
            if cell.nodes.len() > cell.shape.corners() {
                let edges = EDGES.map(|edge| edge.map(|k| tet[k]));
                self.mids
                    .push(edges.map(|edge| cell.on_edge(edge, inside, &mut self.added)));
            }
        }
        self.of_cell.push(start..self.tets.len() as u32);
    }
}

/// Nodes in faces and in the middle of cells.
struct Inside {
    /// The number of the first that is added.
    first: u32,
    /// By the corners of the diagonal.
    known: HashMap<[u32; 2], u32>,
}

impl Cell<'_> {
    /// Corners of its tetrahedra.
    fn tetrahedra(&self) -> Vec<[usize; 4]> {
        if self.shape == CellShape::Tetrahedron {
            return vec![[0, 1, 2, 3]];
        }
        let tip = (0..self.shape.corners()).min_by_key(|&k| self.nodes[k]).unwrap_or(0);
        let far = self.shape.faces().iter().filter(|face| !face.contains(&tip));
        let triangles = far.flat_map(|face| triangles(face, |k| self.nodes[k]));
        triangles.map(|[a, b, c]| [a, b, c, tip]).collect()
    }

    /// The face, from 1, that has three corners; 0 if there is none.
    fn face_of(&self, corners: [usize; 3]) -> u8 {
        let has = |face: &&[usize]| corners.iter().all(|k| face.contains(k));
        let found = self.shape.faces().iter().position(has);
        found.map_or(0, |face| face as u8 + 1)
    }

    /// Node in the middle of an edge of a tetrahedron.
    fn on_edge(&self, edge: [usize; 2], inside: &mut Inside, added: &mut Vec<Vec<u32>>) -> u32 {
        let (corners, edges) = (self.shape.corners(), self.shape.edges());
        let is_between = |corners: &[usize]| edge.iter().all(|k| corners.contains(k));
        if let Some(own) = edges.iter().position(|ends| is_between(ends)) {
            return self.nodes[corners + own];
        }
        let face = self.shape.quadrilaterals().position(is_between);
        let given = &self.nodes[corners + edges.len()..];
        if let Some(&node) = face.map_or_else(|| given.last(), |face| given.get(face)) {
            return node;
        }
        *inside
            .known
            .entry(ascending(edge.map(|k| self.nodes[k])))
            .or_insert_with(|| {
                let around = face.and_then(|face| self.shape.quadrilaterals().nth(face));
                let on = |ends: &[usize]| around.is_none_or(|face| ends.iter().all(|k| face.contains(k)));
                let all = (0..corners)
                    .filter(|&k| on(&[k]))
                    .chain((corners..).zip(edges).filter(|e| on(e.1)).map(|e| e.0));
                added.push(all.map(|k| self.nodes[k]).collect());
                inside.first + added.len() as u32 - 1
            })
    }
}

/// A face as triangles of the same orientation, one of four corners cut from that of the smallest number.
fn triangles<T: Copy, K: Ord>(face: &[T], number: impl Fn(T) -> K) -> impl Iterator<Item = [T; 3]> {
    let smallest = (0..face.len()).min_by_key(|&k| number(face[k]));
    // a triangle stays as it is
    let first = smallest.filter(|_| face.len() > 3).unwrap_or(0);
    let at = move |k: usize| face[(first + k) % face.len()];
    (2..face.len()).map(move |k| [at(0), at(k - 1), at(k)])
}

/// The triangles, of the same orientation, into which a division cuts a face, given by its corners.
pub fn divide_face(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    triangles(corners, |n| n)
}

/// The middle of a face of eight nodes, or of a hexahedron of twenty, by its shape functions.
fn middle(points: &[[f64; 3]], nodes: &[u32]) -> Vec3 {
    let sum = |nodes: &[u32]| nodes.iter().fold([0.0; 3], |sum, &n| add(sum, points[n as usize]));
    let (corners, mids) = nodes.split_at(if nodes.len() == 8 { 4 } else { 8 });
    // shape functions of serendipity elements: -1/4 at corners; those of the nodes on edges have the rest
    let rest = (1.0 + 0.25 * corners.len() as f64) / mids.len() as f64;
    add(scale(-0.25, sum(corners)), scale(rest, sum(mids)))
}
