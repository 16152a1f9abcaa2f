//! The body of most cases: the benchmark's brick with everything variable.

use super::case::{Failure, Setup};
use crate::brick::{END, GAP, LENGTHS, POISSON, TOP, TRACTION_UNIT, YOUNG};
use signorini::prelude::*;

/// A brick on a floor; all lengths are multiplied by `metre`, all stresses by `pascal`.
#[derive(Debug, Clone)]
pub struct Block {
    /// Edges, m.
    pub lengths: [f64; 3],
    /// Subdomains along the edges.
    pub boxes: [usize; 3],
    /// Cells of a subdomain along each edge.
    pub cells: [usize; 3],
    /// Displacement of inner nodes relative to a cell.
    pub perturbation: f64,
    /// Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Distance of the floor, m.
    pub gap: f64,
    /// Friction.
    pub friction: Friction,
    /// Traction on the top, Pa.
    pub top: [f64; 3],
    /// History of the top.
    pub top_history: Vec<(f64, f64)>,
    /// Traction at the free end, Pa.
    pub end: [f64; 3],
    /// History of the end.
    pub end_history: Vec<(f64, f64)>,
    /// Whether the end x = 0 is fixed.
    pub clamped: bool,
    /// Time levels; 0 for a static scene.
    pub steps: usize,
    /// Difference formula.
    pub formula: DifferenceFormula,
    /// Unit of length in metres is `1 / metre`.
    pub metre: f64,
    /// Unit of stress in pascals is `1 / pascal`.
    pub pascal: f64,
    /// Settings.
    pub settings: Settings,
}

impl Default for Block {
    /// The benchmark with 3 subdomains of 4 x 4 x 4 cells, 6 steps and a constant coefficient of 0.3.
    fn default() -> Self {
        Self {
            lengths: LENGTHS,
            boxes: [3, 1, 1],
            cells: [4; 3],
            perturbation: 0.0,
            young: YOUNG,
            poisson: POISSON,
            gap: GAP,
            friction: Friction::coulomb(0.3),
            top: TOP.map(|v| v * TRACTION_UNIT),
            top_history: vec![(0.0, 0.0), (1.0, 1.0)],
            end: END.map(|v| v * TRACTION_UNIT),
            end_history: vec![(0.0, 0.0), (0.4, 1.0), (0.7, 0.0), (1.0, 1.0)],
            clamped: true,
            steps: 6,
            formula: DifferenceFormula::BACKWARD_EULER,
            metre: 1.0,
            pascal: 1.0,
            settings: Settings::default(),
        }
    }
}

impl Block {
    /// The mesh, in the unit of length.
    pub fn mesh(&self) -> Result<TetMesh, Failure> {
        let cells = std::array::from_fn(|d| self.boxes[d] * self.cells[d]);
        Ok(Brick::new(self.lengths.map(|l| l * self.metre), cells)
            .perturbed(self.perturbation, 1)
            .build()?)
    }

    /// The material, in the unit of stress.
    pub fn material(&self) -> Result<Hooke, Failure> {
        Ok(Hooke::isotropic(self.young * self.pascal, self.poisson)?)
    }

    /// The case on the brick.
    pub fn setup(&self) -> Result<Setup, Failure> {
        self.setup_on(self.mesh()?, Materials::uniform(self.material()?))
    }

    /// The case on a mesh with the tags of the brick.
    pub fn setup_on(&self, mesh: TetMesh, materials: Materials) -> Result<Setup, Failure> {
        let mut scene = Scene::new(mesh, materials).with_boxes(self.boxes);
        if self.clamped {
            scene = scene.with_support(Support::fixed(brick::X_MIN));
        }
        if self.steps > 0 {
            scene = scene
                .with_analysis(Analysis::quasistatic(1.0, self.steps).with_formula(self.formula));
        }
        let contact = Contact::rigid(brick::Z_MIN)
            .with_gap(self.gap * self.metre)
            .with_friction(self.friction.clone());
        let mut setup = Setup {
            scene: scene.replace_contact(Some(contact)),
            settings: self.settings.clone(),
            loads: Vec::new(),
            start: None,
        };
        for (tag, value, table) in [
            (brick::Z_MAX, self.top, &self.top_history),
            (brick::X_MAX, self.end, &self.end_history),
        ] {
            if value != [0.0; 3] {
                let density = LoadDensity::traction(tag, value.map(|v| v * self.pascal));
                setup = setup.with_load(density, History::table(table.clone())?);
            }
        }
        Ok(setup)
    }
}

impl Setup {
    /// Adds a load to the scene and to the list for the balances.
    #[must_use]
    pub fn with_load(mut self, density: LoadDensity, history: History) -> Self {
        self.scene = self
            .scene
            .with_load(Load::new(density.clone()).with_history(history.clone()));
        self.loads.push((density, history));
        self
    }

    /// Changes the scene.
    #[must_use]
    pub fn map(mut self, change: impl FnOnce(Scene) -> Scene) -> Self {
        self.scene = change(self.scene);
        self
    }
}
