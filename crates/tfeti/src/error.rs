//! What can go wrong while a T-FETI system is built.

use crate::linalg::sparse::FactorError;

/// Errors of the set-up. Every message names the place and, where there is one, the remedy.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TfetiError {
    /// A subdomain has a motion without strain besides the six rigid ones.
    #[error(
        "subdomain {subdomain}: the stiffness matrix is singular beyond its six rigid motions (pivot {pivot}); \
         a part of it hangs on a single node or edge, or its elements are degenerate: use another decomposition"
    )]
    Singular {
        /// Subdomain number.
        subdomain: usize,
        /// Elimination step (position in the factor) at which the pivot vanished.
        pivot: usize,
    },
    /// The rigid motions of a subdomain are dependent: its nodes lie on one line.
    #[error(
        "subdomain {subdomain}: its nodes lie on one line, so it has fewer than six rigid motions"
    )]
    Collinear {
        /// Subdomain number.
        subdomain: usize,
    },
    /// The material of an element is unknown or unusable.
    #[error("tetrahedron {element}: {message}")]
    Material {
        /// Number of the tetrahedron in the mesh.
        element: usize,
        /// What the material table answered.
        message: String,
    },
    /// A node number beyond the mesh.
    #[error("{place}: node {node} does not exist, the mesh has nodes 0..{nodes}")]
    UnknownNode {
        /// Where the number was given, for example "support 2".
        place: String,
        /// The number.
        node: u32,
        /// Number of nodes of the mesh.
        nodes: usize,
    },
    /// A support without nodes or without directions.
    #[error("support {support} has no {what}; remove it or give it some")]
    EmptySupport {
        /// Position in the list of supports.
        support: usize,
        /// `"nodes"` or `"directions"`.
        what: &'static str,
    },
    /// A direction of a support that is zero or not finite.
    #[error("support {support}: direction {direction} is zero or not finite")]
    BadDirection {
        /// Position in the list of supports.
        support: usize,
        /// Position in its list of directions.
        direction: usize,
    },
    /// Prescribed displacements that do not fit the support.
    #[error(
        "support {support}: {found} prescribed displacements for {nodes} nodes; give one for all or one for each"
    )]
    MotionLength {
        /// Position in the list of supports.
        support: usize,
        /// Number of displacements given.
        found: usize,
        /// Number of nodes of the support.
        nodes: usize,
    },
    /// A displacement case beyond the number of supports.
    #[error(
        "support {support}: displacement case {case} is too large for {supports} supports; number the cases from 0 without gaps"
    )]
    CaseNumber {
        /// Position in the list of supports.
        support: usize,
        /// The number of the case.
        case: u32,
        /// Number of supports.
        supports: usize,
    },
    /// A prescribed displacement that is not finite.
    #[error("support {support}, node {node}: the prescribed displacement is not finite")]
    BadMotion {
        /// Position in the list of supports.
        support: usize,
        /// Mesh node.
        node: u32,
    },
    /// Two supports prescribe different displacements of one node in one direction.
    #[error(
        "node {node}: supports {first} and {second} prescribe different displacements in the same direction (case {case}, difference {difference:e} m); \
         make them agree or remove one"
    )]
    ContradictorySupports {
        /// Mesh node.
        node: u32,
        /// The support that fixed the direction first (the last of those that span it).
        first: usize,
        /// The support that contradicts.
        second: usize,
        /// Displacement case in which they differ.
        case: u32,
        /// Difference of the two prescribed values in metres.
        difference: f64,
    },
    /// A node that takes part in two contact points of one normal, or of a pair.
    #[error(
        "node {node} has two contact points with the same partner along the same normal, or is its own partner; give each pair of nodes, and each obstacle of a node, once"
    )]
    ContactNodeTwice {
        /// Mesh node.
        node: u32,
    },
    /// A side of a contact point whose nodes and weights are no mean.
    #[error(
        "contact point {point}: a side of it is no weighted mean of nodes: {what}; give it nodes, each once, with finite weights that sum to one"
    )]
    BadSide {
        /// Position in the list of contact points.
        point: usize,
        /// What is wrong.
        what: &'static str,
    },
    /// A contact frame that is not orthonormal or not finite.
    #[error("contact point {point} (node {node}): normal and tangents are not orthonormal")]
    BadFrame {
        /// Position in the list of contact points.
        point: usize,
        /// Mesh node.
        node: u32,
    },
    /// The decomposition was made for another mesh, or a system of another decomposition is to be reused.
    #[error(
        "the decomposition has {found} {what}, the mesh or the system to reuse has {expected}; \
         decompose this mesh, and reuse a system of this decomposition only"
    )]
    DecompositionMismatch {
        /// What was counted, for example `"nodes"` or `"elements"`.
        what: &'static str,
        /// Number in the decomposition.
        found: usize,
        /// Number in the mesh or in the system to reuse.
        expected: usize,
    },
    /// The stiffness of the copies was taken from a system of another decomposition.
    #[error(
        "copy stiffness: it has {found} nodes in subdomain {subdomain}, the decomposition has {expected}; \
         take it from a system of this decomposition"
    )]
    ForeignStiffness {
        /// First subdomain that differs.
        subdomain: usize,
        /// Number of its nodes in the stiffness; 0 if it has no such subdomain.
        found: usize,
        /// Number of its nodes in the decomposition; 0 if it has no such subdomain.
        expected: usize,
    },
    /// A vector of the wrong length.
    #[error("{what}: expected length {expected}, found {found}")]
    Length {
        /// Which vector.
        what: &'static str,
        /// Needed length.
        expected: usize,
        /// Given length.
        found: usize,
    },
    /// A number that is not finite in an input vector.
    #[error("{what}: entry {index} is not finite")]
    NotFinite {
        /// Which vector.
        what: &'static str,
        /// Position of the first such entry.
        index: usize,
    },
    /// A setting outside of its range.
    #[error("setting {name} = {value} is out of range: {range}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The permitted range in words.
        range: &'static str,
    },
    /// The inverses do not fit into the memory limit.
    #[error(
        "the generalised inverses need about {needed} bytes, the limit is {limit}; \
         raise `memory_limit`, allow sharing, choose sparse inverses or smaller subdomains"
    )]
    Memory {
        /// Smallest number of bytes found.
        needed: u64,
        /// The limit.
        limit: u64,
    },
    /// The coarse matrix is not positive definite although no free motion was found.
    #[error(
        "the coarse matrix G W G^T is not positive definite (pivot {pivot}); some subdomains are held by interface rows of weight zero only"
    )]
    CoarseSingular {
        /// Elimination step at which the pivot vanished.
        pivot: usize,
    },
    /// The pattern of a subdomain factor cannot be analysed.
    #[error(
        "subdomain {subdomain}: the pattern of its factor cannot be analysed, it is too large to be stored or numbered; \
         use smaller subdomains"
    )]
    FactorPattern {
        /// Subdomain number.
        subdomain: usize,
    },
    /// Contact points join so many rows that a preconditioner cannot scale them; no such case is covered yet.
    #[error(
        "node {node}: contact points join {rows} rows by the nodes of their sides, preconditioners scale at most {limit} together; \
         solve without preconditioner, or cut the sides"
    )]
    JoinedRows {
        /// First of the mesh nodes.
        node: u32,
        /// Number of rows.
        rows: usize,
        /// Largest number.
        limit: usize,
    },
    /// More unknowns than 32-bit tables can number.
    #[error("{what} = {count} is more than the 32-bit tables can number")]
    TooLarge {
        /// What is too many.
        what: &'static str,
        /// How many.
        count: usize,
    },
}

/// Prints its sentence, as with `{}`: that is what a user sees of a `main` that returns it.
impl std::fmt::Debug for TfetiError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

impl TfetiError {
    /// What a failure of a factorisation says of a subdomain.
    pub(crate) fn pattern(error: FactorError, subdomain: usize) -> Self {
        match error {
            FactorError::Pivot(pivot) => Self::Singular { subdomain, pivot },
            FactorError::Pattern => Self::FactorPattern { subdomain },
        }
    }
}
