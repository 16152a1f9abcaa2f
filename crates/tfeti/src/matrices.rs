//! The matrices of one class: stiffness, kernel and generalised inverse.

use crate::boundary::BoundaryMap;
use crate::class::Classes;
use crate::cost::{InverseSettings, Size, choose};
use crate::error::TfetiError;
use crate::inverse::{Inverse, pattern_error, regularised};
use crate::kernel::Kernel;
use crate::sparse::{Columns, Symbolic};
use rayon::prelude::*;
use signorini_fem_mesh::{Decomposition, Materials, TetMesh, assemble_stiffness};

/// Stiffness and kernel of a class.
#[derive(Debug)]
pub(crate) struct ClassBase {
    pub(crate) stiffness: Columns,
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
                kernel: Kernel::new(&points, s)?,
            })
        })
        .collect()
}

/// Chooses and computes the inverses of all classes.
pub(crate) fn invert(
    classes: &Classes,
    bases: &[ClassBase],
    map: &BoundaryMap,
    settings: &InverseSettings,
) -> Result<Vec<ClassInverse>, TfetiError> {
    let symbolic: Vec<Symbolic> = (0..bases.len())
        .into_par_iter()
        .map(|k| {
            let subdomain = classes.classes()[k].members[0] as usize;
            Symbolic::new(&regularised(&bases[k].stiffness, &bases[k].kernel), 3)
                .map_err(|e| pattern_error(e, subdomain))
        })
        .collect::<Result<_, _>>()?;
    let sizes: Vec<Size> = (0..bases.len())
        .map(|k| Size {
            dim: bases[k].stiffness.dim,
            boundary: 3 * map.classes[k].nodes.len(),
            members: map.classes[k].members.len(),
            factor: symbolic[k].stored(),
        })
        .collect();
    let dense = choose(&sizes, settings)?;
    (0..bases.len())
        .into_par_iter()
        .map(|k| {
            let base = &bases[k];
            let subdomain = classes.classes()[k].members[0] as usize;
            let project = settings.moore_penrose || dense[k];
            let full = Inverse::new(
                &base.stiffness,
                &base.kernel,
                &symbolic[k],
                project,
                subdomain,
            )?;
            let boundary =
                dense[k].then(|| full.boundary_block(&base.kernel, &map.classes[k].nodes));
            let single = sizes[k].members == 1 && boundary.is_none();
            let full = if single { full.packed() } else { full };
            Ok(ClassInverse { full, boundary })
        })
        .collect()
}
