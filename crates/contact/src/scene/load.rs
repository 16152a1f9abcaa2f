//! Loads in space and time.

use signorini_fem_mesh::{FacetTag, History, LoadDensity};

/// A load in space and time.
#[derive(Debug, Clone)]
#[must_use]
pub struct Load {
    pub(crate) density: LoadDensity,
    pub(crate) history: History,
}

impl Load {
    /// A load that is constant in time.
    pub fn new(density: LoadDensity) -> Self {
        Self {
            density,
            history: History::constant(1.0),
        }
    }

    /// Force per area on a tag, Pa.
    pub fn traction(tag: FacetTag, value: [f64; 3]) -> Self {
        Self::new(LoadDensity::traction(tag, value))
    }

    /// A force on a tag, N, spread evenly over its facets: a bolt force on the print of its head, say. The sum of the
    /// load is this force to rounding, whatever area the facets of a curved surface have.
    pub fn force(tag: FacetTag, value: [f64; 3]) -> Self {
        Self::new(LoadDensity::force(tag, value))
    }

    /// Pressure on a tag, Pa, positive into the body.
    pub fn pressure(tag: FacetTag, value: f64) -> Self {
        Self::new(LoadDensity::pressure(tag, value))
    }

    /// Force per volume, N/m³.
    pub fn body(value: [f64; 3]) -> Self {
        Self::new(LoadDensity::body(value))
    }

    /// The load is multiplied by `history(t)`.
    pub fn with_history(mut self, history: History) -> Self {
        self.history = history;
        self
    }

    /// The load in space.
    pub fn density(&self) -> &LoadDensity {
        &self.density
    }

    /// Its factor in time.
    pub fn history(&self) -> &History {
        &self.history
    }
}
