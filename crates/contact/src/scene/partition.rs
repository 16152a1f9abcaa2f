//! How the body is cut into subdomains.

use crate::error::ContactError;
use signorini_fem_mesh::decomposition::{PartCount, even_parts};
use signorini_fem_mesh::{Decomposition, Materials, TetMesh};

/// Tetrahedra of a subdomain that a scene without a partition asks for. From 400 to 1500 the work is much the same.
const TETS: usize = 700;

/// The same of quadratic tetrahedra: about as many unknowns.
const QUADRATIC: usize = 120;

/// Most subdomains that a scene without a partition is cut into: their rigid motions are one problem, solved in each
/// iteration.
const MOST: usize = 1000;

/// How the body is cut into subdomains.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Partition {
    /// Into parts of some hundred tetrahedra each, by [`even_parts`]; materials are not mixed. Less than 1400
    /// tetrahedra, 240 of order 2, are one part.
    Automatic,
    /// As [`Partition::Automatic`], into so many.
    Subdomains(usize),
    /// Not at all: one subdomain a body.
    Whole,
    /// Into boxes of the bounding box, by element centroids (see [`Decomposition::boxes`]).
    Boxes([usize; 3]),
    /// By the given part number of every element.
    Parts(Vec<u32>),
}

impl Partition {
    /// The subdomains of a mesh; refuses a zero count, and part numbers with gaps or disconnected parts.
    pub(crate) fn decompose(&self, mesh: &TetMesh, materials: &Materials) -> Result<Decomposition, ContactError> {
        let even = |count| -> Result<Decomposition, ContactError> {
            let parts = even_parts(mesh, &same_material(mesh, materials)?, count)?;
            Ok(Decomposition::from_parts(mesh, &parts)?)
        };
        let tets = mesh.tets().len();
        let own = if mesh.order() == 2 { QUADRATIC } else { TETS };
        match self {
            Self::Automatic if tets < 2 * own => Ok(Decomposition::whole(mesh)),
            Self::Automatic => even(PartCount::About((tets / own).min(MOST))),
            Self::Subdomains(count) => even(PartCount::Exactly(*count)),
            Self::Whole => Ok(Decomposition::whole(mesh)),
            Self::Boxes(boxes) => Ok(Decomposition::boxes(mesh, *boxes)?),
            Self::Parts(parts) => Ok(Decomposition::from_parts(mesh, parts)?),
        }
    }
}

/// A label for each tetrahedron: the first region of the same material.
fn same_material(mesh: &TetMesh, materials: &Materials) -> Result<Vec<u32>, ContactError> {
    let mut regions = mesh.regions().to_vec();
    regions.sort_unstable();
    regions.dedup();
    let laws = materials.of_tets(&regions)?;
    let first: Vec<u32> = laws
        .iter()
        .map(|law| laws.iter().position(|other| other == law).unwrap_or(0) as u32)
        .collect();
    let label = |region: &u32| first[regions.partition_point(|known| known < region)];
    Ok(mesh.regions().iter().map(label).collect())
}
