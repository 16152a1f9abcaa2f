//! The scene: plain data that say what is to be simulated.

use crate::clock::Analysis;
use crate::error::ContactError;
use crate::law::{Friction, PlaceField};
use signorini_fem_mesh::{Decomposition, FacetTag, History, LoadDensity, Materials, TetMesh};
use signorini_tfeti::Directions;
use std::fmt;
use std::sync::Arc;

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

/// A support: directions of nodes that are fixed, or moved in a prescribed way.
#[derive(Debug, Clone)]
pub struct Support {
    pub(crate) place: Place,
    pub(crate) directions: Directions,
    pub(crate) motion: Option<(Vec<[f64; 3]>, History)>,
}

impl Support {
    /// All components are zero.
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
    pub fn moved(mut self, displacement: [f64; 3], history: History) -> Self {
        self.motion = Some((vec![displacement], history));
        self
    }

    /// The same with one displacement a node, in the order of the nodes (ascending for a tag).
    #[must_use]
    pub fn moved_each(mut self, displacements: Vec<[f64; 3]>, history: History) -> Self {
        self.motion = Some((displacements, history));
        self
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
}

/// The distance between the contact surface and the obstacle, measured along the outward normal.
#[derive(Clone)]
#[non_exhaustive]
pub enum Gap {
    /// The surfaces touch: the offset vector stays zero.
    None,
    /// The same distance at every node, m.
    Constant(f64),
    /// Distance at a point, m; negative values mean that the body starts inside the obstacle.
    Field(PlaceField),
}

impl fmt::Debug for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("None"),
            Self::Constant(value) => f.debug_tuple("Constant").field(value).finish(),
            Self::Field(_) => f.write_str("Field(..)"),
        }
    }
}

/// Direction in which the contact surface meets the obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ContactNormal {
    /// The body's own outward normal at each node.
    Body,
    /// One unit vector into the obstacle, e.g. (0, 0, -1) for a floor: the usual choice for a plane obstacle
    /// under a curved body.
    Fixed([f64; 3]),
}

/// A part of the boundary that may touch a rigid obstacle.
#[derive(Debug, Clone)]
pub struct Contact {
    pub(crate) tags: Vec<FacetTag>,
    pub(crate) gap: Gap,
    pub(crate) normal: ContactNormal,
    pub(crate) friction: Friction,
}

impl Contact {
    /// Contact of the facets with a tag with a rigid obstacle: touching, along the body's normals, no friction.
    #[must_use]
    pub fn rigid(tag: FacetTag) -> Self {
        Self {
            tags: vec![tag],
            gap: Gap::None,
            normal: ContactNormal::Body,
            friction: Friction::None,
        }
    }

    /// Contact with the half-space below a plane: gap and normal follow from the plane.
    ///
    /// `point` lies on the plane, `outward` points out of the obstacle (up for a floor). A later
    /// [`with_gap`](Self::with_gap) takes the place of the distance to the plane; move `point` instead.
    #[must_use]
    pub fn half_space(tag: FacetTag, point: [f64; 3], outward: [f64; 3]) -> Self {
        let length = outward.iter().map(|c| c * c).sum::<f64>().sqrt();
        let unit = outward.map(|c| c / length);
        let gap = move |x: [f64; 3]| (0..3).map(|c| (x[c] - point[c]) * unit[c]).sum();
        Self::rigid(tag)
            .with_normal(unit.map(|c| -c))
            .with_gap_field(gap)
    }

    /// More facets of the same kind. Each node has one normal: where facets of two sides meet at an edge it is their mean, so
    /// that nodes of an edge between floor and wall meet neither straight. Leave such edges out of one of the tags, or give
    /// one direction for all by [`with_normal`](Self::with_normal).
    #[must_use]
    pub fn and_tag(mut self, tag: FacetTag) -> Self {
        self.tags.push(tag);
        self
    }

    /// A constant gap in m.
    #[must_use]
    pub fn with_gap(mut self, gap: f64) -> Self {
        self.gap = if gap == 0.0 {
            Gap::None
        } else {
            Gap::Constant(gap)
        };
        self
    }

    /// A gap in m that depends on the place.
    #[must_use]
    pub fn with_gap_field(mut self, gap: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static) -> Self {
        self.gap = Gap::Field(Arc::new(gap));
        self
    }

    /// One direction of contact for all nodes, pointing into the obstacle: out of the body, at some contact node at least.
    #[must_use]
    pub fn with_normal(mut self, into_obstacle: [f64; 3]) -> Self {
        self.normal = ContactNormal::Fixed(into_obstacle);
        self
    }

    /// The friction law. A bound or coefficient that is zero everywhere is no friction.
    #[must_use]
    pub fn with_friction(mut self, friction: Friction) -> Self {
        self.friction = if friction.is_zero() {
            Friction::None
        } else {
            friction
        };
        self
    }

    /// The friction law.
    #[must_use]
    pub fn friction(&self) -> &Friction {
        &self.friction
    }

    /// The gap at a node, m, checked.
    pub(crate) fn gap_at(&self, node: u32, position: [f64; 3]) -> Result<f64, ContactError> {
        let value = match &self.gap {
            Gap::None => 0.0,
            Gap::Constant(value) => *value,
            Gap::Field(field) => field(position),
        };
        if value.is_finite() {
            Ok(value)
        } else {
            Err(ContactError::Gap { node, value })
        }
    }
}

/// How the body is cut into subdomains.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Cut {
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
    pub(crate) contact: Option<Contact>,
    /// Contacts given; more than one are refused.
    pub(crate) contacts: usize,
    pub(crate) cut: Cut,
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
            contact: None,
            contacts: 0,
            cut: Cut::Whole,
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

    /// Sets the contact surface. A scene has one, with one law; a second call is refused when the scene is used, because it
    /// would drop the first surface. [`replace_contact`](Self::replace_contact) does that on purpose.
    #[must_use]
    pub fn with_contact(mut self, contact: Contact) -> Self {
        self.contact = Some(contact);
        self.contacts += 1;
        self
    }

    /// Another contact surface in the place of the one there is; `None` for no contact.
    #[must_use]
    pub fn replace_contact(mut self, contact: Option<Contact>) -> Self {
        self.contacts = usize::from(contact.is_some());
        self.contact = contact;
        self
    }

    /// Cuts the body into boxes. Empty boxes are dropped and disconnected ones split (see
    /// [`Decomposition::boxes`]), so any mesh and any positive counts will do.
    #[must_use]
    pub fn with_boxes(mut self, boxes: [usize; 3]) -> Self {
        self.cut = Cut::Boxes(boxes);
        self
    }

    /// Cuts the body by part numbers, one an element.
    #[must_use]
    pub fn with_parts(mut self, parts: Vec<u32>) -> Self {
        self.cut = Cut::Parts(parts);
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

    /// The contact surface, if any.
    #[must_use]
    pub fn contact(&self) -> Option<&Contact> {
        self.contact.as_ref()
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
            Cut::Whole => Decomposition::whole(&self.mesh),
            Cut::Boxes(boxes) => Decomposition::boxes(&self.mesh, *boxes)?,
            Cut::Parts(parts) => Decomposition::from_parts(&self.mesh, parts)?,
        })
    }

    /// Nodes of a place, checked; `what` names who asks.
    pub(crate) fn nodes(
        &self,
        what: &'static str,
        place: &Place,
    ) -> Result<Vec<u32>, ContactError> {
        match place {
            Place::Tag(tag) => {
                let nodes = self.mesh.nodes_on(*tag);
                if nodes.is_empty() {
                    return Err(self.unknown_tag(what, *tag));
                }
                Ok(nodes)
            }
            Place::Nodes(nodes) => {
                let count = self.mesh.points().len();
                match nodes.iter().find(|&&n| n as usize >= count) {
                    Some(&node) => Err(ContactError::UnknownNode {
                        what,
                        node,
                        nodes: count,
                    }),
                    None => Ok(nodes.clone()),
                }
            }
        }
    }

    pub(crate) fn unknown_tag(&self, what: &'static str, tag: FacetTag) -> ContactError {
        let known: Vec<String> = self.mesh.tags().iter().map(|t| t.0.to_string()).collect();
        ContactError::UnknownTag {
            what,
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
        for support in &self.supports {
            let nodes = self.nodes("support", &support.place)?;
            if let Some((values, _)) = &support.motion
                && values.len() != 1
                && values.len() != nodes.len()
            {
                let (values, nodes) = (values.len(), nodes.len());
                return Err(ContactError::ValueCount {
                    what: "support",
                    values,
                    nodes,
                });
            }
        }
        for level in 0..self.analysis.levels() {
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
        if self.contacts > 1 {
            return Err(ContactError::SeveralContacts {
                count: self.contacts,
            });
        }
        let Some(contact) = &self.contact else {
            return Ok(());
        };
        for &tag in &contact.tags {
            if self.mesh.nodes_on(tag).is_empty() {
                return Err(self.unknown_tag("contact", tag));
            }
        }
        if let ContactNormal::Fixed(normal) = contact.normal {
            let length: f64 = normal.iter().map(|c| c * c).sum();
            if !(length.is_finite() && length > 0.0) {
                return Err(ContactError::ObstacleNormal { normal });
            }
        }
        if let Friction::Coulomb(coefficient) = &contact.friction {
            coefficient.validate()?;
        }
        Ok(())
    }
}
