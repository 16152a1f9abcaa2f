//! Rigid couplings: parts of the boundary that move as one rigid body.

use super::support::Place;
use signorini_fem_mesh::History;

/// A rigid coupling: nodes that move together as a rigid body, for small rotations, with a reference point, which need not
/// be in the mesh. The point is free, or some of its motions are held or moved; [`Load::on_coupling`](crate::Load::on_coupling)
/// loads it. A stiff plate under a press, a hub on its bore, the far end of a part that is not modelled.
///
/// Elsewhere: kinematic coupling and `*RIGID BODY` (CalculiX, Abaqus), RBE2 (Nastran).
///
/// Nodes must not all lie on a line. They can be in one coupling only. Supports of them must say what the coupling holds,
/// as on planes of symmetry; their reaction is then that of the coupling. They cannot touch what is rigid, too; they may
/// touch other bodies. What the coupling does not say of its motion is found: by loads, the stiffness of the body, other
/// contacts.
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
    pub(crate) place: Place,
    pub(crate) reference: [f64; 3],
    pub(crate) held: [bool; 6],
    pub(crate) motions: Vec<([f64; 6], History)>,
}

impl Coupling {
    /// A free coupling of the nodes of a tag, or of single nodes, with its reference point, m.
    pub fn rigid(place: impl Into<Place>, reference: [f64; 3]) -> Self {
        Self {
            place: place.into(),
            reference,
            held: [false; 6],
            motions: Vec::new(),
        }
    }

    /// Which of its motions are held: displacements of the reference point along x, y, z, and rotations about them.
    pub fn with_held(mut self, held: [bool; 6]) -> Self {
        self.held = held;
        self
    }

    /// Those that are held, and only these, follow `history(t) * motion` instead of staying at zero: displacements in m, rotations in
    /// radians. Several such motions add up.
    pub fn with_motion(mut self, motion: [f64; 6], history: History) -> Self {
        self.motions.push((motion, history));
        self
    }

    /// Its nodes.
    pub fn place(&self) -> &Place {
        &self.place
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
