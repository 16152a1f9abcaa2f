//! The sides of contact points in a mesh of order 2.
//!
//! Under a constant pressure the corners of a quadratic facet carry no force, so that conditions at single nodes fail.
//! A contact point is a corner all the same; what counts is a mean of the displacement around it ([`Surface::mean`]),
//! and the same mean of the gap. The force of a point over its area is then the pressure there. Tied sides whose nodes
//! are the same need no means: each node is tied to its partner, mid-nodes too.

use super::chords::edges;
use super::partners::{Paired, Partner, Partners};
use super::side::{Sides, mean_place, rounded};
use crate::error::ContactError;
use crate::mortar::Rim;
use crate::scene::{Contact, Gap, Scene};
use crate::tolerances::{JUMP, OVERSHOT};
use signorini_fem_mesh::internal::Lists;
use signorini_fem_mesh::vec3::{area_vector, norm, sub, unit};
use signorini_fem_mesh::{Surface, SurfaceFrame, TetMesh};
use signorini_qp::vector;
use signorini_tfeti::Side;
use std::collections::HashMap;

/// What means over the sides of a contact need.
pub(super) struct Means<'a> {
    scene: &'a Scene,
    /// Position of the contact in the scene.
    contact: usize,
    surface: &'a Surface,
    /// What of a gap may be rounding, m.
    rounding: f64,
    /// Triangles around each node.
    around: Lists<u32>,
    /// Partner of each node of the surface, corners and mid-nodes; empty against a rigid obstacle.
    partners: HashMap<u32, u32>,
}

impl<'a> Means<'a> {
    /// `None` for a mesh of order 1, and where `mortar` has made the sides.
    pub(super) fn new(
        scene: &'a Scene,
        contact: usize,
        surface: &'a Surface,
        partners: &Partners,
        rounding: f64,
    ) -> Option<Self> {
        if scene.mesh.order() == 1 || matches!(partners, Partners::Mortar(_)) {
            return None;
        }
        Some(Self {
            scene,
            contact,
            surface,
            rounding,
            around: surface.around(),
            partners: match partners {
                Partners::Nodes(partners) => all_partners(scene, contact, surface, partners),
                _ => HashMap::new(),
            },
        })
    }

    /// The mid-nodes of a surface with their partners, if all are in one place: nodes can then be tied one by one.
    pub(super) fn matching_mids(&self) -> Option<Vec<MatchingMid>> {
        let (mesh, mut out) = (&self.scene.mesh, Vec::new());
        let place = |node: u32| mesh.points()[node as usize];
        for (triangle, &facet) in self.surface.triangles().iter().zip(self.surface.facets()) {
            let [a, b, c] = *triangle;
            for (ends, node) in [[a, b], [b, c], [c, a]]
                .into_iter()
                .zip(mesh.facet_mids(facet as usize)?)
            {
                let partner = *self.partners.get(&node)?;
                let apart = norm(sub(place(partner), place(node)));
                (apart <= self.rounding).then_some(())?;
                out.push(MatchingMid { node, partner, ends });
            }
        }
        out.sort_by_key(|mid| mid.node);
        out.dedup_by_key(|mid| mid.node);
        Some(out)
    }

    /// Where the force of a node acts that is one point, m: in the mean of its side.
    pub(super) fn place(&self, local: usize) -> [f64; 3] {
        mean_place(&self.side(local, self.around.of(local)), |node| {
            self.scene.mesh.points()[node as usize]
        })
    }

    fn side(&self, local: usize, triangles: &[u32]) -> Side {
        Side::new(self.surface.mean(local, triangles.iter().map(|&t| t as usize)))
    }

    /// Sides and gap of the point of a node on the triangles of its side, all around it if there are none.
    pub(super) fn point(
        &self,
        (local, triangles): (usize, &[u32]),
        frame: &SurfaceFrame,
    ) -> Result<(Sides, f64), ContactError> {
        let triangles = if triangles.is_empty() { self.around.of(local) } else { triangles };
        let own = self.side(local, triangles);
        let other = |&(node, weight): &(u32, f64)| Some((*self.partners.get(&node)?, weight));
        let partner: Option<Vec<(u32, f64)>> = own.nodes().iter().map(other).collect();
        let place = |node: u32| self.scene.mesh.points()[node as usize];
        let measured = |node: u32| {
            self.partners.get(&node).map_or(0.0, |&to| {
                let gap = vector::dot(&sub(place(to), place(node)), &frame.normal);
                rounded(gap, self.rounding)
            })
        };
        let gap = mean_gap(self.scene, self.contact, &own, &frame.normal, measured)?;
        let sides = Sides {
            own,
            partner: partner.map(Side::new),
            swapped: false,
        };
        Ok((sides, gap))
    }
}

/// The pair with [dual functions](Surface::with_dual) where the gap opens from the rim of its side. `mortar` has its
/// own.
pub(super) fn opened(scene: &Scene, index: usize, mut paired: Paired) -> Result<Paired, ContactError> {
    let (mesh, contact) = (&scene.mesh, &scene.contacts[index]);
    let is_told = matches!(contact.gap, Gap::None | Gap::Constant(_));
    if mesh.order() == 1 || contact.tied || is_told || paired.is_mortar() {
        return Ok(paired);
    }
    let surface = &paired.surface;
    let rim = Rim::new(mesh, surface, contact.crease);
    let partners = match &paired.partners {
        Partners::Nodes(partners) => all_partners(scene, index, surface, partners),
        _ => HashMap::new(),
    };
    let place = |node: u32| mesh.points()[node as usize];
    let opens = |triangle: &usize| {
        let facet = surface.facets()[*triangle] as usize;
        let [a, b, c] = mesh.facets()[facet].nodes;
        let Some([ab, bc, ca]) = mesh.facet_mids(facet) else {
            return false;
        };
        let nodes = [a, b, c, ab, bc, ca];
        let normal = (paired.fixed).map_or_else(|| unit(area_vector(&mesh.facet_points(facet))), |frame| frame.normal);
        let gap = |node: u32| {
            let to = partners.get(&node).map(|to| sub(place(*to), place(node)));
            let measured = to.map_or(0.0, |way| vector::dot(&way, &normal));
            contact.gap_at(index, node, place(node), &normal, measured).ok()
        };
        rim.opens(nodes, || {
            let gaps: Option<Vec<f64>> = nodes.into_iter().map(gap).collect();
            gaps?.try_into().ok()
        })
    };
    let opens: Vec<usize> = (0..surface.facets().len()).filter(opens).collect();
    paired.surface = paired.surface.with_dual(mesh, &opens)?;
    Ok(paired)
}

/// A mid-node in the place of one of the other side.
#[derive(Debug)]
pub(super) struct MatchingMid {
    pub(super) node: u32,
    pub(super) partner: u32,
    /// The ends of its edge, by places in the surface.
    pub(super) ends: [u32; 2],
}

/// The gap of a side along a normal, m: the mean over its nodes, at which `measured` says what coordinates do. Beyond
/// the end of an obstacle that of its centre, where nothing is met.
pub(super) fn mean_gap(
    scene: &Scene,
    index: usize,
    side: &Side,
    normal: &[f64; 3],
    measured: impl Fn(u32) -> f64,
) -> Result<f64, ContactError> {
    let (mesh, contact) = (&scene.mesh, &scene.contacts[index]);
    let centre = mean_place(side, |node| mesh.points()[node as usize]);
    if let Some(distance) = contact.beyond(centre, normal) {
        return Ok(distance);
    }
    mean(mesh, contact, (side, centre, normal), |node, place| {
        contact.gap_at(index, node, place, normal, measured(node))
    })
}

/// The mean over the nodes of a side of what is at each; where a gap that is given jumps between them, what is at the
/// centre, which is beside a curved side.
pub(super) fn mean(
    mesh: &TetMesh,
    contact: &Contact,
    (side, centre, normal): (&Side, [f64; 3], &[f64; 3]),
    at: impl Fn(u32, [f64; 3]) -> Result<f64, ContactError>,
) -> Result<f64, ContactError> {
    let (mut sum, mut least, mut most) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
    for &(node, weight) in side.nodes() {
        let value = at(node, mesh.points()[node as usize])?;
        sum += weight * value;
        (least, most) = (value.min(least), value.max(most));
    }
    if !matches!(contact.gap, Gap::Field(_)) || most <= least {
        return Ok(sum);
    }
    let first = side.nodes()[0].0;
    let there = at(first, centre)?;
    let beside = vector::dot(&sub(centre, mesh.points()[first as usize]), normal).abs();
    // where all directions are alike, as around a node, the mean of a quadratic field is its value in the middle
    let range = most - least;
    let beyond = (sum - most).max(least - sum) > OVERSHOT * range;
    let jumps = beyond || (sum - there).abs() > JUMP * range + beside;
    Ok(if jumps { there.clamp(least, most) } else { sum })
}

/// The partners of corners, and of mid-nodes those on the edge between the partners of its ends.
fn all_partners(scene: &Scene, contact: usize, surface: &Surface, partners: &[Partner]) -> HashMap<u32, u32> {
    let (mesh, contact) = (&scene.mesh, &scene.contacts[contact]);
    let mids_of = |facet: usize| mesh.facet_mids(facet).into_iter().flatten();
    let mut mids: HashMap<[u32; 2], u32> = HashMap::new();
    for (facet, own) in mesh
        .facets()
        .iter()
        .enumerate()
        .filter(|(_, f)| contact.partner.contains(&f.tag))
    {
        for (edge, mid) in edges(own.nodes).into_iter().zip(mids_of(facet)) {
            mids.insert(edge, mid);
        }
    }
    let corners = surface.nodes().iter().zip(partners);
    let mut out: HashMap<u32, u32> = corners.map(|(&node, partner)| (node, partner.node)).collect();
    for &facet in surface.facets() {
        let facet = facet as usize;
        let others = mesh.facets()[facet].nodes.map(|n| out[&n]);
        for (edge, node) in edges(others).into_iter().zip(mids_of(facet)) {
            // where meshes match all edges have theirs
            out.extend(mids.get(&edge).map(|&partner| (node, partner)));
        }
    }
    out
}
