//! The brick of the benchmark, with everything variable.
//!
//! Section 6 of the paper; `docs/reports/benchmark.md` says what is our reading: the side of the floor, the unit of
//! the tractions, the histories, the coefficient of friction and its decay.

use signorini::contact::Plan;
use signorini::fem_mesh::Surface;
use signorini::prelude::*;

use crate::Failure;

/// Edges of the brick, m.
pub const LENGTHS: [f64; 3] = [3.0, 1.0, 1.0];
/// Young's modulus, Pa.
pub const YOUNG: f64 = 211.9e9;
/// Poisson's ratio, the paper's sigma.
pub const POISSON: f64 = 0.277;
/// Distance of the floor, m.
pub const GAP: f64 = 0.1;
/// Traction on the top, Pa.
pub const TOP: [f64; 3] = [0.0, 0.0, -30e8];
/// Traction on the free end, Pa.
pub const END: [f64; 3] = [9e8, 0.0, -15e8];
/// Normal and friction force at half load with a coefficient of 0.2 that meshes tend to, N: by Richardson's
/// extrapolation of linear elements with 15, 30, 60 cells a metre, good to 2e-5 and 1e-3.
pub const LIMITS: [f64; 2] = [2.6228e9, -8.38e7];
/// Time steps of the benchmark in one second.
pub const STEPS: usize = 50;
/// Cells along the edge of a subdomain in the benchmark: H/h.
pub const CELLS: usize = 5;
/// The difference formula of the paper: 3/2, -2, 1/2.
pub const PAPER_FORMULA: DifferenceFormula = DifferenceFormula::PAPER;
/// Backward Euler.
pub const EULER: DifferenceFormula = DifferenceFormula::BACKWARD_EULER;
/// From 0 to 1 in one second.
pub const RAMP: &[(f64, f64)] = &[(0.0, 0.0), (1.0, 1.0)];
/// Up, down, and up again in one second.
pub const WAVES: &[(f64, f64)] = &[(0.0, 0.0), (0.4, 1.0), (0.7, 0.0), (1.0, 1.0)];

/// The benchmark's friction: 0.3 at rest, 0.1 at high rate, the difference falls by e in 0.05 m/s.
pub fn weakening() -> Friction {
    Friction::Coulomb(Coefficient::Exponential {
        fixed: 0.3,
        kinetic: 0.1,
        decay: 0.05,
    })
}

/// Steel of the benchmark.
pub fn steel() -> Result<Materials, Failure> {
    Ok(Materials::uniform(Hooke::isotropic(YOUNG, POISSON)?))
}

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
    pub fn name(self) -> &'static str {
        match self {
            Self::B => "b",
            Self::C => "c",
        }
    }

    /// Points (time in s, factor) of the history.
    pub fn table(self) -> Vec<(f64, f64)> {
        match self {
            Self::B => RAMP.to_vec(),
            Self::C => WAVES.to_vec(),
        }
    }
}

/// A brick above a floor; all lengths are multiplied by `metre`, all stresses by `pascal`.
#[derive(Debug, Clone)]
pub struct Block {
    /// Edges, m.
    pub lengths: [f64; 3],
    /// Subdomains along the edges.
    pub boxes: [usize; 3],
    /// Cells of a subdomain along each edge.
    pub cells: [usize; 3],
    /// Order of the elements, 1 or 2.
    pub order: usize,
    /// Displacement of inner nodes relative to a cell; above 0 no two subdomains are alike.
    pub perturbation: f64,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Distance of the floor, m.
    pub gap: f64,
    /// Friction on the floor; `None` without a floor.
    pub floor: Option<Friction>,
    /// Traction on the top, Pa, and its history.
    pub top: [f64; 3],
    /// History of the top.
    pub top_history: Vec<(f64, f64)>,
    /// Traction at the free end, Pa.
    pub end: [f64; 3],
    /// History of the end.
    pub end_history: Vec<(f64, f64)>,
    /// Whether the end x = 0 is fixed.
    pub clamped: bool,
    /// Time steps in one second; 0 for a static scene.
    pub steps: usize,
    /// Difference formula.
    pub formula: DifferenceFormula,
    /// The unit of length is `1 / metre` metres.
    pub metre: f64,
    /// The unit of stress is `1 / pascal` pascals.
    pub pascal: f64,
}

impl Default for Block {
    /// Loads and floor of the benchmark, loading c, but 3 subdomains of 4 x 4 x 4 cells, 6 steps of backward Euler
    /// and a constant coefficient of 0.3.
    fn default() -> Self {
        Self {
            lengths: LENGTHS,
            boxes: [3, 1, 1],
            cells: [4; 3],
            order: 1,
            perturbation: 0.0,
            young: YOUNG,
            poisson: POISSON,
            gap: GAP,
            floor: Some(Friction::coulomb(0.3)),
            top: TOP,
            top_history: RAMP.to_vec(),
            end: END,
            end_history: WAVES.to_vec(),
            clamped: true,
            steps: 6,
            formula: EULER,
            metre: 1.0,
            pascal: 1.0,
        }
    }
}

impl Block {
    /// The benchmark: `3n x n x n` subdomains.
    pub fn benchmark(n: usize, loading: Loading) -> Self {
        Self {
            boxes: [n.saturating_mul(3), n, n],
            cells: [CELLS; 3],
            floor: Some(weakening()),
            end_history: loading.table(),
            steps: STEPS,
            formula: PAPER_FORMULA,
            ..Self::default()
        }
    }

    /// The mesh, in the unit of length.
    pub fn mesh(&self) -> Result<TetMesh, Failure> {
        let cells = std::array::from_fn(|d| self.boxes[d].saturating_mul(self.cells[d]));
        let brick = Brick::new(self.lengths.map(|l| l * self.metre), cells);
        let mesh = brick.perturbed(self.perturbation, 1).build()?;
        Ok(if self.order == 2 { mesh.raise_order()? } else { mesh })
    }

    /// The material, in the unit of stress.
    pub fn material(&self) -> Result<Hooke, Failure> {
        Ok(Hooke::isotropic(self.young * self.pascal, self.poisson)?)
    }

    /// The tractions that are not zero, with their histories.
    pub fn loads(&self) -> Result<Vec<(LoadDensity, History)>, Failure> {
        let top = (brick::Z_MAX, self.top, &self.top_history);
        let end = (brick::X_MAX, self.end, &self.end_history);
        let mut loads = Vec::new();
        for (tag, value, table) in [top, end] {
            if value != [0.0; 3] {
                let density = LoadDensity::Traction(tag, value.map(|v| v * self.pascal));
                loads.push((density, History::table(table.clone())?));
            }
        }
        Ok(loads)
    }

    /// The scene.
    pub fn scene(&self) -> Result<Scene, Failure> {
        self.scene_on(self.mesh()?, Materials::uniform(self.material()?))
    }

    /// The scene on another mesh with the tags of the brick.
    pub fn scene_on(&self, mesh: TetMesh, materials: Materials) -> Result<Scene, Failure> {
        let mut scene = Scene::new(mesh, materials).with_boxes(self.boxes);
        if self.clamped {
            scene = scene.with_support(Support::fixed(brick::X_MIN));
        }
        for (density, history) in self.loads()? {
            scene = scene.with_load(Load::new(density).with_history(history));
        }
        if let Some(friction) = &self.floor {
            let gap = self.gap * self.metre;
            let floor = Contact::rigid(brick::Z_MIN).with_friction(friction.clone());
            scene = scene.with_contact(if gap == 0.0 { floor } else { floor.with_gap(gap) });
        }
        if self.steps > 0 {
            let analysis = Analysis::quasistatic(1.0, self.steps);
            scene = scene.with_analysis(analysis.with_formula(self.formula));
        }
        Ok(scene)
    }
}

/// A number for each tetrahedron of a mesh, from its centre: regions or parts.
pub fn by_centre(mesh: &TetMesh, number: impl Fn([f64; 3]) -> u32) -> Vec<u32> {
    let centre = |tet| {
        let corners = mesh.tet_points(tet);
        [0, 1, 2].map(|c| corners.iter().map(|p| p[c]).sum::<f64>() / 4.0)
    };
    (0..mesh.tets().len()).map(|tet| number(centre(tet))).collect()
}

/// Part numbers of the tetrahedra of a mesh: the nearest of some points.
pub fn by_nearest(mesh: &TetMesh, points: &[[f64; 3]]) -> Vec<u32> {
    by_centre(mesh, |centre| {
        let square = |p: &[f64; 3]| (0..3).map(|d| (p[d] - centre[d]).powi(2)).sum::<f64>();
        let distances = points.iter().map(square).enumerate();
        distances
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0, |(k, _)| k as u32)
    })
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
pub fn sizes(scene: &Scene, settings: &Settings) -> Result<Sizes, Failure> {
    let plan = Plan::new(scene, settings)?;
    let friction = scene.contacts().iter().any(|c| c.friction().is_some());
    let rows = if friction { 3 } else { 1 };
    let floor = Surface::new(scene.mesh(), &[brick::Z_MIN])?;
    let nodes = floor.nodes().len();
    Ok(Sizes {
        n_s: plan.subdomains,
        n_p: plan.primal,
        n_d: plan.dual(),
        n_d_paper: plan.interface_rows + plan.dirichlet_rows + rows * nodes,
    })
}
