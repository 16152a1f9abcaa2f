//! The mesh: tetrahedra with tagged boundary facets and material regions.

use std::collections::{BTreeMap, HashMap};

use crate::tables::{ascending, distinct};
use crate::tolerances::COINCIDENT;
use crate::vec3::{self, Vec3};

use super::check;
use super::curved;
use super::error::MeshError;
use super::faces::{FaceTable, NONE, connected_sets, face_each_other, face_nodes};

/// The number of a part of the boundary, by which supports, loads and contacts refer to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FacetTag(pub u32);

impl std::fmt::Display for FacetTag {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "tag {}", self.0)
    }
}

/// The tags of a mesh in the words of an error: "the tags 1, 2" or "no tags".
pub fn tag_list(tags: &[FacetTag]) -> String {
    if tags.is_empty() {
        return "no tags".into();
    }
    let numbers: Vec<String> = tags.iter().map(|tag| tag.0.to_string()).collect();
    format!("the tags {}", numbers.join(", "))
}

/// A tagged triangle of the boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Facet {
    /// Nodes; in a [`TetMesh`] counter-clockwise seen from outside the body.
    pub nodes: [u32; 3],
    /// Part of the boundary that the triangle belongs to.
    pub tag: FacetTag,
}

/// A triangle of the boundary, tagged or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct BoundaryFacet {
    /// Nodes, counter-clockwise seen from outside the body.
    pub nodes: [u32; 3],
    /// The tetrahedron that it bounds.
    pub tet: u32,
}

/// A mesh of linear or quadratic tetrahedra with tagged boundary facets and material regions.
///
/// In a mesh of order 2 every edge has a mid-node ([`TetMesh::quadratic`], [`TetMesh::raise_order`]). Tetrahedra and
/// facets are listed by their corners; [`TetMesh::mids`] has the mid-nodes.
///
/// A value of this type has passed all checks: finite coordinates, valid node numbers,
/// tetrahedra of positive volume that do not overlap at faces, no unused nodes, no coinciding
/// nodes inside one body but on [cracks](Self::crack), whose tagged facets face each other, and facets that lie on the
/// boundary, each listed once and oriented outward. It may hold several bodies; nodes of different bodies may coincide.
///
/// Tetrahedra are oriented so that det(p1 - p0, p2 - p0, p3 - p0) > 0.
#[derive(Clone, PartialEq)]
pub struct TetMesh {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) tets: Vec<[u32; 4]>,
    /// Mid-nodes of the edges of each tetrahedron; empty in a mesh of order 1.
    pub(super) mids: Vec<[u32; 6]>,
    pub(super) facets: Vec<Facet>,
    pub(super) owners: Vec<u32>,
    pub(super) regions: Vec<u32>,
    pub(super) neighbours: Vec<[u32; 4]>,
}

/// Its sizes; not the megabytes of points and tetrahedra.
impl std::fmt::Debug for TetMesh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TetMesh")
            .field("order", &self.order())
            .field("points", &self.points.len())
            .field("tets", &self.tets.len())
            .field("tags", &self.tags())
            .finish_non_exhaustive()
    }
}

impl TetMesh {
    /// Builds and checks a mesh. Facets may be given in either orientation and are turned
    /// outward; untagged parts of the boundary need no facets. All tetrahedra get region 0.
    ///
    /// # Errors
    /// [`MeshError`] names the first fault and its remedy.
    pub fn new(points: Vec<[f64; 3]>, tets: Vec<[u32; 4]>, facets: Vec<Facet>) -> Result<Self, MeshError> {
        Self::checked(points, tets, Vec::new(), facets)
    }

    /// A mesh of order 2, or without mid-nodes of order 1, that has passed all checks.
    pub(super) fn checked(
        points: Vec<[f64; 3]>,
        tets: Vec<[u32; 4]>,
        mids: Vec<[u32; 6]>,
        facets: Vec<Facet>,
    ) -> Result<Self, MeshError> {
        check::sizes(points.len(), tets.len())?;
        check::coordinates(&points)?;
        check::connectivity(points.len(), &tets)?;
        check::shapes(&points, &tets)?;
        curved::check(&points, &tets, &mids)?;
        check::no_dangling(points.len(), &tets, &mids)?;
        let table = FaceTable::new(points.len(), &tets);
        let neighbours = table.neighbours(tets.len())?;
        let (facets, owners) = place_facets(&points, &tets, &table, facets)?;
        let mesh = Self {
            regions: vec![0; tets.len()],
            points,
            tets,
            mids,
            facets,
            owners,
            neighbours,
        };
        check::no_coincident(&mesh.points, &mesh.tets, &mesh.mids, |pairs| {
            mesh.leave_cracks_out(pairs)
        })?;
        Ok(mesh)
    }

    /// Drops pairs of coinciding nodes that are meant: with tagged facets that face each other, as those of a crack do.
    pub(super) fn leave_cracks_out(&self, pairs: &mut Vec<(usize, usize)>) {
        let mut normals: HashMap<usize, Vec<Vec3>> =
            pairs.iter().flat_map(|(a, b)| [*a, *b]).map(|n| (n, vec![])).collect();
        for (facet, corners) in self.facets.iter().enumerate() {
            let mids = self.facet_mids(facet).into_iter().flatten();
            for node in corners.nodes.into_iter().chain(mids) {
                if let Some(normals) = normals.get_mut(&(node as usize)) {
                    normals.push(vec3::unit(facet_area_vector(self, facet)));
                }
            }
        }
        pairs.retain(|(a, b)| !face_each_other(&normals[a], &normals[b]));
    }

    /// Sets the material region of each tetrahedron.
    ///
    /// # Errors
    /// [`MeshError::RegionCount`] unless there is exactly one number for each tetrahedron.
    pub fn with_regions(mut self, regions: Vec<u32>) -> Result<Self, MeshError> {
        if regions.len() != self.tets.len() {
            let (given, tets) = (regions.len(), self.tets.len());
            return Err(MeshError::RegionCount { given, tets });
        }
        self.regions = regions;
        Ok(self)
    }

    /// Coordinates of the nodes.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Corners of each tetrahedron, which are all its nodes in a mesh of order 1.
    pub fn tets(&self) -> &[[u32; 4]] {
        &self.tets
    }

    /// Tagged boundary facets, oriented outward, in the order given.
    pub fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// Material region of each tetrahedron.
    pub fn regions(&self) -> &[u32] {
        &self.regions
    }

    /// The material regions in use, ascending.
    pub fn distinct_regions(&self) -> Vec<u32> {
        let runs = self.regions.chunk_by(|a, b| a == b);
        distinct(runs.map(|run| run[0]))
    }

    /// The tetrahedron that the tagged facet number `facet` bounds.
    pub fn facet_owner(&self, facet: usize) -> usize {
        self.owners[facet] as usize
    }

    /// The tags in use, ascending.
    pub fn tags(&self) -> Vec<FacetTag> {
        distinct(self.facets.iter().map(|f| f.tag))
    }

    /// Nodes on the facets of a tag, including mid-nodes, ascending; empty if the tag is absent.
    pub fn nodes_on(&self, tag: FacetTag) -> Vec<u32> {
        let on_tag = self.facets.iter().filter(|f| f.tag == tag);
        let mut nodes: Vec<_> = on_tag.flat_map(|f| f.nodes).collect();
        let on_tag = (0..self.facets.len()).filter(|&f| self.facets[f].tag == tag);
        nodes.extend(on_tag.filter_map(|f| self.facet_mids(f)).flatten());
        distinct(nodes)
    }

    /// The node nearest to a point, of several the first; `None` where the point is not finite.
    pub fn nearest_node(&self, point: [f64; 3]) -> Option<u32> {
        let finite = point.iter().all(|x| x.is_finite());
        let distance = |p: &[f64; 3]| vec3::norm(vec3::sub(*p, point));
        let distances = self.points.iter().map(distance).enumerate().filter(|_| finite);
        distances
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(node, _)| node as u32)
    }

    /// Coordinates of the four corners of a tetrahedron.
    pub fn tet_points(&self, tet: usize) -> [[f64; 3]; 4] {
        self.tets[tet].map(|n| self.points[n as usize])
    }

    /// Coordinates of the three corners of a tagged facet.
    pub fn facet_points(&self, facet: usize) -> [[f64; 3]; 3] {
        self.facets[facet].nodes.map(|n| self.points[n as usize])
    }

    /// Volume of a tetrahedron, positive.
    pub fn volume(&self, tet: usize) -> f64 {
        match self.mids.get(tet) {
            None => vec3::tet_volume(&self.tet_points(tet)),
            Some(_) => curved::volume(&self.quadratic_points(tet)),
        }
    }

    /// Volume of the whole mesh.
    pub fn total_volume(&self) -> f64 {
        (0..self.tets.len()).map(|t| self.volume(t)).sum()
    }

    /// Bounding box of the mesh: its lowest and highest corner.
    pub fn extent(&self) -> ([f64; 3], [f64; 3]) {
        check::extent(self.points.iter().copied())
    }

    /// Pairs of these nodes that coincide, the one that comes first in the list first: of bodies that match where they
    /// touch, of cracks, or of parts that are to be [merged](super::merge_nodes). Numbers that the mesh does not have
    /// coincide with none.
    ///
    /// ```
    /// use signorini_fem_mesh::Brick;
    ///
    /// let lower = Brick::new([1.0; 3], [1; 3]).build()?;
    /// let both = lower.append(&lower.map_points(|[x, y, z]| [x, y, z + 1.0])?)?;
    /// assert_eq!(both.coincident(&[0, 4, 5, 8, 9, 99]), [[4, 8], [5, 9]]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn coincident(&self, nodes: &[u32]) -> Vec<[u32; 2]> {
        let place = |&n: &u32| Some((n, *self.points.get(n as usize)?));
        let (nodes, places): (Vec<u32>, Vec<Vec3>) = nodes.iter().filter_map(place).unzip();
        let (low, high) = self.extent();
        let mut pairs = Vec::new();
        check::close_pairs(&places, COINCIDENT * vec3::norm(vec3::sub(high, low)), |(a, b)| {
            pairs.push([nodes[a], nodes[b]]);
        });
        pairs
    }

    /// The tetrahedra across the four faces of a tetrahedron, `None` at the boundary. Face number
    /// i is opposite to node i.
    pub fn neighbours(&self, tet: usize) -> [Option<usize>; 4] {
        self.neighbours[tet].map(|n| (n != NONE).then_some(n as usize))
    }

    pub(crate) fn neighbour_table(&self) -> &[[u32; 4]] {
        &self.neighbours
    }

    /// The body of each tetrahedron: 0, 1, ... in the order of the first tetrahedron of each.
    /// Tetrahedra belong to the same body if a path through common faces joins them; a common
    /// edge or node alone is a hinge and does not join.
    pub fn components(&self) -> Vec<u32> {
        connected_sets(&self.neighbours, |_, _| true)
    }

    /// All triangles of the boundary, tagged or not, by ascending tetrahedron and face.
    pub fn boundary_facets(&self) -> Vec<BoundaryFacet> {
        let mut facets = Vec::new();
        for (t, (tet, neighbours)) in self.tets.iter().zip(&self.neighbours).enumerate() {
            for face in (0..4).filter(|&f| neighbours[f] == NONE) {
                let nodes = face_nodes(tet, face);
                facets.push(BoundaryFacet { nodes, tet: t as u32 });
            }
        }
        facets
    }
}

/// Turns facets outward and finds their tetrahedra. Leaves out faces of cracks that have all corners at the tip, and
/// are closed: facets inside that are listed from both sides, at whose corners others of their tags face each other.
fn place_facets(
    points: &[Vec3],
    tets: &[[u32; 4]],
    table: &FaceTable,
    facets: Vec<Facet>,
) -> Result<(Vec<Facet>, Vec<u32>), MeshError> {
    let nodes = points.len();
    let (mut placed, mut owners) = (Vec::with_capacity(facets.len()), Vec::with_capacity(facets.len()));
    let mut taken = HashMap::with_capacity(facets.len());
    let mut inside: BTreeMap<[u32; 3], Vec<(usize, [usize; 2])>> = BTreeMap::new();
    for (number, facet) in facets.iter().enumerate() {
        let given = facet.nodes;
        if let Some(&node) = given.iter().find(|&&n| n as usize >= nodes) {
            return Err(MeshError::FacetNodeOutOfRange {
                facet: number,
                node,
                nodes,
            });
        }
        let nodes = given;
        let mut sides = table.sides(given);
        let Some((tet, face)) = sides.next() else {
            let facet = number;
            return Err(MeshError::FacetUnknown { facet, nodes });
        };
        if let Some((second, _)) = sides.next() {
            inside
                .entry(ascending(given))
                .or_default()
                .push((number, [tet, second]));
            continue;
        }
        if let Some(first) = taken.insert((tet, face), number) {
            let second = number;
            return Err(MeshError::FacetRepeated { first, second, nodes });
        }
        let nodes = outward(given, face_nodes(&tets[tet], face));
        placed.push(Facet { nodes, ..*facet });
        owners.push(tet as u32);
    }
    // normals of what is around inner ones
    let mut around: BTreeMap<(FacetTag, u32), Vec<Vec3>> = BTreeMap::new();
    for facet in placed.iter().filter(|_| !inside.is_empty()) {
        let normal = vec3::unit(vec3::area_vector(&facet.nodes.map(|n| points[n as usize])));
        facet
            .nodes
            .into_iter()
            .for_each(|node| around.entry((facet.tag, node)).or_default().push(normal));
    }
    let is_closed = |found: &[(usize, [usize; 2])]| {
        let corners = found.iter().flat_map(|&(facet, _)| {
            let Facet { nodes, tag } = facets[facet];
            nodes.map(|node| (tag, node))
        });
        let normals = corners.filter_map(|corner| around.get(&corner)).flatten();
        let normals: Vec<Vec3> = normals.copied().collect();
        found.len() == 2 && face_each_other(&normals, &normals)
    };
    let faults = inside.values().filter(|found| !is_closed(found)).flatten();
    match faults.min() {
        Some(&(facet, [first, second])) => Err(MeshError::FacetInside {
            facet,
            nodes: facets[facet].nodes,
            first,
            second,
        }),
        None => Ok((placed, owners)),
    }
}

/// The triangle as given if it is a rotation of the outward one, else with two nodes swapped.
fn outward(given: [u32; 3], out: [u32; 3]) -> [u32; 3] {
    let [a, b, c] = given;
    let rotations = [out, [out[1], out[2], out[0]], [out[2], out[0], out[1]]];
    if rotations.contains(&given) { given } else { [a, c, b] }
}

/// Area vector (normal times area) of a facet.
pub(crate) fn facet_area_vector(mesh: &TetMesh, facet: usize) -> Vec3 {
    vec3::area_vector(&mesh.facet_points(facet))
}
