//! The parts of a scene, by their numbers.

use signorini_fem_mesh::FacetTag;

/// A part of a scene, by its number there: its position in the scene or in the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Part {
    /// A contact.
    Contact(usize),
    /// A support.
    Support(usize),
    /// A spring.
    Spring(usize),
    /// A rigid coupling.
    Coupling(usize),
    /// A linear equation.
    Equation(usize),
    /// A load.
    Load(usize),
    /// A node of the mesh.
    Node(u32),
    /// A tetrahedron of the mesh.
    Tet(usize),
    /// A material region.
    Region(u32),
    /// The facets with a tag.
    Tag(FacetTag),
    /// A step in time, from 0.
    Step(usize),
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Contact(index) => write!(f, "contact {index}"),
            Self::Support(index) => write!(f, "support {index}"),
            Self::Spring(index) => write!(f, "spring {index}"),
            Self::Coupling(index) => write!(f, "coupling {index}"),
            Self::Equation(index) => write!(f, "equation {index}"),
            Self::Load(index) => write!(f, "load {index}"),
            Self::Node(node) => write!(f, "node {node}"),
            Self::Tet(tet) => write!(f, "tetrahedron {tet}"),
            Self::Region(region) => write!(f, "region {region}"),
            Self::Tag(tag) => write!(f, "{tag}"),
            Self::Step(step) => write!(f, "step {step}"),
        }
    }
}
