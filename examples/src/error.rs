//! What can go wrong in an example, and how a binary ends.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use signorini::contact::ContactError;
use signorini::fem_mesh as fem;
use thiserror::Error;

/// Any failure of an example.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExampleError {
    /// The library refuses the input or breaks down.
    #[error(transparent)]
    Library(#[from] signorini::Error),
    /// A file or folder cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The terminal (or whatever stands in its place) refuses.
    #[error("cannot print: {0}")]
    Print(#[from] std::io::Error),
    /// Results that JSON cannot hold.
    #[error("cannot write the results as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A chart cannot be drawn.
    #[error("cannot draw {what}: {reason}")]
    Picture {
        /// The picture.
        what: &'static str,
        /// What the drawing library says.
        reason: String,
    },
    /// The thread pool cannot be made.
    #[error("cannot start {threads} threads: {reason}; use a smaller --threads")]
    Threads {
        /// Threads asked for.
        threads: usize,
        /// What the system says.
        reason: String,
    },
    /// A picture or table of a level before any is solved.
    #[error("no time level is solved yet, or the last step failed; solve one first")]
    NoLevel,
    /// With `--strict`: some levels did not reach the tolerance.
    #[error("{levels} time levels did not reach the tolerance (--strict)")]
    NotConverged {
        /// How many.
        levels: usize,
    },
}

impl ExampleError {
    /// Wraps an error of the file system with the path.
    pub fn write(path: impl AsRef<Path>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.as_ref().to_path_buf();
        move |source| Self::Write { path, source }
    }
}

macro_rules! from_library {
    ($($error:ty),*) => {
        $(impl From<$error> for ExampleError {
            fn from(error: $error) -> Self {
                Self::Library(error.into())
            }
        })*
    };
}

from_library!(
    ContactError,
    fem::BrickError,
    fem::DecompositionError,
    fem::MeshError,
    fem::gmsh::GmshError,
    fem::HookeError,
    fem::HistoryError,
    fem::SurfaceError,
    fem::FieldError,
    fem::output::OutputError,
    signorini_qp::QpError
);

/// Prints an error, if there is one, and gives the exit code: 0, or 1 after an error.
#[must_use]
pub fn exit<T>(result: Result<T, ExampleError>) -> ExitCode {
    match result {
        Ok(_) => ExitCode::SUCCESS,
        // the reader of a pipe has what it wanted
        Err(ExampleError::Print(e)) if e.kind() == std::io::ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
