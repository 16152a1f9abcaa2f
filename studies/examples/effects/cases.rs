//! The brick: each scene has one effect more than the one before.

use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::{Block, Loading, weakening};

/// What is computed from every step besides the solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extra {
    /// Nothing.
    None,
    /// Stresses.
    Stress,
    /// Estimates of errors.
    Errors,
}

/// A scene with a name.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    /// What is new.
    pub(crate) name: String,
    /// The scene.
    pub(crate) scene: Scene,
    /// Settings.
    pub(crate) settings: Settings,
    /// What is computed from a step.
    pub(crate) extra: Extra,
}

impl Case {
    /// A scene with the default settings.
    pub(crate) fn new(name: impl Into<String>, scene: Scene) -> Self {
        let (name, settings) = (name.into(), Settings::default());
        Self {
            name,
            scene,
            settings,
            extra: Extra::None,
        }
    }
}

/// The brick of the benchmark with `cells` cells along the edge of each of three subdomains, and `steps` steps where
/// it has a history.
pub(crate) fn cases(cells: usize, steps: usize) -> Result<Vec<Case>, Failure> {
    let full = Block {
        cells: [cells; 3],
        steps,
        ..Block::benchmark(1, Loading::B)
    };
    let whole = |floor: Option<Friction>, gap: f64, steps: usize| Block {
        boxes: [1; 3],
        cells: [3 * cells, cells, cells],
        floor,
        gap,
        steps,
        ..full.clone()
    };
    let gap = full.gap;
    let coulomb = Friction::coulomb(0.3);
    let blocks = [
        ("elastic only", whole(None, 0.0, 0)),
        ("+ contact", whole(Some(Friction::None), 0.0, 0)),
        ("+ gap", whole(Some(Friction::None), gap, 0)),
        ("+ Tresca friction", whole(Some(Friction::tresca(3e8)), gap, 0)),
        ("Coulomb instead", whole(Some(coulomb.clone()), gap, 0)),
        ("+ history", whole(Some(coulomb), gap, steps)),
        ("+ rate dependence", whole(Some(weakening()), gap, steps)),
        ("+ several subdomains", full.clone()),
        ("+ stress output", full.clone()),
        ("+ error estimates", full.clone()),
    ];
    let case = |(name, block): (&str, Block)| {
        let mut case = Case::new(name, block.scene()?);
        case.extra = match name {
            "+ stress output" => Extra::Stress,
            "+ error estimates" => Extra::Errors,
            _ => Extra::None,
        };
        Ok(case)
    };
    blocks.into_iter().map(case).collect()
}
