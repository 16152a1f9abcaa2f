//! Decomposition into subdomains that are torn apart at their common nodes.

use thiserror::Error;

use crate::buckets::{buckets, range};
use crate::mesh::{NONE, TetMesh, connected_sets};
use crate::vec3;

/// A part of the mesh with its own numbering of nodes and tetrahedra.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Subdomain {
    /// Global number of each local node, ascending. Local numbers therefore follow the global
    /// order, and translates of a regular mesh have the same local tables.
    pub nodes: Vec<u32>,
    /// Tetrahedra in local node numbers, in the order of `elements`.
    pub tets: Vec<[u32; 4]>,
    /// Global number of each tetrahedron, ascending.
    pub elements: Vec<u32>,
}

impl Subdomain {
    /// Number of displacement unknowns, three for each local node.
    #[must_use]
    pub fn dofs(&self) -> usize {
        3 * self.nodes.len()
    }

    /// Local number of a global node, if it is here.
    #[must_use]
    pub fn local(&self, node: u32) -> Option<usize> {
        self.nodes.binary_search(&node).ok()
    }

    /// Coordinates of the local nodes.
    ///
    /// # Panics
    /// If the subdomain belongs to another, larger mesh.
    #[must_use]
    pub fn points(&self, mesh: &TetMesh) -> Vec<[f64; 3]> {
        self.nodes
            .iter()
            .map(|&n| mesh.points()[n as usize])
            .collect()
    }
}

/// A copy of a global node in a subdomain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct NodeCopy {
    /// Number of the subdomain.
    pub subdomain: u32,
    /// Local number of the node there.
    pub local: u32,
}

/// A decomposition that cannot be used.
#[derive(Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DecompositionError {
    /// The table of parts does not have one entry for each tetrahedron.
    #[error("{given} part numbers for {tets} tetrahedra; give exactly one each")]
    PartCount {
        /// Entries given.
        given: usize,
        /// Number of tetrahedra.
        tets: usize,
    },
    /// No part at all is asked for.
    #[error("a mesh cannot be cut into 0 parts; ask for 1 at least")]
    NoParts,
    /// A box grid has no boxes along an axis.
    #[error("the grid of boxes {boxes:?} has none along {axis}; give at least 1 each")]
    NoBoxes {
        /// Boxes along each axis.
        boxes: [usize; 3],
        /// `"x"`, `"y"` or `"z"`.
        axis: &'static str,
    },
    /// A part has no tetrahedra.
    #[error(
        "part {part} of {parts} has no tetrahedron; number the parts without gaps from 0, or use fewer of them"
    )]
    EmptyPart {
        /// Number of the part.
        part: usize,
        /// Number of parts.
        parts: usize,
    },
    /// A part falls into several pieces.
    #[error(
        "part {part} consists of {pieces} pieces that share no face (tetrahedra {first} and {second} are in different ones), so it would have more than six rigid motions; pass the parts through split_disconnected"
    )]
    DisconnectedPart {
        /// Number of the part.
        part: usize,
        /// Number of its pieces.
        pieces: usize,
        /// A tetrahedron of the first piece.
        first: usize,
        /// A tetrahedron of the second piece.
        second: usize,
    },
}

/// The subdomains of a mesh, and where each node went.
///
/// Every subdomain is connected through faces, so that its rigid motions are the six of a body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decomposition {
    subdomains: Vec<Subdomain>,
    part_of: Vec<u32>,
    /// Copies of node n: `copies[copy_start[n]..copy_start[n + 1]]`, by ascending subdomain.
    copy_start: Vec<u32>,
    copies: Vec<NodeCopy>,
}

impl Decomposition {
    /// No decomposition: each body of the mesh is one subdomain.
    #[must_use]
    pub fn whole(mesh: &TetMesh) -> Self {
        Self::build(mesh, mesh.components())
    }

    /// Cuts the bounding box of the mesh into a grid of equal boxes; each tetrahedron goes where
    /// its centroid lies.
    ///
    /// Subdomains are numbered as their boxes, with x fastest, then y, then z. A box without
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
        // Indices z, y, x of the box: their order is that of the boxes, and no product overflows.
        let box_of = |tet: usize| {
            let centre = vec3::centroid(&mesh.tet_points(tet));
            [2, 1, 0].map(|d| {
                let place = (centre[d] - low[d]) / (high[d] - low[d]) * boxes[d] as f64;
                (place as usize).min(boxes[d] - 1)
            })
        };
        let boxes: Vec<[usize; 3]> = (0..mesh.tets().len()).map(box_of).collect();
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
        let part_of = pieces.iter().map(|&piece| number[piece as usize]).collect();
        Ok(Self::build(mesh, part_of))
    }

    /// Takes the part number of each tetrahedron, from a graph partitioner for instance. The
    /// numbers run from 0 without gaps.
    ///
    /// # Errors
    /// [`DecompositionError`] if there is not one number for each tetrahedron, a part is empty, or
    /// a part is not connected (see [`split_disconnected`]).
    pub fn from_parts(mesh: &TetMesh, parts: &[u32]) -> Result<Self, DecompositionError> {
        let tets = mesh.tets().len();
        if parts.len() != tets {
            return Err(DecompositionError::PartCount {
                given: parts.len(),
                tets,
            });
        }
        let count = parts.iter().max().map_or(0, |&p| p as usize + 1);
        if count > tets {
            let part = first_gap(parts, tets);
            return Err(DecompositionError::EmptyPart { part, parts: count });
        }
        Self::checked(mesh, parts.to_vec(), count)
    }

    fn checked(
        mesh: &TetMesh,
        part_of: Vec<u32>,
        parts: usize,
    ) -> Result<Self, DecompositionError> {
        let part = first_gap(&part_of, parts);
        if part < parts {
            return Err(DecompositionError::EmptyPart { part, parts });
        }
        let pieces = split_by(mesh, &part_of);
        // The piece in which each part starts; a second piece is an error.
        let mut start = vec![(NONE, 0); parts];
        for (tet, (&part, &piece)) in part_of.iter().zip(&pieces).enumerate() {
            let (begun, first) = start[part as usize];
            if begun == NONE {
                start[part as usize] = (piece, tet);
            } else if begun != piece {
                let of_part = pieces.iter().zip(&part_of).filter(|(_, p)| **p == part);
                let mut distinct: Vec<u32> = of_part.map(|(piece, _)| *piece).collect();
                distinct.sort_unstable();
                distinct.dedup();
                return Err(DecompositionError::DisconnectedPart {
                    part: part as usize,
                    pieces: distinct.len(),
                    first,
                    second: tet,
                });
            }
        }
        Ok(Self::build(mesh, part_of))
    }

    /// Expects part numbers without gaps.
    fn build(mesh: &TetMesh, part_of: Vec<u32>) -> Self {
        let parts = part_of.iter().max().map_or(0, |&p| p as usize + 1);
        let (starts, tets) = buckets(parts, &part_of);
        let nodes = mesh.points().len();
        let mut local = vec![0u32; nodes];
        let subdomains: Vec<_> = (0..parts)
            .map(|part| {
                let elements = tets[range(&starts, part)].to_vec();
                let global = |&tet: &u32| mesh.tets()[tet as usize];
                let mut nodes: Vec<u32> = elements.iter().flat_map(global).collect();
                nodes.sort_unstable();
                nodes.dedup();
                for (number, &node) in nodes.iter().enumerate() {
                    local[node as usize] = number as u32;
                }
                let to_local = |tet: &u32| global(tet).map(|n| local[n as usize]);
                let tets = elements.iter().map(to_local).collect();
                Subdomain {
                    nodes,
                    tets,
                    elements,
                }
            })
            .collect();
        let (copy_start, copies) = collect_copies(nodes, &subdomains);
        Self {
            subdomains,
            part_of,
            copy_start,
            copies,
        }
    }

    /// The subdomains, by part number.
    #[must_use]
    pub fn subdomains(&self) -> &[Subdomain] {
        &self.subdomains
    }

    /// The copies of a global node, by ascending subdomain.
    ///
    /// # Panics
    /// If there is no such node.
    #[must_use]
    pub fn copies(&self, node: usize) -> &[NodeCopy] {
        &self.copies[range(&self.copy_start, node)]
    }

    /// The subdomain that owns a tetrahedron.
    ///
    /// # Panics
    /// If there is no such tetrahedron.
    #[must_use]
    pub fn part_of(&self, tet: usize) -> u32 {
        self.part_of[tet]
    }

    /// The subdomain of every tetrahedron.
    #[must_use]
    pub fn parts(&self) -> &[u32] {
        &self.part_of
    }

    /// Number of global nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.copy_start.len() - 1
    }

    /// Number of displacement unknowns of all subdomains together, the paper's n_p.
    #[must_use]
    pub fn torn_dofs(&self) -> usize {
        3 * self.copies.len()
    }
}

/// Gives every piece of a part that is not connected through faces a part number of its own. The
/// pieces are numbered anew, by the smallest tetrahedron of each; the result has no gaps, so
/// [`Decomposition::from_parts`] accepts it.
///
/// # Errors
/// [`DecompositionError::PartCount`] if there is not one number for each tetrahedron.
pub fn split_disconnected(mesh: &TetMesh, parts: &[u32]) -> Result<Vec<u32>, DecompositionError> {
    let tets = mesh.tets().len();
    if parts.len() != tets {
        return Err(DecompositionError::PartCount {
            given: parts.len(),
            tets,
        });
    }
    Ok(split_by(mesh, parts))
}

pub(crate) fn split_by(mesh: &TetMesh, parts: &[u32]) -> Vec<u32> {
    connected_sets(mesh.neighbour_table(), |a, b| parts[a] == parts[b])
}

/// The same parts, numbered without gaps by their first tetrahedra.
pub(crate) fn renumbered(parts: &[u32]) -> Vec<u32> {
    let mut number = vec![NONE; parts.iter().max().map_or(0, |&p| p as usize + 1)];
    let mut next = 0;
    let new = |&part: &u32| {
        let number = &mut number[part as usize];
        if *number == NONE {
            *number = next;
            next += 1;
        }
        *number
    };
    parts.iter().map(new).collect()
}

/// The first number below `limit` that is not among the parts, else `limit`.
fn first_gap(parts: &[u32], limit: usize) -> usize {
    let mut found = vec![false; limit];
    for &part in parts {
        if let Some(f) = found.get_mut(part as usize) {
            *f = true;
        }
    }
    found.iter().position(|&f| !f).unwrap_or(limit)
}

fn collect_copies(nodes: usize, subdomains: &[Subdomain]) -> (Vec<u32>, Vec<NodeCopy>) {
    let (mut torn, mut node_of) = (Vec::new(), Vec::new());
    for (number, subdomain) in subdomains.iter().enumerate() {
        torn.extend((0..subdomain.nodes.len()).map(|local| NodeCopy {
            subdomain: number as u32,
            local: local as u32,
        }));
        node_of.extend_from_slice(&subdomain.nodes);
    }
    let (start, positions) = buckets(nodes, &node_of);
    let copies = positions.iter().map(|&k| torn[k as usize]).collect();
    (start, copies)
}
