//! What can go wrong while a T-FETI system is built.

use crate::linalg::sparse::FactorError;
use crate::processes::communicator::CommunicationError;

signorini_fem_mesh::errors! {
    /// Errors of the set-up. A message names the place where it is known, and the remedy where there is one.
    #[derive(Clone, PartialEq)]
    TfetiError from { Communication(CommunicationError) } {
        Singular { subdomain: usize, pivot: usize } =
            "subdomain {subdomain}: the stiffness matrix is singular beyond its six rigid motions (pivot {pivot}); a \
            part of it hangs on a single node or edge, its elements are degenerate, or it has three or fewer quadratic \
            tetrahedra with a Poisson's ratio above 0.4, or such with centroids in one plane: use another \
            decomposition";
        Contrast { subdomain: usize, ratio: f64 } =
            "subdomain {subdomain}: some of its nodes are {ratio:.1e} times as stiff as others, so that rounding hides \
            what is soft: look at the units of its materials and at its smallest elements, or use subdomains of more \
            even stiffness";
        Collinear { subdomain: usize } =
            "subdomain {subdomain}: its nodes lie on one line, so it has fewer than six rigid motions; use another \
            decomposition, or a coupling of more nodes";
        Material { element: usize, message: String } = "tetrahedron {element}: {message}";
        Equation { equation: usize, node: Option<u32>, others: Vec<usize>, reason: &'static str } =
            "equation {equation}{}{}: {reason}", node.map_or(String::new(), |n| format!(", node {n}")), beside(others);
        Spring { node: u32, stiffness: f64 } =
            "spring at node {node}: its direction must be a unit vector, and its stiffness, {stiffness}, positive and \
            neither so small nor so large that its inverse overflows or vanishes";
        SpringRest { node: u32, case: u32, value: f64 } =
            "spring at node {node}: at rest its displacement is {value} in case {case}; give a finite value, and a \
            case that supports have";
        RigidSupport { subdomain: usize } =
            "subdomain {subdomain}: what is held of a rigid motion must be a displacement along a unit vector or a \
            rotation about one, of a subdomain without elements, at a finite point, with finite values of cases that \
            are numbered from 0 without gaps";
        UnknownNode { place: String, node: u32, nodes: usize } =
            "{place}: node {node} does not exist, the mesh has nodes 0..{nodes}";
        EmptySupport { support: usize, what: &'static str } =
            "support {support} has no {what}; remove it or give it some";
        BadDirection { support: usize, node: Option<u32>, direction: usize } =
            "support {support}{}: direction {direction} is zero or not finite",
            node.map_or(String::new(), |n| format!(", node {n}"));
        MotionLength { support: usize, found: usize, nodes: usize } =
            "support {support}: {found} prescribed displacements for {nodes} nodes; give one for all or one for each";
        DirectionLists { support: usize, found: usize, nodes: usize } =
            "support {support}: {found} lists of directions for {nodes} nodes; give one for each";
        CaseNumber { support: usize, case: u32, supports: usize } =
            "support {support}: displacement case {case} is too large for {supports} supports; number the cases from \
            0 without gaps";
        BadMotion { support: usize, node: u32 } =
            "support {support}, node {node}: the prescribed displacement is not finite";
        ContradictorySupports { node: u32, first: usize, second: usize, case: u32, difference: f64 } =
            "node {node}: supports {first} and {second} prescribe different displacements in the same direction ({}\
            difference {difference:e}); make them agree or remove one", later(*case);
        ContactNodeTwice { node: u32 } =
            "node {node} has two contact points with the same partner along the same normal, or is its own partner; \
            give each pair of nodes, and each obstacle of a node, once";
        BadSide { point: usize, what: &'static str } =
            "contact point {point}: a side of it is no weighted mean of nodes: {what}; give it nodes, each once, with \
            finite weights that sum to one";
        BadFrame { point: usize, node: u32 } =
            "contact point {point} (node {node}): normal and tangents are not orthonormal";
        BadCompliance { point: usize, node: u32, compliance: f64 } =
            "contact point {point} (node {node}): its compliance is {compliance}; it must be finite and not negative";
        BadStretch { point: usize, node: u32, stretch: f64 } =
            "contact point {point} (node {node}): friction along the second tangent is {stretch} times that along the \
            first; this must be finite and positive";
        DecompositionMismatch { what: &'static str, found: usize, expected: usize } =
            "the decomposition has {found} {what}, the mesh has {expected}; decompose this mesh";
        Length { what: &'static str, expected: usize, found: usize } =
            "{what}: expected length {expected}, found {found}";
        NotFinite { what: &'static str, index: usize } = "{what}: entry {index} is not finite";
        Setting { name: &'static str, value: f64, range: &'static str } =
            "setting {name} = {value} is out of range: {range}";
        Memory { needed: u64, limit: u64 } =
            "the generalised inverses need about {needed} bytes, the limit is {limit}; raise \
            InverseSettings::with_memory_limit, allow sharing, choose sparse inverses or smaller subdomains";
        CoarseSingular { pivot: usize } =
            "the coarse matrix G W G^T is not positive definite (pivot {pivot}); some subdomains are held by \
            interface rows of weight zero only";
        FactorPattern { subdomain: usize } =
            "subdomain {subdomain}: the pattern of its factor cannot be analysed, it is too large to be stored or \
            numbered; use smaller subdomains";
        DependentRows { node: u32 } =
            "node {node}: its rows depend on one another, no preconditioner can scale them; give each contact once";
        TooLarge { what: &'static str, count: usize } =
            "{what}: {count} are more than tables can number or hold";
    }
}

/// A displacement case after the first, which may be the only one.
fn later(case: u32) -> String {
    if case > 0 { format!("case {case}, ") } else { String::new() }
}

/// Other equations that an error names.
fn beside(others: &[usize]) -> String {
    let numbers: Vec<String> = others.iter().map(usize::to_string).collect();
    match numbers[..] {
        [] => String::new(),
        _ => format!(", beside equations {}", numbers.join(", ")),
    }
}

impl TfetiError {
    /// An error if a vector does not have the length expected.
    pub(crate) fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), Self> {
        if found == expected { Ok(()) } else { Err(Self::Length { what, expected, found }) }
    }

    /// What a failure of a factorisation says of a subdomain.
    pub(crate) fn pattern(error: FactorError, subdomain: usize) -> Self {
        match error {
            FactorError::Pivot(pivot) => Self::Singular { subdomain, pivot },
            FactorError::Pattern => Self::FactorPattern { subdomain },
        }
    }
}
