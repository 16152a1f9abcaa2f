//! What is wrong with a deck, and where.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use signorini_fem_mesh::{HistoryError, HookeError, MeshError};
use thiserror::Error;

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

/// A deck that cannot be read. With `{:?}` it prints its sentence, too.
#[derive(Error)]
#[non_exhaustive]
pub enum DeckError {
    /// The file system refuses the deck itself.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Something at a line: the sentence names file, line, the word there and a remedy.
    #[error("{location}: {word}: {fault}")]
    At {
        /// Where.
        location: Location,
        /// The keyword, parameter or entry as it is written there (shortened).
        word: String,
        /// What is wrong with it.
        fault: Box<Fault>,
    },
    /// The elements make no mesh.
    #[error(
        "the elements of {} make no mesh (nodes and elements are counted from 0 here, in the order of the \
        file): {source}",
        path.display()
    )]
    Mesh {
        /// The deck.
        path: PathBuf,
        /// What is wrong with it.
        source: MeshError,
    },
    /// A deck with no elements.
    #[error("{} has no elements; it needs *ELEMENT, TYPE=C3D4 or C3D10", path.display())]
    NoElements {
        /// The deck.
        path: PathBuf,
    },
    /// A scene is asked of a deck that is only a mesh.
    #[error(
        "{} has no *SOLID SECTION: it is a mesh, not a scene; give it *MATERIAL, *ELASTIC and *SOLID \
        SECTION, or take only its mesh",
        path.display()
    )]
    NoSection {
        /// The deck.
        path: PathBuf,
    },
    /// A program asks for a name that the deck does not have.
    #[error("{} has no {what} named {name:?}; {}", path.display(), listed(known))]
    UnknownName {
        /// The deck.
        path: PathBuf,
        /// `"surface"`, `"node set"` or `"element set"`.
        what: &'static str,
        /// The name asked for.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
}

impl fmt::Debug for DeckError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl DeckError {
    /// The line that is wrong, if it is one.
    #[must_use]
    pub fn location(&self) -> Option<&Location> {
        match self {
            Self::At { location, .. } => Some(location),
            _ => None,
        }
    }

    /// The word that is wrong, if it is one.
    #[must_use]
    pub fn word(&self) -> Option<&str> {
        match self {
            Self::At { word, .. } => Some(word),
            _ => None,
        }
    }

    pub(crate) fn at(location: &Location, word: &str, fault: Fault) -> Self {
        let word = match word.char_indices().nth(WORD) {
            Some((end, _)) => format!("{}...", &word[..end]),
            None => word.to_owned(),
        };
        Self::At {
            location: location.clone(),
            word,
            fault: Box::new(fault),
        }
    }
}

/// What is wrong with a word of a deck, and the remedy.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Fault {
    /// Data before the first keyword.
    #[error("the deck begins with data; begin with a keyword, for instance *NODE")]
    NoKeyword,
    /// A keyword line that ends with a comma and is not continued.
    #[error("the line ends with a comma, but no line continues it; remove the comma")]
    NotContinued,
    /// An included file cannot be read.
    #[error("cannot read {}: {source}; paths are relative to the file that includes", path.display())]
    Include {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file includes itself, directly or not.
    #[error("the file includes itself, directly or through others; remove one *INCLUDE")]
    IncludeLoop,
    /// More than this reader takes.
    #[error("more than {most} {what}; {remedy}")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// The most that is read.
        most: u64,
        /// What to do.
        remedy: &'static str,
    },
    /// A keyword that nobody knows.
    #[error("this keyword is not known; those that are read: {known}")]
    UnknownKeyword {
        /// The keywords that are read.
        known: String,
    },
    /// Something known that this library cannot do.
    #[error("not supported: {0}")]
    Unsupported(&'static str),
    /// A parameter that the keyword does not have here.
    #[error("{keyword} has no such parameter here; {}", listed(known))]
    UnknownParameter {
        /// The keyword.
        keyword: String,
        /// The parameters that are read.
        known: Vec<String>,
    },
    /// A parameter given twice.
    #[error("the parameter is given twice; keep one of them")]
    RepeatedParameter,
    /// A parameter is missing.
    #[error("the parameter {0} is missing")]
    MissingParameter(&'static str),
    /// A value that is not among those possible, or an entry that is not what it should be.
    #[error("expected {0}")]
    Expected(&'static str),
    /// A keyword at a wrong place.
    #[error("{0}")]
    Misplaced(&'static str),
    /// A name that is not defined.
    #[error("there is no {what} of this name; {}", listed(known))]
    UnknownName {
        /// What it should be the name of.
        what: &'static str,
        /// The names that there are.
        known: Vec<String>,
    },
    /// A number that is not defined.
    #[error("there is no {0} with this number; check the number, or define it with *NODE or *ELEMENT")]
    UnknownNumber(&'static str),
    /// Defined twice.
    #[error("defined a second time, first in line {first}; {remedy}")]
    Repeated {
        /// Line of the first definition.
        first: usize,
        /// What to do.
        remedy: &'static str,
    },
    /// Nothing is there.
    #[error("{0}")]
    Empty(&'static str),
    /// An element that has no positive volume.
    #[error(
        "the element has no volume, or is turned inside out; its first three nodes have to be \
        counter-clockwise seen from the fourth"
    )]
    Volume,
    /// A face inside the body.
    #[error(
        "face {face} of element {element} lies inside the body, against another element; give only faces of \
        the boundary"
    )]
    FaceInside {
        /// Number of the element.
        element: u32,
        /// Number of its face.
        face: u8,
    },
    /// A law that is not admissible.
    #[error(transparent)]
    Hooke(#[from] HookeError),
    /// An amplitude that cannot be used.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// A contradiction or something that cannot be said to the solver; the sentence has the remedy.
    #[error("{0}")]
    Cannot(String),
}

/// "there are: A, B", shortened.
pub(crate) fn listed(known: &[String]) -> String {
    const MOST: usize = 40;
    if known.is_empty() {
        return "there is none".into();
    }
    let mut text = format!("there are: {}", known[..known.len().min(MOST)].join(", "));
    if known.len() > MOST {
        text.push_str(&format!(" and {} more", known.len() - MOST));
    }
    text
}
