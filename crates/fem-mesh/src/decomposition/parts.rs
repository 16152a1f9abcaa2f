//! Subdomains by part numbers of the tetrahedra.

use crate::mesh::{NONE, TetMesh, connected_sets};
use crate::tables::{count_of, distinct};
use crate::vec3;

use super::subdomains::{Decomposition, DecompositionError};

impl Decomposition {
    /// Takes the part number of each tetrahedron, from a graph partitioner for instance. The
    /// numbers run from 0 without gaps.
    ///
    /// # Errors
    /// [`DecompositionError`] if there is not one number for each tetrahedron, a part is empty, or
    /// a part is not connected (see [`split_disconnected`]).
    pub fn from_parts(mesh: &TetMesh, parts: &[u32]) -> Result<Self, DecompositionError> {
        expect_parts(mesh, parts)?;
        let count = count_of(parts);
        // of more parts than tetrahedra one of the first is empty
        let part = first_gap(parts, count.min(parts.len()));
        if part < count {
            return Err(DecompositionError::EmptyPart { part, parts: count });
        }
        let pieces = split_by(mesh, parts);
        // The piece in which each part starts; a second piece is an error.
        let mut start = vec![(NONE, 0); count];
        for (tet, (&part, &piece)) in parts.iter().zip(&pieces).enumerate() {
            let (begun, first) = start[part as usize];
            if begun == NONE {
                start[part as usize] = (piece, tet);
            } else if begun != piece {
                let of_part = pieces.iter().zip(parts).filter(|(_, p)| **p == part);
                return Err(DecompositionError::DisconnectedPart {
                    part: part as usize,
                    pieces: distinct(of_part.map(|(piece, _)| piece)).len(),
                    first,
                    second: tet,
                });
            }
        }
        Ok(Self::build(mesh, parts.to_vec()))
    }
}

/// Gives every piece of a part that is not connected through faces a part number of its own. The
/// pieces are numbered anew, by the smallest tetrahedron of each; the result has no gaps, so
/// [`Decomposition::from_parts`] accepts it.
///
/// # Errors
/// [`DecompositionError::PartCount`] if there is not one number for each tetrahedron.
pub fn split_disconnected(mesh: &TetMesh, parts: &[u32]) -> Result<Vec<u32>, DecompositionError> {
    expect_parts(mesh, parts)?;
    Ok(split_by(mesh, parts))
}

pub(super) fn split_by(mesh: &TetMesh, parts: &[u32]) -> Vec<u32> {
    connected_sets(mesh.neighbour_table(), |a, b| parts[a] == parts[b])
}

/// The same parts, numbered without gaps by their first tetrahedra.
pub(super) fn renumbered(parts: &[u32]) -> Vec<u32> {
    let mut number = vec![NONE; count_of(parts)];
    let mut next = 0;
    let new = |&part: &u32| {
        let number = &mut number[part as usize];
        if *number == NONE {
            *number = next;
            next += 1;
        }
        *number
    };
    parts.iter().map(new).collect()
}

/// The first number below `limit` that is not among the parts, else `limit`.
fn first_gap(parts: &[u32], limit: usize) -> usize {
    let mut found = vec![false; limit];
    for &part in parts {
        if let Some(f) = found.get_mut(part as usize) {
            *f = true;
        }
    }
    found.iter().position(|&f| !f).unwrap_or(limit)
}

/// Checks that there is one number for each tetrahedron.
pub(super) fn expect_parts(mesh: &TetMesh, parts: &[u32]) -> Result<(), DecompositionError> {
    let (given, tets) = (parts.len(), mesh.tets().len());
    if given != tets {
        return Err(DecompositionError::PartCount { given, tets });
    }
    Ok(())
}

/// Volume and surface of each part, by numbers from zero. Of a rod four times their ratio is the thickness.
#[doc(hidden)]
#[must_use]
pub fn volumes_and_surfaces(mesh: &TetMesh, parts: &[u32]) -> Vec<[f64; 2]> {
    let mut out = vec![[0.0; 2]; count_of(parts)];
    for (tet, &part) in parts.iter().enumerate() {
        let (corners, [volume, surface]) = (mesh.tet_points(tet), &mut out[part as usize]);
        *volume += vec3::tet_volume(&corners);
        for (face, other) in mesh.neighbours(tet).into_iter().enumerate() {
            if other.is_none_or(|other| parts[other] != part) {
                *surface += vec3::norm(vec3::area_vector(&[1, 2, 3].map(|k| corners[(face + k) % 4])));
            }
        }
    }
    out
}
