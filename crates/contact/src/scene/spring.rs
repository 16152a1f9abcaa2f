//! Springs: an elastic ground under a part of the boundary.

use crate::error::ContactError;
use signorini_fem_mesh::FacetTag;

/// An elastic foundation (Winkler) under the facets with a tag: at each point the ground reacts with a stress
/// proportional to the displacement, in tension and compression. It resists rigid motions like a support.
///
/// Stiffness is in N/m³: stress (Pa) over displacement (m). A layer of thickness `t` without lateral expansion has `E
/// (1 - nu) / ((1 + nu) (1 - 2 nu) t)` along the normal. At a node it acts with a third of the areas of its facets, in
/// a mesh of order 2 at mid-nodes only. If a support fixes a direction of a node, the spring acts at right angles to
/// it. Contact nodes may have springs (at edges); springs much softer or stiffer than the body then cost many products.
#[derive(Debug, Clone, Copy, PartialEq)]
#[must_use]
pub struct Spring {
    pub(crate) tag: FacetTag,
    pub(crate) stiffness: Stiffness,
}

/// N/m³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stiffness {
    Normal(f64),
    Components([f64; 3]),
}

impl Spring {
    /// Along the normal of each facet.
    pub fn normal(tag: FacetTag, stiffness: f64) -> Self {
        Self {
            tag,
            stiffness: Stiffness::Normal(stiffness),
        }
    }

    /// Along x, y and z; zero for none.
    pub fn components(tag: FacetTag, stiffness: [f64; 3]) -> Self {
        Self {
            tag,
            stiffness: Stiffness::Components(stiffness),
        }
    }

    /// Stiffness at a facet with this unit normal, as the rows of a matrix, N/m³.
    pub(crate) fn matrix(&self, normal: [f64; 3]) -> [[f64; 3]; 3] {
        match self.stiffness {
            Stiffness::Normal(k) => normal.map(|a| normal.map(|b| k * a * b)),
            Stiffness::Components([x, y, z]) => [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]],
        }
    }

    pub(crate) fn validate(&self, index: usize) -> Result<(), ContactError> {
        let values = match self.stiffness {
            Stiffness::Normal(k) => [k; 3],
            Stiffness::Components(k) => k,
        };
        let bad = values.iter().find(|k| !(k.is_finite() && **k >= 0.0));
        let none = values.iter().all(|k| *k == 0.0).then_some(&0.0);
        match bad.or(none) {
            Some(&value) => Err(ContactError::SpringStiffness { spring: index, value }),
            None => Ok(()),
        }
    }
}
