//! Partners: which node of the other body a contact node may touch.
//!
//! Meshes match, so that the partner of a node lies on its normal. What is small against the facets is put down to rounding,
//! and across a gap to the normals of curved surfaces, which are those of facets. Nodes on sides that do not face each other are no partners: a thin body has nodes of
//! its far side on the same normal.

use super::rounding::rounding;
use crate::error::ContactError;
use crate::scene::{Contact, Gap};
use rayon::prelude::*;
use signorini_fem_mesh::{Surface, SurfaceFrame, TetMesh};
use signorini_qp::vector;
use std::collections::HashMap;

/// Distance of a partner from the normal, over the size of the facets (the root of the area of a node), that is allowed;
/// what is allowed more over the gap; and the most of that, over the size again.
const BESIDE: f64 = 0.02;
const TILT: f64 = 0.1;
const MOST: f64 = 0.2;

/// Cosine between a normal and that of the other side reversed above which they face each other.
const FACING: f64 = 0.1;

/// Distance over the size of the facets up to which partners are looked for first: gaps are mostly small.
const NEAR: f64 = 10.0;

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
    fixed: Option<&SurfaceFrame>,
) -> Result<Vec<Partner>, ContactError> {
    if contact.partner.is_empty() {
        return Ok(Vec::new());
    }
    let other = Side::new(mesh, Surface::new(mesh, &contact.partner)?);
    let rounding = rounding(mesh);
    let found: Vec<Result<Partner, ContactError>> = surface
        .nodes()
        .par_iter()
        .enumerate()
        .map(|(local, &node)| {
            let normal = fixed.unwrap_or(&surface.frames()[local]).normal;
            let size = surface.areas()[local].sqrt();
            let partner = other.partner(mesh, node, normal, size);
            let partner = partner.ok_or_else(|| ContactError::NoPartner {
                contact: index,
                node,
                beside: other.beside(mesh, node, normal),
                limit: BESIDE * size,
            })?;
            if matches!(contact.gap, Gap::Measured) && -partner.gap > size {
                return Err(ContactError::Overlap {
                    contact: index,
                    node,
                    partner: partner.node,
                    depth: -partner.gap,
                    size,
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
    // of several errors the first, whichever thread has found one
    let found: Vec<Partner> = found.into_iter().collect::<Result<_, _>>()?;
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
    let [a, b] = [a, b].map(|node| &mesh.points()[node as usize]);
    vector::distance(a, b)
}

/// The other side, with its nodes in the order of each coordinate.
struct Side {
    surface: Surface,
    /// Coordinate and place in the surface.
    sorted: [Vec<(f64, u32)>; 3],
}

impl Side {
    fn new(mesh: &TetMesh, surface: Surface) -> Self {
        let sorted = [0, 1, 2].map(|c| {
            let nodes = surface.nodes().iter().zip(0..);
            let mut list: Vec<(f64, u32)> = nodes
                .map(|(&node, local)| (mesh.points()[node as usize][c], local))
                .collect();
            list.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            list
        });
        Self { surface, sorted }
    }

    /// The nearest node at the normal of a node with facets of this size.
    fn partner(&self, mesh: &TetMesh, node: u32, normal: [f64; 3], size: f64) -> Option<Partner> {
        let search = |most: f64| self.nearest(mesh, node, normal, size, most);
        let near = search(NEAR * size).filter(|(_, distance)| *distance <= NEAR * size);
        let found = near.or_else(|| search(f64::INFINITY));
        found.map(|(partner, _)| partner)
    }

    /// The nearest of the nodes that may be closer than `most`, with its distance.
    fn nearest(
        &self,
        mesh: &TetMesh,
        node: u32,
        normal: [f64; 3],
        size: f64,
        most: f64,
    ) -> Option<(Partner, f64)> {
        let at = mesh.points()[node as usize];
        // along the axis on which the normal is shortest
        let slope = |c: &usize| normal[*c].abs();
        let axis = (0..3)
            .min_by(|a, b| slope(a).total_cmp(&slope(b)))
            .unwrap_or(0);
        let along = match slope(&axis) {
            0.0 => 0.0,
            slope => slope * most,
        };
        let reach = (BESIDE + MOST) * size + along;
        let list = &self.sorted[axis];
        let from = list.partition_point(|(x, _)| *x < at[axis] - reach);
        let near = list[from..].iter();
        let near = near.take_while(|(x, _)| *x <= at[axis] + reach);
        let mut found = None::<(Partner, f64)>;
        for &(_, local) in near {
            let Some((partner, beside)) = self.seen(mesh, node, normal, local as usize) else {
                continue;
            };
            let distance = partner.gap.hypot(beside);
            let allowed = BESIDE * size + (TILT * partner.gap.abs()).min(MOST * size);
            if beside <= allowed && found.is_none_or(|f| distance < f.1) {
                found = Some((partner, distance));
            }
        }
        found
    }

    /// How far from the normal of a node the next of all nodes that face it is, m; infinite if none does.
    fn beside(&self, mesh: &TetMesh, node: u32, normal: [f64; 3]) -> f64 {
        let all = 0..self.surface.nodes().len();
        let seen = all.filter_map(|local| self.seen(mesh, node, normal, local));
        seen.fold(f64::INFINITY, |least, (_, beside)| least.min(beside))
    }

    /// A node of the other side as it is seen from a node: along its normal, and beside it. `None` if it does not face it.
    fn seen(
        &self,
        mesh: &TetMesh,
        node: u32,
        normal: [f64; 3],
        local: usize,
    ) -> Option<(Partner, f64)> {
        let candidate = self.surface.nodes()[local];
        let facing = -self.surface.frames()[local].normal_part(normal);
        if candidate == node || facing < FACING {
            return None;
        }
        let [at, to] = [node, candidate].map(|n| mesh.points()[n as usize]);
        let way = [0, 1, 2].map(|c| to[c] - at[c]);
        let gap = vector::dot(&way, &normal);
        let beside = vector::norm(&[0, 1, 2].map(|c| way[c] - gap * normal[c]));
        let partner = Partner {
            node: candidate,
            gap,
        };
        Some((partner, beside))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_fem_mesh::{Brick, FacetTag, brick};

    fn lower(tag: FacetTag) -> FacetTag {
        FacetTag(tag.0 + 100)
    }

    /// A block over a larger one, bent about the y axis, with a gap.
    fn bent(gap: f64) -> TetMesh {
        let upper = Brick::new([1.0, 1.0, 0.5], [6, 4, 2])
            .build()
            .expect("brick");
        let below = Brick::new([2.0, 1.0, 0.5], [12, 4, 2])
            .build()
            .expect("brick");
        let below = below
            .map_points(|[x, y, z]| [x - 0.5, y, z - 0.5])
            .expect("moved")
            .map_tags(lower);
        // circles about the axis x = 0.5, z = -3; normals stay normals
        let turn = |[x, y, z]: [f64; 3], out: f64| {
            let (radius, angle) = (3.0 + z + out, (x - 0.5) / 3.0);
            [0.5 + radius * angle.sin(), y, radius * angle.cos() - 3.0]
        };
        let upper = upper.map_points(|p| turn(p, gap)).expect("bent");
        let below = below.map_points(|p| turn(p, 0.0)).expect("bent");
        upper.append(&below).expect("two bodies")
    }

    /// Near and far partners are those that looking at all nodes finds.
    #[test]
    fn partners_lie_on_the_normals_of_curved_surfaces() {
        for gap in [0.0, 1e-3, 0.02, 0.3] {
            let mesh = bent(gap);
            let surface = Surface::new(&mesh, &[brick::Z_MIN]).expect("surface");
            let contact = Contact::between(brick::Z_MIN, lower(brick::Z_MAX));
            let found = partners(&mesh, 0, &contact, &surface, None).expect("partners");
            assert_eq!(found.len(), surface.nodes().len());
            let all = Surface::new(&mesh, &contact.partner).expect("surface");
            for (partner, &node) in found.iter().zip(surface.nodes()) {
                let at = mesh.points()[node as usize];
                let distance = |n: &u32| {
                    let to = mesh.points()[*n as usize];
                    (0..3).map(|c| (to[c] - at[c]).powi(2)).sum::<f64>()
                };
                let nearest = all.nodes().iter();
                let nearest = nearest.min_by(|a, b| distance(a).total_cmp(&distance(b)));
                assert_eq!(nearest, Some(&partner.node), "gap {gap}");
                // edges of the surface have the normals of one row of facets
                assert!((partner.gap - gap).abs() <= 1e-3 * gap, "{}", partner.gap);
            }
        }
    }
}
