//! Linear equations between displacements.

use signorini_fem_mesh::History;

/// A linear equation between displacements of nodes, `sum a . u = value`: nodes that move alike, faces of a periodic
/// cell, a lever, a direction in which a node may not move. Elsewhere: multi-point constraint, `*EQUATION` (CalculiX,
/// Abaqus), MPC (Nastran).
///
/// Its [force](crate::result::Reactions::equations) acts on each node along the coefficients there.
/// [Points](crate::Coupling::point) without elements may take part: control nodes that are moved or loaded, whose
/// displacement is that of many others.
///
/// Equations may say what others, or supports, say already: such a one has no force. Contradictions are refused, and
/// equations that name nodes of rigid couplings, or say what ties or contact say of the same nodes. What equations
/// leave free needs supports, as without them.
///
/// ```
/// use signorini_contact::{Coupling, Equation, Load, Scene, Settings, Simulation, Support};
/// use signorini_fem_mesh::{Brick, Hooke, Materials, brick};
///
/// // the end of a bar stays plane, and a point has its displacement, and the force
/// let bar = Brick::new([0.2, 0.02, 0.02], [10, 2, 2]).build()?;
/// let end = bar.nodes_on(brick::X_MAX);
/// let along = [1.0, 0.0, 0.0];
/// let scene = Scene::new(bar, Materials::uniform(Hooke::isotropic(2e11, 0.0)?))
///     .with_support(Support::fixed(brick::X_MIN))
///     .with_coupling(Coupling::point([0.3, 0.01, 0.01]))
///     .with_load(Load::on_coupling(0, [1e4, 0.0, 0.0], [0.0; 3]));
/// let alike = |node| Equation::new([(node, along)]).with_point(0, [-1.0, 0.0, 0.0]);
/// let scene = end.into_iter().map(alike).fold(scene, Scene::with_equation);
/// let mut simulation = Simulation::new(scene, Settings::default())?;
/// let result = simulation.step()?;
/// // force times length over stiffness
/// assert!((result.couplings()[0].displacement[0] / 2.5e-5 - 1.0).abs() < 1e-6);
/// let sum: f64 = result.reactions().equations.iter().map(|e| e.multiplier).sum();
/// assert!((sum / 1e4 - 1.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
#[must_use]
pub struct Equation {
    pub(crate) terms: Vec<(u32, [f64; 3])>,
    pub(crate) points: Vec<(usize, [f64; 3])>,
    pub(crate) value: Option<(f64, History)>,
}

impl Equation {
    /// Nodes of the mesh, with what multiplies their displacements; the value is zero.
    pub fn new(terms: impl IntoIterator<Item = (u32, [f64; 3])>) -> Self {
        Self {
            terms: terms.into_iter().collect(),
            points: Vec::new(),
            value: None,
        }
    }

    /// Adds the displacement of a [point](crate::Coupling::point), by its number among the couplings of the scene.
    pub fn with_point(mut self, coupling: usize, vector: [f64; 3]) -> Self {
        self.points.push((coupling, vector));
        self
    }

    /// Its value is `history(t) * value` instead of zero, m where coefficients are numbers.
    pub fn with_value(mut self, value: f64, history: History) -> Self {
        self.value = Some((value, history));
        self
    }

    /// Its nodes, with what multiplies their displacements.
    pub fn terms(&self) -> &[(u32, [f64; 3])] {
        &self.terms
    }

    /// Its points, by their numbers among the couplings, likewise.
    pub fn points(&self) -> &[(usize, [f64; 3])] {
        &self.points
    }

    /// Its value and the history of that; `None` for zero.
    pub fn value(&self) -> Option<(f64, &History)> {
        self.value.as_ref().map(|(value, history)| (*value, history))
    }
}
