//! A case: what is hard, how it is built, and what outcome is acceptable.

use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::Block;

/// Everything a run needs.
#[derive(Debug)]
pub(crate) struct Setup {
    /// The scene.
    pub(crate) scene: Scene,
    /// The settings.
    pub(crate) settings: Settings,
    /// The loads of the scene once more, for balances that are computed apart from the library.
    pub(crate) loads: Vec<(LoadDensity, History)>,
    /// A state to resume from.
    pub(crate) start: Option<State>,
}

impl Setup {
    /// A scene with the loads of a list, and no other loads.
    pub(crate) fn new(mut scene: Scene, loads: Vec<(LoadDensity, History)>) -> Self {
        for (density, history) in &loads {
            scene = scene.with_load(Load::new(density.clone()).with_history(history.clone()));
        }
        Self {
            scene,
            settings: Settings::default(),
            loads,
            start: None,
        }
    }

    /// Adds a load to the scene and to the list for the balances.
    pub(crate) fn with_load(mut self, density: LoadDensity, history: History) -> Self {
        let load = Load::new(density.clone()).with_history(history.clone());
        self.loads.push((density, history));
        self.map(|scene| scene.with_load(load))
    }

    /// Changes the scene.
    pub(crate) fn map(mut self, change: impl FnOnce(Scene) -> Scene) -> Self {
        self.scene = change(self.scene);
        self
    }
}

/// Makes a case of a block.
pub(crate) trait ToSetup {
    /// The case on the brick.
    fn setup(&self) -> Result<Setup, Failure>;
    /// The case on a mesh with the tags of the brick.
    fn setup_on(&self, mesh: TetMesh, materials: Materials) -> Result<Setup, Failure>;
}

impl ToSetup for Block {
    fn setup(&self) -> Result<Setup, Failure> {
        self.setup_on(self.mesh()?, Materials::uniform(self.material()?))
    }

    fn setup_on(&self, mesh: TetMesh, materials: Materials) -> Result<Setup, Failure> {
        let (scene, loads) = (self.scene_on(mesh, materials)?, self.loads()?);
        Ok(Setup {
            scene,
            settings: Settings::default(),
            loads,
            start: None,
        })
    }
}

/// What is acceptable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Expect {
    /// Every step converges, with the largest relative violation below this.
    Certified(f64),
    /// Every step converges and is certified, or ends with one of these statuses; what converged is certified.
    CertifiedOr(f64, &'static [StepStatus]),
    /// An error whose text contains this.
    Refused(&'static str),
}

/// Builds a case.
pub(crate) type Build = Box<dyn Fn() -> Result<Setup, Failure> + Send + Sync>;

/// A case.
pub(crate) struct Case {
    /// Heading in the document.
    pub(crate) group: &'static str,
    /// Unique name.
    pub(crate) name: String,
    /// What is hard.
    pub(crate) hard: &'static str,
    /// What is acceptable.
    pub(crate) expect: Expect,
    /// Most products a step in the mean, without a fall-back.
    pub(crate) at_most: Option<usize>,
    /// Left out of the short run.
    pub(crate) long: bool,
    /// A case with the same answer in dimensionless figures, and how close it has to be.
    pub(crate) same_as: Option<(String, f64)>,
    /// Makes scene and settings.
    pub(crate) build: Build,
}

impl Case {
    /// A case that has to be certified to 1e-5, ten times the tolerance of the solver.
    pub(crate) fn new(
        group: &'static str,
        name: impl Into<String>,
        hard: &'static str,
        build: impl Fn() -> Result<Setup, Failure> + Send + Sync + 'static,
    ) -> Self {
        Self {
            group,
            name: name.into(),
            hard,
            expect: Expect::Certified(1e-5),
            at_most: None,
            long: false,
            same_as: None,
            build: Box::new(build),
        }
    }

    /// A case on the brick.
    pub(crate) fn brick(group: &'static str, name: impl Into<String>, hard: &'static str, block: Block) -> Self {
        Self::new(group, name, hard, move || block.setup())
    }

    /// Sets what is acceptable.
    pub(crate) fn expect(mut self, expect: Expect) -> Self {
        self.expect = expect;
        self
    }

    /// Sets the most products a step in the mean; no step may need the fall-back.
    pub(crate) fn at_most(mut self, products: usize) -> Self {
        self.at_most = Some(products);
        self
    }

    /// Leaves the case out of the short run.
    pub(crate) fn long(mut self) -> Self {
        self.long = true;
        self
    }

    /// The dimensionless figures equal those of another case.
    pub(crate) fn same_as(mut self, name: impl Into<String>, within: f64) -> Self {
        self.same_as = Some((name.into(), within));
        self
    }
}
