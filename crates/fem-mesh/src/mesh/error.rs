//! What can be wrong with a mesh. Every message names the place and a remedy.

use super::cells::CellShape;
use crate::errors::place;

errors! {
    /// A mesh that cannot be used, the place of the fault and its remedy.
    #[derive(Clone, PartialEq)]
    MeshError {
        Empty { what: &'static str } = "the mesh has no {what}; give at least one tetrahedron and its four nodes";
        TooLarge { what: &'static str, count: usize, limit: usize } =
            "{count} {what} are more than the {limit} that the tables can number; use a coarser mesh";
        NotFinite { node: usize, point: [f64; 3] } =
            "node {node} has the coordinates {}, which are not finite; check what computed or wrote them", place(point);
        NodeOutOfRange { tet: usize, node: u32, nodes: usize } =
            "tetrahedron {tet} names node {node}, but there are only {nodes} nodes, numbered from 0; look for a \
            table numbered from 1";
        RepeatedNode { tet: usize, node: u32 } =
            "tetrahedron {tet} names node {node} twice; remove the collapsed element or repair its connectivity";
        DegenerateTet { tet: usize, nodes: [u32; 4], flatness: f64 } =
            "tetrahedron {tet} with nodes {nodes:?} is flat: six times its volume is {flatness:e} of its longest \
            edge cubed; remesh around it, or move one of its nodes out of the plane of the others";
        InvertedTet { tet: usize, nodes: [u32; 4], volume: f64 } =
            "tetrahedron {tet} with nodes {nodes:?} is inverted (volume {volume:e}); swap its nodes {} and {}, or \
            call orient_tets first if the whole table is numbered that way", nodes[2], nodes[3];
        OverlappingTets { first: usize, second: usize, face: [u32; 3] } =
            "tetrahedra {first} and {second} lie on the same side of their common face {face:?}, so they overlap; \
            remove one of them";
        FaceShared { face: [u32; 3], count: usize, first: usize } =
            "the face {face:?} belongs to {count} tetrahedra, among them {first}; a face can separate only two, so \
            remove the elements that are listed twice";
        DanglingNode { node: usize, count: usize } =
            "node {node} belongs to no tetrahedron ({count} such nodes in all); remove it, or call drop_unused_nodes \
            first";
        CoincidentNodes { first: usize, second: usize, distance: f64 } =
            "nodes {first} and {second} of the same body coincide (distance {distance:e}); merge them (merge_nodes), \
            otherwise the body is cut open there, or tag the facets of both sides if it is a crack";
        FacetNodeOutOfRange { facet: usize, node: u32, nodes: usize } =
            "facet {facet} names node {node}, but there are only {nodes} nodes, numbered from 0; look for a table \
            numbered from 1";
        FacetUnknown { facet: usize, nodes: [u32; 3] } =
            "facet {facet} with nodes {nodes:?} is no face of any tetrahedron; surface and volume must use the same \
            nodes, so mesh them together";
        FacetInside { facet: usize, nodes: [u32; 3], first: usize, second: usize } =
            "facet {facet} with nodes {nodes:?} lies inside the body, between the tetrahedra {first} and {second}; \
            tag only facets of the boundary (a crack has facets of its own on both sides: TetMesh::crack, Gmsh's plugin Crack)";
        FacetRepeated { first: usize, second: usize, nodes: [u32; 3] } =
            "facets {first} and {second} are the same triangle {nodes:?}; a facet has one tag, so list it once";
        MidNodeCorner { tet: usize, node: u32 } =
            "tetrahedron {tet} has the mid-node {node}, which is a corner; mid-nodes have numbers of their own, so \
            look for another order of the ten nodes";
        MidNodeTwice { node: u32, first: [u32; 2], second: [u32; 2] } =
            "node {node} is in the middle of two edges, {first:?} and {second:?}; look for another order of the ten \
            nodes, or give each edge a node of its own";
        MidNodesOfEdge { edge: [u32; 2], first: u32, second: u32 } =
            "the edge {edge:?} has two mid-nodes, {first} and {second}; use one in all tetrahedra around it \
            (merge_nodes), otherwise the body is cut open there";
        MidNodeOff { tet: usize, node: u32, edge: [u32; 2], distance: f64, limit: f64 } =
            "the mid-node {node} of tetrahedron {tet} is {distance:.2} of the length of its edge {edge:?} away from its \
            middle, more than {limit:.2}; move it there, remesh finer around it, or look for another order of the \
            ten nodes";
        CurvedInside { tet: usize, nodes: [u32; 4], least: f64, limit: f64 } =
            "tetrahedron {tet} with corners {nodes:?} is turned inside out by its mid-nodes: its volume per volume of \
            the straight one falls to {least:.1e} somewhere in it, less than {limit:.0e}; straighten its edges or \
            remesh finer around it";
        MixedOrder { first: usize, second: usize } =
            "a mesh of order {first} and one of order {second} cannot be one; raise_order the linear one";
        CellNodes { cell: usize, shape: CellShape, nodes: usize } =
            "cell {cell} is a {shape:?} of {nodes} nodes; give its {} corners, and for one of second order a node on each edge, \
            and then none or one in each face of four corners and in the middle of a hexahedron", shape.corners();
        CellFlat { cell: usize } =
            "cell {cell} has no volume: too many of its corners are one node; remove it, or repair its connectivity";
        CellsCross { first: usize, second: usize } =
            "cell {first} has a face of four corners, on which cell {second} has a triangle along the other diagonal; mesh both \
            alike, put pyramids between them, or make them separate bodies that are tied";
        CellNode { cell: usize, node: u32, nodes: usize } =
            "cell {cell} names node {node}, but there are only {nodes} nodes, numbered from 0; look for a table numbered from 1";
        NoCut = "no face inside the mesh opens; check what tells its sides, and of a crack its faces: one with all corners at \
            the tip stays closed";
        CrackSides { first: usize, second: usize } =
            "a face of the crack is between the tetrahedra {first} and {second}, and both are said to be on one side; check \
            what tells the sides";
        CutEnds { node: u32 } =
            "the cut ends inside a body, at node {node}, around which both sides are still joined; let it go through to \
            the boundary";
        RegionCount { given: usize, tets: usize } =
            "{given} region numbers for {tets} tetrahedra; give exactly one each";
    }
}
