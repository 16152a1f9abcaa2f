//! What can go wrong while a T-FETI system is built.

use crate::linalg::sparse::FactorError;

/// Errors of the set-up. Every message names the place and, where there is one, the remedy; fields are what it names.
#[allow(missing_docs)]
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TfetiError {
    /// A subdomain has a motion without strain besides the six rigid ones.
    #[error(
        "subdomain {subdomain}: the stiffness matrix is singular beyond its six rigid motions (pivot {pivot}); \
         a part of it hangs on a single node or edge, or its elements are degenerate: use another decomposition"
    )]
    Singular { subdomain: usize, pivot: usize },
    /// The rigid motions of a subdomain are dependent: its nodes lie on one line.
    #[error("subdomain {subdomain}: its nodes lie on one line, so it has fewer than six rigid motions")]
    Collinear { subdomain: usize },
    /// The material of an element is unknown or unusable.
    #[error("tetrahedron {element}: {message}")]
    Material { element: usize, message: String },
    /// A node number beyond the mesh.
    #[error("{place}: node {node} does not exist, the mesh has nodes 0..{nodes}")]
    UnknownNode { place: String, node: u32, nodes: usize },
    /// A support without nodes or without directions.
    #[error("support {support} has no {what}; remove it or give it some")]
    EmptySupport { support: usize, what: &'static str },
    /// A direction of a support that is zero or not finite.
    #[error("support {support}: direction {direction} is zero or not finite")]
    BadDirection { support: usize, direction: usize },
    /// Prescribed displacements that do not fit the support.
    #[error("support {support}: {found} prescribed displacements for {nodes} nodes; give one for all or one for each")]
    MotionLength { support: usize, found: usize, nodes: usize },
    /// A displacement case beyond the number of supports.
    #[error(
        "support {support}: displacement case {case} is too large for {supports} supports; \
         number the cases from 0 without gaps"
    )]
    CaseNumber { support: usize, case: u32, supports: usize },
    /// A prescribed displacement that is not finite.
    #[error("support {support}, node {node}: the prescribed displacement is not finite")]
    BadMotion { support: usize, node: u32 },
    /// Two supports prescribe different displacements of one node in one direction.
    #[error(
        "node {node}: supports {first} and {second} prescribe different displacements in the same direction \
         (case {case}, difference {difference:e} m); \
         make them agree or remove one"
    )]
    ContradictorySupports {
        node: u32,
        first: usize,
        second: usize,
        case: u32,
        difference: f64,
    },
    /// A node that takes part in two contact points of one normal, or of a pair.
    #[error(
        "node {node} has two contact points with the same partner along the same normal, or is its own partner; \
         give each pair of nodes, and each obstacle of a node, once"
    )]
    ContactNodeTwice { node: u32 },
    /// A side of a contact point whose nodes and weights are no mean.
    #[error(
        "contact point {point}: a side of it is no weighted mean of nodes: {what}; \
         give it nodes, each once, with finite weights that sum to one"
    )]
    BadSide { point: usize, what: &'static str },
    /// A contact frame that is not orthonormal or not finite.
    #[error("contact point {point} (node {node}): normal and tangents are not orthonormal")]
    BadFrame { point: usize, node: u32 },
    /// The decomposition was made for another mesh.
    #[error("the decomposition has {found} {what}, the mesh has {expected}; decompose this mesh")]
    DecompositionMismatch {
        what: &'static str,
        found: usize,
        expected: usize,
    },
    /// The stiffness of the copies was taken from a system of another decomposition.
    #[error(
        "copy stiffness: it has {found} nodes in subdomain {subdomain}, the decomposition has {expected}; \
         take it from a system of this decomposition"
    )]
    ForeignStiffness {
        subdomain: usize,
        found: usize,
        expected: usize,
    },
    /// A vector of the wrong length.
    #[error("{what}: expected length {expected}, found {found}")]
    Length {
        what: &'static str,
        expected: usize,
        found: usize,
    },
    /// A number that is not finite in an input vector.
    #[error("{what}: entry {index} is not finite")]
    NotFinite { what: &'static str, index: usize },
    /// A setting outside of its range.
    #[error("setting {name} = {value} is out of range: {range}")]
    Setting {
        name: &'static str,
        value: f64,
        range: &'static str,
    },
    /// The inverses do not fit into the memory limit.
    #[error(
        "the generalised inverses need about {needed} bytes, the limit is {limit}; \
         raise `memory_limit`, allow sharing, choose sparse inverses or smaller subdomains"
    )]
    Memory { needed: u64, limit: u64 },
    /// The coarse matrix is not positive definite although no free motion was found.
    #[error(
        "the coarse matrix G W G^T is not positive definite (pivot {pivot}); \
         some subdomains are held by interface rows of weight zero only"
    )]
    CoarseSingular { pivot: usize },
    /// The pattern of a subdomain factor cannot be analysed.
    #[error(
        "subdomain {subdomain}: the pattern of its factor cannot be analysed, it is too large to be stored or \
         numbered; use smaller subdomains"
    )]
    FactorPattern { subdomain: usize },
    /// Rows of a node depend on one another where they should not.
    #[error("node {node}: its rows depend on one another, no preconditioner can scale them; give each contact once")]
    DependentRows { node: u32 },
    /// Contact points join so many rows that a preconditioner cannot scale them; no such case is covered yet.
    #[error(
        "node {node}: contact points join {rows} rows by the nodes of their sides, \
         preconditioners scale at most {limit} together; \
         solve without preconditioner, or cut the sides"
    )]
    JoinedRows { node: u32, rows: usize, limit: usize },
    /// More unknowns than 32-bit tables can number.
    #[error("{what} = {count} is more than the 32-bit tables can number")]
    TooLarge { what: &'static str, count: usize },
}

/// Prints its sentence, as with `{}`: that is what a user sees of a `main` that returns it.
impl std::fmt::Debug for TfetiError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

impl TfetiError {
    /// An error if a vector does not have the length expected.
    pub(crate) fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), Self> {
        match found == expected {
            true => Ok(()),
            false => Err(Self::Length { what, expected, found }),
        }
    }

    /// What a failure of a factorisation says of a subdomain.
    pub(crate) fn pattern(error: FactorError, subdomain: usize) -> Self {
        match error {
            FactorError::Pivot(pivot) => Self::Singular { subdomain, pivot },
            FactorError::Pattern => Self::FactorPattern { subdomain },
        }
    }
}
