//! Partners: which nodes of the other body a contact node may touch.
//!
//! Where meshes match the partner of a node lies on its normal; elsewhere it is a list of nodes (`mortar`). What is
//! small against the facets is put down to rounding, and across a gap to the normals of curved surfaces, which are
//! those of facets. Nodes on sides that do not face each other are no partners: a thin body has nodes of its far side
//! on the same normal.

use super::chords::arcs;
use super::crossing::flush;
use super::normals::{differ, fixed_frame};
use crate::error::ContactError;
use crate::mortar::{Arcs, MortarNode, Rim, mortar_nodes};
use crate::scene::{Contact, Gap};
use crate::tolerances::{BESIDE, COARSER, FACING, HARDER, LOCKING, MOST_TILT, OVERLAP, TILT};
use rayon::prelude::*;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};
use signorini_fem_mesh::internal::ascending;
use signorini_fem_mesh::{Hooke, Materials, Surface, SurfaceFrame, TetMesh};
use signorini_qp::vector;
use std::collections::{HashMap, HashSet};

/// Distance over the size of the facets up to which partners are looked for first: gaps are mostly small.
const NEAR: f64 = 10.0;
/// How many nodes are looked at first, evenly spread: a node without a partner looks at all of the other side.
const PROBES: usize = 64;

/// The partner of a contact node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Partner {
    /// The node itself at the tip of a crack, which is on both sides.
    pub(super) node: u32,
    /// Distance along the normal of the contact node, m; negative where the bodies overlap.
    pub(super) gap: f64,
}

/// A contact surface and what its nodes may touch.
#[derive(Debug)]
pub(super) struct Paired {
    /// The side that has the contact points.
    pub(super) surface: Surface,
    /// The one frame of all its nodes, of a contact with a fixed direction.
    pub(super) fixed: Option<SurfaceFrame>,
    pub(super) partners: Partners,
    /// Whether the scene names the other side first.
    pub(super) swapped: bool,
}

/// What is known of a contact once matching meshes are found.
pub(super) enum Found {
    Paired(Paired),
    /// Its sides, whose meshes do not match.
    Apart([Surface; 2]),
}

/// What the nodes of a contact surface may touch.
#[derive(Debug)]
pub(super) enum Partners {
    /// A rigid obstacle.
    Obstacle,
    /// A node each.
    Nodes(Vec<Partner>),
    /// Several nodes each, or none.
    Mortar(Vec<Option<MortarNode>>),
}

impl Paired {
    /// Whether the meshes of its sides do not match.
    pub(super) fn is_mortar(&self) -> bool {
        matches!(self.partners, Partners::Mortar(_))
    }

    /// The sides of a contact with an obstacle, or of two whose meshes match: the first one has the points.
    pub(super) fn matching(
        mesh: &TetMesh,
        (index, contact): (usize, &Contact),
        rounding: f64,
    ) -> Result<Found, ContactError> {
        let surface = Surface::new(mesh, &contact.tags)?;
        let fixed = fixed_frame(index, contact, &surface)?;
        let paired = |surface, partners| Self {
            surface,
            fixed,
            partners,
            swapped: false,
        };
        if contact.partner.is_empty() {
            return Ok(Found::Paired(paired(surface, Partners::Obstacle)));
        }
        if let Some(tag) = contact.tags.iter().find(|t| contact.partner.contains(t)) {
            return Err(ContactError::SameSide {
                contact: index,
                tag: tag.0,
            });
        }
        let other = OtherSide::new(mesh, Surface::new(mesh, &contact.partner)?);
        let nodes = nodes(mesh, index, contact, &surface, fixed.as_ref(), &other, rounding)?;
        Ok(match nodes {
            Some(nodes) => Found::Paired(paired(surface, Partners::Nodes(nodes))),
            None => Found::Apart([surface, other.surface]),
        })
    }

    /// The sides of a contact whose meshes do not match. The coarser one has the points, of sides with facets of one
    /// size that with fewer: rows are farther from depending on one another, and pressures smoother. But a curved side
    /// that hardly changes its volume has them, in meshes of order 2: between points of larger facets it gives way, and
    /// loses its pressure. Linear tetrahedra are too stiff to. And a flat side of these that reaches beyond has none if
    /// its body is much harder: a rim of the softer one would be all that several of them press.
    pub(super) fn mortar(
        (mesh, materials): (&TetMesh, &Materials),
        (index, contact): (usize, &Contact),
        [surface, other]: [Surface; 2],
        crossing: &HashSet<u32>,
    ) -> Result<Self, ContactError> {
        let fixed = fixed_frame(index, contact, &surface)?;
        let facet = |s: &Surface| s.total_area() / s.triangles().len() as f64;
        let [own, others] = [facet(&surface), facet(&other)];
        let flush = |from: &Surface, seen: &[Option<MortarNode>]| flush(mesh, contact, from, seen, crossing);
        // told gaps are meant, and quadratic facets have their own curves
        let measured = !contact.tied && matches!(contact.gap, Gap::Measured);
        let mut curves = Arcs::new();
        if measured && mesh.order() == 1 {
            let sides = [&surface, &other];
            curves.extend(sides.into_iter().flat_map(|side| arcs(mesh, side)));
            // convex sides touch in a point or along a line: means know more of what is between nodes
            if curves.values().all(|arc| arc.is_nan() || *arc > 0.0) {
                curves.clear();
            }
        }
        let seen = |from: &Surface, to: &Surface| {
            let rim = (measured && mesh.order() == 2).then(|| Rim::new(mesh, from, contact.crease));
            let choices = (contact.tied, contact.crease);
            mortar_nodes(mesh, from, to, choices, (rim.as_ref(), &curves), |seen| {
                flush(from, seen)
            })
        };
        let there = || seen(&surface, &other);
        let back = || seen(&other, &surface);
        let is_curved = |s: &Surface| differ(s.frames().iter().map(|f| f.normal));
        let keeps = |s: &Surface| mesh.order() == 2 && is_curved(s) && keeps_volume(mesh, materials, s);
        let (mortar, swapped) = match [keeps(&surface), keeps(&other)] {
            [true, false] => (there(), false),
            [false, true] => (back(), true),
            _ if others > COARSER * own => (back(), true),
            _ if own > COARSER * others => (there(), false),
            _ => {
                let count = |nodes: &[Option<MortarNode>]| nodes.iter().flatten().count();
                let (there, back) = (there(), back());
                if count(&back) < count(&there) { (back, true) } else { (there, false) }
            }
        };
        let sides = [&surface, &other];
        let is_harder = || {
            let [own, others] = sides.map(|s| hardness(mesh, materials, s));
            let [own, others] = if swapped { [others, own] } else { [own, others] };
            own > HARDER * others
        };
        let yields = mesh.order() == 1
            && !sides.into_iter().any(is_curved)
            && is_harder()
            && reaches_beyond(sides[usize::from(swapped)], &mortar);
        let (mortar, swapped) = match (yields, swapped) {
            (true, false) => (back(), true),
            (true, true) => (there(), false),
            (false, _) => (mortar, swapped),
        };
        if mortar.iter().all(Option::is_none) {
            let distance = OtherSide::new(mesh, other).distance(&surface);
            let contact = index;
            return Err(ContactError::NoPartner { contact, distance });
        }
        let turned = |frame: SurfaceFrame| SurfaceFrame::from_normal(frame.normal.map(|c| -c));
        let (surface, fixed) = if swapped { (other, fixed.and_then(turned)) } else { (surface, fixed) };
        Ok(Self {
            surface,
            fixed,
            partners: Partners::Mortar(mortar),
            swapped,
        })
    }
}

/// Whether a side goes on where the other one ends.
fn reaches_beyond(surface: &Surface, seen: &[Option<MortarNode>]) -> bool {
    let mut seen = seen.iter().zip(surface.areas());
    seen.any(|(seen, area)| seen.as_ref().is_some_and(|s| s.area < (1.0 - OVERLAP) * area))
}

/// The materials behind the facets of a side.
fn behind<'a>(mesh: &TetMesh, materials: &'a Materials, surface: &Surface) -> impl Iterator<Item = &'a Hooke> {
    let region = |facet: &u32| mesh.regions()[mesh.facet_owner(*facet as usize)];
    surface
        .facets()
        .iter()
        .filter_map(move |f| materials.get(region(f)).ok())
}

/// The largest shear modulus behind a side, Pa.
fn hardness(mesh: &TetMesh, materials: &Materials, surface: &Surface) -> f64 {
    let shear = behind(mesh, materials, surface).map(|hooke| hooke.voigt()[3][3]);
    shear.fold(0.0, f64::max)
}

/// Whether a body behind a side is nearly incompressible.
fn keeps_volume(mesh: &TetMesh, materials: &Materials, surface: &Surface) -> bool {
    behind(mesh, materials, surface).any(|hooke| hooke.poisson() > Some(LOCKING))
}

/// The partner of each node; `None` where meshes do not match.
fn nodes(
    mesh: &TetMesh,
    index: usize,
    contact: &Contact,
    surface: &Surface,
    fixed: Option<&SurfaceFrame>,
    other: &OtherSide<'_>,
    rounding: f64,
) -> Result<Option<Vec<Partner>>, ContactError> {
    let partner = |(local, &node): (usize, &u32)| {
        if other.surface.local(node).is_some() {
            // the tip of a crack; in a mesh of order 2 its mean moves
            return Ok((mesh.order() == 1).then_some(Partner { node, gap: 0.0 }));
        }
        let seen_from = Viewer {
            at: mesh.points()[node as usize],
            normal: fixed.unwrap_or(&surface.frames()[local]).normal,
            size: surface.areas()[local].sqrt(),
        };
        let size = seen_from.size;
        let Some(mut partner) = other.partner(&seen_from) else {
            return Ok(None);
        };
        check_overlap(index, contact, [node, partner.node], partner.gap, size)?;
        if partner.gap.abs() <= rounding {
            partner.gap = 0.0;
        }
        Ok(Some(partner))
    };
    let every = surface.nodes().len().div_ceil(PROBES);
    for node in surface.nodes().iter().enumerate().step_by(every) {
        if partner(node)?.is_none() {
            return Ok(None);
        }
    }
    let found: Vec<_> = surface.nodes().par_iter().enumerate().map(partner).collect();
    // of several errors the first, whichever thread has found one
    let found: Option<Vec<Partner>> = found.into_iter().collect::<Result<_, ContactError>>()?;
    // tied nodes that are apart may turn (`mortar`)
    let together = |found: &Vec<Partner>| !contact.tied || found.iter().all(|p| p.gap == 0.0);
    let found = found.filter(together);
    Ok(found
        .filter(|found| differ_in_place(mesh, surface, found, rounding))
        .and_then(|found| match_facets(mesh, surface, found, &other.surface)))
}

/// Refuses bodies that lie in each other deeper than the facets of a node and its partner, unless the gap is given:
/// tied sides may be apart, not one within the other. `size` is the root of the area of the node, m.
pub(super) fn check_overlap(
    index: usize,
    contact: &Contact,
    [node, partner]: [u32; 2],
    gap: f64,
    size: f64,
) -> Result<(), ContactError> {
    let measured = contact.tied || matches!(contact.gap, Gap::Measured);
    if measured && -gap > size {
        return Err(ContactError::Overlap {
            contact: index,
            node,
            partner,
            depth: -gap,
            size,
        });
    }
    Ok(())
}

/// Whether the partners of nodes in different places differ.
fn differ_in_place(mesh: &TetMesh, surface: &Surface, found: &[Partner], rounding: f64) -> bool {
    let place = |node: u32| &mesh.points()[node as usize];
    let mut owners = HashMap::new();
    found.iter().zip(surface.nodes()).all(|(partner, &second)| {
        let first = owners.insert(partner.node, second);
        first.is_none_or(|first| vector::distance(place(first), place(second)) <= rounding)
    })
}

/// The partners, if those of each facet are a facet of the other side. Other diagonals, or a node within, give nodes
/// other areas: forces at nodes would be right in sum only. Of several nodes in one place, where cuts cross, the
/// partner is that of the facets.
fn match_facets(mesh: &TetMesh, surface: &Surface, mut found: Vec<Partner>, other: &Surface) -> Option<Vec<Partner>> {
    let mut first_in: HashMap<[u64; 3], u32> = HashMap::new();
    let mut first = |node: u32| {
        let place = mesh.points()[node as usize].map(f64::to_bits);
        *first_in.entry(place).or_insert(node)
    };
    let firsts: Vec<u32> = other.nodes().iter().map(|node| first(*node)).collect();
    let facets = other.triangles().iter();
    let there: HashMap<[u32; 3], &[u32; 3]> = facets.map(|t| (ascending(t.map(|n| firsts[n as usize])), t)).collect();
    let seen: Vec<u32> = found.iter().map(|partner| first(partner.node)).collect();
    let mut settled = vec![false; found.len()];
    for own in surface.triangles() {
        let facet = there.get(&ascending(own.map(|n| seen[n as usize])))?;
        for own in own.map(|n| n as usize) {
            let partner = facet.iter().find(|n| firsts[**n as usize] == seen[own])?;
            let partner = other.nodes()[*partner as usize];
            if std::mem::replace(&mut settled[own], true) && found[own].node != partner {
                return None;
            }
            found[own].node = partner;
        }
    }
    Some(found)
}

/// A contact node that looks for its partner.
struct Viewer {
    at: [f64; 3],
    normal: [f64; 3],
    /// Root of the area of the node, m.
    size: f64,
}

/// The other side, with its nodes in a tree.
struct OtherSide<'a> {
    mesh: &'a TetMesh,
    surface: Surface,
    /// Places in the surface.
    tree: RTree<GeomWithData<[f64; 3], u32>>,
}

impl<'a> OtherSide<'a> {
    fn new(mesh: &'a TetMesh, surface: Surface) -> Self {
        let nodes = surface.nodes().iter().zip(0..);
        let places = nodes.map(|(&node, local)| GeomWithData::new(mesh.points()[node as usize], local));
        let tree = RTree::bulk_load(places.collect());
        Self { mesh, surface, tree }
    }

    /// The nearest node at the normal of a node.
    fn partner(&self, from: &Viewer) -> Option<Partner> {
        let near = NEAR * from.size;
        let found = self.nearest(from, near).filter(|(_, distance)| *distance <= near);
        let found = found.or_else(|| self.nearest(from, f64::INFINITY));
        found.map(|(partner, _)| partner)
    }

    /// The nearest of the nodes that may be closer than `most`, with its distance; of equal ones the first.
    fn nearest(&self, from: &Viewer, most: f64) -> Option<(Partner, f64)> {
        let beside = (BESIDE + MOST_TILT) * from.size;
        // no way along an axis at right angles to the normal, however far
        let along = |slope: f64| if slope == 0.0 { 0.0 } else { slope.abs() * most };
        let reach = from.normal.map(|slope| beside + along(slope));
        let corner = |sign: f64| [0, 1, 2].map(|c| from.at[c] + sign * reach[c]);
        let near = AABB::from_corners(corner(-1.0), corner(1.0));
        let seen = |found: &GeomWithData<[f64; 3], u32>| {
            let (partner, beside) = self.seen(from, found.data as usize)?;
            let tilted = (TILT * partner.gap.abs()).min(MOST_TILT * from.size);
            let distance = partner.gap.hypot(beside);
            (beside <= BESIDE * from.size + tilted).then_some((partner, distance, found.data))
        };
        let found = self.tree.locate_in_envelope(&near).filter_map(seen);
        let found = found.min_by(|a, b| a.1.total_cmp(&b.1).then(a.2.cmp(&b.2)));
        found.map(|(partner, distance, _)| (partner, distance))
    }

    /// Distance to the nearest node of another surface, m, whichever way it looks.
    fn distance(&self, surface: &Surface) -> f64 {
        let distance = |node: &u32| {
            let place = self.mesh.points()[*node as usize];
            let nearest = self.tree.nearest_neighbor(&place);
            nearest.map_or(f64::INFINITY, |found| vector::distance(found.geom(), &place))
        };
        surface.nodes().iter().map(distance).fold(f64::INFINITY, f64::min)
    }

    /// A node of this side as it is seen from a node: along its normal, and beside it. `None` if it does not face it.
    fn seen(&self, from: &Viewer, local: usize) -> Option<(Partner, f64)> {
        let node = self.surface.nodes()[local];
        let facing = -self.surface.frames()[local].normal_part(from.normal);
        if facing < FACING {
            return None;
        }
        let to = self.mesh.points()[node as usize];
        let way = [0, 1, 2].map(|c| to[c] - from.at[c]);
        let gap = vector::dot(&way, &from.normal);
        let beside = vector::norm(&[0, 1, 2].map(|c| way[c] - gap * from.normal[c]));
        Some((Partner { node, gap }, beside))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_fem_mesh::mesh::orient_tets;
    use signorini_fem_mesh::{Brick, Facet, FacetTag, brick};

    fn lower(tag: FacetTag) -> FacetTag {
        FacetTag(tag.0 + 100)
    }

    /// A block over a larger one, bent about the y axis, with a gap.
    fn bent(gap: f64) -> TetMesh {
        let upper = Brick::new([1.0, 1.0, 0.5], [6, 4, 2]).build().expect("brick");
        let below = Brick::new([7.0 / 3.0, 1.0, 0.5], [14, 4, 2]).build().expect("brick");
        let below = below
            .map_points(|[x, y, z]| [x - 2.0 / 3.0, y, z - 0.5])
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
            let contact = Contact::between(brick::Z_MIN, lower(brick::Z_MAX));
            let paired = Paired::matching(&mesh, (0, &contact), 1e-12).expect("partners");
            let Found::Paired(Paired {
                partners: Partners::Nodes(found),
                surface,
                ..
            }) = paired
            else {
                panic!("meshes match");
            };
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

    /// A facet that the other side has cut in three has the same edges and corners, and is not matched.
    #[test]
    fn a_node_within_a_facet_makes_meshes_apart() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let cone = |inner: Option<[f64; 3]>, top: f64, tag: FacetTag| {
            let mut points = corners.to_vec();
            points.extend(inner);
            let apex = points.len() as u32;
            points.push([0.3, 0.3, top]);
            let nodes = match inner {
                None => vec![[0, 1, 2]],
                Some(_) => vec![[0, 1, 3], [1, 2, 3], [2, 0, 3]],
            };
            let mut tets: Vec<[u32; 4]> = nodes.iter().map(|[a, b, c]| [*a, *b, *c, apex]).collect();
            orient_tets(&points, &mut tets);
            let facets = nodes.into_iter().map(|nodes| Facet { nodes, tag }).collect();
            TetMesh::new(points, tets, facets).expect("cone")
        };
        let (above, below) = (FacetTag(1), FacetTag(2));
        let contact = Contact::between(above, below);
        for (inner, apart) in [(None, false), (Some([0.3, 0.3, 0.0]), true)] {
            let mesh = cone(None, 1.0, above).append(&cone(inner, -1.0, below)).expect("two");
            let paired = Paired::matching(&mesh, (0, &contact), 1e-12).expect("partners");
            assert_eq!(matches!(paired, Found::Apart(_)), apart);
        }
    }
}
