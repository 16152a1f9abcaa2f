//! Where contact can happen: the contact points of all surfaces, with normal, area and gap.
//!
//! A node of a smooth surface is one point. Where facets meet at a crease it is one for each side, and where two
//! contacts meet one for each of them, so that nodes in an edge between a floor and a wall, or in a corner, meet all
//! of their obstacles. Only where the normals of two contacts are the same is the node one point for both: one of the
//! conditions follows from the other. Between bodies a node is one point for each partner.
//!
//! What contacts say of each node ([`conditions`]) is kept beside the points that are made of it: the certificate
//! judges the former.

use super::creases::{SurfaceSide, creases};
use super::means::{MatchingMid, Means, mean, mean_gap};
use super::normals::{along_axis, differ, shape_frames};
use super::partners::{Paired, Partners, check_overlap};
use super::side::{Sides, mean_place, rounded};
use crate::error::ContactError;
use crate::mortar::MortarNode;
use crate::scene::{Contact, Pose, Scene};
use crate::tolerances::{FACING, SAME_NORMAL};
use signorini_fem_mesh::{Surface, SurfaceFrame, TetMesh, vec3};
use signorini_qp::vector;
use signorini_tfeti::Side;
use std::cmp::Ordering;
use std::collections::HashMap;
use std::ops::Range;

/// A contact point before any row is made.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ContactPoint {
    /// Position of its contact surface in the scene.
    pub(crate) surface: usize,
    /// The nodes that it is made of.
    pub(crate) sides: Sides,
    /// Its place, m.
    pub(crate) position: [f64; 3],
    /// The mean of the places of its own nodes, m: that place unless these are several. What a linear displacement is
    /// there, rows measure.
    pub(crate) centre: [f64; 3],
    /// Normal into the obstacle and two tangents.
    pub(crate) frame: SurfaceFrame,
    /// Its part of the areas of the facets of its side, m².
    pub(crate) area: f64,
    /// Distance to the obstacle as given, m.
    pub(crate) gap: f64,
    /// Whether that is measured to the curve that facets of the other side stand for.
    pub(crate) to_curve: bool,
    /// Of it what was added to a measured overlap that facets alone make.
    pub(crate) closed: f64,
    /// Friction along the second tangent over that along the first.
    pub(crate) stretch: f64,
    /// How far it gives way along the normal and along the surface, m/Pa.
    pub(crate) compliance: [f64; 2],
}

impl ContactPoint {
    /// The node that names it.
    pub(crate) fn node(&self) -> u32 {
        self.sides.node()
    }

    /// Contact, node and place, as errors name it.
    pub(crate) fn at(&self) -> (usize, u32, [f64; 3]) {
        (self.surface, self.node(), self.position)
    }

    /// The gap, m, that the obstacle has brought by moving along the surface, without what it opens.
    pub(crate) fn gap_brought(&self, scene: &Scene, pose: &Pose) -> Result<f64, ContactError> {
        let contact = &scene.contacts[self.surface];
        let normal = &self.frame.normal;
        if let Some(distance) = contact.beyond(pose.origin(&self.centre), &pose.back(normal)) {
            return Ok(pose.brings(distance, &self.centre, normal));
        }
        let brought = mean(
            &scene.mesh,
            contact,
            (&self.sides.own, self.centre, normal),
            |node, place| contact.gap_brought(self.surface, node, place, normal, (self.gap - self.closed, pose)),
        )?;
        Ok(brought + self.closed)
    }

    /// Closes an overlap.
    pub(crate) fn close(&mut self) {
        (self.gap, self.closed) = (0.0, self.closed - self.gap);
    }

    /// The gap where the obstacle has moved, m.
    pub(crate) fn gap_after(&self, scene: &Scene, pose: &Pose) -> Result<f64, ContactError> {
        Ok(self.gap_brought(scene, pose)? + self.opened(pose))
    }

    /// What the obstacle opens by moving along the normal, m.
    pub(crate) fn opened(&self, pose: &Pose) -> f64 {
        vector::dot(&pose.drag(&self.centre), &self.frame.normal)
    }

    /// Whether two conditions are on the same displacement: one of them then follows from the other.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.sides.partner == other.sides.partner && self.frame.normal_part(other.frame.normal) > SAME_NORMAL
    }
}

/// Where the conditions of a contact stand, which are in its order.
pub(crate) fn of_contact(conditions: &[ContactPoint], contact: usize) -> Range<usize> {
    let [first, end] = [contact, contact + 1].map(|k| conditions.partition_point(|c| c.surface < k));
    first..end
}

/// What the contacts of a scene say, with the poses of their obstacles: each of their nodes with each of its normals.
/// Contact by contact, nodes ascending.
pub(super) fn conditions(
    scene: &Scene,
    (paired, poses): (&[Paired], &[Vec<Pose>]),
    rounding: f64,
) -> Result<Vec<ContactPoint>, ContactError> {
    let mut out: Vec<ContactPoint> = Vec::new();
    let acting = |(_, (contact, _)): &(usize, (&Contact, &Paired))| scene.acts(contact.span);
    for (index, (contact, paired)) in scene.contacts.iter().zip(paired).enumerate().filter(acting) {
        let (surface, fixed, partners) = (&paired.surface, paired.fixed, &paired.partners);
        let means = Means::new(scene, index, surface, partners, rounding);
        let mids = means.as_ref().filter(|_| contact.tied).and_then(Means::matching_mids);
        let means = means.filter(|_| mids.is_none());
        let place = |local: usize| match &means {
            Some(means) => means.place(local),
            None => scene.mesh.points()[surface.nodes()[local] as usize],
        };
        let shaped = shape_frames(scene, index, surface, place, &poses[index])?;
        let sides = match (partners, fixed) {
            (Partners::Obstacle, None) if shaped.is_empty() => creases(&scene.mesh, surface, contact.crease),
            _ => HashMap::new(),
        };
        let curved = is_curved(partners);
        for (local, &node) in surface.nodes().iter().enumerate() {
            let shape = shaped.get(local).copied();
            if shape == Some(None) {
                continue;
            }
            let position = scene.mesh.points()[node as usize];
            let Some(facing) = Facing::new(scene, index, paired, local, rounding)? else {
                continue;
            };
            let own = sides.get(&(local as u32));
            for side in own.map_or(std::slice::from_ref(&facing.surface), Vec::as_slice) {
                let frame = fixed.or(shape.flatten()).unwrap_or(side.frame);
                if contact.never_faces(place(local), &frame.normal, &poses[index]) {
                    continue;
                }
                let (sides, gap) = match &means {
                    None => {
                        let mut sides = facing.sides.clone();
                        let measured = |_| facing.measured;
                        let gap = mean_gap(scene, index, &sides.own, &frame.normal, measured)?;
                        if curved && !contact.tied {
                            sides.turn_partner(place_of(&scene.mesh), rounding);
                        }
                        (sides, gap)
                    }
                    Some(means) => means.point((local, &side.triangles), &frame)?,
                };
                let gap = rounded(gap, rounding);
                let frame = along_axis(index, contact, node, frame)?;
                out.push(ContactPoint {
                    centre: mean_place(&sides.own, place_of(&scene.mesh)),
                    surface: index,
                    sides,
                    position,
                    frame,
                    area: side.area,
                    gap,
                    to_curve: facing.to_curve,
                    closed: 0.0,
                    stretch: contact.friction_axis.map_or(1.0, |(_, ratio)| ratio),
                    compliance: contact.compliance,
                });
            }
        }
        // between tips of a crack a point has the name of a mid-node
        let own = of_contact(&out, index);
        out[own].sort_by_key(ContactPoint::node);
        let mids = mids.into_iter().flatten();
        out.extend(mids.map(|mid| tied_mid(scene, (index, surface), fixed, &mid)));
    }
    Ok(out)
}

/// A node of a contact and what it faces.
struct Facing {
    surface: SurfaceSide,
    sides: Sides,
    /// The gap as coordinates have it, m, and whether that is to the curve that facets of the other side stand for.
    measured: f64,
    to_curve: bool,
}

impl Facing {
    /// `None` where a node has no condition: it is on both sides, sees nothing, or has handed it on.
    fn new(
        scene: &Scene,
        index: usize,
        paired: &Paired,
        local: usize,
        rounding: f64,
    ) -> Result<Option<Self>, ContactError> {
        let surface = &paired.surface;
        let node = surface.nodes()[local];
        let mut out = Self {
            surface: SurfaceSide {
                frame: surface.frames()[local],
                area: surface.areas()[local],
                triangles: Vec::new(),
            },
            sides: Sides {
                own: Side::node(node),
                partner: None,
                swapped: paired.swapped,
            },
            measured: 0.0,
            to_curve: false,
        };
        match &paired.partners {
            Partners::Obstacle => {}
            // what is on both sides does not move against itself
            Partners::Nodes(partners) if partners[local].node == node => return Ok(None),
            Partners::Nodes(partners) => {
                out.measured = partners[local].gap;
                out.sides.partner = Some(Side::node(partners[local].node));
            }
            Partners::Mortar(nodes) => {
                let Some(seen) = nodes[local].as_ref().filter(|seen| !seen.is_handed_on) else {
                    return Ok(None);
                };
                (out.surface.frame, out.surface.area) = (seen.frame, seen.area);
                let gap = mortar_gap(scene, index, surface, local, seen)?;
                // weights are in part negative: over a curved side, or beside an edge, a mean may be inside where no
                // facet is
                let deepest = seen.nearest.min(0.0);
                let inside = !scene.contacts[index].tied && gap < deepest - rounding;
                let gap = match seen.curve {
                    // facets of the other side are beside the curve that is meant
                    Some(curve) => curve,
                    None if inside => deepest,
                    None => gap,
                };
                out.to_curve = seen.curve.is_some();
                let weights: f64 = seen.partner.iter().map(|(_, weight)| weight.abs()).sum();
                // along an inclined direction it is farther
                let along = (paired.fixed).map_or(1.0, |frame| frame.normal_part(seen.frame.normal).max(FACING));
                out.measured = rounded(gap / along, weights * rounding);
                out.sides.own = Side::new(seen.own.clone());
                out.sides.partner = Some(Side::new(seen.partner.clone()));
            }
        }
        Ok(Some(out))
    }
}

/// A node without a condition because another contact has one, and what it faces.
#[derive(Debug)]
pub(crate) struct HandedOn {
    /// Position of its contact in the scene.
    pub(crate) contact: usize,
    pub(crate) sides: Sides,
    pub(crate) normal: [f64; 3],
}

/// Those of all contacts.
pub(super) fn handed_on(paired: &[Paired]) -> Vec<HandedOn> {
    let mut out = Vec::new();
    for (contact, paired) in paired.iter().enumerate() {
        let Partners::Mortar(nodes) = &paired.partners else {
            continue;
        };
        let nodes = paired.surface.nodes().iter().zip(nodes);
        let own = nodes.filter_map(|(node, seen)| Some((*node, seen.as_ref().filter(|s| s.is_handed_on)?)));
        out.extend(own.map(|(node, seen)| HandedOn {
            contact,
            sides: Sides {
                own: Side::node(node),
                partner: Some(Side::new(seen.partner.clone())),
                swapped: paired.swapped,
            },
            normal: paired.fixed.unwrap_or(seen.frame).normal,
        }));
    }
    out
}

/// The tie of a mid-node. Normal and area are those of the ends of its edge, in the mean.
fn tied_mid(
    scene: &Scene,
    (contact, surface): (usize, &Surface),
    fixed: Option<SurfaceFrame>,
    mid: &MatchingMid,
) -> ContactPoint {
    let [a, b] = mid.ends.map(|end| end as usize);
    let [one, other] = [a, b].map(|end| surface.frames()[end]);
    let frame = fixed.or_else(|| SurfaceFrame::from_normal(vec3::add(one.normal, other.normal)));
    let position = scene.mesh.points()[mid.node as usize];
    ContactPoint {
        surface: contact,
        sides: Sides {
            own: Side::node(mid.node),
            partner: Some(Side::node(mid.partner)),
            swapped: false,
        },
        position,
        centre: position,
        frame: frame.unwrap_or(one),
        area: 0.5 * (surface.areas()[a] + surface.areas()[b]),
        gap: 0.0,
        to_curve: false,
        closed: 0.0,
        stretch: 1.0,
        compliance: [0.0; 2],
    }
}

fn place_of(mesh: &TetMesh) -> impl Fn(u32) -> [f64; 3] {
    |node| mesh.points()[node as usize]
}

/// Whether meshes do not match and normals differ.
fn is_curved(partners: &Partners) -> bool {
    let Partners::Mortar(nodes) = partners else {
        return false;
    };
    differ(nodes.iter().flatten().map(|n| n.frame.normal))
}

/// The weighted gap of a node of a surface along its normal, m: from the node to the weighted mean of what it sees.
fn mortar_gap(
    scene: &Scene,
    contact: usize,
    surface: &Surface,
    local: usize,
    seen: &MortarNode,
) -> Result<f64, ContactError> {
    let node = surface.nodes()[local];
    let from = scene.mesh.points()[node as usize];
    let gap = seen.gap(&scene.mesh, from, &seen.frame.normal);
    let (nodes, size) = ([node, seen.partner[0].0], surface.areas()[local].sqrt());
    check_overlap(contact, &scene.contacts[contact], nodes, gap, size)?;
    Ok(gap)
}

/// The contact points: of the conditions of a node those with one normal are one, in the place of the first. Beside
/// them for each condition the point that stands for it.
pub(super) fn points(
    scene: &Scene,
    conditions: &[ContactPoint],
    rounding: f64,
) -> Result<(Vec<ContactPoint>, Vec<usize>), ContactError> {
    let mut out: Vec<ContactPoint> = Vec::with_capacity(conditions.len());
    let mut stands = Vec::with_capacity(conditions.len());
    // points of each node that there may be others of
    let mut known: HashMap<u32, Vec<usize>> = HashMap::new();
    let mut count = vec![0u32; scene.mesh.points().len()];
    conditions.iter().for_each(|c| count[c.node() as usize] += 1);
    for condition in conditions {
        let node = condition.node();
        if count[node as usize] == 1 {
            stands.push(out.len());
            out.push(condition.clone());
            continue;
        }
        let others = known.entry(node).or_default();
        let same = |k: &&usize| out[**k].is_same(condition);
        match others.iter().find(same).copied() {
            Some(k) => {
                join(scene, rounding, &mut out[k], condition)?;
                stands.push(k);
            }
            None => {
                others.push(out.len());
                stands.push(out.len());
                out.push(condition.clone());
            }
        }
    }
    Ok((out, stands))
}

/// Joins a condition to a point with the same normal. Only the nearer obstacle can be touched: law, gap and area are
/// its own. Where both are as near the law is that of the first one, on the area of both; facets that they share
/// count once.
fn join(scene: &Scene, rounding: f64, point: &mut ContactPoint, other: &ContactPoint) -> Result<(), ContactError> {
    let [x, y] = [&*point, other].map(|c| &scene.contacts[c.surface]);
    let nearer = order(other.gap - point.gap, rounding);
    if x.motions != y.motions
        || x.rotation != y.rotation
        || x.gap_history != y.gap_history
        || x.compliance != y.compliance
        || x.compliance[0] > 0.0 && nearer != Ordering::Equal
        || !stays(scene, rounding, point, other, nearer)?
    {
        return Err(ContactError::SharedNode {
            node: point.node(),
            first: point.surface,
            second: other.surface,
        });
    }
    match nearer {
        Ordering::Equal => {
            let shared = x.tags.iter().any(|t| y.tags.contains(t));
            if point.sides.own != other.sides.own {
                point.sides.own = both(point, other);
                point.closed = (point.area * point.closed + other.area * other.closed) / (point.area + other.area);
                point.centre = mean_place(&point.sides.own, place_of(&scene.mesh));
            }
            point.area = if shared && point.surface != other.surface {
                point.area.max(other.area)
            } else {
                point.area + other.area
            };
        }
        Ordering::Less => {
            (point.surface, point.area) = (other.surface, other.area);
            (point.gap, point.closed) = (other.gap, other.closed);
            (point.sides, point.centre) = (other.sides.clone(), other.centre);
            if x.friction_axis.is_some() || y.friction_axis.is_some() {
                (point.frame, point.stretch) = (other.frame, other.stretch);
            }
        }
        Ordering::Greater => {}
    }
    Ok(())
}

/// The mean over the sides of two conditions on one node, by their areas.
fn both(point: &ContactPoint, other: &ContactPoint) -> Side {
    let area = point.area + other.area;
    let mut nodes: Vec<(u32, f64)> = Vec::new();
    for side in [point, other] {
        for &(node, weight) in side.sides.own.nodes() {
            let share = weight * side.area / area;
            match nodes.iter_mut().find(|n| n.0 == node) {
                Some(known) => known.1 += share,
                None => nodes.push((node, share)),
            }
        }
    }
    Side::new(nodes)
}

/// The sign of a difference of gaps.
fn order(difference: f64, rounding: f64) -> Ordering {
    if difference.abs() <= rounding { Ordering::Equal } else { difference.total_cmp(&0.0) }
}

/// Whether the nearer of two obstacles with one motion stays the nearer one: fields that move along and factors of the
/// gap may change that.
fn stays(
    scene: &Scene,
    rounding: f64,
    point: &ContactPoint,
    other: &ContactPoint,
    nearer: Ordering,
) -> Result<bool, ContactError> {
    let [x, y] = [point, other].map(|c| &scene.contacts[c.surface]);
    if !x.changes_gap() && !y.changes_gap() {
        return Ok(true);
    }
    let times = scene.analysis.times();
    // what has ended, or not begun, is nowhere
    for (pose, _) in x.acting(&x.poses(times), times).filter(|(_, time)| y.span.has(*time)) {
        let difference = other.gap_after(scene, pose)? - point.gap_after(scene, pose)?;
        if order(difference, rounding) != nearer {
            return Ok(false);
        }
    }
    Ok(true)
}
