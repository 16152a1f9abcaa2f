//! Meshes of order 2: tables of mid-nodes.

use crate::tables::distinct;
use crate::vec3::{add, scale};

use super::cells::EDGES;
use super::error::MeshError;
use super::tet_mesh::{Facet, TetMesh};

impl TetMesh {
    /// Builds and checks a mesh of quadratic tetrahedra. Of the ten nodes the first four are the corners, and the
    /// others lie on the edges 01, 12, 02, 03, 13, 23: the order of VTK, Abaqus and CalculiX (that of Gmsh has the last
    /// two swapped). Facets are given by their corners.
    ///
    /// # Errors
    /// [`MeshError`] names the first fault and its remedy: those of [`TetMesh::new`], mid-nodes that are not in the
    /// middle or not shared, tetrahedra that they turn inside out.
    pub fn quadratic(points: Vec<[f64; 3]>, tets: Vec<[u32; 10]>, facets: Vec<Facet>) -> Result<Self, MeshError> {
        let corners = tets.iter().map(|t| [t[0], t[1], t[2], t[3]]).collect();
        let mids = tets.iter().map(|t| [t[4], t[5], t[6], t[7], t[8], t[9]]).collect();
        Self::checked(points, corners, mids, facets)
    }

    /// The mesh of order 2 with the same tetrahedra: a node in the middle of every edge, numbered behind the others by
    /// the ends of the edges. A mesh of order 2 stays as it is.
    ///
    /// ```
    /// use signorini_fem_mesh::Brick;
    ///
    /// let linear = Brick::new([1.0; 3], [1, 1, 1]).build()?;
    /// let quadratic = linear.raise_order()?;
    /// assert_eq!((linear.order(), quadratic.order()), (1, 2));
    /// assert_eq!((linear.points().len(), quadratic.points().len()), (8, 26));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if there are too many edges to be numbered.
    pub fn raise_order(&self) -> Result<Self, MeshError> {
        if self.order() == 2 {
            return Ok(self.clone());
        }
        let ends = |tet: &[u32; 4]| EDGES.map(|[a, b]| [tet[a].min(tet[b]), tet[a].max(tet[b])]);
        let edges = distinct(self.tets.iter().flat_map(ends));
        let nodes = self.points.len();
        super::check::numbered("nodes", nodes + edges.len())?;
        let mut out = self.clone();
        let place = |n: u32| self.points[n as usize];
        out.points
            .extend(edges.iter().map(|&[a, b]| scale(0.5, add(place(a), place(b)))));
        let number = |edge: [u32; 2]| (nodes + edges.partition_point(|e| *e < edge)) as u32;
        out.mids = self.tets.iter().map(|tet| ends(tet).map(number)).collect();
        Ok(out)
    }

    /// Order of the displacements: 1 (linear tetrahedra) or 2 (quadratic ones).
    pub fn order(&self) -> usize {
        if self.mids.is_empty() { 1 } else { 2 }
    }

    /// Mid-nodes of the edges 01, 12, 02, 03, 13, 23 of each tetrahedron; empty in a mesh of order 1.
    pub fn mids(&self) -> &[[u32; 6]] {
        &self.mids
    }

    /// The ten nodes of each tetrahedron; empty in a mesh of order 1.
    pub fn quadratic_tets(&self) -> Vec<[u32; 10]> {
        quadratic_tets(&self.tets, &self.mids)
    }

    /// Mid-nodes of the edges 01, 12, 20 of a tagged facet; none in a mesh of order 1, or if there is no such facet.
    pub fn facet_mids(&self, facet: usize) -> Option<[u32; 3]> {
        let own = self.facets.get(facet).filter(|_| self.order() == 2)?;
        Some(self.mids_of(self.facet_owner(facet), own.nodes))
    }

    /// Mid-nodes of the edges 01, 12, 20 of a triangle of a tetrahedron.
    pub(super) fn mids_of(&self, tet: usize, triangle: [u32; 3]) -> [u32; 3] {
        let corners = &self.tets[tet];
        [[0, 1], [1, 2], [2, 0]].map(|edge| {
            let ends = edge.map(|k| triangle[k]);
            let same = |[a, b]: &[usize; 2]| ends.contains(&corners[*a]) && ends.contains(&corners[*b]);
            let place = EDGES.iter().position(same).unwrap_or(0);
            self.mids[tet][place]
        })
    }

    /// The six nodes of a tagged facet of a mesh of order 2, corners first.
    pub(crate) fn quadratic_facet(&self, facet: usize) -> [u32; 6] {
        let nodes = self.facets[facet].nodes;
        let ([a, b, c], [d, e, f]) = (nodes, self.mids_of(self.facet_owner(facet), nodes));
        [a, b, c, d, e, f]
    }

    /// Their coordinates.
    pub(crate) fn quadratic_facet_points(&self, facet: usize) -> [[f64; 3]; 6] {
        self.quadratic_facet(facet).map(|n| self.points[n as usize])
    }

    /// Coordinates of the ten nodes of a tetrahedron of a mesh of order 2.
    pub(crate) fn quadratic_points(&self, tet: usize) -> [[f64; 3]; 10] {
        join(self.tets[tet], self.mids[tet]).map(|n| self.points[n as usize])
    }
}

/// The ten nodes of tetrahedra from their corners and mid-nodes.
pub(crate) fn quadratic_tets(tets: &[[u32; 4]], mids: &[[u32; 6]]) -> Vec<[u32; 10]> {
    tets.iter().zip(mids).map(|(&tet, &mids)| join(tet, mids)).collect()
}

fn join([a, b, c, d]: [u32; 4], [e, f, g, h, i, j]: [u32; 6]) -> [u32; 10] {
    [a, b, c, d, e, f, g, h, i, j]
}
