//! How the body is cut into subdomains.

use std::collections::HashMap;

use crate::error::ContactError;
use signorini_fem_mesh::decomposition::{PartCount, compact_parts, even_parts};
use signorini_fem_mesh::{Decomposition, Materials, TetMesh};

/// Tetrahedra of a subdomain that a scene without a partition asks for. From 400 to 1500 the work is much the same.
const TETS: usize = 700;

/// The same of quadratic tetrahedra: about as many unknowns.
const QUADRATIC: usize = 120;

/// Most subdomains that a scene without a partition is cut into: up to so many, one factor serves their rigid motions,
/// without a second level.
const MOST: usize = 1000;

/// How the mesh is partitioned into subdomains.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Partition {
    /// Parts of several hundred tetrahedra each, by [`even_parts`]; materials are not mixed. A mesh with less than 1400
    /// tetrahedra, or 240 of order 2, has one part a body, whatever its materials; rods are cut in lengths.
    Automatic,
    /// As [`Partition::Automatic`], with this number of parts.
    Subdomains(usize),
    /// One subdomain per body.
    Whole,
    /// A grid of boxes in the bounding box, by element centroids (see [`Decomposition::boxes`]).
    Boxes([usize; 3]),
    /// A part number for every element, for instance from a graph partitioner; [`compact_parts`] makes the parts
    /// compact. Materials are mixed only where a given part mixes them.
    Parts(Vec<u32>),
    /// A part number for every element, used unchanged: consecutive numbers, connected parts.
    AsGiven(Vec<u32>),
}

impl Partition {
    /// The subdomains of a mesh; refuses a zero count, and where parts are to stay as they are,
    /// numbers with gaps and parts in pieces.
    pub(crate) fn decompose(&self, mesh: &TetMesh, materials: &Materials) -> Result<Decomposition, ContactError> {
        let cut = |groups: &[u32], count| -> Result<Decomposition, ContactError> {
            let parts = even_parts(mesh, groups, count)?;
            Ok(Decomposition::from_parts(mesh, &parts)?)
        };
        let even = |count| cut(&same_material(mesh, materials)?, count);
        let tets = mesh.tets().len();
        let own = if mesh.order() == 2 { QUADRATIC } else { TETS };
        match self {
            // bodies in one piece, but for cracks and rods
            Self::Automatic if tets < 2 * own => cut(&vec![0; tets], PartCount::About(1)),
            Self::Automatic => even(PartCount::About((tets / own).min(MOST))),
            Self::Subdomains(count) => even(PartCount::Exactly(*count)),
            Self::Whole => Ok(Decomposition::whole(mesh)),
            Self::Boxes(boxes) => Ok(Decomposition::boxes(mesh, *boxes)?),
            Self::Parts(parts) => {
                let mut groups = same_material(mesh, materials)?;
                let parts_of: HashMap<u32, u32> = parts.iter().copied().zip(groups.iter().copied()).collect();
                if parts.iter().zip(&groups).any(|(part, group)| parts_of[part] != *group) {
                    groups.fill(0);
                }
                Ok(Decomposition::from_parts(mesh, &compact_parts(mesh, &groups, parts)?)?)
            }
            Self::AsGiven(parts) => Ok(Decomposition::from_parts(mesh, parts)?),
        }
    }
}

/// A label for each tetrahedron: the first region of the same material.
fn same_material(mesh: &TetMesh, materials: &Materials) -> Result<Vec<u32>, ContactError> {
    let regions = mesh.distinct_regions();
    let laws = materials.of_tets(&regions)?;
    let first: Vec<u32> = laws
        .iter()
        .map(|law| laws.iter().position(|other| other == law).unwrap_or(0) as u32)
        .collect();
    let label = |region: &u32| first[regions.partition_point(|known| known < region)];
    Ok(mesh.regions().iter().map(label).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_fem_mesh::{Brick, Hooke};

    #[test]
    fn given_parts_are_made_compact_and_mix_materials_only_where_they_did() {
        let mesh = Brick::new([2.0, 1.0, 1.0], [8, 4, 4]).build().expect("mesh");
        let centre = |tet: usize| mesh.tet_points(tet).iter().map(|p| p[0]).sum::<f64>() / 4.0;
        let tets = mesh.tets().len();
        let regions: Vec<u32> = (0..tets).map(|tet| u32::from(centre(tet) > 0.7)).collect();
        let mesh = mesh.clone().with_regions(regions.clone()).expect("regions");
        let steel = Hooke::isotropic(2e11, 0.3).expect("steel");
        let rubber = Hooke::isotropic(1e7, 0.45).expect("rubber");
        let materials = Materials::new(vec![(0, steel), (1, rubber)]).expect("table");
        let mixed = |parts: &[u32]| {
            let cut = Partition::Parts(parts.to_vec())
                .decompose(&mesh, &materials)
                .expect("cut");
            let mut out = vec![(0, 0); cut.subdomains().len()];
            for (&part, &region) in cut.parts().iter().zip(&regions) {
                let (all, rubber) = &mut out[part as usize];
                (*all, *rubber) = (*all + 1, *rubber + region);
            }
            out
        };
        // crumbs of each material, with gaps in the numbers
        let crumbs: Vec<u32> = (0..tets)
            .map(|tet| 10 * (2 * (tet as u32 % 3) + regions[tet]))
            .collect();
        let cut = mixed(&crumbs);
        assert!(cut.iter().all(|&(all, rubber)| rubber == 0 || rubber == all), "{cut:?}");
        let scattered = Partition::AsGiven(crumbs).decompose(&mesh, &materials);
        assert!(scattered.is_err(), "parts as given hang together");
        // slabs across the boundary of the materials stay across it
        let slabs: Vec<u32> = (0..tets).map(|tet| u32::from(centre(tet) > 1.0)).collect();
        let cut = mixed(&slabs);
        assert!(
            cut.len() == 2 && cut.iter().any(|&(all, rubber)| 0 < rubber && rubber < all),
            "{cut:?}"
        );
    }
}
