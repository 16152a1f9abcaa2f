//! The matrices of the subdomains: stiffness and kernel, one set a class.

use crate::error::TfetiError;
use crate::linalg::block_rows::BlockRows;
use crate::linalg::sparse::Columns;
use crate::subdomain::class::{Class, Classes};
use crate::subdomain::kernel::Kernel;
use rayon::prelude::*;
use signorini_fem_mesh::{Decomposition, Hooke, Materials, TetMesh, assemble_stiffness};
use std::sync::OnceLock;

/// All subdomains with their matrices.
#[derive(Debug)]
pub(crate) struct Subdomains {
    pub(crate) classes: Classes,
    /// One for each class.
    pub(crate) bases: Vec<ClassBase>,
}

/// Stiffness and kernel of a class.
#[derive(Debug)]
pub(crate) struct ClassBase {
    pub(crate) stiffness: Columns,
    /// The same for products with several members, made when first needed.
    pub(crate) blocks: OnceLock<BlockRows>,
    pub(crate) kernel: Kernel,
    /// What preconditioners are made of where the material is nearly incompressible and elements do not lock: the
    /// stiffness of a compressible one. With its own they would need many times more iterations.
    pub(crate) compressible: Option<Columns>,
}

impl ClassBase {
    /// The stiffness that preconditioners are made of.
    pub(crate) fn preconditioning(&self) -> &Columns {
        self.compressible.as_ref().unwrap_or(&self.stiffness)
    }
}

impl Subdomains {
    /// Assembles stiffness and kernel of every class from its first member.
    pub(crate) fn assemble(
        mesh: &TetMesh,
        decomposition: &Decomposition,
        materials: &Materials,
        classes: Classes,
    ) -> Result<Self, TfetiError> {
        let base = |class: &Class| {
            let s = class.members[0] as usize;
            let subdomain = &decomposition.subdomains()[s];
            let nodes = subdomain.nodes.iter();
            let points: Vec<[f64; 3]> = nodes.map(|&n| mesh.points()[n as usize]).collect();
            let elements = subdomain.elements.iter();
            let regions: Vec<u32> = elements.map(|&e| mesh.regions()[e as usize]).collect();
            let element = subdomain.elements[0] as usize;
            let material = |message| TfetiError::Material { element, message };
            let hooke = materials.of_tets(&regions).map_err(|e| material(e.to_string()))?;
            let assemble = |laws: &[&Hooke]| {
                let matrix = if subdomain.mids.is_empty() {
                    assemble_stiffness(&points, &subdomain.tets, |t| laws[t])
                } else {
                    assemble_stiffness(&points, &subdomain.quadratic_tets(), |t| laws[t])
                };
                let matrix = matrix.map_err(|e| material(e.to_string()))?;
                Ok::<_, TfetiError>(Columns::from_symmetric(&matrix))
            };
            let softer = || hooke.iter().map(|law| law.compressible()).collect::<Vec<_>>();
            let softer = (!subdomain.mids.is_empty()).then(softer);
            let softer = softer.filter(|laws| laws.iter().any(Option::is_some));
            let compressible = softer.map(|softer| {
                let laws = softer
                    .iter()
                    .zip(&hooke)
                    .map(|(soft, &law)| soft.as_ref().unwrap_or(law));
                assemble(&laws.collect::<Vec<_>>())
            });
            Ok(ClassBase {
                stiffness: assemble(&hooke)?,
                compressible: compressible.transpose()?,
                blocks: OnceLock::new(),
                kernel: Kernel::new(&points, s)?,
            })
        };
        let bases = classes.classes().par_iter().map(base).collect::<Result<_, _>>()?;
        Ok(Self { classes, bases })
    }

    /// Number of subdomains.
    pub(crate) fn count(&self) -> usize {
        self.classes.subdomains()
    }

    /// Class of a subdomain.
    pub(crate) fn class(&self, subdomain: usize) -> usize {
        self.classes.place(subdomain).0
    }

    /// Matrices of a subdomain.
    pub(crate) fn of(&self, subdomain: usize) -> &ClassBase {
        &self.bases[self.class(subdomain)]
    }

    /// Rigid motions of a subdomain.
    pub(crate) fn kernel(&self, subdomain: usize) -> &Kernel {
        &self.of(subdomain).kernel
    }
}
