//! The parts of a scene that an error or a warning speaks of, and what they are called where the scene comes from.

use crate::error::ContactError;
use crate::part::Part;
use crate::status::{FreeCoupling, Slide};
use signorini_fem_mesh::loads::Function;
use signorini_fem_mesh::{FacetTag, LoadError, MaterialError, MeshError, SurfaceError};
use signorini_tfeti::TfetiError;
use std::sync::Arc;

type Name = dyn Fn(Part) -> Option<String> + Send + Sync;

/// What parts are called, if anybody knows.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Names {
    name: Option<Function<Name>>,
    /// Whether the loads are others than those that it names.
    other_loads: bool,
}

impl Names {
    pub(crate) fn new(name: impl Fn(Part) -> Option<String> + Send + Sync + 'static) -> Self {
        Self {
            name: Some(Function(Arc::new(name))),
            other_loads: false,
        }
    }

    /// Names no loads any more.
    pub(crate) fn forget_loads(&mut self) {
        self.other_loads = true;
    }

    /// The error behind the names of what it speaks of.
    pub(crate) fn tell(&self, error: ContactError) -> ContactError {
        let told = matches!(error, ContactError::Named { .. });
        match self.of(error.parts()).filter(|_| !told) {
            Some(names) => ContactError::Named {
                names,
                source: Box::new(error),
            },
            None => error,
        }
    }

    /// That of a part.
    pub(crate) fn name(&self, part: Part) -> Option<String> {
        let known = self
            .name
            .as_ref()
            .filter(|_| !self.other_loads || !matches!(part, Part::Load(_)));
        (known?)(part)
    }

    /// Those of some parts, if any has one.
    pub(crate) fn of(&self, parts: Vec<Part>) -> Option<String> {
        let names = listed(parts, |part| self.name(part));
        (!names.is_empty()).then_some(names)
    }
}

/// What parts are called, of those that have a name.
fn listed(parts: Vec<Part>, name: impl Fn(Part) -> Option<String>) -> String {
    let named = |part: Part| Some(format!("{part} is {}", name(part)?));
    let names: Vec<String> = parts.into_iter().filter_map(named).collect();
    names.join(", ")
}

impl ContactError {
    /// What its [parts](Self::parts) are called, of those that have a name.
    pub fn names(&self, name: impl Fn(Part) -> Option<String>) -> String {
        listed(self.parts(), name)
    }

    /// The parts of the scene that it speaks of, without repetition.
    pub fn parts(&self) -> Vec<Part> {
        let mut parts = match self {
            Self::Coefficient { contact, .. }
            | Self::ContactValue { contact, .. }
            | Self::Compliance { contact, .. }
            | Self::EmptyTable { contact }
            | Self::TableRate { contact, .. }
            | Self::ObstacleNormal { contact, .. }
            | Self::ObstacleSide { contact, .. }
            | Self::NoPartner { contact, .. }
            | Self::TwoGaps { contact }
            | Self::Tied { contact }
            | Self::MovedPartner { contact } => vec![Part::Contact(*contact)],
            Self::Gap { contact, node, .. }
            | Self::MovedField { contact, node, .. }
            | Self::ObstacleGradient { contact, node, .. }
            | Self::ObstacleDistance { contact, node, .. }
            | Self::FrictionAxis { contact, node, .. }
            | Self::CoefficientAt { contact, node, .. }
            | Self::SlipBound { contact, node, .. }
            | Self::TurnedNormal { contact, node, .. } => vec![Part::Contact(*contact), Part::Node(*node)],
            Self::Overlap {
                contact, node, partner, ..
            } => {
                vec![Part::Contact(*contact), Part::Node(*node), Part::Node(*partner)]
            }
            Self::SamePair { first, second, tags } => {
                let contacts = [first, second].map(|contact| Part::Contact(*contact));
                let tags = tags.map(|tag| Part::Tag(FacetTag(tag)));
                contacts.into_iter().chain(tags).collect()
            }
            Self::SameSide { contact, tag } => vec![Part::Contact(*contact), Part::Tag(FacetTag(*tag))],
            Self::SharedNode { node, first, second } => {
                vec![Part::Node(*node), Part::Contact(*first), Part::Contact(*second)]
            }
            Self::SupportInObstacle {
                support, contact, node, ..
            }
            | Self::PartedTie {
                support, contact, node, ..
            } => vec![Part::Support(*support), Part::Contact(*contact), Part::Node(*node)],
            Self::Probe { node, .. } => vec![Part::Node(*node)],
            Self::NotHeld {
                step, node, coupling, ..
            } => {
                let own = [Part::Node(*node), Part::Step(*step)].into_iter();
                own.chain(of_coupling(coupling.as_deref())).collect()
            }
            Self::NotDetermined { node, coupling, .. } => [Part::Node(*node)]
                .into_iter()
                .chain(of_coupling(coupling.as_deref()))
                .collect(),
            Self::Time { step, .. } | Self::UnequalSteps { step, .. } | Self::UnconvergedHistory { step } => {
                vec![Part::Step(*step)]
            }
            Self::Coupling { coupling, node, .. } => {
                let coupling = [Part::Coupling(*coupling)].into_iter();
                coupling.chain(node.map(Part::Node)).collect()
            }
            Self::UnknownCoupling { load, .. } => vec![Part::Load(*load)],
            Self::Spring { spring, .. } | Self::SpringStiffness { spring, .. } => vec![Part::Spring(*spring)],
            Self::UnknownNode { support, .. }
            | Self::ValueCount { support, .. }
            | Self::SupportAxis { support, .. } => {
                vec![Part::Support(*support)]
            }
            Self::OnAxis { support, node } | Self::MotionNotHeld { support, node, .. } => {
                vec![Part::Support(*support), Part::Node(*node)]
            }
            Self::UnknownTag { part, .. }
            | Self::HistoryValue { part, .. }
            | Self::Idle { part, .. }
            | Self::Span { part, .. }
            | Self::TooLarge { part, .. } => vec![*part],
            Self::Stiffness { region, .. } => vec![Part::Region(*region)],
            Self::NotConverged(failure) => {
                let others = |s: &Slide| s.others.into_iter().flatten().map(|(_, node)| node);
                let nodes = failure.slide.iter().flat_map(|s| [s.node].into_iter().chain(others(s)));
                let step = [Part::Step(failure.step)].into_iter();
                let coupling = failure.slide.iter().flat_map(|s| of_coupling(s.coupling.as_ref()));
                step.chain(nodes.map(Part::Node)).chain(coupling).collect()
            }
            Self::Load { index, source } => match source {
                LoadError::UnknownNode { node, .. } => vec![Part::Load(*index), Part::Node(*node)],
                _ => vec![Part::Load(*index)],
            },
            Self::Mesh(error) => of_mesh(error),
            Self::Material(MaterialError::Unknown { region, .. } | MaterialError::Repeated { region }) => {
                vec![Part::Region(*region)]
            }
            Self::Surface(SurfaceError::NoNormal { node }) => vec![Part::Node(*node)],
            Self::Surface(SurfaceError::RepeatedTag { tag } | SurfaceError::UnknownTag { tag, .. }) => {
                vec![Part::Tag(*tag)]
            }
            Self::Tfeti(error) => of_tfeti(error),
            Self::Named { source, .. } => source.parts(),
            _ => Vec::new(),
        };
        let mut seen = Vec::with_capacity(parts.len());
        parts.retain(|part| {
            !seen.contains(part) && {
                seen.push(*part);
                true
            }
        });
        parts
    }
}

fn of_coupling(coupling: Option<&FreeCoupling>) -> impl Iterator<Item = Part> + use<> {
    let own = coupling.map(|c| {
        [
            Some(Part::Coupling(c.coupling as usize)),
            c.tied.map(|t| Part::Contact(t as usize)),
        ]
    });
    own.into_iter().flatten().flatten()
}

fn of_tfeti(error: &TfetiError) -> Vec<Part> {
    match error {
        TfetiError::Material { element, .. } => vec![Part::Tet(*element)],
        TfetiError::Equation {
            equation, node, others, ..
        } => {
            let equations = [equation].into_iter().chain(others).map(|k| Part::Equation(*k));
            equations.chain(node.map(Part::Node)).collect()
        }
        TfetiError::Spring { node, .. }
        | TfetiError::SpringRest { node, .. }
        | TfetiError::UnknownNode { node, .. }
        | TfetiError::ContactNodeTwice { node }
        | TfetiError::BadFrame { node, .. }
        | TfetiError::BadCompliance { node, .. }
        | TfetiError::BadStretch { node, .. }
        | TfetiError::DependentRows { node } => vec![Part::Node(*node)],
        TfetiError::BadDirection { support, node, .. } => {
            let node = node.map(Part::Node);
            [Part::Support(*support)].into_iter().chain(node).collect()
        }
        TfetiError::EmptySupport { support, .. }
        | TfetiError::DirectionLists { support, .. }
        | TfetiError::MotionLength { support, .. }
        | TfetiError::CaseNumber { support, .. } => vec![Part::Support(*support)],
        TfetiError::BadMotion { support, node } => vec![Part::Support(*support), Part::Node(*node)],
        TfetiError::ContradictorySupports {
            node, first, second, ..
        } => {
            vec![Part::Node(*node), Part::Support(*first), Part::Support(*second)]
        }
        _ => Vec::new(),
    }
}

fn of_mesh(error: &MeshError) -> Vec<Part> {
    let node = |n: &usize| u32::try_from(*n).ok().map(Part::Node);
    match error {
        MeshError::NotFinite { node: n, .. } | MeshError::DanglingNode { node: n, .. } => node(n).into_iter().collect(),
        MeshError::CoincidentNodes { first, second, .. } => [first, second].into_iter().filter_map(node).collect(),
        MeshError::NodeOutOfRange { tet, .. } => vec![Part::Tet(*tet)],
        MeshError::RepeatedNode { tet, node }
        | MeshError::MidNodeCorner { tet, node }
        | MeshError::MidNodeOff { tet, node, .. } => vec![Part::Tet(*tet), Part::Node(*node)],
        MeshError::DegenerateTet { tet, .. }
        | MeshError::InvertedTet { tet, .. }
        | MeshError::CurvedInside { tet, .. }
        | MeshError::FaceShared { first: tet, .. } => vec![Part::Tet(*tet)],
        MeshError::OverlappingTets { first, second, .. } | MeshError::FacetInside { first, second, .. } => {
            vec![Part::Tet(*first), Part::Tet(*second)]
        }
        MeshError::FacetUnknown { nodes, .. } | MeshError::FacetRepeated { nodes, .. } => {
            nodes.iter().copied().map(Part::Node).collect()
        }
        MeshError::MidNodeTwice { node, .. } => vec![Part::Node(*node)],
        MeshError::MidNodesOfEdge { edge, first, second } => {
            edge.iter().chain([first, second]).copied().map(Part::Node).collect()
        }
        _ => Vec::new(),
    }
}
