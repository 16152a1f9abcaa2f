//! Rigid couplings: parts of the boundary that move as one rigid body, or relative to each other.

use super::support::Place;
use signorini_fem_mesh::History;

/// A rigid coupling: nodes that move together as a rigid body, for small rotations, with a reference point, which need
/// not be in the mesh. The point is free, or some of its motions are held or moved;
/// [`Load::on_coupling`](crate::Load::on_coupling) loads it. A stiff plate under a press, a hub on its bore, the far
/// end of a part that is not modelled. [`relative`](Self::relative) couples the sides of a cut: bolts, hinges.
///
/// Elsewhere: kinematic coupling and `*RIGID BODY` (CalculiX, Abaqus), RBE2 (Nastran).
///
/// Nodes must not all lie on a line. They can be in one coupling only. Supports of them must say what the coupling
/// holds, as on planes of symmetry; their reaction is then that of the coupling. They cannot touch what is rigid, too;
/// they may touch other bodies. What the coupling does not say of its motion is found: by loads, the stiffness of the
/// body, other contacts.
///
/// ```
/// use signorini_contact::{Coupling, Load, Scene, Settings, Simulation, Support};
/// use signorini_fem_mesh::{Brick, Hooke, Materials, brick};
///
/// let bar = Brick::new([0.2, 0.02, 0.02], [10, 2, 2]).build()?;
/// // a rigid lever at the end of the bar, pulled at 0.1 m from its axis, guided against rotation about the bar
/// let lever = Coupling::rigid(brick::X_MAX, [0.2, 0.11, 0.01]).with_held([false, false, false, true, false, false]);
/// let scene = Scene::new(bar, Materials::uniform(Hooke::isotropic(2e11, 0.3)?))
///     .with_support(Support::fixed(brick::X_MIN))
///     .with_coupling(lever)
///     .with_load(Load::on_coupling(0, [0.0, 0.0, -100.0], [0.0; 3]));
/// let mut simulation = Simulation::new(scene, Settings::default())?;
/// let result = simulation.step()?;
/// let motion = result.couplings()[0];
/// assert!(motion.displacement[2] < 0.0 && motion.rotation[0].abs() < 1e-12);
/// // the guide takes the moment
/// assert!((result.reactions_about([0.2, 0.01, 0.01]).couplings[0].moment[0] - 10.0).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
#[must_use]
pub struct Coupling {
    pub(crate) coupled: Coupled,
    pub(crate) reference: [f64; 3],
    pub(crate) axis: Option<[f64; 3]>,
    pub(crate) held: [bool; 6],
    pub(crate) motions: Vec<([f64; 6], History)>,
    /// What is held from a time on, s.
    pub(crate) lock: Option<([bool; 6], f64)>,
    /// The motions at which it is held then.
    pub(crate) locked: [Option<f64>; 6],
}

/// What moves as a coupling says.
#[derive(Debug, Clone)]
pub(crate) enum Coupled {
    Nodes(Place),
    /// The first side of a tied contact relative to the other.
    Tied(usize),
    /// Nothing but its reference point.
    Point,
}

impl Coupling {
    /// A free coupling of the nodes of a tag, or of single nodes, with its reference point, m.
    pub fn rigid(place: impl Into<Place>, reference: [f64; 3]) -> Self {
        Self::of(Coupled::Nodes(place.into()), reference)
    }

    /// How the first side of a [tied](crate::Contact::tied) contact, by its number in the scene, moves relative to the
    /// other: nothing but a rigid motion about the reference point, m, which loads push or turn with the opposite on
    /// the other side. The forces that the sides transfer are those of the contact.
    ///
    /// A bolt that is cut across, and tightened: the sides may move towards each other along its axis, and are pulled
    /// by the preload along the outward normal of the first. Without rotations that are held it is a ball joint, with
    /// one that is free a hinge. Elsewhere: pretension section, connector, joint.
    ///
    /// ```
    /// use signorini_contact::{Contact, Coupling, Load, Scene, Settings, Simulation, Support};
    /// use signorini_fem_mesh::{Brick, FacetTag, Hooke, Materials, brick};
    ///
    /// // a bolt between two walls, cut in the middle
    /// let bolt = Brick::new([0.1, 0.02, 0.02], [10, 2, 2]).build()?;
    /// let is_left = |tet: usize| Some(bolt.tet_points(tet).iter().map(|p| p[0]).sum::<f64>() < 4.0 * 0.05);
    /// let (left, right) = (FacetTag(7), FacetTag(8));
    /// let (bolt, _) = bolt.cut(is_left, [left, right])?;
    /// let scene = Scene::new(bolt, Materials::uniform(Hooke::isotropic(2e11, 0.3)?))
    ///     .with_support(Support::fixed(brick::X_MIN))
    ///     .with_support(Support::fixed(brick::X_MAX))
    ///     .with_contact(Contact::tied(left, right))
    ///     .with_coupling(Coupling::relative(0, [0.05, 0.01, 0.01]).with_held([false, true, true, true, true, true]))
    ///     .with_load(Load::on_coupling(0, [4e4, 0.0, 0.0], [0.0; 3]));
    /// let mut simulation = Simulation::new(scene, Settings::default())?;
    /// let result = simulation.step()?;
    /// // it is shortened by about force times length over stiffness
    /// assert!((result.couplings()[0].displacement[0] / 5e-5 - 1.0).abs() < 0.1);
    /// assert!((result.reactions().supports[1].resultant.force[0] - 4e4).abs() < 1e-2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn relative(contact: usize, reference: [f64; 3]) -> Self {
        Self::of(Coupled::Tied(contact), reference)
    }

    /// A point alone, m, for [equations](crate::Equation): a control node that is moved, loaded or free. It has no
    /// rotations, and stays where neither an equation nor this coupling says how it moves. It costs as much as a
    /// subdomain, and the set-up grows with the cube of their number: two hundred take a second.
    pub fn point(place: [f64; 3]) -> Self {
        Self::of(Coupled::Point, place)
    }

    fn of(coupled: Coupled, reference: [f64; 3]) -> Self {
        Self {
            coupled,
            reference,
            axis: None,
            held: [false; 6],
            motions: Vec::new(),
            lock: None,
            locked: [None; 6],
        }
    }

    /// What is held, and how it moves, is told along and about this axis, of any length, in the place of x, and two at
    /// right angles to it ([`SurfaceFrame`](signorini_fem_mesh::SurfaceFrame)).
    pub fn with_axis(mut self, axis: [f64; 3]) -> Self {
        self.axis = Some(axis);
        self
    }

    /// Which of its motions are held: displacements of the reference point along x, y, z, and rotations about them.
    pub fn with_held(mut self, held: [bool; 6]) -> Self {
        self.held = held;
        self
    }

    /// Those that are held, and only these, follow `history(t) * motion` instead of staying at zero: displacements in
    /// m, rotations in radians. Several such motions add up.
    pub fn with_motion(mut self, motion: [f64; 6], history: History) -> Self {
        self.motions.push((motion, history));
        self
    }

    /// These of its motions are free, or loaded, at steps until a time, s, and from then on held as they are at the
    /// last of these, or at zero: a bolt is tightened by a force, and then keeps its length. Let the time be the end of a
    /// step, or it is locked before its load is all there. Loads in their directions act on nothing then. Between the
    /// two steps the scene is set up anew.
    pub fn with_lock(mut self, locked: [bool; 6], time: f64) -> Self {
        self.lock = Some((locked, time));
        self
    }

    /// The axis along and about which it is told what is held; `None` for x.
    pub fn axis(&self) -> Option<[f64; 3]> {
        self.axis
    }

    /// Its motions that are locked later, and the time, s.
    pub fn lock(&self) -> Option<([bool; 6], f64)> {
        self.lock
    }

    /// What is held now.
    pub(crate) fn holds(&self) -> [bool; 6] {
        [0, 1, 2, 3, 4, 5].map(|c| self.held[c] || self.locked[c].is_some() || c > 2 && self.is_point())
    }

    /// Motions that are to be locked yet, and when, s.
    pub(crate) fn pending(&self) -> Option<([bool; 6], f64)> {
        self.locks(self.holds())
    }

    /// Motions that are locked once, and when, s.
    pub(crate) fn lockable(&self) -> Option<([bool; 6], f64)> {
        self.locks([0, 1, 2, 3, 4, 5].map(|c| self.held[c] || c > 2 && self.is_point()))
    }

    /// What it locks that is not held already.
    fn locks(&self, holds: [bool; 6]) -> Option<([bool; 6], f64)> {
        let (locked, time) = self.lock?;
        let left = [0, 1, 2, 3, 4, 5].map(|c| locked[c] && !holds[c]);
        left.contains(&true).then_some((left, time))
    }

    /// The tied contact of a [relative](Self::relative) one, by its number in the scene.
    pub fn tied(&self) -> Option<usize> {
        match self.coupled {
            Coupled::Tied(contact) => Some(contact),
            Coupled::Nodes(_) | Coupled::Point => None,
        }
    }

    /// Whether it is a [point](Self::point) alone.
    pub(crate) fn is_point(&self) -> bool {
        matches!(self.coupled, Coupled::Point)
    }

    /// Its nodes; `None` of a relative one and of a point.
    pub fn place(&self) -> Option<&Place> {
        match &self.coupled {
            Coupled::Nodes(place) => Some(place),
            Coupled::Tied(_) | Coupled::Point => None,
        }
    }

    /// Its reference point, m.
    pub fn reference(&self) -> [f64; 3] {
        self.reference
    }

    /// Which of its motions are held.
    pub fn held(&self) -> [bool; 6] {
        self.held
    }

    /// How those that are held move.
    pub fn motions(&self) -> &[([f64; 6], History)] {
        &self.motions
    }
}
