//! A case: what is hard, how it is built, and what outcome is acceptable.

use signorini::prelude::{History, LoadDensity, Scene, Settings, State, StepStatus};

/// Any failure while a case is built.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Everything a run needs.
#[derive(Debug)]
pub struct Setup {
    /// The scene.
    pub scene: Scene,
    /// The settings.
    pub settings: Settings,
    /// The loads of the scene once more, for balances that are computed apart from the library.
    pub loads: Vec<(LoadDensity, History)>,
    /// A state to resume from.
    pub start: Option<State>,
}

/// What is acceptable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Expect {
    /// Every level converges, with the largest relative violation below this.
    Certified(f64),
    /// Every level converges and is certified, or ends with one of these statuses; what converged is certified.
    CertifiedOr(f64, &'static [StepStatus]),
    /// An error whose text contains this.
    Refused(&'static str),
}

/// Builds a case.
pub type Build = Box<dyn Fn() -> Result<Setup, Failure> + Send + Sync>;

/// A case; see the [module](self).
pub struct Case {
    /// Heading in the document.
    pub group: &'static str,
    /// Unique name.
    pub name: String,
    /// What is hard.
    pub hard: &'static str,
    /// What is acceptable.
    pub expect: Expect,
    /// Most products a level in the mean, without a fall-back.
    pub at_most: Option<usize>,
    /// Left out of the short run.
    pub long: bool,
    /// A case with the same answer in dimensionless figures, and how close it has to be.
    pub same_as: Option<(String, f64)>,
    /// Makes scene and settings.
    pub build: Build,
}

impl std::fmt::Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Case")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

impl Case {
    /// A case that has to be certified to 1e-5, ten times the tolerance of the solver.
    pub fn new(
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

    /// Sets what is acceptable.
    #[must_use]
    pub fn expect(mut self, expect: Expect) -> Self {
        self.expect = expect;
        self
    }

    /// Sets the most products a level in the mean; no level may need the fall-back.
    #[must_use]
    pub fn at_most(mut self, products: usize) -> Self {
        self.at_most = Some(products);
        self
    }

    /// Leaves the case out of the short run.
    #[must_use]
    pub fn long(mut self) -> Self {
        self.long = true;
        self
    }

    /// The dimensionless figures equal those of another case.
    #[must_use]
    pub fn same_as(mut self, name: impl Into<String>, within: f64) -> Self {
        self.same_as = Some((name.into(), within));
        self
    }
}
