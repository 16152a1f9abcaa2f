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
    Coupling(CouplingLoad),
}

/// A force and a moment, N and N m, on the reference point of a coupling.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CouplingLoad {
    pub(crate) coupling: usize,
    pub(crate) force: [f64; 3],
    pub(crate) moment: [f64; 3],
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
        Self::new(LoadDensity::Traction(tag, value))
    }

    /// A force on a tag, N, spread evenly over its facets, for instance a bolt force under its head. The sum of the
    /// load is this force to rounding, whatever the area of the facets.
    pub fn force(tag: FacetTag, value: [f64; 3]) -> Self {
        Self::new(LoadDensity::Force(tag, value))
    }

    /// A moment on a tag, N m, for instance the torque of a shaft at its end. The traction is that of beam theory: it
    /// grows linearly from the centroid of the facets, along the surface about its normal and along the normal about an
    /// axis in a plane. Its force is zero and its moment, about any point, the given one, both to rounding.
    ///
    /// ```
    /// use signorini_contact::{Load, Scene, Settings, Simulation, Support};
    /// use signorini_fem_mesh::{Brick, Hooke, Materials, brick};
    ///
    /// let bar = Brick::new([0.2, 0.02, 0.02], [10, 2, 2]).build()?;
    /// let scene = Scene::new(bar, Materials::uniform(Hooke::isotropic(2e11, 0.3)?))
    ///     .with_support(Support::fixed(brick::X_MIN))
    ///     .with_load(Load::moment(brick::X_MAX, [50.0, 0.0, 0.0]));
    /// let clamp = Simulation::new(scene, Settings::default())?.step()?.reactions().supports[0].resultant;
    /// assert!((clamp.moment[0] + 50.0).abs() < 1e-4 && clamp.force[0].abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn moment(tag: FacetTag, value: [f64; 3]) -> Self {
        Self::new(LoadDensity::Moment(tag, value))
    }

    /// Pressure on a tag, Pa, positive into the body.
    pub fn pressure(tag: FacetTag, value: f64) -> Self {
        Self::new(LoadDensity::Pressure(tag, value))
    }

    /// Force per volume, N/m³.
    pub fn body(value: [f64; 3]) -> Self {
        Self::new(LoadDensity::Body(value))
    }

    /// The same in a region only: the weight of a body, say.
    pub fn body_in(region: u32, value: [f64; 3]) -> Self {
        Self::new(LoadDensity::BodyIn(region, value))
    }

    /// A force, N, and a moment, N m, on the reference point of a [coupling](crate::Coupling), by its number in the
    /// scene.
    pub fn on_coupling(coupling: usize, force: [f64; 3], moment: [f64; 3]) -> Self {
        Self::of(Kind::Coupling(CouplingLoad {
            coupling,
            force,
            moment,
        }))
    }

    /// The load is multiplied by `history(t)`.
    pub fn with_history(mut self, history: History) -> Self {
        self.history = history;
        self
    }

    /// The load in space; `None` of an eigenstrain and on a coupling.
    pub fn density(&self) -> Option<&LoadDensity> {
        match &self.kind {
            Kind::Density(density) => Some(density),
            Kind::Eigenstrain(_) | Kind::Coupling(_) => None,
        }
    }

    pub(crate) fn is_eigenstrain(&self) -> bool {
        matches!(self.kind, Kind::Eigenstrain(_))
    }

    /// Its factor in time.
    pub fn history(&self) -> &History {
        &self.history
    }
}
