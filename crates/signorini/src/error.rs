//! One error for programs that use the facade.

use signorini_contact::ContactError;
use signorini_fem_mesh as fem;

fem::errors! {
    /// Any error of the workspace; every crate's own error converts into it, so that `?` works throughout. What a scene
    /// passes on of a mesh or a material is that crate's variant here, what is wrong with one of its loads `Contact`; what
    /// is wrong with a mesh that is built or read is `Brick`, `Gmsh` or `Deck`.
    ///
    /// Its sentence tells inner errors, of files for instance, which are therefore fields and no `source()`. With `{:?}`
    /// it prints that and what sources add, not its fields: a `main` that returns it shows what is wrong and what to do
    /// about it. Programs match on its variants; where a scene [has names](signorini_contact::Scene::with_names), what is
    /// said of it is `Contact`, to match on [`plain`](ContactError::plain).
    ///
    /// ```
    /// use signorini::prelude::*;
    ///
    /// let error = Error::from(Hooke::isotropic(-1.0, 0.3).unwrap_err());
    /// assert_eq!(format!("{error:?}"), error.to_string());
    /// assert!(error.to_string().contains("Young's modulus"));
    /// ```
    Error from {
        Mesh(fem::MeshError),
        Brick(fem::brick::BrickError),
        Hooke(fem::HookeError),
        Material(fem::MaterialError),
        Decomposition(fem::DecompositionError),
        History(fem::HistoryError),
        Load(fem::LoadError),
        Surface(fem::SurfaceError),
        Field(fem::FieldError),
        Tfeti(signorini_tfeti::TfetiError),
        Set(signorini_qp::SetError),
        Qp(signorini_qp::QpError),
        Io(std::io::Error),
        #[cfg(feature = "vtu")]
        Output(fem::output::OutputError),
        #[cfg(feature = "gmsh")]
        Gmsh(fem::gmsh::GmshError),
        #[cfg(feature = "deck")]
        Deck(signorini_deck::DeckError),
    } as {
        Contact(ContactError)
    } {}
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
