//! The scene: plain data that say what is to be simulated.

use crate::clock::Analysis;
use crate::contact_surface::{Contact, ContactNormal};
use crate::error::ContactError;
use crate::law::Friction;
use signorini_fem_mesh::{Decomposition, FacetTag, History, LoadDensity, Materials, TetMesh};
use signorini_tfeti::Directions;

/// Where a support acts.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Place {
    /// All nodes of the facets with this tag.
    Tag(FacetTag),
    /// Single nodes, by their numbers in the mesh.
    Nodes(Vec<u32>),
}

impl From<FacetTag> for Place {
    fn from(tag: FacetTag) -> Self {
        Self::Tag(tag)
    }
}

impl From<Vec<u32>> for Place {
    fn from(nodes: Vec<u32>) -> Self {
        Self::Nodes(nodes)
    }
}

impl From<&[u32]> for Place {
    fn from(nodes: &[u32]) -> Self {
        Self::Nodes(nodes.to_vec())
    }
}

impl<const N: usize> From<[u32; N]> for Place {
    fn from(nodes: [u32; N]) -> Self {
        Self::Nodes(nodes.to_vec())
    }
}

/// A support: directions of nodes that are fixed, or moved in a prescribed way.
#[derive(Debug, Clone)]
pub struct Support {
    pub(crate) place: Place,
    pub(crate) directions: Directions,
    pub(crate) motion: Option<(Vec<[f64; 3]>, History)>,
}

impl Support {
    /// All components are zero, on a tag or at nodes.
    ///
    /// ```
    /// use signorini_contact::Support;
    /// use signorini_fem_mesh::{brick, Brick};
    ///
    /// let mesh = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).build()?;
    /// let clamp = Support::fixed(brick::X_MIN);
    /// let corners = Support::fixed([0, 4]);
    /// // the nodes around a bolt
    /// let near = |x: &[f64; 3]| (x[0] - 1.0).hypot(x[1] - 0.5) < 0.1;
    /// let bolt: Vec<u32> = (0..).zip(mesh.points()).filter(|(_, x)| near(x)).map(|(n, _)| n).collect();
    /// let bolt = Support::components(bolt, [true, true, false]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn fixed(place: impl Into<Place>) -> Self {
        Self {
            place: place.into(),
            directions: Directions::All,
            motion: None,
        }
    }

    /// Some directions are zero.
    #[must_use]
    pub fn partial(place: impl Into<Place>, directions: Directions) -> Self {
        Self {
            place: place.into(),
            directions,
            motion: None,
        }
    }

    /// Single components (x, y, z) are zero.
    #[must_use]
    pub fn components(place: impl Into<Place>, components: [bool; 3]) -> Self {
        Self::partial(place, Directions::Components(components))
    }

    /// The fixed directions follow `history(t) * displacement` (m) instead of staying at zero.
    ///
    /// A support that fixes the normal displacement of a contact node must keep it outside the obstacle at all time
    /// levels: no contact force can stop it there, and the scene is refused.
    ///
    /// Supports that share nodes must move them alike: equal displacements with equal histories, which are equal tables
    /// or clones of one function.
    #[must_use]
    pub fn with_motion(mut self, displacement: [f64; 3], history: History) -> Self {
        self.motion = Some((vec![displacement], history));
        self
    }

    /// The same with one displacement a node, in the order of the nodes (ascending for a tag).
    #[must_use]
    pub fn with_motions(mut self, displacements: Vec<[f64; 3]>, history: History) -> Self {
        self.motion = Some((displacements, history));
        self
    }

    /// Where it acts.
    #[must_use]
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// The directions that it fixes.
    #[must_use]
    pub fn directions(&self) -> &Directions {
        &self.directions
    }

    /// Its displacements (m; one for all nodes or one a node) and their history; `None` if it does not move.
    #[must_use]
    pub fn motion(&self) -> Option<(&[[f64; 3]], &History)> {
        let (values, history) = self.motion.as_ref()?;
        Some((values, history))
    }
}

/// A load in space and time.
#[derive(Debug, Clone)]
pub struct Load {
    pub(crate) density: LoadDensity,
    pub(crate) history: History,
}

impl Load {
    /// A load that is constant in time.
    #[must_use]
    pub fn new(density: LoadDensity) -> Self {
        Self {
            density,
            history: History::constant(1.0),
        }
    }

    /// Force per area on a tag, Pa.
    #[must_use]
    pub fn traction(tag: FacetTag, value: [f64; 3]) -> Self {
        Self::new(LoadDensity::traction(tag, value))
    }

    /// Pressure on a tag, Pa, positive into the body.
    #[must_use]
    pub fn pressure(tag: FacetTag, value: f64) -> Self {
        Self::new(LoadDensity::pressure(tag, value))
    }

    /// Force per volume, N/m³.
    #[must_use]
    pub fn body(value: [f64; 3]) -> Self {
        Self::new(LoadDensity::body(value))
    }

    /// The load is multiplied by `history(t)`.
    #[must_use]
    pub fn with_history(mut self, history: History) -> Self {
        self.history = history;
        self
    }

    /// The load in space.
    #[must_use]
    pub fn density(&self) -> &LoadDensity {
        &self.density
    }

    /// Its factor in time.
    #[must_use]
    pub fn history(&self) -> &History {
        &self.history
    }
}

/// How the body is cut into subdomains.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Partition {
    /// Not at all.
    Whole,
    /// Into boxes of the bounding box, by element centroids (see [`Decomposition::boxes`]).
    Boxes([usize; 3]),
    /// By the given part number of every element.
    Parts(Vec<u32>),
}

/// Everything that says what is to be simulated, and nothing about how.
///
/// ```
/// use signorini_contact::{Analysis, Contact, Friction, Load, Scene, Support};
/// use signorini_fem_mesh::{brick, Brick, Hooke, Materials};
///
/// let mesh = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build()?;
/// let steel = Hooke::isotropic(211.9e9, 0.277)?;
/// let scene = Scene::new(mesh, Materials::uniform(steel))
///     .with_support(Support::fixed(brick::X_MIN))
///     .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -2.5e8]))
///     .with_contact(Contact::rigid(brick::Z_MIN).with_gap(0.1).with_friction(Friction::coulomb(0.3)))
///     .with_boxes([3, 1, 1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scene {
    pub(crate) mesh: TetMesh,
    pub(crate) materials: Materials,
    pub(crate) supports: Vec<Support>,
    pub(crate) loads: Vec<Load>,
    pub(crate) contacts: Vec<Contact>,
    pub(crate) cut: Partition,
    pub(crate) analysis: Analysis,
}

impl Scene {
    /// A free body without loads: static, one subdomain.
    #[must_use]
    pub fn new(mesh: TetMesh, materials: Materials) -> Self {
        Self {
            mesh,
            materials,
            supports: Vec::new(),
            loads: Vec::new(),
            contacts: Vec::new(),
            cut: Partition::Whole,
            analysis: Analysis::statics(),
        }
    }

    /// Adds a support.
    #[must_use]
    pub fn with_support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }

    /// Adds a load.
    #[must_use]
    pub fn with_load(mut self, load: Load) -> Self {
        self.loads.push(load);
        self
    }

    /// Adds a contact surface, with a gap, a direction and a friction law of its own: a floor with friction, a wall without.
    ///
    /// Surfaces may share nodes, and even tags (one surface between two obstacles). A node then has one contact point for
    /// each direction of contact, however little they differ. Only where the directions are the same (two parts of a flat floor with
    /// different friction, to 1.4e-6 radians) it has one for all of them: of the obstacle that is nearer, with its law and area; where
    /// both are as near, with the law of the contact that was added first and the area of both.
    #[must_use]
    pub fn with_contact(mut self, contact: Contact) -> Self {
        self.contacts.push(contact);
        self
    }

    /// One contact surface in the place of those there are; `None` for no contact.
    #[must_use]
    pub fn replace_contact(mut self, contact: Option<Contact>) -> Self {
        self.contacts = contact.into_iter().collect();
        self
    }

    /// Cuts the body into boxes. Empty boxes are dropped and disconnected ones split (see
    /// [`Decomposition::boxes`]), so any mesh and any positive counts will do.
    #[must_use]
    pub fn with_boxes(mut self, boxes: [usize; 3]) -> Self {
        self.cut = Partition::Boxes(boxes);
        self
    }

    /// Cuts the body by part numbers, one an element.
    #[must_use]
    pub fn with_parts(mut self, parts: Vec<u32>) -> Self {
        self.cut = Partition::Parts(parts);
        self
    }

    /// Sets the analysis; static by default.
    #[must_use]
    pub fn with_analysis(mut self, analysis: Analysis) -> Self {
        self.analysis = analysis;
        self
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &TetMesh {
        &self.mesh
    }

    /// The materials.
    #[must_use]
    pub fn materials(&self) -> &Materials {
        &self.materials
    }

    /// The supports, in the order in which they were added.
    #[must_use]
    pub fn supports(&self) -> &[Support] {
        &self.supports
    }

    /// The loads, in the order in which they were added.
    #[must_use]
    pub fn loads(&self) -> &[Load] {
        &self.loads
    }

    /// How the body is cut.
    #[must_use]
    pub fn partition(&self) -> &Partition {
        &self.cut
    }

    /// The first contact surface, if any.
    #[must_use]
    pub fn contact(&self) -> Option<&Contact> {
        self.contacts.first()
    }

    /// The contact surfaces.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// The analysis.
    #[must_use]
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// The decomposition that the scene asks for.
    ///
    /// # Errors
    /// [`ContactError::Decomposition`] for a zero count of boxes, and for part numbers with gaps or
    /// disconnected parts.
    pub fn decompose(&self) -> Result<Decomposition, ContactError> {
        Ok(match &self.cut {
            Partition::Whole => Decomposition::whole(&self.mesh),
            Partition::Boxes(boxes) => Decomposition::boxes(&self.mesh, *boxes)?,
            Partition::Parts(parts) => Decomposition::from_parts(&self.mesh, parts)?,
        })
    }

    /// Nodes of the support at a position, checked.
    pub(crate) fn support_nodes(&self, support: usize) -> Result<Vec<u32>, ContactError> {
        match &self.supports[support].place {
            Place::Tag(tag) => {
                let nodes = self.mesh.nodes_on(*tag);
                if nodes.is_empty() {
                    return Err(self.unknown_tag("support", support, *tag));
                }
                Ok(nodes)
            }
            Place::Nodes(nodes) => {
                let count = self.mesh.points().len();
                match nodes.iter().find(|&&n| n as usize >= count) {
                    Some(&node) => Err(ContactError::UnknownNode {
                        support,
                        node,
                        nodes: count,
                    }),
                    None => Ok(nodes.clone()),
                }
            }
        }
    }

    fn unknown_tag(&self, what: &'static str, index: usize, tag: FacetTag) -> ContactError {
        let known: Vec<String> = self.mesh.tags().iter().map(|t| t.0.to_string()).collect();
        ContactError::UnknownTag {
            what,
            index,
            tag: tag.0,
            known: match &known[..] {
                [] => "no tags".into(),
                known => format!("the tags {}", known.join(", ")),
            },
        }
    }

    /// Checks what needs no computation.
    pub(crate) fn validate(&self) -> Result<(), ContactError> {
        self.analysis.validate()?;
        for (index, support) in self.supports.iter().enumerate() {
            let nodes = self.support_nodes(index)?;
            if let Some((values, _)) = &support.motion
                && values.len() != 1
                && values.len() != nodes.len()
            {
                let (values, nodes) = (values.len(), nodes.len());
                return Err(ContactError::ValueCount {
                    support: index,
                    values,
                    nodes,
                });
            }
        }
        for level in 0..self.analysis.steps() {
            let time = self.analysis.time(level).unwrap_or(0.0);
            let histories = (self
                .loads
                .iter()
                .enumerate()
                .map(|(i, l)| ("load", i, &l.history)))
            .chain(
                self.supports
                    .iter()
                    .enumerate()
                    .filter_map(|(i, s)| s.motion.as_ref().map(|m| ("support", i, &m.1))),
            )
            .chain(
                self.contacts
                    .iter()
                    .enumerate()
                    .filter_map(|(i, c)| c.motion.as_ref().map(|m| ("contact", i, &m.1))),
            );
            for (what, index, history) in histories {
                let value = history.value(time);
                if !value.is_finite() {
                    return Err(ContactError::HistoryValue {
                        what,
                        index,
                        time,
                        value,
                    });
                }
            }
        }
        let mut contacts = self.contacts.iter().enumerate();
        contacts.try_for_each(|(index, c)| self.check(index, c))
    }

    fn check(&self, index: usize, contact: &Contact) -> Result<(), ContactError> {
        for &tag in contact.tags.iter().chain(&contact.partner) {
            if self.mesh.nodes_on(tag).is_empty() {
                return Err(self.unknown_tag("contact", index, tag));
            }
        }
        if let ContactNormal::Fixed(normal) = contact.normal {
            let length: f64 = normal.iter().map(|c| c * c).sum();
            if !(length.is_finite() && length > 0.0) {
                return Err(ContactError::ObstacleNormal {
                    contact: index,
                    normal,
                });
            }
        }
        if contact.motion.is_some() && !contact.partner.is_empty() {
            return Err(ContactError::MovedPartner { contact: index });
        }
        if let Some((displacement, _)) = contact.motion
            && let Some(value) = displacement.iter().find(|c| !c.is_finite())
        {
            return Err(ContactError::Setting {
                name: "displacement of the obstacle",
                value: *value,
                range: "of finite numbers",
            });
        }
        if !(contact.crease > 0.0 && contact.crease <= 180.0) {
            return Err(ContactError::Setting {
                name: "crease",
                value: contact.crease,
                range: "(0, 180]",
            });
        }
        if let Friction::Coulomb(coefficient) = &contact.friction {
            coefficient.validate(index)?;
        }
        Ok(())
    }
}
