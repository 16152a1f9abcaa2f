//! The scene: plain data that say what is to be simulated.

use super::contact::Contact;
use super::coupling::Coupling;
use super::equation::Equation;
use super::load::Load;
use super::partition::Partition;
use super::spring::Spring;
use super::support::Support;
use super::time::Analysis;
use crate::error::ContactError;
use crate::names::Names;
use crate::part::Part;
use signorini_fem_mesh::{Decomposition, History, Materials, TetMesh};
use std::sync::Arc;

/// What is to be simulated: mesh, materials, supports, loads, contacts, partition and times.
/// [`Settings`](crate::Settings) says how.
#[derive(Debug, Clone)]
#[must_use]
pub struct Scene {
    /// Shared with its copies.
    pub(crate) mesh: Arc<TetMesh>,
    pub(crate) materials: Materials,
    pub(crate) supports: Vec<Support>,
    pub(crate) springs: Vec<Spring>,
    pub(crate) loads: Vec<Load>,
    /// How many of them, the first ones, are eigenstrains of the materials.
    pub(crate) of_materials: usize,
    pub(crate) contacts: Vec<Contact>,
    pub(crate) couplings: Vec<Coupling>,
    pub(crate) equations: Vec<Equation>,
    pub(crate) partition: Partition,
    pub(crate) analysis: Analysis,
    pub(crate) names: Names,
    /// The first step of the stage that it is set up for.
    pub(crate) stage: usize,
}

impl Scene {
    /// A free body without loads but the eigenstrains of its materials, which are the first ones: static, with an
    /// automatic partition into subdomains.
    pub fn new(mesh: impl Into<Arc<TetMesh>>, mut materials: Materials) -> Self {
        let constant = |(factor, strain)| Load::eigenstrain(strain).with_history(History::constant(factor));
        let loads: Vec<Load> = materials.take_eigenstrains().into_iter().map(constant).collect();
        Self {
            mesh: mesh.into(),
            materials,
            supports: Vec::new(),
            springs: Vec::new(),
            of_materials: loads.len(),
            loads,
            contacts: Vec::new(),
            couplings: Vec::new(),
            equations: Vec::new(),
            partition: Partition::Automatic,
            analysis: Analysis::statics(),
            names: Names::default(),
            stage: 0,
        }
    }

    /// Adds a support.
    pub fn with_support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }

    /// Adds an elastic foundation.
    pub fn with_spring(mut self, spring: Spring) -> Self {
        self.springs.push(spring);
        self
    }

    /// Adds a load.
    pub fn with_load(mut self, load: Load) -> Self {
        self.loads.push(load);
        self
    }

    /// Other loads than those that were added, whose names are not theirs; the eigenstrains of the materials stay.
    pub(crate) fn set_loads(&mut self, loads: Vec<Load>) {
        self.loads.truncate(self.of_materials);
        self.loads.extend(loads);
        self.names.forget_loads();
    }

    /// Adds a contact surface with its own gap, normals and friction law, for example a floor with friction or a wall
    /// without.
    ///
    /// Surfaces may share nodes, and even tags. A node then has one contact point for each contact normal.
    /// If normals agree (to 1.4e-6 radians), it has one point for both: with law and area of the nearer obstacle or, at
    /// equal distance, with the law of the contact added first and the area of both.
    pub fn with_contact(mut self, contact: Contact) -> Self {
        self.contacts.push(contact);
        self
    }

    /// Adds a rigid coupling.
    pub fn with_coupling(mut self, coupling: Coupling) -> Self {
        self.couplings.push(coupling);
        self
    }

    /// Adds a linear equation between displacements.
    pub fn with_equation(mut self, equation: Equation) -> Self {
        self.equations.push(equation);
        self
    }

    /// Partitions the mesh into boxes. Empty boxes are dropped and disconnected ones split (see
    /// [`Decomposition::boxes`]), so any mesh and any positive counts will do.
    pub fn with_boxes(mut self, boxes: [usize; 3]) -> Self {
        self.partition = Partition::Boxes(boxes);
        self
    }

    /// Partitions the mesh by part numbers, one per element, for instance those of a graph partitioner, and makes the
    /// parts compact: tetrahedra at interfaces may change sides, and small or loose pieces join their neighbours (see
    /// [`Partition::Parts`]). Ragged parts would take two to six times the iterations.
    pub fn with_parts(mut self, parts: Vec<u32>) -> Self {
        self.partition = Partition::Parts(parts);
        self
    }

    /// Partitions the mesh by part numbers, one per element, without changing the parts.
    pub fn with_parts_as_given(mut self, parts: Vec<u32>) -> Self {
        self.partition = Partition::AsGiven(parts);
        self
    }

    /// Partitions the mesh into `count` compact subdomains of similar size. By default the library chooses the number.
    pub fn with_subdomains(mut self, count: usize) -> Self {
        self.partition = Partition::Subdomains(count);
        self
    }

    /// Keeps each body in one piece. Factors of large bodies are expensive, and their contact needs more iterations.
    pub fn without_subdomains(mut self) -> Self {
        self.partition = Partition::Whole;
        self
    }

    /// Sets the analysis; static by default.
    pub fn with_analysis(mut self, analysis: Analysis) -> Self {
        self.analysis = analysis;
        self
    }

    /// Names for parts of the scene, for instance from the file that it comes from: errors and warnings then begin with
    /// the names of the parts concerned. Scenes from decks have names. It may be asked for nodes that are not there.
    ///
    /// ```
    /// use signorini_contact::{Contact, Part, Plan, Scene, Settings};
    /// # use signorini_fem_mesh::{Brick, Hooke, Materials, brick};
    /// # let mesh = Brick::new([1.0; 3], [1; 3]).build()?;
    /// # let steel = Materials::uniform(Hooke::isotropic(2e11, 0.3)?);
    /// let scene = Scene::new(mesh, steel)
    ///     .with_contact(Contact::rigid(brick::Z_MIN).with_normal([0.0; 3]))
    ///     .with_names(|part| (part == Part::Contact(0)).then(|| "the floor".to_owned()));
    /// let error = Plan::new(&scene, &Settings::default()).unwrap_err();
    /// assert!(error.to_string().starts_with("contact 0 is the floor: contact 0: the obstacle's normal"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_names(mut self, names: impl Fn(Part) -> Option<String> + Send + Sync + 'static) -> Self {
        self.names = Names::new(names);
        self
    }

    /// What a part is called, if the scene [has names](Self::with_names) and it has one.
    pub fn name(&self, part: Part) -> Option<String> {
        self.names.name(part)
    }

    /// The mesh.
    pub fn mesh(&self) -> &TetMesh {
        &self.mesh
    }

    /// The materials, without their eigenstrains, which are loads: for stresses take those of a
    /// [result](crate::StepResult::materials).
    pub fn materials(&self) -> &Materials {
        &self.materials
    }

    /// The supports, in the order in which they were added.
    pub fn supports(&self) -> &[Support] {
        &self.supports
    }

    /// The elastic foundations, in the order in which they were added.
    pub fn springs(&self) -> &[Spring] {
        &self.springs
    }

    /// The rigid couplings, in the order in which they were added.
    pub fn couplings(&self) -> &[Coupling] {
        &self.couplings
    }

    /// The linear equations, in the order in which they were added.
    pub fn equations(&self) -> &[Equation] {
        &self.equations
    }

    /// The loads, those of the materials' eigenstrains first, then in the order in which they were added.
    pub fn loads(&self) -> &[Load] {
        &self.loads
    }

    /// The partition into subdomains.
    pub fn partition(&self) -> &Partition {
        &self.partition
    }

    /// The contact surfaces.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// The analysis.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// The decomposition that the scene asks for, without what couplings add.
    pub(crate) fn decompose(&self) -> Result<Decomposition, ContactError> {
        self.partition.decompose(&self.mesh, &self.materials)
    }
}
