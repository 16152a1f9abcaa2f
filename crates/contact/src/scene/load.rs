//! Loads in space and time.

use signorini_fem_mesh::{Eigenstrain, FacetTag, History, LoadDensity};

/// A load in space and time.
#[derive(Debug, Clone)]
#[must_use]
pub struct Load {
    pub(crate) kind: Kind,
    pub(crate) history: History,
}

#[derive(Debug, Clone)]
pub(crate) enum Kind {
    Density(LoadDensity),
    Eigenstrain(Eigenstrain),
}

impl Load {
    /// A load that is constant in time.
    pub fn new(density: LoadDensity) -> Self {
        Self::of(Kind::Density(density))
    }

    /// A stress-free strain: thermal expansion, a shrink fit, the pretension of a bolt. It is constant in time unless a
    /// history is given.
    pub fn eigenstrain(strain: Eigenstrain) -> Self {
        Self::of(Kind::Eigenstrain(strain))
    }

    fn of(kind: Kind) -> Self {
        Self {
            kind,
            history: History::constant(1.0),
        }
    }

    /// Force per area on a tag, Pa.
    pub fn traction(tag: FacetTag, value: [f64; 3]) -> Self {
        Self::new(LoadDensity::traction(tag, value))
    }

    /// A force on a tag, N, spread evenly over its facets, for instance a bolt force under its head. The sum of the
    /// load is this force to rounding, whatever the area of the facets.
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

    /// The load in space; `None` of an eigenstrain.
    pub fn density(&self) -> Option<&LoadDensity> {
        match &self.kind {
            Kind::Density(density) => Some(density),
            Kind::Eigenstrain(_) => None,
        }
    }

    /// Its factor in time.
    pub fn history(&self) -> &History {
        &self.history
    }
}
