//! Springs: an elastic ground under a part of the boundary, or at single nodes.

use super::support::Place;
use crate::error::ContactError;
use nalgebra::Matrix3;
use signorini_fem_mesh::{FacetTag, vec3};

/// An elastic foundation (Winkler) under the facets with a tag: at each point the ground reacts with a stress
/// proportional to the displacement, in tension and compression; or springs between [single nodes](Self::along) and the
/// ground. They resist rigid motions like supports.
///
/// Stiffness of a foundation is in N/m³: stress (Pa) over displacement (m). A layer of thickness `t` without lateral
/// expansion has `E (1 - nu) / ((1 + nu) (1 - 2 nu) t)` along the normal. At a node it acts with a third of the areas
/// of its facets, in a mesh of order 2 at mid-nodes only. If a support fixes a direction of a node, the spring acts at
/// right angles to it, an inclined one also by what the support moves the node; of several there the sum of forces is
/// right, but not what each has of it. Contact nodes may have springs (at edges); springs much softer or stiffer than the
/// body then cost many products.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Spring {
    pub(crate) place: Place,
    pub(crate) stiffness: Stiffness,
}

/// N/m³, at single nodes N/m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stiffness {
    Normal(f64),
    Components([f64; 3]),
    /// Along a direction of any length.
    Along([f64; 3], f64),
}

impl Spring {
    /// Along the normal of each facet.
    pub fn normal(tag: FacetTag, stiffness: f64) -> Self {
        Self {
            place: tag.into(),
            stiffness: Stiffness::Normal(stiffness),
        }
    }

    /// Along x, y and z; zero for none.
    pub fn components(tag: FacetTag, stiffness: [f64; 3]) -> Self {
        Self {
            place: tag.into(),
            stiffness: Stiffness::Components(stiffness),
        }
    }

    /// A spring to the ground at each of some nodes, along a direction; several at one node act together. Stiffness is
    /// in N/m. A node that is listed twice has two.
    ///
    /// ```
    /// use signorini_contact::{Load, Scene, Settings, Simulation, Spring, Support};
    /// use signorini_fem_mesh::{Brick, Hooke, Materials, brick};
    ///
    /// // a bar on rollers hangs at the corners of its end
    /// let bar = Brick::new([0.2, 0.02, 0.02], [10, 1, 1]).build()?;
    /// let corners = bar.nodes_on(brick::X_MIN);
    /// let scene = Scene::new(bar, Materials::uniform(Hooke::isotropic(2e11, 0.0)?))
    ///     .with_support(Support::components(brick::Z_MIN, [false, true, true]))
    ///     .with_spring(Spring::along(corners, [1.0, 0.0, 0.0], 1e6))
    ///     .with_load(Load::force(brick::X_MAX, [4e3, 0.0, 0.0]));
    /// let mut simulation = Simulation::new(scene, Settings::default())?;
    /// let result = simulation.step()?;
    /// // four springs of 1e6 N/m, and what the corners give way
    /// assert!((result.displacement()[0][0] / 1e-3 - 1.0).abs() < 0.1);
    /// assert!((result.reactions().springs[0].resultant.force[0] / -4e3 - 1.0).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn along(nodes: Vec<u32>, direction: [f64; 3], stiffness: f64) -> Self {
        Self {
            place: nodes.into(),
            stiffness: Stiffness::Along(direction, stiffness),
        }
    }

    /// Stiffness at a facet with this unit normal, or at a node, N/m³ or N/m.
    pub(crate) fn matrix(&self, normal: [f64; 3]) -> Matrix3<f64> {
        let along = |unit: [f64; 3], k: f64| Matrix3::from_fn(|i, j| k * unit[i] * unit[j]);
        match self.stiffness {
            Stiffness::Normal(k) => along(normal, k),
            Stiffness::Components(k) => Matrix3::from_diagonal(&k.into()),
            Stiffness::Along(direction, k) => along(vec3::unit(scaled(direction)), k),
        }
    }

    /// Checks the numbers, and single nodes of a mesh of so many.
    pub(crate) fn validate(&self, index: usize, nodes: usize) -> Result<(), ContactError> {
        let refuse = |reason| Err(ContactError::Spring { spring: index, reason });
        if let Place::Nodes(own) = &self.place {
            if own.is_empty() {
                return refuse("it has no nodes");
            }
            if own.iter().any(|node| *node as usize >= nodes) {
                return refuse("the mesh has not all of its nodes, which are numbered from 0");
            }
        }
        let values = match self.stiffness {
            Stiffness::Normal(k) => [k; 3],
            Stiffness::Components(k) => k,
            Stiffness::Along(direction, k) => {
                if !vec3::is_finite(scaled(direction)) {
                    return refuse("its direction has no length; give a vector that is finite and not zero");
                }
                [k; 3]
            }
        };
        let bad = values.iter().find(|k| !(k.is_finite() && **k >= 0.0));
        let none = values.iter().all(|k| *k == 0.0).then_some(&0.0);
        match bad.or(none) {
            Some(&value) => Err(ContactError::SpringStiffness { spring: index, value }),
            None => Ok(()),
        }
    }
}

/// A vector over its largest component: its square is neither zero nor infinite.
fn scaled(direction: [f64; 3]) -> [f64; 3] {
    let largest = direction.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    direction.map(|c| c / largest)
}
