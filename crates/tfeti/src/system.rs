//! The whole T-FETI system of a body, built once and immutable.

use crate::boundary::BoundaryMap;
use crate::class::{Classes, Sharing};
use crate::coarse::Coarse;
use crate::coarse_factor::CoarseFactor;
use crate::contact::ContactNodes;
use crate::copy_stiffness::CopyStiffness;
use crate::cost::InverseSettings;
use crate::dual::DualOperator;
use crate::error::TfetiError;
use crate::gluing::Gluing;
use crate::kernel::{Kernel, mean};
use crate::matrices::{ClassBase, ClassInverse, assemble, invert};
use crate::report::SetupReport;
use crate::rows::RowRule;
use crate::supports::Support;
use signorini_fem_mesh::{Decomposition, Materials, TetMesh};
use std::sync::Arc;
use std::time::Instant;

/// What a T-FETI system is built from. All fields are borrowed while it is built only.
#[derive(Debug, Clone, Copy)]
pub struct TfetiBuilder<'a> {
    mesh: &'a TetMesh,
    decomposition: &'a Decomposition,
    materials: &'a Materials,
    supports: &'a [Support],
    contact: Option<&'a ContactNodes>,
    rule: RowRule,
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
            rule: RowRule::default(),
            sharing: Sharing::default(),
            inverse: InverseSettings::default(),
            earlier: None,
        }
    }

    /// Takes classes, stiffness and factors of the subdomains from another system of the same mesh, decomposition, materials and
    /// sharing: only the rows differ, and what depends on them is made anew. The result is that of a build from nothing, bit
    /// for bit. The sizes of the subdomains are checked, values are not.
    #[must_use]
    pub fn reuse(mut self, earlier: &'a Tfeti) -> Self {
        self.earlier = Some(earlier);
        self
    }

    /// Sets the supports.
    #[must_use]
    pub fn supports(mut self, supports: &'a [Support]) -> Self {
        self.supports = supports;
        self
    }

    /// Sets the contact points.
    #[must_use]
    pub fn contact(mut self, contact: &'a ContactNodes) -> Self {
        self.contact = Some(contact);
        self
    }

    /// Sets how the rows of `B` are built. Default: orthonormal.
    #[must_use]
    pub fn rule(mut self, rule: RowRule) -> Self {
        self.rule = rule;
        self
    }

    /// Sets whether translates share their matrices. Default: they do.
    #[must_use]
    pub fn sharing(mut self, sharing: Sharing) -> Self {
        self.sharing = sharing;
        self
    }

    /// Sets how the generalised inverses are chosen.
    #[must_use]
    pub fn inverse(mut self, settings: InverseSettings) -> Self {
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
        let mut clock = Clock(Instant::now());
        let classes = match self.earlier {
            Some(earlier) => {
                let own = decomposition.subdomains().len();
                check("subdomains", own, earlier.subdomains())?;
                check(
                    "torn unknowns",
                    decomposition.torn_dofs(),
                    earlier.torn_dim(),
                )?;
                for (s, subdomain) in decomposition.subdomains().iter().enumerate() {
                    let expected = earlier.torn_range(s).len() / 3;
                    check("nodes in a subdomain", subdomain.nodes.len(), expected)?;
                }
                earlier.parts.classes.clone()
            }
            None => Arc::new(Classes::find(
                mesh,
                decomposition,
                self.materials,
                self.sharing,
            )?),
        };
        let classes_seconds = clock.lap();
        let bases = match self.earlier {
            Some(earlier) => earlier.parts.bases.clone(),
            None => Arc::new(assemble(mesh, decomposition, self.materials, &classes)?),
        };
        let assembly_seconds = clock.lap();
        let heterogeneous = has_several_laws(mesh, self.materials);
        let stiffness = if heterogeneous {
            CopyStiffness::new(&classes, &bases)
        } else {
            CopyStiffness::default()
        };
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
        let factors = self.earlier.map(|earlier| &earlier.parts.inverses[..]);
        let centres: Vec<[f64; 3]> = decomposition
            .subdomains()
            .iter()
            .map(|s| mean(s.nodes.iter().map(|&n| mesh.points()[n as usize])))
            .collect();
        let started = Instant::now();
        let ((inverses, inverse_seconds), coarse) = rayon::join(
            || {
                let inverses = invert(&classes, &bases, &map, &self.inverse, factors);
                (inverses, started.elapsed().as_secs_f64())
            },
            || {
                let parts = (map.clone(), bases.clone(), classes.clone(), gluing.clone());
                let coarse = Coarse::new(parts.0, parts.1, parts.2, parts.3, centres)?;
                let factor = coarse.factor()?;
                Ok::<_, TfetiError>((coarse, factor))
            },
        );
        let inverses = Arc::new(inverses?);
        let (coarse, factor) = coarse?;
        let coarse_seconds = (clock.lap() - inverse_seconds).max(0.0);
        let dual = DualOperator::new(map.clone(), bases.clone(), inverses.clone());
        let mut offsets = vec![0];
        for subdomain in decomposition.subdomains() {
            offsets.push(offsets[offsets.len() - 1] + 3 * subdomain.nodes.len());
        }
        let report = SetupReport {
            subdomains: classes.subdomains(),
            classes: crate::report::class_reports(&classes, &map, &inverses),
            primal_unknowns: decomposition.torn_dofs(),
            rows: gluing.ranges().clone(),
            rows_as_paper: gluing.rows_as_paper(),
            removed: crate::rows::count_removed(gluing.removed()),
            inverse_bytes: inverses.iter().map(ClassInverse::bytes).sum(),
            coarse_bytes: 8 * coarse.factor_size() as u64,
            table_bytes: map.bytes(),
            factorisations: 1 + if factors.is_some() { 0 } else { bases.len() },
            free_motions: factor
                .free_motions()
                .iter()
                .map(ToString::to_string)
                .collect(),
            classes_seconds,
            gluing_seconds,
            assembly_seconds,
            inverse_seconds,
            coarse_seconds,
        };
        let node_of = decomposition
            .subdomains()
            .iter()
            .flat_map(|s| s.nodes.iter().copied())
            .collect();
        let nodes = mesh.points().len();
        let parts = Parts {
            classes,
            gluing,
            map,
            bases,
            inverses,
            offsets,
        };
        Ok(Tfeti {
            parts,
            dual,
            coarse,
            factor,
            report,
            node_of,
            nodes,
            heterogeneous,
            stiffness,
        })
    }
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
    /// Whether elements differ in their Hooke tensors.
    pub(crate) heterogeneous: bool,
    stiffness: CopyStiffness,
}

impl Tfeti {
    /// The rows of `B`.
    #[must_use]
    pub fn gluing(&self) -> &Gluing {
        &self.parts.gluing
    }

    /// How the copies of a node count in contact and support rows.
    #[must_use]
    pub fn copy_stiffness(&self) -> &CopyStiffness {
        &self.stiffness
    }

    /// The stiffness of the copies of each node, whether or not they differ in their materials.
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
    #[must_use]
    pub fn torn_range(&self, subdomain: usize) -> std::ops::Range<usize> {
        self.parts.offsets[subdomain]..self.parts.offsets[subdomain + 1]
    }

    /// Rigid motions of a subdomain.
    #[must_use]
    pub fn kernel(&self, subdomain: usize) -> &Kernel {
        &self.parts.bases[self.parts.classes.place(subdomain).0].kernel
    }
}
