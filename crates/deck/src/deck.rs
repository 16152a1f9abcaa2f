//! A deck that was read.

use std::path::{Path, PathBuf};

use signorini_contact::Scene;
use signorini_fem_mesh::{FacetTag, TetMesh};

use crate::error::DeckError;
use crate::lexer;
use crate::model::{self, Ignored, Names};
use crate::scene::{self, Translated};

/// A deck as a mesh and a scene, with the names and numbers that it had. See the [crate](crate) for what is read.
///
/// Nodes and tetrahedra of the mesh are in the order of the file, nodes between those of divided elements behind them;
/// nodes that no element uses are dropped. The
/// names of sets and surfaces are compared without regard to case and blanks.
#[derive(Debug)]
pub struct Deck {
    path: PathBuf,
    is: Translated,
    ignored: Vec<Ignored>,
}

impl Deck {
    /// Reads a deck and all files that it includes.
    ///
    /// # Errors
    /// [`DeckError`] names the first fault with file, line, word and remedy: what is not understood, not
    /// supported, not defined, or contradictory.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, DeckError> {
        let path = path.as_ref();
        let cards = lexer::cards(path)?;
        let model = model::read(&cards)?;
        drop(cards);
        let mut is = scene::translate(path, &model)?;
        let mut ignored = model.ignored;
        ignored.append(&mut is.ignored);
        Ok(Self {
            path: path.to_owned(),
            is,
            ignored,
        })
    }

    /// The mesh. Its regions are the sections of the deck, from 0.
    pub fn mesh(&self) -> &TetMesh {
        &self.is.mesh
    }

    /// The scene, to be solved as it is or to be added to: a cut into subdomains for instance, which decks do
    /// not say. A deck without steps gives one with supports and contacts, but without loads.
    ///
    /// # Errors
    /// [`DeckError::NoSection`] for a deck that is a mesh only.
    pub fn scene(&self) -> Result<Scene, DeckError> {
        let path = self.path.clone();
        self.is.scene.clone().ok_or(DeckError::NoSection { path })
    }

    /// How often a step that fails may be halved without being shorter than the least increment of any `*STATIC`, for
    /// [`Settings::with_step_halving`](signorini_contact::Settings::with_step_halving). At most 5, as CalculiX cuts
    /// back at most 5 times; 0 if a step is `DIRECT`. Without a least increment it is 1e-5 of the period.
    ///
    /// ```no_run
    /// # use signorini_contact::{ContactError, Settings, Simulation};
    /// # use signorini_deck::Deck;
    /// # fn simulation(deck: &Deck) -> Result<Simulation, Box<dyn std::error::Error>> {
    /// let settings = Settings::default().with_step_halving(deck.step_halving());
    /// # Ok(Simulation::new(deck.scene()?, settings)?)
    /// # }
    /// ```
    pub fn step_halving(&self) -> u32 {
        self.is.halvings
    }

    /// What the deck asks for and does not get: output, settings of other solvers, penalty numbers.
    pub fn ignored(&self) -> &[Ignored] {
        &self.ignored
    }

    /// The tags of a surface: one, or several where surfaces and pressures overlap.
    ///
    /// # Errors
    /// [`DeckError::UnknownName`] lists the surfaces there are.
    pub fn surface(&self, name: &str) -> Result<&[FacetTag], DeckError> {
        self.find("surface", &self.is.surfaces, name)
    }

    /// The nodes of a set, ascending, in the numbers of the mesh, those that are in it and those between them.
    ///
    /// # Errors
    /// [`DeckError::UnknownName`] lists the sets there are.
    pub fn node_set(&self, name: &str) -> Result<&[u32], DeckError> {
        self.find("node set", &self.is.node_sets, name)
    }

    /// The tetrahedra of a set, ascending, in the numbers of the mesh.
    ///
    /// # Errors
    /// [`DeckError::UnknownName`] lists the sets there are.
    pub fn element_set(&self, name: &str) -> Result<&[u32], DeckError> {
        self.find("element set", &self.is.element_sets, name)
    }

    fn find<'a, T>(&self, what: &'static str, names: &'a Names<Vec<T>>, name: &str) -> Result<&'a [T], DeckError> {
        let found = names.position(&lexer::name(name));
        let found = found.ok_or_else(|| DeckError::UnknownName {
            path: self.path.clone(),
            what,
            name: name.to_owned(),
            known: names.names(),
        })?;
        Ok(names.at(found))
    }

    /// Names of the surfaces, in the order of the deck.
    pub fn surfaces(&self) -> impl Iterator<Item = &str> {
        self.is.surfaces.iter().map(|(name, _)| name)
    }

    /// Names of the sets of nodes, in the order of the deck.
    pub fn node_sets(&self) -> impl Iterator<Item = &str> {
        self.is.node_sets.iter().map(|(name, _)| name)
    }

    /// Names of the sets of elements, in the order of the deck.
    pub fn element_sets(&self) -> impl Iterator<Item = &str> {
        self.is.element_sets.iter().map(|(name, _)| name)
    }

    /// For each support of the scene the set that it is given on, `nodes` for nodes by their numbers.
    pub fn support_names(&self) -> &[String] {
        &self.is.support_names
    }

    /// For each rigid coupling of the scene the word that names its surface or its rigid body.
    pub fn coupling_names(&self) -> &[String] {
        &self.is.coupling_names
    }

    /// The node of the mesh with a number in the deck, if the mesh has it.
    pub fn node(&self, number: u32) -> Option<u32> {
        self.is.nodes.get(number)
    }

    /// The numbers that the nodes of the mesh have in the deck; where it is cut, or elements are divided, one number is
    /// there more than once.
    pub fn node_numbers(&self) -> &[u32] {
        &self.is.node_labels
    }

    /// The numbers that the elements of the tetrahedra have in the deck.
    pub fn element_numbers(&self) -> &[u32] {
        &self.is.element_labels
    }
}
