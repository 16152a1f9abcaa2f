//! Partners: which node of the other body a contact node may touch.
//!
//! Meshes match, so that the partner of a node lies on its normal. What is small against the facets is put down to rounding
//! and to the normals of curved surfaces. Nodes on sides that do not face each other are no partners: a thin body has nodes of
//! its far side on the same normal.

use crate::contact_surface::{Contact, Gap};
use crate::error::ContactError;
use rayon::prelude::*;
use signorini_fem_mesh::{Frame, Surface, TetMesh};
use std::collections::HashMap;

/// Distance of a partner from the normal, over the size of the facets (the root of the area of a node), that is allowed.
const BESIDE: f64 = 0.02;

/// Cosine between a normal and that of the other side reversed above which they face each other.
const FACING: f64 = 0.1;

/// Depth of measured overlap over the size of the facets from which on a node belongs to some far side: interference is small.
const DEEP: f64 = 1.0;

/// Gaps below this share of the largest coordinate are rounding errors.
const ROUNDING: f64 = 1e-12;

/// The partner of a contact node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Partner {
    pub(crate) node: u32,
    /// Distance along the normal of the contact node, m; negative where the bodies overlap.
    pub(crate) gap: f64,
}

/// The partners of the nodes of a surface, node by node; none where the contact is with a rigid obstacle. `fixed` is the
/// frame of a contact with one direction.
pub(crate) fn partners(
    mesh: &TetMesh,
    index: usize,
    contact: &Contact,
    surface: &Surface,
    fixed: Option<&Frame>,
) -> Result<Vec<Partner>, ContactError> {
    if contact.partner.is_empty() {
        return Ok(Vec::new());
    }
    let other = Surface::new(mesh, &contact.partner)?;
    let largest = |m: f64, v: &f64| m.max(v.abs());
    let rounding = ROUNDING * mesh.points().iter().flatten().fold(0.0, largest);
    let found: Result<Vec<Partner>, ContactError> = surface
        .nodes()
        .par_iter()
        .enumerate()
        .map(|(local, &node)| {
            let normal = fixed.unwrap_or(&surface.frames()[local]).normal;
            let size = surface.areas()[local].sqrt();
            let limit = BESIDE * size;
            let (partner, beside) = nearest(mesh, &other, node, normal, limit);
            let partner = partner.ok_or(ContactError::NoPartner {
                contact: index,
                node,
                beside,
                limit,
            })?;
            if matches!(contact.gap, Gap::Measured) && partner.gap < -DEEP * size {
                return Err(ContactError::DeepOverlap {
                    contact: index,
                    node,
                    partner: partner.node,
                    depth: -partner.gap,
                    limit: DEEP * size,
                });
            }
            let gap = if partner.gap.abs() > rounding {
                partner.gap
            } else {
                0.0
            };
            Ok(Partner { gap, ..partner })
        })
        .collect();
    let found = found?;
    let mut owners = HashMap::new();
    for (partner, &node) in found.iter().zip(surface.nodes()) {
        if let Some(first) = owners.insert(partner.node, node)
            && distance(mesh, first, node) > rounding
        {
            return Err(ContactError::SharedPartner {
                contact: index,
                partner: partner.node,
                first,
                second: node,
            });
        }
    }
    Ok(found)
}

fn distance(mesh: &TetMesh, a: u32, b: u32) -> f64 {
    let [a, b] = [a, b].map(|node| mesh.points()[node as usize]);
    (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>().sqrt()
}

/// The nearest node of the other side within `limit` of the normal, and how far from the normal the best of all is.
fn nearest(
    mesh: &TetMesh,
    other: &Surface,
    node: u32,
    normal: [f64; 3],
    limit: f64,
) -> (Option<Partner>, f64) {
    let at = mesh.points()[node as usize];
    let (mut found, mut shortest, mut least) = (None, f64::INFINITY, f64::INFINITY);
    for (&candidate, frame) in other.nodes().iter().zip(other.frames()) {
        if candidate == node || -frame.normal_part(normal) < FACING {
            continue;
        }
        let to = mesh.points()[candidate as usize];
        let way = [0, 1, 2].map(|c| to[c] - at[c]);
        let gap = (0..3).map(|c| way[c] * normal[c]).sum::<f64>();
        let side = [0, 1, 2].map(|c| way[c] - gap * normal[c]);
        let beside = side.iter().map(|c| c * c).sum::<f64>().sqrt();
        least = least.min(beside);
        // of slender facets several nodes may be close enough to the normal
        let distance = gap.hypot(beside);
        if beside <= limit && distance < shortest {
            shortest = distance;
            found = Some(Partner {
                node: candidate,
                gap,
            });
        }
    }
    (found, least)
}
