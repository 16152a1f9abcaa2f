//! Hexahedra, prisms and pyramids as tetrahedra.
//!
//! A cell is the union of the tetrahedra between its corner of the smallest number and the faces without that corner; a
//! quadrilateral is cut along the diagonal from its smallest corner. Cells that share a face so cut it alike
//! (J. Dompierre et al., How to subdivide pyramids, prisms, and hexahedra into tetrahedra, 1999).

use std::collections::HashMap;
use std::ops::Range;

use crate::tables::{Lists, ascending};
use crate::vec3::{Vec3, add, scale};

use super::cells::{Cell, CellShape, EDGES, TET_FACES};
use super::error::MeshError;

/// Cells divided into tetrahedra. Corners of a cell may be one node, as those of a hexahedron that stands for a prism.
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
/// assert_eq!(mesh.tets().len(), 6);
/// assert!((mesh.total_volume() - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Division {
    /// Corners of the tetrahedra, cell by cell; a tetrahedron stays as it is.
    pub tets: Vec<[u32; 4]>,
    /// Nodes on the edges of each, if the cells have some.
    pub mids: Vec<[u32; 6]>,
    /// For the face of each that lacks its corner 3, 2, 0 and 1, in this order, the number of the face of the cell that
    /// it is a part of, from 1; 0 inside the cell.
    pub faces: Vec<[u8; 4]>,
    /// Tetrahedra of each cell.
    pub of_cell: Vec<Range<u32>>,
    added: Lists<(u32, f64)>,
}

impl Division {
    /// Divides cells all of which have nodes on their edges, or none; new nodes are added to the points.
    ///
    /// # Errors
    /// [`MeshError::CellNodes`] for a number of nodes that a cell does not take, [`MeshError::CellNode`] for a node
    /// that there is not, [`MeshError::CellFlat`] for too many corners that are one, [`MeshError::CellsCross`] for
    /// triangles that do not fit, [`MeshError::MixedOrder`] for cells with and without nodes on their edges,
    /// [`MeshError::TooLarge`] for more nodes or tetrahedra than can be numbered.
    pub fn new(points: &mut Vec<[f64; 3]>, cells: &[Cell<'_>]) -> Result<Self, MeshError> {
        Self::of(points, cells, false)
    }

    /// The same into quadratic tetrahedra: cells without nodes on their edges get those of others there, or new ones.
    /// Linear tetrahedra are far stiffer in bending than the cells that they fill; quadratic ones are not.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn raised(points: &mut Vec<[f64; 3]>, cells: &[Cell<'_>]) -> Result<Self, MeshError> {
        Self::of(points, cells, true)
    }

    fn of(points: &mut Vec<[f64; 3]>, cells: &[Cell<'_>], raised: bool) -> Result<Self, MeshError> {
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
            if first != second && !raised {
                return Err(MeshError::MixedOrder { first, second });
            }
        }
        let mut out = Self::default();
        let mut inside = Inside {
            first: points.len() as u32,
            known: HashMap::new(),
        };
        if let Some(error) = crossed(cells) {
            return Err(error);
        }
        // an edge of one cell may be the diagonal of another one: edges come before diagonals, and what has nodes first
        let is_fit =
            |cell: &Cell| cell.shape == cells[0].shape && cell.nodes.len() == cells[0].nodes.len() && cell.is_alike();
        let passes = [(2, true), (1, true), (2, false)];
        for (wanted, own) in passes
            .into_iter()
            .filter(|_| (raised || first == 2) && !cells.iter().all(is_fit))
        {
            for cell in cells.iter().filter(|cell| order(cell) == wanted) {
                cell.note(own, &mut inside, &mut out.added);
            }
        }
        for (number, cell) in cells.iter().enumerate() {
            out.add(cell, raised || first == 2, &mut inside);
            if out.of_cell[number].is_empty() {
                return Err(MeshError::CellFlat { cell: number });
            }
            super::check::numbered("nodes", points.len() + out.added.count())?;
            super::check::numbered("tetrahedra", out.tets.len())?;
            super::check::numbered("nodes around new ones", out.added.items().len())?;
        }
        let new: Vec<_> = out.added().map(|between| middle(points, between)).collect();
        points.extend(new);
        Ok(out)
    }

    /// Nodes that are added behind all others, on edges, in faces and in the middle of hexahedra that have none there:
    /// the given nodes of the edge, the face or the cell, and the shares of their places in that of the new one. These
    /// are the shape functions of second order, or, of cells of first order, halves for the ends of the edge and zeros.
    pub fn added(&self) -> impl ExactSizeIterator<Item = &[(u32, f64)]> {
        self.added.iter()
    }

    fn add(&mut self, cell: &Cell, quadratic: bool, inside: &mut Inside) {
        let start = self.tets.len() as u32;
        for tet in cell.tetrahedra() {
            self.tets.push(tet);
            self.faces
                .push(TET_FACES.map(|face| cell.face_of(face.map(|k| tet[k]))));
            if quadratic {
                let edges = EDGES.map(|edge| edge.map(|k| tet[k]));
                self.mids
                    .push(edges.map(|edge| cell.on_edge(edge, inside, &mut self.added)));
            }
        }
        self.of_cell.push(start..self.tets.len() as u32);
    }
}

/// Nodes that are added.
struct Inside {
    /// The number of the first that is added.
    first: u32,
    /// By the ends of the edge of the tetrahedra that they are on.
    known: HashMap<[u32; 2], u32>,
}

impl Cell<'_> {
    /// Corners of its tetrahedra; a corner that is there more than once makes them fewer.
    fn tetrahedra(&self) -> Vec<[u32; 4]> {
        let corners = &self.nodes[..self.shape.corners()];
        if let &[a, b, c, d] = corners {
            return vec![[a, b, c, d]];
        }
        let tip = corners.iter().copied().min().unwrap_or(0);
        let far = self.shape.faces().iter().filter(|face| !self.has(face, tip));
        let triangles = far.flat_map(|face| divide_face(&self.corners(face)).collect::<Vec<_>>());
        let is_whole = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        triangles.filter(is_whole).map(|[a, b, c]| [a, b, c, tip]).collect()
    }

    fn corners(&self, of: &[usize]) -> Vec<u32> {
        of.iter().map(|&k| self.nodes[k]).collect()
    }

    /// Each once, in their order.
    fn distinct_corners(&self, of: &[usize]) -> Vec<u32> {
        let mut out: Vec<u32> = Vec::with_capacity(of.len());
        for node in self.corners(of) {
            if !out.contains(&node) {
                out.push(node);
            }
        }
        out
    }

    /// Whether it meets cells like itself only in faces of as many corners.
    fn is_alike(&self) -> bool {
        match self.shape {
            CellShape::Tetrahedron => true,
            CellShape::Hexahedron => (1..8).all(|k| !self.nodes[..k].contains(&self.nodes[k])),
            CellShape::Pyramid | CellShape::Prism => false,
        }
    }

    /// Finds the nodes on the edges of its tetrahedra, or on its `own` edges only.
    fn note(&self, own: bool, inside: &mut Inside, added: &mut Lists<(u32, f64)>) {
        for tet in self.tetrahedra() {
            for edge in EDGES.map(|edge| edge.map(|k| tet[k])) {
                let mut edges = self.shape.edges().iter();
                if !own || edges.any(|ends| edge.iter().all(|node| self.has(ends, *node))) {
                    let node = self.on_edge(edge, inside, added);
                    inside.known.entry(ascending(edge)).or_insert(node);
                }
            }
        }
    }

    /// Whether a node is among some corners.
    fn has(&self, corners: &[usize], node: u32) -> bool {
        corners.iter().any(|&k| self.nodes[k] == node)
    }

    /// The face, from 1, that has three corners; 0 if there is none.
    fn face_of(&self, corners: [u32; 3]) -> u8 {
        let has = |face: &&[usize]| corners.iter().all(|node| self.has(face, *node));
        let found = self.shape.faces().iter().position(has);
        found.map_or(0, |face| face as u8 + 1)
    }

    /// Node in the middle of an edge of a tetrahedron.
    fn on_edge(&self, edge: [u32; 2], inside: &mut Inside, added: &mut Lists<(u32, f64)>) -> u32 {
        let (corners, edges) = (self.shape.corners(), self.shape.edges());
        let is_between = |corners: &[usize]| edge.iter().all(|node| self.has(corners, *node));
        let own = edges.iter().position(|ends| is_between(ends));
        let face = self.shape.quadrilaterals().position(is_between);
        let inner = self.nodes.get(corners + edges.len()..).unwrap_or(&[]);
        if own.is_none()
            && let Some(&node) = inside.known.get(&ascending(edge))
        {
            return node;
        }
        let given = match (own, face) {
            (Some(own), _) => self.nodes.get(corners + own),
            (None, Some(face)) => inner.get(face),
            (None, None) => inner.last(),
        };
        if let Some(&node) = given {
            return node;
        }
        *inside.known.entry(ascending(edge)).or_insert_with(|| {
            let around = match (own, face) {
                (Some(own), _) => Some(&edges[own][..]),
                (None, Some(face)) => self.shape.quadrilaterals().nth(face),
                (None, None) => None,
            };
            let is_on = |ends: &[usize]| around.is_none_or(|around| ends.iter().all(|k| around.contains(k)));
            let on_corners: Vec<usize> = (0..corners).filter(|&k| is_on(&[k])).collect();
            let on_edges = (corners..).zip(edges).filter(|e| is_on(e.1)).map(|e| e.0);
            let mids: Vec<u32> = on_edges.filter_map(|k| self.nodes.get(k)).copied().collect();
            // straight edges of cells of first order keep their tetrahedra whole, however these are warped
            let half = |node| 0.5 * f64::from(u8::from(edge.contains(&node)));
            let [corner, mid] = shares(on_corners.len(), mids.len());
            let is_first = mids.is_empty();
            let corners = on_corners.into_iter().map(|k| self.nodes[k]);
            let corners = corners.map(|node| (node, if is_first { half(node) } else { corner }));
            added.push(corners.chain(mids.into_iter().map(|n| (n, mid))));
            inside.first + added.count() as u32 - 1
        })
    }
}

/// A triangle of a cell across the diagonal of a face of four corners of another one.
fn crossed(cells: &[Cell<'_>]) -> Option<MeshError> {
    if cells.iter().all(|cell| cell.is_alike() && cell.shape == cells[0].shape) {
        return None;
    }
    let mut triangles: HashMap<[u32; 3], usize> = HashMap::new();
    for (number, cell) in cells.iter().enumerate() {
        for face in cell.shape.faces() {
            if let &[a, b, c] = &cell.distinct_corners(face)[..] {
                triangles.insert(ascending([a, b, c]), number);
            }
        }
    }
    for (first, cell) in cells.iter().enumerate() {
        for face in cell.shape.quadrilaterals() {
            let corners = cell.distinct_corners(face);
            if corners.len() < 4 {
                continue;
            }
            let parts: Vec<_> = divide_face(&corners).map(ascending).collect();
            for left in 0..4 {
                let three = ascending(std::array::from_fn(|k| corners[(left + 1 + k) % 4]));
                if let (false, Some(&second)) = (parts.contains(&three), triangles.get(&three)) {
                    return Some(MeshError::CellsCross { first, second });
                }
            }
        }
    }
    None
}

/// The triangles, of the same orientation, into which a division cuts a face, given by its corners: a quadrilateral is
/// cut from that of the smallest number.
pub fn divide_face(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let smallest = (0..corners.len()).min_by_key(|&k| corners[k]);
    // a triangle stays as it is
    let first = smallest.filter(|_| corners.len() > 3).unwrap_or(0);
    let at = move |k: usize| corners[(first + k) % corners.len()];
    (2..corners.len()).map(move |k| [at(0), at(k - 1), at(k)])
}

/// Shape functions of second order in the middle of a face or a hexahedron with nodes on the edges only: at its
/// corners, and at these.
fn shares(corners: usize, mids: usize) -> [f64; 2] {
    [-0.25, (1.0 + 0.25 * corners as f64) / mids as f64]
}

fn middle(points: &[[f64; 3]], between: &[(u32, f64)]) -> Vec3 {
    let shares = between.iter().map(|&(node, share)| scale(share, points[node as usize]));
    shares.fold([0.0; 3], add)
}
