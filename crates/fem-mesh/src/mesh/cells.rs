//! Shapes of cells of other meshes: their edges and faces.

/// Ends of the edges of a tetrahedron on which its mid-nodes lie.
pub const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];

/// Corners of the faces of a tetrahedron, counter-clockwise seen from inside.
pub const TET_FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

/// What a cell is. Its corners, edges and faces are in the order of Abaqus and CalculiX.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CellShape {
    /// Corners 0 to 3.
    Tetrahedron,
    /// Corners 0 to 3 of the base and the apex 4.
    Pyramid,
    /// Corners 0 to 2 of one triangle and, above them, 3 to 5 of the other.
    Prism,
    /// Corners 0 to 3 of one quadrilateral and, above them, 4 to 7 of the other.
    Hexahedron,
}

impl CellShape {
    /// Number of corners.
    pub fn corners(self) -> usize {
        match self {
            Self::Tetrahedron => 4,
            Self::Pyramid => 5,
            Self::Prism => 6,
            Self::Hexahedron => 8,
        }
    }

    /// Ends of the edges, in the order of the nodes on them.
    pub fn edges(self) -> &'static [[usize; 2]] {
        match self {
            Self::Tetrahedron => &EDGES,
            Self::Pyramid => &[[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 4], [2, 4], [3, 4]],
            Self::Prism => &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
            Self::Hexahedron => &[
                [0, 1],
                [1, 2],
                [2, 3],
                [3, 0],
                [4, 5],
                [5, 6],
                [6, 7],
                [7, 4],
                [0, 4],
                [1, 5],
                [2, 6],
                [3, 7],
            ],
        }
    }

    /// Corners of the faces, counter-clockwise seen from inside a cell of positive volume.
    pub fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Tetrahedron => &[&TET_FACES[0], &TET_FACES[1], &TET_FACES[2], &TET_FACES[3]],
            Self::Pyramid => &[&[0, 1, 2, 3], &[0, 4, 1], &[1, 4, 2], &[2, 4, 3], &[3, 4, 0]],
            Self::Prism => &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]],
            Self::Hexahedron => &[
                &[0, 1, 2, 3],
                &[4, 7, 6, 5],
                &[0, 4, 5, 1],
                &[1, 5, 6, 2],
                &[2, 6, 7, 3],
                &[3, 7, 4, 0],
            ],
        }
    }

    /// Faces with four corners.
    pub(super) fn quadrilaterals(self) -> impl Iterator<Item = &'static [usize]> {
        self.faces().iter().copied().filter(|face| face.len() == 4)
    }

    /// Nodes of a cell that has some in its faces and its middle, too.
    fn complete(self) -> usize {
        let inside = usize::from(self == Self::Hexahedron);
        self.corners() + self.edges().len() + self.quadrilaterals().count() + inside
    }

    /// Whether a cell may have so many nodes: its corners, also one on each edge, or also one in each face of four
    /// corners and in the middle of a hexahedron.
    pub fn takes(self, nodes: usize) -> bool {
        let second = self.corners() + self.edges().len();
        [self.corners(), second, self.complete()].contains(&nodes)
    }
}

/// A cell of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell<'a> {
    /// What it is.
    pub shape: CellShape,
    /// Its nodes: the corners, those on the [edges](CellShape::edges), those in the [faces](CellShape::faces) of four
    /// corners, and that in the middle of a hexahedron, as many of these kinds as it [takes](CellShape::takes).
    pub nodes: &'a [u32],
}
