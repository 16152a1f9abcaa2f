//! The brick of the benchmark with the numbers that the studies vary.

use signorini::prelude::*;

use crate::brick::{DURATION, END, FRICTION, GAP, Loading, TOP, TRACTION_UNIT, clamped};

/// Slip bound of the study of effects, Pa.
const GIVEN: f64 = 1e8;

/// What the contact surface does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Floor {
    /// There is none.
    None,
    /// Contact without friction.
    Smooth,
    /// A given slip bound.
    Given,
    /// Coulomb friction with the coefficient at rest.
    Coulomb,
    /// Coulomb friction with a coefficient that falls with the slip rate: the benchmark.
    Weakening,
}

impl Floor {
    pub(super) const ALL: [(Self, &'static str); 5] = [
        (Self::None, "elastic only"),
        (Self::Smooth, "contact"),
        (Self::Given, "given friction"),
        (Self::Coulomb, "Coulomb friction"),
        (Self::Weakening, "rate-dependent friction"),
    ];

    fn friction(self) -> Option<Friction> {
        let (fixed, kinetic, decay) = FRICTION;
        Some(match self {
            Self::None => return None,
            Self::Smooth => Friction::None,
            Self::Given => Friction::tresca(GIVEN),
            Self::Coulomb => Friction::coulomb(fixed),
            Self::Weakening => Friction::Coulomb(Coefficient::Exponential {
                fixed,
                kinetic,
                decay,
            }),
        })
    }
}

/// A variant of the benchmark.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variant {
    pub(super) n: usize,
    pub(super) cells: usize,
    pub(super) steps: usize,
    pub(super) formula: DifferenceFormula,
    pub(super) loading: Loading,
    pub(super) floor: Floor,
}

impl Variant {
    /// Cell size, m.
    pub(super) fn cell(&self) -> f64 {
        1.0 / (self.n * self.cells) as f64
    }

    pub(super) fn scene(&self) -> Result<Scene, Error> {
        let traction = |tag, value: [f64; 3]| Load::traction(tag, value.map(|v| v * TRACTION_UNIT));
        let analysis = Analysis::quasistatic(DURATION, self.steps).with_formula(self.formula);
        let scene = clamped(self.n, self.cells, 0.0)?
            .with_load(traction(brick::Z_MAX, TOP).with_history(History::ramp(DURATION, 1.0)?))
            .with_load(
                traction(brick::X_MAX, END).with_history(History::table(self.loading.table())?),
            )
            .with_analysis(analysis);
        Ok(match self.floor.friction() {
            Some(friction) => scene.with_contact(
                Contact::rigid(brick::Z_MIN)
                    .with_gap(GAP)
                    .with_friction(friction),
            ),
            None => scene,
        })
    }
}
