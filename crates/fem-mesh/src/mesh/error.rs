//! What can be wrong with a mesh. Every message names the place and a remedy.

use thiserror::Error;

/// A mesh that cannot be used, the place of the fault and its remedy.
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// There are no nodes or no tetrahedra.
    #[error("the mesh has no {what}; give at least one tetrahedron and its four nodes")]
    Empty {
        /// `"nodes"` or `"tetrahedra"`.
        what: &'static str,
    },
    /// More nodes or tetrahedra than 32-bit tables can number.
    #[error(
        "{count} {what} are more than the {limit} that the tables can number; use a coarser mesh"
    )]
    TooLarge {
        /// `"nodes"` or `"tetrahedra"`.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error(
        "node {node} has the coordinates {point:?}, which are not finite; check what computed or wrote them"
    )]
    NotFinite {
        /// Node number.
        node: usize,
        /// Its coordinates.
        point: [f64; 3],
    },
    /// A tetrahedron names a node that does not exist.
    #[error(
        "tetrahedron {tet} names node {node}, but there are only {nodes} nodes, numbered from 0; look for a table numbered from 1"
    )]
    NodeOutOfRange {
        /// Tetrahedron number.
        tet: usize,
        /// The node that it names.
        node: u32,
        /// Number of nodes in the mesh.
        nodes: usize,
    },
    /// A tetrahedron names the same node twice.
    #[error(
        "tetrahedron {tet} names node {node} twice; remove the collapsed element or repair its connectivity"
    )]
    RepeatedNode {
        /// Tetrahedron number.
        tet: usize,
        /// The node named twice.
        node: u32,
    },
    /// The volume of a tetrahedron is zero to rounding.
    #[error(
        "tetrahedron {tet} with nodes {nodes:?} is flat: six times its volume is {flatness:e} of its longest edge cubed; remesh around it, or move one of its nodes out of the plane of the others"
    )]
    DegenerateTet {
        /// Tetrahedron number.
        tet: usize,
        /// Its nodes.
        nodes: [u32; 4],
        /// Six times the volume over the cube of the longest edge.
        flatness: f64,
    },
    /// A tetrahedron is numbered against the orientation convention.
    #[error("tetrahedron {tet} with nodes {nodes:?} is inverted (volume {volume:e}); swap its nodes {} and {}, or call orient_tets first if the whole table is numbered that way", .nodes[2], .nodes[3])]
    InvertedTet {
        /// Tetrahedron number.
        tet: usize,
        /// Its nodes; the last two may be swapped.
        nodes: [u32; 4],
        /// Its signed volume, negative.
        volume: f64,
    },
    /// Two tetrahedra lie on the same side of a common face, or are equal.
    #[error(
        "tetrahedra {first} and {second} lie on the same side of their common face {face:?}, so they overlap; remove one of them"
    )]
    OverlappingTets {
        /// The first tetrahedron.
        first: usize,
        /// The second tetrahedron.
        second: usize,
        /// Nodes of the common face.
        face: [u32; 3],
    },
    /// More than two tetrahedra share a face.
    #[error(
        "the face {face:?} belongs to {count} tetrahedra, among them {first}; a face can separate only two, so remove the elements that are listed twice"
    )]
    FaceShared {
        /// Nodes of the face.
        face: [u32; 3],
        /// How many tetrahedra have it.
        count: usize,
        /// One of them.
        first: usize,
    },
    /// A node belongs to no tetrahedron.
    #[error(
        "node {node} belongs to no tetrahedron ({count} such nodes in all); remove it, or call drop_unused_nodes first"
    )]
    DanglingNode {
        /// The first such node.
        node: usize,
        /// How many there are.
        count: usize,
    },
    /// Two nodes of one body lie at the same place.
    #[error(
        "nodes {first} and {second} of the same body coincide (distance {distance:e}); merge them (merge_nodes), otherwise the body is cut open there"
    )]
    CoincidentNodes {
        /// The smaller node number.
        first: usize,
        /// The larger node number.
        second: usize,
        /// Their distance.
        distance: f64,
    },
    /// A facet names a node that does not exist.
    #[error(
        "facet {facet} names node {node}, but there are only {nodes} nodes, numbered from 0; look for a table numbered from 1"
    )]
    FacetNodeOutOfRange {
        /// Facet number.
        facet: usize,
        /// The node that it names.
        node: u32,
        /// Number of nodes in the mesh.
        nodes: usize,
    },
    /// A facet is not a face of any tetrahedron.
    #[error(
        "facet {facet} with nodes {nodes:?} is no face of any tetrahedron; surface and volume must use the same nodes, so mesh them together"
    )]
    FacetUnknown {
        /// Facet number.
        facet: usize,
        /// Its nodes.
        nodes: [u32; 3],
    },
    /// A facet lies between two tetrahedra.
    #[error(
        "facet {facet} with nodes {nodes:?} lies inside the body, between the tetrahedra {first} and {second}; tag only facets of the boundary"
    )]
    FacetInside {
        /// Facet number.
        facet: usize,
        /// Its nodes.
        nodes: [u32; 3],
        /// Tetrahedron on one side.
        first: usize,
        /// Tetrahedron on the other side.
        second: usize,
    },
    /// A facet is listed twice.
    #[error(
        "facets {first} and {second} are the same triangle {nodes:?}; a facet has one tag, so list it once"
    )]
    FacetRepeated {
        /// The first of the two.
        first: usize,
        /// The second of the two.
        second: usize,
        /// Nodes of the triangle.
        nodes: [u32; 3],
    },
    /// The table of regions does not have one entry for each tetrahedron.
    #[error("{given} region numbers for {tets} tetrahedra; give exactly one each")]
    RegionCount {
        /// Entries given.
        given: usize,
        /// Number of tetrahedra.
        tets: usize,
    },
}
