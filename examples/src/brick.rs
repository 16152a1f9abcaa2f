//! The scene of the benchmark: a steel brick, clamped at one end, pressed on a rough floor and pulled along it.
//!
//! Section 6 of the paper; `docs/reports/benchmark.md` says what is our reading: the side of the floor, the unit of the tractions,
//! the histories, the coefficient of friction and its decay.

use signorini::contact::Plan;
use signorini::prelude::*;

/// Edges of the brick, m.
pub const LENGTHS: [f64; 3] = [3.0, 1.0, 1.0];
/// Young's modulus, Pa.
pub const YOUNG: f64 = 211.9e9;
/// Poisson's ratio, the paper's sigma.
pub const POISSON: f64 = 0.277;
/// Distance of the floor, m.
pub const GAP: f64 = 0.1;
/// Unit of the tractions, Pa.
pub const TRACTION_UNIT: f64 = 1e8;
/// Traction on the top in units.
pub const TOP: [f64; 3] = [0.0, 0.0, -30.0];
/// Traction on the free end in units.
pub const END: [f64; 3] = [9.0, 0.0, -15.0];
/// End of the time interval, s.
pub const DURATION: f64 = 1.0;
/// Time steps of the benchmark.
pub const STEPS: usize = 50;
/// Cells along the edge of a subdomain in the benchmark: H/h.
pub const CELLS: usize = 5;
/// Coefficient of friction at rest, at high rate, and the rate in m/s over which the difference falls by e.
pub const FRICTION: (f64, f64, f64) = (0.3, 0.1, 0.05);
/// Amplitude of the displaced inner nodes of `--perturb`, relative to a cell.
pub const PERTURBATION: f64 = 0.1;

/// History of the traction at the free end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Loading {
    /// phi_b: one ramp.
    B,
    /// phi_c: up, down, and up again.
    C,
}

impl Loading {
    /// Both, in the order of the table.
    pub const BOTH: [Self; 2] = [Self::B, Self::C];

    /// `"b"` or `"c"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::B => "b",
            Self::C => "c",
        }
    }

    /// What the history does, for captions.
    #[must_use]
    pub fn caption(self) -> &'static str {
        match self {
            Self::B => "loading b: end pulled once",
            Self::C => "loading c: end pulled, released, pulled again",
        }
    }

    /// Points (time in s, factor) of the history.
    #[must_use]
    pub fn table(self) -> Vec<(f64, f64)> {
        match self {
            Self::B => vec![(0.0, 0.0), (1.0, 1.0)],
            Self::C => vec![(0.0, 0.0), (0.4, 1.0), (0.7, 0.0), (1.0, 1.0)],
        }
    }
}

/// The benchmark and the numbers in it that the examples vary.
#[derive(Debug, Clone, PartialEq)]
pub struct Benchmark {
    /// Subdomains along the short edges; 3n x n x n in all.
    pub n: usize,
    /// Cells along the edge of a subdomain, H/h.
    pub cells: usize,
    /// History at the free end.
    pub loading: Loading,
    /// Equal time steps.
    pub steps: usize,
    /// Difference formula.
    pub formula: DifferenceFormula,
    /// Unit of the tractions, Pa.
    pub unit: f64,
    /// Displacement of inner nodes relative to a cell; above 0 no two subdomains are alike.
    pub perturbation: f64,
}

impl Benchmark {
    /// The benchmark as it stands, for one size and loading.
    #[must_use]
    pub fn new(n: usize, loading: Loading) -> Self {
        Self {
            n,
            cells: CELLS,
            loading,
            steps: STEPS,
            formula: DifferenceFormula::THREE_STEP,
            unit: TRACTION_UNIT,
            perturbation: 0.0,
        }
    }

    /// Whether nothing differs from the benchmark, so that the paper's counts are comparable.
    #[must_use]
    pub fn is_standard(&self) -> bool {
        *self == Self::new(self.n, self.loading)
    }

    /// The scene.
    ///
    /// # Errors
    /// [`Error`] for sizes that are 0 or too large, and numbers that are not finite.
    pub fn scene(&self) -> Result<Scene, Error> {
        let (fixed, kinetic, decay) = FRICTION;
        let friction = Friction::Coulomb(Coefficient::Exponential {
            fixed,
            kinetic,
            decay,
        });
        let ramp = History::ramp(DURATION, 1.0)?;
        let end = History::table(self.loading.table())?;
        let traction = |tag, value: [f64; 3]| Load::traction(tag, value.map(|v| v * self.unit));
        let analysis = Analysis::quasistatic(DURATION, self.steps).with_formula(self.formula);
        Ok(clamped(self.n, self.cells, self.perturbation)?
            .with_load(traction(brick::Z_MAX, TOP).with_history(ramp))
            .with_load(traction(brick::X_MAX, END).with_history(end))
            .with_contact(
                Contact::rigid(brick::Z_MIN)
                    .with_gap(GAP)
                    .with_friction(friction),
            )
            .with_analysis(analysis))
    }
}

/// The benchmark with its own formula and loads: `n`, loading, time steps, cells of a subdomain (5 in the paper).
///
/// # Errors
/// As [`Benchmark::scene`].
pub fn scene(n: usize, loading: Loading, steps: usize, cells: usize) -> Result<Scene, Error> {
    Benchmark {
        steps,
        cells,
        ..Benchmark::new(n, loading)
    }
    .scene()
}

/// The brick without loads and floor: mesh, steel, fixed at x1 = 0, cut into 3n x n x n cubes.
///
/// # Errors
/// [`Error`] for sizes that are 0 or too large.
pub fn clamped(n: usize, cells: usize, perturbation: f64) -> Result<Scene, Error> {
    let boxes = [n.saturating_mul(3), n, n];
    let mesh = Brick::new(LENGTHS, boxes.map(|b| b.saturating_mul(cells)))
        .perturbed(perturbation, 1)
        .build()?;
    let steel = Hooke::isotropic(YOUNG, POISSON)?;
    Ok(Scene::new(mesh, Materials::uniform(steel))
        .with_support(Support::fixed(brick::X_MIN))
        .with_boxes(boxes))
}

/// Sizes of a brick scene as Table 6.1 gives them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sizes {
    /// Subdomains.
    pub n_s: usize,
    /// Unknown displacements of all subdomains.
    pub n_p: usize,
    /// Rows of full rank.
    pub n_d: usize,
    /// Rows as the paper counts them: three at every contact node (one without friction), fixed or not.
    pub n_d_paper: usize,
}

/// Counts without setting anything up.
///
/// # Errors
/// [`Error`] if the scene or the settings are wrong.
pub fn sizes(scene: &Scene, settings: &Settings) -> Result<Sizes, Error> {
    let plan = Plan::new(scene, settings)?;
    let friction = scene.contact().is_some_and(|c| c.friction().is_some());
    let rows = if friction { 3 } else { 1 };
    Ok(Sizes {
        n_s: plan.subdomains,
        n_p: plan.primal,
        n_d: plan.dual(),
        n_d_paper: plan.interface_rows
            + plan.dirichlet_rows
            + rows * scene.mesh().nodes_on(brick::Z_MIN).len(),
    })
}
