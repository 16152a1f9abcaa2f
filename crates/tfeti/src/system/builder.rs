//! The whole T-FETI system of a body, built once and immutable.

use crate::coarse::space::Coarse;
use crate::dual::boundary::BoundaryMap;
use crate::dual::operator::DualOperator;
use crate::error::TfetiError;
use crate::projector::factor::CoarseFactor;
use crate::rows::contact::ContactConstraints;
use crate::rows::gluing::Gluing;
use crate::rows::kinds::{RowScaling, count_removed};
use crate::rows::supports::NodeSupport;
use crate::subdomain::class::{Classes, Sharing};
use crate::subdomain::copy_stiffness::CopyStiffness;
use crate::subdomain::cost::InverseSettings;
use crate::subdomain::kernel::{Kernel, mean};
use crate::subdomain::matrices::{ClassBase, ClassInverse, assemble, invert};
use crate::system::report::{SetupReport, class_reports};
use signorini_fem_mesh::{Decomposition, Materials, TetMesh};
use std::sync::Arc;
use std::time::Instant;

/// What a T-FETI system is built from. All fields are borrowed while it is built only.
#[derive(Debug, Clone, Copy)]
pub struct TfetiBuilder<'a> {
    mesh: &'a TetMesh,
    decomposition: &'a Decomposition,
    materials: &'a Materials,
    supports: &'a [NodeSupport],
    contact: Option<&'a ContactConstraints>,
    rule: RowScaling,
    sharing: Sharing,
    inverse: InverseSettings,
    earlier: Option<&'a Tfeti>,
}

impl<'a> TfetiBuilder<'a> {
    /// A body without supports and contact.
    #[must_use]
    pub fn new(
        mesh: &'a TetMesh,
        decomposition: &'a Decomposition,
        materials: &'a Materials,
    ) -> Self {
        Self {
            mesh,
            decomposition,
            materials,
            supports: &[],
            contact: None,
            rule: RowScaling::default(),
            sharing: Sharing::default(),
            inverse: InverseSettings::default(),
            earlier: None,
        }
    }

    /// Takes classes, stiffness and factors of the subdomains from another system of the same mesh, decomposition, materials and
    /// sharing: only the rows differ, and what depends on them is made anew. The result is that of a build from nothing, bit
    /// for bit. The sizes of the subdomains are checked, values are not.
    #[must_use]
    pub fn with_reuse(mut self, earlier: &'a Tfeti) -> Self {
        self.earlier = Some(earlier);
        self
    }

    /// Sets the supports.
    #[must_use]
    pub fn with_supports(mut self, supports: &'a [NodeSupport]) -> Self {
        self.supports = supports;
        self
    }

    /// Sets the contact points.
    #[must_use]
    pub fn with_contact(mut self, contact: &'a ContactConstraints) -> Self {
        self.contact = Some(contact);
        self
    }

    /// Sets how the rows of `B` are built. Default: orthonormal.
    #[must_use]
    pub fn with_row_scaling(mut self, rule: RowScaling) -> Self {
        self.rule = rule;
        self
    }

    /// Sets whether translates share their matrices. Default: they do.
    #[must_use]
    pub fn with_sharing(mut self, sharing: Sharing) -> Self {
        self.sharing = sharing;
        self
    }

    /// Sets how the generalised inverses are chosen.
    #[must_use]
    pub fn with_inverse(mut self, settings: InverseSettings) -> Self {
        self.inverse = settings;
        self
    }

    /// Builds the system.
    ///
    /// # Errors
    /// Any of [`TfetiError`]: bad supports or contact points, unknown materials, subdomains whose stiffness is singular
    /// beyond the rigid motions, not enough memory. A body that nothing holds is no error here: see
    /// [`Tfeti::coarse_factor`] and its free motions.
    pub fn build(self) -> Result<Tfeti, TfetiError> {
        self.check()?;
        let (mesh, decomposition) = (self.mesh, self.decomposition);
        let mut clock = Clock(Instant::now());
        let classes = self.classes()?;
        let classes_seconds = clock.lap();
        let bases = self.bases(&classes)?;
        let assembly_seconds = clock.lap();
        let mut stiffness = CopyStiffness::new(&classes, &bases);
        if !has_several_laws(mesh, self.materials) {
            stiffness = stiffness.unless_alike(decomposition);
        }
        let gluing = Arc::new(Gluing::new(
            decomposition,
            mesh.points().len(),
            self.supports,
            self.contact,
            self.rule,
            &stiffness,
        )?);
        let map = Arc::new(BoundaryMap::new(&classes, &gluing));
        let gluing_seconds = clock.lap();
        let (inverses, coarse) = rayon::join(
            || clocked(|| self.invert(&classes, &bases, &map)),
            || self.coarse(&classes, &bases, &map, &gluing),
        );
        let (inverses, inverse_seconds) = inverses;
        let inverses = Arc::new(inverses?);
        let (coarse, factor) = coarse?;
        let coarse_seconds = (clock.lap() - inverse_seconds).max(0.0);
        let motions = factor.free_motions().iter();
        let report = SetupReport {
            subdomains: classes.subdomains(),
            classes: class_reports(&classes, &map, &inverses),
            primal_unknowns: decomposition.torn_dofs(),
            rows: gluing.ranges().clone(),
            rows_as_paper: gluing.rows_as_paper(),
            removed: count_removed(gluing.removed()),
            inverse_bytes: inverses.iter().map(ClassInverse::bytes).sum(),
            coarse_bytes: 8 * coarse.factor_size() as u64,
            table_bytes: map.bytes(),
            factorisations: 1 + if self.earlier.is_some() {
                0
            } else {
                bases.len()
            },
            free_motions: motions.map(ToString::to_string).collect(),
            classes_seconds,
            gluing_seconds,
            assembly_seconds,
            inverse_seconds,
            coarse_seconds,
        };
        Ok(Tfeti {
            dual: DualOperator::new(map.clone(), bases.clone(), inverses.clone()),
            parts: Parts {
                classes,
                gluing,
                map,
                bases,
                inverses,
                offsets: offsets(decomposition),
            },
            coarse,
            factor,
            report,
            node_of: node_of(decomposition),
            nodes: mesh.points().len(),
            stiffness,
        })
    }

    /// Whether settings, mesh, decomposition and the earlier system fit together.
    fn check(&self) -> Result<(), TfetiError> {
        self.inverse.validate()?;
        let (mesh, decomposition) = (self.mesh, self.decomposition);
        let check = |what, found: usize, expected: usize| {
            if found == expected {
                Ok(())
            } else {
                Err(TfetiError::DecompositionMismatch {
                    what,
                    found,
                    expected,
                })
            }
        };
        check("nodes", decomposition.nodes(), mesh.points().len())?;
        check("elements", decomposition.parts().len(), mesh.tets().len())?;
        let Some(earlier) = self.earlier else {
            return Ok(());
        };
        let (own, torn) = (decomposition.subdomains(), decomposition.torn_dofs());
        check("subdomains", own.len(), earlier.subdomains())?;
        check("torn unknowns", torn, earlier.torn_dim())?;
        for (s, subdomain) in own.iter().enumerate() {
            let expected = earlier.torn_range(s).len() / 3;
            check("nodes in a subdomain", subdomain.nodes.len(), expected)?;
        }
        Ok(())
    }

    fn classes(&self) -> Result<Arc<Classes>, TfetiError> {
        if let Some(earlier) = self.earlier {
            return Ok(earlier.parts.classes.clone());
        }
        let (mesh, decomposition) = (self.mesh, self.decomposition);
        Classes::find(mesh, decomposition, self.materials, self.sharing).map(Arc::new)
    }

    /// Stiffness and kernel of each class.
    fn bases(&self, classes: &Classes) -> Result<Arc<Vec<ClassBase>>, TfetiError> {
        if let Some(earlier) = self.earlier {
            return Ok(earlier.parts.bases.clone());
        }
        assemble(self.mesh, self.decomposition, self.materials, classes).map(Arc::new)
    }

    fn invert(
        &self,
        classes: &Classes,
        bases: &[ClassBase],
        map: &BoundaryMap,
    ) -> Result<Vec<ClassInverse>, TfetiError> {
        let factors = self.earlier.map(|earlier| &earlier.parts.inverses[..]);
        invert(classes, bases, map, &self.inverse, factors)
    }

    /// `G`, and the factor of `G G^T`.
    fn coarse(
        &self,
        classes: &Arc<Classes>,
        bases: &Arc<Vec<ClassBase>>,
        map: &Arc<BoundaryMap>,
        gluing: &Arc<Gluing>,
    ) -> Result<(Coarse, CoarseFactor), TfetiError> {
        let points = self.mesh.points();
        let subdomains = self.decomposition.subdomains().iter();
        let centres = subdomains
            .map(|s| mean(s.nodes.iter().map(|&n| points[n as usize])))
            .collect();
        let coarse = Coarse::new(
            map.clone(),
            bases.clone(),
            classes.clone(),
            gluing.clone(),
            centres,
        )?;
        let factor = coarse.factor()?;
        Ok((coarse, factor))
    }
}

/// First unknown of each subdomain in torn vectors, and their length.
fn offsets(decomposition: &Decomposition) -> Vec<usize> {
    let mut end = 0;
    let ends = decomposition.subdomains().iter().map(|subdomain| {
        end += subdomain.dofs();
        end
    });
    std::iter::once(0).chain(ends).collect()
}

/// Mesh node of each node copy, in torn order.
fn node_of(decomposition: &Decomposition) -> Vec<u32> {
    let subdomains = decomposition.subdomains().iter();
    subdomains.flat_map(|s| s.nodes.iter().copied()).collect()
}

/// Whether regions in use have different Hooke tensors.
fn has_several_laws(mesh: &TetMesh, materials: &Materials) -> bool {
    let law = |region: u32| materials.get(region).ok().map(|h| *h.voigt());
    let mut regions = mesh.regions().to_vec();
    regions.dedup();
    regions.sort_unstable();
    regions.dedup();
    regions.windows(2).any(|pair| law(pair[0]) != law(pair[1]))
}

struct Clock(Instant);

impl Clock {
    fn lap(&mut self) -> f64 {
        let seconds = self.0.elapsed().as_secs_f64();
        self.0 = Instant::now();
        seconds
    }
}

/// The result of some work, and its seconds.
fn clocked<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let started = Instant::now();
    let result = work();
    (result, started.elapsed().as_secs_f64())
}

#[derive(Debug)]
pub(crate) struct Parts {
    pub(crate) classes: Arc<Classes>,
    pub(crate) gluing: Arc<Gluing>,
    pub(crate) map: Arc<BoundaryMap>,
    pub(crate) bases: Arc<Vec<ClassBase>>,
    pub(crate) inverses: Arc<Vec<ClassInverse>>,
    /// First unknown of each subdomain in torn vectors.
    pub(crate) offsets: Vec<usize>,
}

/// A T-FETI system: the rows of `B`, the dual operator `F`, the coarse space `G` and what is needed to recover
/// displacements. Immutable, and shared freely between threads.
///
/// *Torn* vectors hold the unknowns of all subdomains one after another (`3 local node + component`).
#[derive(Debug)]
pub struct Tfeti {
    pub(crate) parts: Parts,
    dual: DualOperator,
    coarse: Coarse,
    factor: CoarseFactor,
    report: SetupReport,
    /// Mesh node of each node copy, in torn order.
    pub(crate) node_of: Vec<u32>,
    pub(crate) nodes: usize,
    stiffness: CopyStiffness,
}

impl Tfeti {
    /// The rows of `B`.
    #[must_use]
    pub fn gluing(&self) -> &Gluing {
        &self.parts.gluing
    }

    /// How the copies of a node count in contact and support rows: by their stiffness in a body of several materials, and
    /// where that of the copies of a node differs by more than a factor of four, as in ragged cuts; alike otherwise.
    #[must_use]
    pub fn copy_stiffness(&self) -> &CopyStiffness {
        &self.stiffness
    }

    /// The stiffness of the copies of each node, whether or not they differ.
    #[must_use]
    pub fn all_copy_stiffness(&self) -> CopyStiffness {
        CopyStiffness::new(&self.parts.classes, &self.parts.bases)
    }

    /// The classes of subdomains.
    #[must_use]
    pub fn classes(&self) -> &Classes {
        &self.parts.classes
    }

    /// `F = B K+ B^T`.
    #[must_use]
    pub fn dual(&self) -> &DualOperator {
        &self.dual
    }

    /// `G = R^T B^T`.
    #[must_use]
    pub fn coarse(&self) -> &Coarse {
        &self.coarse
    }

    /// The factor of `G G^T`. If its free motions are not empty, no row stops the body from moving that way.
    #[must_use]
    pub fn coarse_factor(&self) -> &CoarseFactor {
        &self.factor
    }

    /// What was built, how large it is and how long it took.
    #[must_use]
    pub fn report(&self) -> &SetupReport {
        &self.report
    }

    /// Number of subdomains.
    #[must_use]
    pub fn subdomains(&self) -> usize {
        self.parts.classes.subdomains()
    }

    /// Length of dual vectors.
    #[must_use]
    pub fn dual_dim(&self) -> usize {
        self.parts.gluing.rows_full_rank()
    }

    /// Length of torn vectors: the paper's `n_p`.
    #[must_use]
    pub fn torn_dim(&self) -> usize {
        self.parts.offsets[self.parts.offsets.len() - 1]
    }

    /// Unknowns of a subdomain in torn vectors.
    ///
    /// # Panics
    /// If there is no such subdomain.
    #[must_use]
    pub fn torn_range(&self, subdomain: usize) -> std::ops::Range<usize> {
        self.parts.offsets[subdomain]..self.parts.offsets[subdomain + 1]
    }

    /// Rigid motions of a subdomain.
    ///
    /// # Panics
    /// If there is no such subdomain.
    #[must_use]
    pub fn kernel(&self, subdomain: usize) -> &Kernel {
        &self.parts.bases[self.parts.classes.place(subdomain).0].kernel
    }
}
