//! What is wrong with a deck, and where.

use std::borrow::Cow;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use signorini_fem_mesh::{HistoryError, HookeError, MeshError};

/// Longest part of a word that an error repeats, characters.
const WORD: usize = 80;

/// A line of a deck or of a file that it includes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// The file.
    pub file: Arc<Path>,
    /// The line, from 1.
    pub line: usize,
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file.display(), self.line)
    }
}

signorini_fem_mesh::errors! {
    /// A deck that cannot be read.
    DeckError {
        Io { path: PathBuf, r#source: std::io::Error } = "cannot read {}: {source}", path.display();
        At { location: Location, word: String, fault: Box<Fault> } = "{location}: {word}: {fault}";
        Mesh { path: PathBuf, r#source: MeshError } =
            "the elements of {} make no mesh: {source}", path.display();
        NoElements { path: PathBuf } =
            "{} has no elements; it needs *ELEMENT of solid elements, for instance TYPE=C3D4 or C3D10", path.display();
        NoSection { path: PathBuf } =
            "{} has no *SOLID SECTION: it is a mesh, not a scene; give it *MATERIAL, *ELASTIC and *SOLID SECTION, or \
            take only its mesh", path.display();
        UnknownName { path: PathBuf, what: &'static str, name: String, known: Vec<String> } =
            "{} has no {what} named {name:?}; {}", path.display(), listed(known);
    }
}

impl DeckError {
    /// The line that is wrong, if it is one.
    pub fn location(&self) -> Option<&Location> {
        match self {
            Self::At { location, .. } => Some(location),
            _ => None,
        }
    }

    /// The word that is wrong, if it is one.
    pub fn word(&self) -> Option<&str> {
        match self {
            Self::At { word, .. } => Some(word),
            _ => None,
        }
    }
}

/// A word or a line of a deck, and where it stands.
#[derive(Debug, Clone)]
pub(crate) struct Word {
    pub(crate) location: Location,
    pub(crate) text: String,
}

impl Word {
    pub(crate) fn new(location: &Location, text: impl Into<String>) -> Self {
        Self {
            location: location.clone(),
            text: text.into(),
        }
    }

    /// It and where it stands.
    pub(crate) fn told(&self) -> String {
        format!("{} ({})", self.text, self.location)
    }

    pub(crate) fn fault(&self, fault: Fault) -> DeckError {
        let word = match self.text.char_indices().nth(WORD) {
            Some((end, _)) => format!("{}...", &self.text[..end]),
            None => self.text.clone(),
        };
        DeckError::At {
            location: self.location.clone(),
            word,
            fault: Box::new(fault),
        }
    }

    /// Something else is wanted in its place.
    pub(crate) fn expected(&self, what: &'static str) -> DeckError {
        self.fault(Fault::Expected(what))
    }

    /// It cannot be had, and why.
    pub(crate) fn cannot(&self, why: impl Into<Cow<'static, str>>) -> DeckError {
        self.fault(Fault::Cannot(why.into()))
    }
}

signorini_fem_mesh::errors! {
    /// What is wrong with a word of a deck, and the remedy.
    Fault from { Hooke(HookeError), History(HistoryError) } {
        NoKeyword = "the deck begins with data; begin with a keyword, for instance *NODE";
        NotContinued = "the line ends with a comma, but no line continues it; remove the comma";
        Include { path: PathBuf, r#source: std::io::Error } =
            "cannot read {}: {source}; paths are relative to the file that includes, or to the deck", path.display();
        IncludeLoop = "the file includes itself, directly or through others; remove one *INCLUDE";
        TooMany { what: &'static str, most: u64, remedy: &'static str } = "more than {most} {what}; {remedy}";
        UnknownKeyword { known: String } = "this keyword is not known; those that are read: {known}";
        Unsupported(&'static str) = "not supported: {0}";
        UnknownParameter { keyword: String, known: Vec<String> } =
            "{keyword} has no such parameter here; {}", listed(known);
        RepeatedParameter = "the parameter is given twice; keep one of them";
        MissingParameter(&'static str) = "the parameter {0} is missing";
        Expected(&'static str) = "expected {0}";
        UnknownName { what: &'static str, known: Vec<String> } = "there is no {what} of this name; {}", listed(known);
        UnknownNumber(&'static str) =
            "there is no {0} with this number; check the number, or define it with *NODE or *ELEMENT";
        Repeated { first: Location, remedy: &'static str } =
            "defined a second time, first in {first}; {remedy}";
        Volume =
            "the element has no volume, or is turned inside out or far from convex; the nodes of its first face have to be \
            counter-clockwise seen from its other nodes";
        Distorted { r#source: MeshError } =
            "the element is too far from convex or too distorted to be divided into tetrahedra; move its nodes, or remesh around \
            it (of its tetrahedra: {source})";
        FaceInside { element: u32, face: u8 } =
            "face {face} of element {element} lies inside the body, against another element; give only faces of the \
            boundary";
        Mesh { names: String, r#source: MeshError } = "the elements make no mesh: {names}: {source}";
        Cannot(Cow<'static, str>) = "{0}";
    }
}

/// "there are: A, B", shortened.
pub(crate) fn listed(known: &[String]) -> String {
    const MOST: usize = 40;
    if known.is_empty() {
        return "there is none".into();
    }
    let more = match known.len().saturating_sub(MOST) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("there are: {}{more}", known[..known.len().min(MOST)].join(", "))
}
