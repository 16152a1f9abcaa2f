//! Decomposition into subdomains that are torn apart at their common nodes.

use crate::mesh::{TetMesh, quadratic_tets};
use crate::tables::{Lists, distinct};
use crate::tolerances::TABLES;
use rayon::prelude::*;

/// A part of the mesh with its own numbering of nodes and tetrahedra.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Subdomain {
    /// Global number of each local node, ascending. Local numbers therefore follow the global
    /// order, and translates of a regular mesh have the same local tables.
    pub nodes: Vec<u32>,
    /// Corners of the tetrahedra in local node numbers, in the order of `elements`.
    pub tets: Vec<[u32; 4]>,
    /// Their mid-nodes ([`TetMesh::mids`]) in local numbers; empty in a mesh of order 1.
    pub mids: Vec<[u32; 6]>,
    /// Global number of each tetrahedron, ascending.
    pub elements: Vec<u32>,
    /// Whether it does not move its nodes, which only say where it is: its motion is that of one part relative to
    /// another.
    pub is_relative: bool,
}

impl Subdomain {
    /// Number of displacement unknowns, three for each local node.
    pub fn dofs(&self) -> usize {
        3 * self.nodes.len()
    }

    /// The ten nodes of each tetrahedron in local numbers; empty in a mesh of order 1.
    pub fn quadratic_tets(&self) -> Vec<[u32; 10]> {
        quadratic_tets(&self.tets, &self.mids)
    }

    /// Whether it has no elements: it then moves as a rigid body.
    pub fn is_rigid(&self) -> bool {
        self.elements.is_empty()
    }

    /// Local number of a global node, if it is here.
    pub fn local(&self, node: u32) -> Option<usize> {
        self.nodes.binary_search(&node).ok()
    }

    /// Coordinates of the local nodes.
    pub fn points(&self, mesh: &TetMesh) -> Vec<[f64; 3]> {
        self.nodes.iter().map(|&n| mesh.points()[n as usize]).collect()
    }
}

/// The nodes of a subdomain [without elements](Decomposition::with_rigid).
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Rigid {
    /// It moves them.
    Nodes(Vec<u32>),
    /// Moves nothing: its six motions are those of one part relative to another, measured at these nodes.
    Places(Vec<u32>),
}

/// The copies of each of so many nodes, by ascending subdomain.
fn copies_of(subdomains: &[Subdomain], nodes: usize) -> Lists<NodeCopy> {
    let (mut torn, mut node_of) = (Vec::new(), Vec::new());
    for (subdomain, own) in (0..).zip(subdomains).filter(|(_, own)| !own.is_relative) {
        let copies = (0..own.nodes.len() as u32).map(|local| NodeCopy { subdomain, local });
        torn.extend(copies);
        node_of.extend_from_slice(&own.nodes);
    }
    Lists::by_key(nodes, &node_of).map(|k| torn[k as usize])
}

/// A copy of a global node in a subdomain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct NodeCopy {
    /// Number of the subdomain.
    pub subdomain: u32,
    /// Local number of the node there.
    pub local: u32,
}

errors! {
    /// A decomposition that cannot be used.
    #[derive(Clone, PartialEq, Eq)]
    DecompositionError {
        PartCount { given: usize, tets: usize } =
            "{given} part numbers for {tets} tetrahedra; give exactly one each";
        NoParts = "a mesh cannot be cut into 0 parts; ask for 1 at least";
        NoBoxes { boxes: [usize; 3], axis: &'static str } =
            "the grid of boxes {boxes:?} has none along {axis}; give at least 1 each";
        RigidNode { node: u32, nodes: usize } =
            "node {node} of a rigid subdomain does not exist, the mesh has {nodes} nodes, numbered from 0";
        EmptyPart { part: usize, parts: usize } =
            "part {part} of {parts} has no tetrahedron; number the parts without gaps from 0, or use fewer of them";
        DisconnectedPart { part: usize, pieces: usize, first: usize, second: usize } =
            "part {part} consists of {pieces} pieces that share no face (tetrahedra {first} and {second} are in \
            different ones), so it would have more than six rigid motions; pass the parts through split_disconnected";
    }
}

/// The subdomains of a mesh, and where each node went.
///
/// Every subdomain is connected through faces, or [rigid](Self::with_rigid), so that its rigid motions are the six of a
/// body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decomposition {
    subdomains: Vec<Subdomain>,
    part_of: Vec<u32>,
    /// Copies of each node, by ascending subdomain.
    copies: Lists<NodeCopy>,
}

impl Decomposition {
    /// No decomposition: each body of the mesh is one subdomain.
    pub fn whole(mesh: &TetMesh) -> Self {
        Self::build(mesh, mesh.components())
    }

    /// Expects part numbers without gaps.
    pub(super) fn build(mesh: &TetMesh, part_of: Vec<u32>) -> Self {
        let tets = Lists::by_number(&part_of);
        let (parts, nodes) = (tets.count(), mesh.points().len());
        // with a table of local numbers for some parts after one another
        let subdomains: Vec<_> = (0..parts)
            .into_par_iter()
            .with_min_len(parts.div_ceil(TABLES))
            .map_init(
                || vec![0u32; nodes],
                |local, part| {
                    let elements = tets.of(part).to_vec();
                    let global = |&tet: &u32| mesh.tets()[tet as usize];
                    let own_mids = || elements.iter().filter_map(|&tet| mesh.mids().get(tet as usize));
                    let corners = elements.iter().flat_map(global);
                    let nodes = distinct(corners.chain(own_mids().flatten().copied()));
                    for (number, &node) in nodes.iter().enumerate() {
                        local[node as usize] = number as u32;
                    }
                    let to_local = |tet: &u32| global(tet).map(|n| local[n as usize]);
                    let tets = elements.iter().map(to_local).collect();
                    let mids = own_mids().map(|mids| mids.map(|n| local[n as usize])).collect();
                    Subdomain {
                        nodes,
                        tets,
                        mids,
                        elements,
                        is_relative: false,
                    }
                },
            )
            .collect();
        let copies = copies_of(&subdomains, nodes);
        Self {
            subdomains,
            part_of,
            copies,
        }
    }

    /// Adds subdomains without elements behind the others. They are rigid: nothing but their six motions moves them,
    /// and their nodes, which stay those of elements too, move with them, unless they are [places](Rigid::Places).
    ///
    /// # Errors
    /// [`DecompositionError::RigidNode`] for a node that does not exist.
    pub fn with_rigid(mut self, rigid: Vec<Rigid>) -> Result<Self, DecompositionError> {
        let nodes = self.nodes();
        for own in rigid {
            let (list, is_relative) = match own {
                Rigid::Nodes(list) => (list, false),
                Rigid::Places(list) => (list, true),
            };
            if let Some(&node) = list.iter().find(|&&n| n as usize >= nodes) {
                return Err(DecompositionError::RigidNode { node, nodes });
            }
            self.subdomains.push(Subdomain {
                nodes: distinct(list),
                is_relative,
                ..Subdomain::default()
            });
        }
        self.copies = copies_of(&self.subdomains, nodes);
        Ok(self)
    }

    /// The subdomains, by part number, and behind them the rigid ones.
    pub fn subdomains(&self) -> &[Subdomain] {
        &self.subdomains
    }

    /// The copies of a global node, by ascending subdomain.
    pub fn copies(&self, node: usize) -> &[NodeCopy] {
        self.copies.of(node)
    }

    /// The subdomain of every tetrahedron.
    pub fn parts(&self) -> &[u32] {
        &self.part_of
    }

    /// Number of global nodes.
    pub fn nodes(&self) -> usize {
        self.copies.count()
    }

    /// Number of displacement unknowns of all subdomains together, the paper's n_p.
    pub fn torn_dofs(&self) -> usize {
        self.subdomains.iter().map(Subdomain::dofs).sum()
    }

    /// The mesh node that each node of each subdomain is a copy of, one after another; none of places.
    pub fn torn_nodes(&self) -> impl Iterator<Item = Option<u32>> {
        let of = |s: &'_ Subdomain| s.is_relative;
        let subdomains = self.subdomains.iter();
        subdomains.flat_map(move |s| s.nodes.iter().map(move |&node| (!of(s)).then_some(node)))
    }
}
