//! One error for programs that use the facade.

use signorini_contact::ContactError;
use signorini_fem_mesh as fem;
use std::fmt;
use thiserror::Error;

/// Any error of the workspace; every crate's own error converts into it, so that `?` works throughout. Each arrives in
/// one way: what a scene passes on from a crate below (a mesh, a material) is that crate's variant here, not one of
/// `Contact`.
///
/// With `{:?}` it prints its sentence and what its sources add, not its fields: a `main` that returns it shows what is
/// wrong and what to do about it. Programs match on its variants.
///
/// ```
/// use signorini::prelude::*;
///
/// let error = Error::from(Hooke::isotropic(-1.0, 0.3).unwrap_err());
/// assert_eq!(format!("{error:?}"), error.to_string());
/// assert!(error.to_string().contains("Young's modulus"));
/// ```
#[derive(Error)]
#[non_exhaustive]
pub enum Error {
    /// Scene, settings, simulation.
    #[error(transparent)]
    Contact(ContactError),
    /// Mesh.
    #[error(transparent)]
    Mesh(#[from] fem::MeshError),
    /// Brick.
    #[error(transparent)]
    Brick(#[from] fem::brick::BrickError),
    /// Hooke's law.
    #[error(transparent)]
    Hooke(#[from] fem::HookeError),
    /// Table of materials.
    #[error(transparent)]
    Material(#[from] fem::MaterialError),
    /// Stiffness.
    #[error(transparent)]
    Assembly(#[from] fem::AssemblyError),
    /// Decomposition.
    #[error(transparent)]
    Decomposition(#[from] fem::DecompositionError),
    /// History.
    #[error(transparent)]
    History(#[from] fem::HistoryError),
    /// Load.
    #[error(transparent)]
    Load(#[from] fem::LoadError),
    /// Contact surface.
    #[error(transparent)]
    Surface(#[from] fem::SurfaceError),
    /// Derived fields.
    #[error(transparent)]
    Field(#[from] fem::FieldError),
    /// Domain decomposition.
    #[error(transparent)]
    Tfeti(#[from] signorini_tfeti::TfetiError),
    /// Convex sets.
    #[error(transparent)]
    Set(#[from] signorini_qp::SetError),
    /// Quadratic programming.
    #[error(transparent)]
    Qp(#[from] signorini_qp::QpError),
    /// Files that a program reads or writes besides.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// Result files.
    #[cfg(feature = "vtu")]
    #[error(transparent)]
    Output(#[from] fem::output::OutputError),
    /// Gmsh files.
    #[cfg(feature = "gmsh")]
    #[error(transparent)]
    Gmsh(#[from] fem::gmsh::GmshError),
    /// Decks.
    #[cfg(feature = "deck")]
    #[error(transparent)]
    Deck(#[from] signorini_deck::DeckError),
}

impl From<ContactError> for Error {
    fn from(error: ContactError) -> Self {
        match error {
            ContactError::Mesh(error) => Self::Mesh(error),
            ContactError::Material(error) => Self::Material(error),
            ContactError::Decomposition(error) => Self::Decomposition(error),
            ContactError::Surface(error) => Self::Surface(error),
            ContactError::Field(error) => Self::Field(error),
            ContactError::Tfeti(error) => Self::Tfeti(error),
            ContactError::Qp(error) => Self::Qp(error),
            #[cfg(feature = "vtu")]
            ContactError::Output(error) => Self::Output(error),
            error => Self::Contact(error),
        }
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Contact(error) => fmt::Debug::fmt(error, f),
            other => fmt::Display::fmt(other, f),
        }
    }
}
