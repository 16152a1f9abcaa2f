//! The matrices of one class: stiffness, kernel and generalised inverse.

use crate::dual::boundary::BoundaryMap;
use crate::error::TfetiError;
use crate::linalg::block_rows::BlockRows;
use crate::linalg::sparse::{Columns, Symbolic};
use crate::subdomain::class::Classes;
use crate::subdomain::cost::{InverseSettings, Size, choose};
use crate::subdomain::inverse::{Inverse, pattern_error, regularised};
use crate::subdomain::kernel::Kernel;
use rayon::prelude::*;
use signorini_fem_mesh::{Decomposition, Materials, TetMesh, assemble_stiffness};
use std::sync::OnceLock;

/// Stiffness and kernel of a class.
#[derive(Debug)]
pub(crate) struct ClassBase {
    pub(crate) stiffness: Columns,
    /// The same for products with several members, made when first needed.
    pub(crate) blocks: OnceLock<BlockRows>,
    pub(crate) kernel: Kernel,
}

/// Generalised inverse of a class.
#[derive(Debug)]
pub(crate) struct ClassInverse {
    /// Inverse of the whole matrix, for loads and recovery.
    pub(crate) full: Inverse,
    /// Dense inverse on the boundary, for products; `None` if products use the sparse factor.
    pub(crate) boundary: Option<Vec<f64>>,
}

impl ClassInverse {
    pub(crate) fn bytes(&self) -> u64 {
        8 * (self.full.stored() + self.boundary.as_ref().map_or(0, Vec::len)) as u64
    }
}

/// Assembles stiffness and kernel of every class from its representative.
pub(crate) fn assemble(
    mesh: &TetMesh,
    decomposition: &Decomposition,
    materials: &Materials,
    classes: &Classes,
) -> Result<Vec<ClassBase>, TfetiError> {
    classes
        .classes()
        .par_iter()
        .map(|class| {
            let s = class.members[0] as usize;
            let subdomain = &decomposition.subdomains()[s];
            let points: Vec<[f64; 3]> = subdomain
                .nodes
                .iter()
                .map(|&n| mesh.points()[n as usize])
                .collect();
            let regions: Vec<u32> = subdomain
                .elements
                .iter()
                .map(|&e| mesh.regions()[e as usize])
                .collect();
            let material = |message: String| TfetiError::Material {
                element: subdomain.elements[0] as usize,
                message,
            };
            let hooke = materials
                .of_tets(&regions)
                .map_err(|e| material(e.to_string()))?;
            let matrix = assemble_stiffness(&points, &subdomain.tets, |t| hooke[t])
                .map_err(|e| material(e.to_string()))?;
            Ok(ClassBase {
                stiffness: Columns::from_symmetric(&matrix),
                blocks: OnceLock::new(),
                kernel: Kernel::new(&points, s)?,
            })
        })
        .collect()
}

fn symbolic(base: &ClassBase, subdomain: usize) -> Result<Symbolic, TfetiError> {
    Symbolic::new(&regularised(&base.stiffness, &base.kernel), 3)
        .map_err(|e| pattern_error(e, subdomain))
}

/// Chooses and computes the inverses of all classes; with the factors of another system of the same classes, if there is one.
pub(crate) fn invert(
    classes: &Classes,
    bases: &[ClassBase],
    map: &BoundaryMap,
    settings: &InverseSettings,
    earlier: Option<&[ClassInverse]>,
) -> Result<Vec<ClassInverse>, TfetiError> {
    let start = |k: usize| {
        if let Some(earlier) = earlier {
            return Ok(Start::Factor(&earlier[k].full));
        }
        let subdomain = classes.classes()[k].members[0] as usize;
        symbolic(&bases[k], subdomain).map(Start::Symbolic)
    };
    let starts: Vec<Start<'_>> = (0..bases.len())
        .into_par_iter()
        .map(start)
        .collect::<Result<_, _>>()?;
    let sizes: Vec<Size> = (0..bases.len())
        .map(|k| Size {
            dim: bases[k].stiffness.dim,
            boundary: 3 * map.classes[k].nodes.len(),
            members: map.classes[k].members.len(),
            factor: starts[k].stored(),
        })
        .collect();
    let dense = choose(&sizes, settings)?;
    (0..bases.len())
        .into_par_iter()
        .map(|k| {
            let base = &bases[k];
            let subdomain = classes.classes()[k].members[0] as usize;
            let project = settings.moore_penrose || dense[k];
            let full = match &starts[k] {
                // a packed factor has no products with many columns
                Start::Factor(full) if !(dense[k] && full.is_packed()) => {
                    full.with_projection(project)
                }
                Start::Factor(_) => {
                    let symbolic = symbolic(base, subdomain)?;
                    Inverse::new(&base.stiffness, &base.kernel, &symbolic, project, subdomain)?
                }
                Start::Symbolic(symbolic) => {
                    Inverse::new(&base.stiffness, &base.kernel, symbolic, project, subdomain)?
                }
            };
            let boundary =
                dense[k].then(|| full.boundary_block(&base.kernel, &map.classes[k].nodes));
            let single = sizes[k].members == 1 && boundary.is_none();
            let full = if single {
                full.packed(&base.stiffness)
            } else {
                full
            };
            Ok(ClassInverse { full, boundary })
        })
        .collect()
}

/// What an inverse is made from.
enum Start<'a> {
    /// The pattern of the factor.
    Symbolic(Symbolic),
    /// The factor of an earlier system.
    Factor(&'a Inverse),
}

impl Start<'_> {
    /// Numbers stored for the factor.
    fn stored(&self) -> usize {
        match self {
            Self::Symbolic(symbolic) => symbolic.stored(),
            Self::Factor(inverse) => inverse.stored(),
        }
    }
}
