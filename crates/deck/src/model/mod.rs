//! The deck in its own words: what the cards say, without a mesh of the library or a scene.
//!
//! In go the cards of [`crate::lexer`], out comes a [`Model`] with nodes and elements by their numbers in the
//! deck, sets, surfaces, materials, contact pairs and steps. Keywords, parameters and entries that are not
//! understood end here, with their place; names are looked up by [`crate::scene`], above. May use `lexer` and
//! `error`.

mod assembly;
mod coupling;
mod elastic;
mod equation;
mod keywords;
mod mesh;
mod names;
mod orientation;
mod property;
mod step;
mod temperature;
mod transform;

use crate::error::{DeckError, Location, Word};
use crate::lexer::Named;
use signorini_fem_mesh::mesh::CellShape;
use signorini_fem_mesh::{History, Hooke};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

pub(crate) use coupling::{Coupling, CouplingLaw};
pub(crate) use equation::{Equation, Flat, Term};
pub(crate) use keywords::read;
pub(crate) use names::Names;
pub(crate) use orientation::Orientation;
pub(crate) use step::{
    COMPONENT, Components, Condition, Conditions, DistributedKind, FORCE, Given, INCREMENTS, Step, Target, VolumeLaw,
};
pub(crate) use transform::{Axes, Transform, rectangular};

/// A request of the deck that has no meaning here, or what it means to Abaqus where it is read as CalculiX does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ignored {
    /// Where it stands.
    pub location: Location,
    /// The keyword or parameter.
    pub word: String,
    /// Why nothing is done.
    pub why: Cow<'static, str>,
}

impl Ignored {
    pub(crate) fn new(word: &Word, why: impl Into<Cow<'static, str>>) -> Self {
        Self {
            location: word.location.clone(),
            word: word.text.clone(),
            why: why.into(),
        }
    }
}

impl std::fmt::Display for Ignored {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}: ignored: {}", self.location, self.word, self.why)
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) label: u32,
    pub(crate) point: [f64; 3],
    pub(crate) location: Location,
}

/// What an element is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// C3D4, C3D8 and the like.
    Solid(CellShape),
    /// R3D3 or R3D4.
    Rigid,
    /// CPS3, CPS4 and the like, as meshers write the faces of a surface: its corners.
    Flat,
    /// T3D2 or T3D3, likewise.
    Line,
}

impl Kind {
    /// Whether it only names a place.
    pub(crate) fn is_mark(self) -> bool {
        matches!(self, Self::Flat | Self::Line)
    }
}

/// An element.
#[derive(Debug, Clone)]
pub(crate) struct Element {
    pub(crate) label: u32,
    pub(crate) kind: Kind,
    /// Corners, and of a solid of second order the nodes on its edges.
    pub(crate) nodes: Vec<u32>,
    pub(crate) location: Location,
}

impl Element {
    /// Its number, where it is defined.
    pub(crate) fn word(&self) -> Word {
        Word::new(&self.location, self.label.to_string())
    }

    /// Why a face is refused.
    pub(crate) fn no_face(&self, number: u8) -> String {
        format!("element {} has no face {number}", self.label)
    }
}

/// Something that belongs to a set.
#[derive(Debug, Clone)]
pub(crate) enum Member {
    One(u32),
    Range {
        from: u32,
        to: u32,
        step: u32,
    },
    /// Another set as the cards before made it.
    Set(String),
}

/// What a card says of a set of nodes or elements.
#[derive(Debug, Clone)]
pub(crate) struct SetCard {
    pub(crate) name: String,
    /// Whether it is *NODE or *ELEMENT, which come before all others.
    pub(crate) defines: bool,
    /// Each with its place.
    pub(crate) members: Vec<(Member, Location)>,
}

/// A side of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Side {
    /// Face 1 to 6 of a solid.
    Face(u8),
    /// Where the normal of a rigid facet points to, or the other side.
    Facet { positive: bool },
    /// All faces of solids on the boundary.
    Outside,
    /// Faces on the boundary whose corners are all among the nodes of the surface.
    Nodes,
}

/// Faces with the same number, of an element or of those of a set; nodes of a surface of nodes.
#[derive(Debug, Clone)]
pub(crate) struct Faces {
    pub(crate) target: Target,
    pub(crate) side: Side,
    pub(crate) word: Word,
}

#[derive(Debug, Clone)]
pub(crate) struct Material {
    pub(crate) location: Location,
    /// Where it is given, and the law.
    pub(crate) elastic: Option<(Location, Hooke)>,
    pub(crate) density: Option<f64>,
    /// Where it is given, and the coefficients along x, y, z.
    pub(crate) expansion: Option<(Location, [f64; 3])>,
}

#[derive(Debug, Clone)]
pub(crate) struct Section {
    pub(crate) elset: Named,
    pub(crate) material: Named,
    pub(crate) axes: MaterialAxes,
}

/// Along what the laws of a section are given.
#[derive(Debug, Clone)]
pub(crate) enum MaterialAxes {
    /// x, y and z.
    Global,
    /// An orientation.
    Named(Named),
    /// The axes of a part that an instance turns, with the word of the instance.
    Turned(Word),
}

#[derive(Debug, Clone)]
pub(crate) struct Amplitude {
    pub(crate) history: History,
    pub(crate) points: Vec<(f64, f64)>,
    /// Whether its times are counted from the beginning of the analysis, not of the step.
    pub(crate) total: bool,
}

#[derive(Debug, Clone)]
pub(crate) struct Interaction {
    pub(crate) location: Location,
    pub(crate) behavior: Option<Location>,
    pub(crate) friction: Option<f64>,
    /// The word that ties all pairs with it.
    pub(crate) tied: Option<Word>,
    /// Along the normal and along the surface, length over stress.
    pub(crate) compliance: [f64; 2],
}

/// Elements or nodes that keep their shape and follow a node.
#[derive(Debug, Clone)]
pub(crate) struct RigidBody {
    /// The keyword.
    pub(crate) word: Word,
    pub(crate) elset: Option<Named>,
    pub(crate) nset: Option<Named>,
    /// The node whose displacement it has, with the word that names it.
    pub(crate) reference: (Target, Word),
    /// The node whose displacement is its rotation.
    pub(crate) rotation: Option<(Target, Word)>,
}

#[derive(Debug, Clone)]
pub(crate) struct Pair {
    pub(crate) law: Law,
    pub(crate) slave: Named,
    pub(crate) master: Named,
}

impl Pair {
    /// The names of both surfaces.
    pub(crate) fn surfaces(&self) -> [&str; 2] {
        [&self.slave.name, &self.master.name]
    }
}

/// What holds between the surfaces of a pair.
#[derive(Debug, Clone)]
pub(crate) enum Law {
    Contact(Touch),
    Tied(Tie),
}

/// Surfaces that may touch.
#[derive(Debug, Clone)]
pub(crate) struct Touch {
    pub(crate) interaction: Named,
    /// ADJUST, and the gaps up to which sides touch.
    pub(crate) adjust: Option<(Word, f64)>,
}

/// The gap of a pair of surfaces.
#[derive(Debug, Clone)]
pub(crate) struct Clearance {
    pub(crate) word: Word,
    pub(crate) slave: Named,
    pub(crate) master: Named,
    pub(crate) value: f64,
}

/// Bonded surfaces.
#[derive(Debug, Clone)]
pub(crate) struct Tie {
    /// ADJUST, or the keyword.
    pub(crate) word: Word,
    /// Whether nodes are to be moved onto the other surface.
    pub(crate) adjust: bool,
    /// Distance up to which nodes are tied, if it is given.
    pub(crate) tolerance: Option<f64>,
}

impl Model {
    /// The material of a section.
    pub(crate) fn material(&self, section: &Section) -> Result<&Material, DeckError> {
        let Named { name, word } = &section.material;
        Ok(self.materials.at(self.materials.find("material", name, word)?))
    }

    /// The names of the surfaces that cards use.
    pub(crate) fn used_surfaces(&self) -> BTreeSet<&str> {
        let pairs = self.pairs.iter().flat_map(Pair::surfaces);
        let coupled = self.couplings.iter().map(|coupling| &coupling.surface.name[..]);
        let loaded = self.steps.iter().flat_map(|step| &step.distributed.lines);
        let loaded = loaded.filter_map(|load| match (&load.kind, &load.target) {
            (DistributedKind::Surface | DistributedKind::Traction(_), Target::Name(name)) => Some(&name[..]),
            _ => None,
        });
        pairs.chain(coupled).chain(loaded).collect()
    }
}

/// A deck in its own words.
#[derive(Debug, Default)]
pub(crate) struct Model {
    pub(crate) nodes: Vec<Node>,
    pub(crate) elements: Vec<Element>,
    /// What is said of sets of nodes, in the order of the deck.
    pub(crate) nsets: Vec<SetCard>,
    /// Sets of nodes whose order is to count, and where it says so.
    pub(crate) unsorted: BTreeMap<String, Location>,
    /// The same of elements.
    pub(crate) elsets: Vec<SetCard>,
    pub(crate) surfaces: Names<Vec<Faces>>,
    pub(crate) materials: Names<Material>,
    pub(crate) orientations: Names<Orientation>,
    pub(crate) sections: Vec<Section>,
    pub(crate) amplitudes: Names<Amplitude>,
    pub(crate) interactions: Names<Interaction>,
    pub(crate) pairs: Vec<Pair>,
    pub(crate) clearances: Vec<Clearance>,
    pub(crate) rigid: Vec<RigidBody>,
    pub(crate) couplings: Vec<Coupling>,
    pub(crate) equations: Vec<Equation>,
    pub(crate) flats: Vec<Flat>,
    pub(crate) transforms: Vec<Transform>,
    /// Supports that hold before the first step.
    pub(crate) supports: Vec<Condition<Components>>,
    /// Temperatures without stress.
    pub(crate) initial: Vec<Condition<()>>,
    pub(crate) steps: Vec<Step>,
    pub(crate) ignored: Vec<Ignored>,
}
