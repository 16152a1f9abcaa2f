//! The matrices of the subdomains: stiffness and kernel, one set a class.

use crate::error::TfetiError;
use crate::linalg::block_rows::BlockRows;
use crate::linalg::sparse::Columns;
use crate::subdomain::class::{Class, Classes};
use crate::subdomain::held::Held;
use crate::subdomain::inverse::regularised;
use crate::subdomain::kernel::Kernel;
use crate::subdomain::ownership::Ownership;
use rayon::prelude::*;
use signorini_fem_mesh::{Decomposition, Hooke, Materials, TetMesh, assemble_stiffness};
use std::borrow::Cow;
use std::sync::OnceLock;

/// All subdomains with their matrices.
#[derive(Debug)]
pub(crate) struct Subdomains {
    pub(crate) classes: Classes,
    pub(crate) ownership: Ownership,
    /// One for each class.
    pub(crate) bases: Vec<ClassBase>,
}

/// What is known of a class: its matrices where this rank holds them.
#[derive(Debug)]
pub(crate) struct ClassBase {
    pub(crate) held: Option<ClassMatrices>,
    /// Of the stiffness that preconditioners are made of.
    pub(crate) diagonal: Vec<f64>,
    /// Smallest and largest shear modulus of its elements, the mean of three; `None` of a rigid class.
    pub(crate) moduli: Option<[f64; 2]>,
    pub(crate) kernel: Kernel,
}

/// Stiffness of a class.
#[derive(Debug)]
pub(crate) struct ClassMatrices {
    pub(crate) stiffness: Columns,
    /// The same for products with several members, made when first needed.
    pub(crate) blocks: OnceLock<BlockRows>,
    /// What preconditioners are made of where the material is nearly incompressible and elements do not lock: the
    /// stiffness of a compressible one. With its own they would need many times more iterations.
    pub(crate) compressible: Option<Columns>,
    /// What supports hold.
    pub(crate) held: Option<Held>,
}

impl ClassMatrices {
    /// The stiffness that preconditioners are made of.
    pub(crate) fn preconditioning(&self) -> Cow<'_, Columns> {
        let own = self.compressible.as_ref().unwrap_or(&self.stiffness);
        self.held
            .as_ref()
            .map_or(Cow::Borrowed(own), |held| Cow::Owned(held.stiffened(own)))
    }

    /// A positive definite matrix whose inverse is a generalised one of the stiffness.
    pub(crate) fn regularised(&self, kernel: &Kernel) -> Columns {
        match &self.held {
            None => regularised(&self.stiffness, kernel),
            Some(held) => held.regularised(&self.stiffness),
        }
    }
}

impl Subdomains {
    /// Assembles kernel and, where this rank holds it, stiffness of every class from its first member.
    pub(crate) fn assemble(
        mesh: &TetMesh,
        decomposition: &Decomposition,
        materials: &Materials,
        classes: Classes,
        ownership: Ownership,
    ) -> Result<Self, TfetiError> {
        let laws = |class: &Class| {
            let subdomain = &decomposition.subdomains()[class.members[0] as usize];
            let elements = subdomain.elements.iter();
            let regions: Vec<u32> = elements.map(|&e| mesh.regions()[e as usize]).collect();
            let laws = materials.of_tets(&regions);
            laws.map_err(|e| TfetiError::Material {
                element: subdomain.elements.first().map_or(0, |&e| e as usize),
                message: e.to_string(),
            })
        };
        let matrices = |class: &Class, points: &[[f64; 3]], kernel: &Kernel, hooke: &[&Hooke]| {
            let s = class.members[0] as usize;
            let subdomain = &decomposition.subdomains()[s];
            let element = subdomain.elements[0] as usize;
            let material = |message| TfetiError::Material { element, message };
            let assemble = |laws: &[&Hooke]| {
                let matrix = if subdomain.mids.is_empty() {
                    assemble_stiffness(points, &subdomain.tets, |t| laws[t])
                } else {
                    assemble_stiffness(points, &subdomain.quadratic_tets(), |t| laws[t])
                };
                let matrix = matrix.map_err(|e| material(e.to_string()))?;
                Ok::<_, TfetiError>(Columns::from_symmetric(&matrix))
            };
            let softer: Vec<_> = hooke.iter().map(|law| law.compressible()).collect();
            let compressible = softer.iter().any(Option::is_some).then(|| {
                let laws = softer
                    .iter()
                    .zip(hooke)
                    .map(|(soft, &law)| soft.as_ref().unwrap_or(law));
                assemble(&laws.collect::<Vec<_>>())
            });
            let stiffness = assemble(hooke)?;
            Ok::<_, TfetiError>(ClassMatrices {
                held: Held::new(&stiffness, kernel, &class.held),
                stiffness,
                compressible: compressible.transpose()?,
                blocks: OnceLock::new(),
            })
        };
        let base = |(k, class): (usize, &Class)| {
            let s = class.members[0] as usize;
            let nodes = decomposition.subdomains()[s].nodes.iter();
            let points: Vec<[f64; 3]> = nodes.map(|&n| mesh.points()[n as usize]).collect();
            let (laws, kernel) = (laws(class)?, Kernel::new(&points, s)?);
            let shear = |law: &&Hooke| (3..6).map(|i| law.voigt()[i][i]).sum::<f64>() / 3.0;
            let held = (ownership.holds(k) && !class.is_rigid).then(|| matrices(class, &points, &kernel, &laws));
            let held = held.transpose()?;
            let moduli = laws.iter().map(shear);
            let diagonal = |m: &ClassMatrices| {
                let own = m.preconditioning();
                (0..own.dim).map(|i| own.diagonal(i)).collect()
            };
            Ok(ClassBase {
                diagonal: held.as_ref().map_or_else(|| vec![0.0; 3 * class.nodes], diagonal),
                held,
                moduli: moduli.map(|v| [v; 2]).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]),
                kernel,
            })
        };
        let each = classes.classes().par_iter().enumerate();
        let mut bases: Vec<ClassBase> = each.map(base).collect::<Result<_, TfetiError>>()?;
        share_diagonals(&ownership, &mut bases);
        Ok(Self {
            classes,
            ownership,
            bases,
        })
    }

    /// The matrices of a class, if this rank holds them.
    pub(crate) fn held(&self, class: usize) -> Option<&ClassMatrices> {
        self.bases[class].held.as_ref()
    }

    pub(crate) fn count(&self) -> usize {
        self.classes.subdomains()
    }

    pub(crate) fn class(&self, subdomain: usize) -> usize {
        self.classes.place(subdomain).0
    }

    pub(crate) fn rank_of(&self, subdomain: usize) -> usize {
        let (class, member) = self.classes.place(subdomain);
        self.ownership.rank_of(class, member)
    }

    /// Matrices of a subdomain.
    pub(crate) fn of(&self, subdomain: usize) -> &ClassBase {
        &self.bases[self.class(subdomain)]
    }

    pub(crate) fn kernel(&self, subdomain: usize) -> &Kernel {
        &self.of(subdomain).kernel
    }
}

/// Brings the diagonals of all classes to all ranks.
fn share_diagonals(ownership: &Ownership, bases: &mut [ClassBase]) {
    let (mut all, mut pieces) = (Vec::new(), Vec::new());
    for (class, base) in bases.iter().enumerate() {
        let start = all.len();
        all.extend_from_slice(&base.diagonal);
        pieces.push((ownership.rank_of(class, 0), start..all.len()));
    }
    ownership.exchange.complete(&mut all, &pieces);
    for (base, (_, range)) in bases.iter_mut().zip(pieces) {
        base.diagonal.copy_from_slice(&all[range]);
    }
}
