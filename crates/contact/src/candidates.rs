//! Where contact can happen: the contact points of all surfaces, with normal, area and gap.
//!
//! A node of a smooth surface is one point. Where facets meet at a crease it is one for each side, and where two surfaces
//! meet at an edge one for each of them, so that nodes in an edge between a floor and a wall, or in a corner, meet all of
//! their obstacles. Surfaces that go over into one another share a node with one point. Between bodies a node is one point,
//! with a [partner](crate::partners).

use crate::contact_surface::{Contact, ContactNormal};
use crate::error::ContactError;
use crate::partners::{Partner, partners};
use crate::scene::Scene;
use signorini_fem_mesh::{Frame, Surface, TetMesh};
use signorini_tfeti::{ContactNodes, ContactPoint};
use std::collections::HashMap;

/// Cosine to the outward normal below which a direction counts as along the surface.
const ALONG: f64 = 1e-9;

/// Cosine above which two directions of contact are one.
const SAME: f64 = 1.0 - 1e-6;

/// A contact point before any row is made.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    /// Position of its contact surface in the scene.
    pub(crate) surface: usize,
    /// Mesh node.
    pub(crate) node: u32,
    /// Its partner on another body.
    pub(crate) opponent: Option<u32>,
    pub(crate) frame: Frame,
    /// A third of the areas of the facets of its side, m².
    pub(crate) area: f64,
    /// Initial distance to the obstacle, m.
    pub(crate) gap: f64,
}

/// The surfaces of a scene's contacts.
pub(crate) fn surfaces(scene: &Scene) -> Result<Vec<Surface>, ContactError> {
    let surface = |contact: &Contact| Ok(Surface::new(&scene.mesh, &contact.tags)?);
    scene.contacts.iter().map(surface).collect()
}

/// The points as `tfeti` wants them.
pub(crate) fn contact_nodes<'a>(
    scene: &Scene,
    candidates: impl Iterator<Item = &'a Candidate>,
) -> ContactNodes {
    let point = |c: &Candidate| {
        let contact = &scene.contacts[c.surface];
        ContactPoint::new(c.node, c.frame)
            .with_opponent(c.opponent)
            .with_friction(contact.friction().is_some())
            .with_moving_obstacle(contact.motion.is_some())
    };
    candidates.map(point).collect()
}

/// The contact points of all surfaces: surface by surface, nodes ascending.
pub(crate) fn candidates(
    scene: &Scene,
    surfaces: &[Surface],
) -> Result<Vec<Candidate>, ContactError> {
    let mut out: Vec<Candidate> = Vec::new();
    // points of each node, where there may be more than one
    let mut known: HashMap<u32, Vec<usize>> = HashMap::new();
    for (index, (contact, surface)) in scene.contacts.iter().zip(surfaces).enumerate() {
        let fixed = fixed_frame(index, contact, surface)?;
        let partners = partners(&scene.mesh, index, contact, surface, fixed.as_ref())?;
        let sides = match fixed {
            None if partners.is_empty() => creases(&scene.mesh, surface, contact.crease),
            _ => HashMap::new(),
        };
        let alone = scene.contacts.len() == 1;
        for (local, &node) in surface.nodes().iter().enumerate() {
            let partner = partners.get(local);
            let measured = partner.map_or(0.0, |p: &Partner| p.gap);
            let gap = contact.gap_at(index, node, scene.mesh.points()[node as usize], measured)?;
            let one = [(surface.frames()[local], surface.areas()[local])];
            let own = sides.get(&(local as u32));
            for &(frame, area) in own.map_or(&one[..], Vec::as_slice) {
                let candidate = Candidate {
                    surface: index,
                    node,
                    opponent: partner.map(|p| p.node),
                    frame: fixed.unwrap_or(frame),
                    area,
                    gap,
                };
                if alone && own.is_none() {
                    out.push(candidate);
                    continue;
                }
                let others = known.entry(node).or_default();
                let same = |k: &&usize| is_same(scene, &out[**k], &candidate);
                match others.iter().find(same) {
                    Some(&k) => join(scene, &mut out[k], candidate)?,
                    None => {
                        others.push(out.len());
                        out.push(candidate);
                    }
                }
            }
        }
    }
    Ok(out)
}

/// The one frame of all nodes of a contact with a fixed direction.
fn fixed_frame(
    index: usize,
    contact: &Contact,
    surface: &Surface,
) -> Result<Option<Frame>, ContactError> {
    let ContactNormal::Fixed(normal) = contact.normal else {
        return Ok(None);
    };
    let frame = Frame::from_normal(normal).ok_or(ContactError::ObstacleNormal {
        contact: index,
        normal,
    })?;
    let outside = |own: &Frame| frame.normal_part(own.normal) > ALONG;
    if !surface.frames().iter().any(outside) {
        return Err(ContactError::ObstacleSide {
            contact: index,
            direction: normal,
            nodes: surface.nodes().len(),
        });
    }
    Ok(Some(frame))
}

/// Whether two points of a node are one: the same direction, or surfaces that go over into one another. Sides of one surface
/// have been told apart at its creases.
fn is_same(scene: &Scene, a: &Candidate, b: &Candidate) -> bool {
    if a.opponent.is_some() || b.opponent.is_some() {
        return false;
    }
    let cosine = a.frame.normal_part(b.frame.normal);
    if a.surface == b.surface {
        return cosine > SAME;
    }
    let [x, y] = [a, b].map(|c| &scene.contacts[c.surface]);
    let body = [x, y].iter().all(|c| c.normal == ContactNormal::Body);
    cosine > SAME || (body && cosine > x.crease.min(y.crease).to_radians().cos())
}

/// Joins a point to an earlier one of the same node: the law is that of the nearer obstacle. Surfaces with a tag in common
/// share its facets, whose area counts once.
fn join(scene: &Scene, point: &mut Candidate, other: Candidate) -> Result<(), ContactError> {
    let [x, y] = [&*point, &other].map(|c| &scene.contacts[c.surface]);
    if x.motion != y.motion {
        // which obstacle is nearer would change with time
        return Err(ContactError::SharedNode {
            node: point.node,
            first: point.surface,
            second: other.surface,
        });
    }
    let shared = point.surface != other.surface && x.tags.iter().any(|t| y.tags.contains(t));
    let weights = point.area + other.area;
    let area = if shared {
        point.area.max(other.area)
    } else {
        weights
    };
    if point.frame.normal_part(other.frame.normal) <= SAME {
        let mean = [0, 1, 2].map(|c| {
            (point.area * point.frame.normal[c] + other.area * other.frame.normal[c]) / weights
        });
        point.frame = Frame::from_normal(mean).unwrap_or(point.frame);
    }
    if other.gap < point.gap {
        (point.surface, point.gap) = (other.surface, other.gap);
    }
    point.area = area;
    Ok(())
}

/// The sides that meet at each node of a crease, as frames and areas; keys are places in the surface.
fn creases(mesh: &TetMesh, surface: &Surface, crease: f64) -> HashMap<u32, Vec<(Frame, f64)>> {
    let mut out = HashMap::new();
    if crease >= 180.0 {
        return out;
    }
    let limit = crease.to_radians().cos();
    let vectors: Vec<[f64; 3]> = surface
        .triangles()
        .iter()
        .map(|t| area_vector(mesh, surface, t))
        .collect();
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); surface.nodes().len()];
    for (k, triangle) in surface.triangles().iter().enumerate() {
        triangle
            .iter()
            .for_each(|&n| around[n as usize].push(k as u32));
    }
    for (node, triangles) in around.iter().enumerate() {
        let sides = sides(surface, &vectors, triangles, limit);
        if sides.len() < 2 {
            continue;
        }
        let side = |members: &Vec<u32>| {
            let mut sum = [0.0; 3];
            let mut area = 0.0;
            for &t in members {
                let v = vectors[t as usize];
                area += length(v) / 3.0;
                (0..3).for_each(|c| sum[c] += v[c]);
            }
            Frame::from_normal(sum).map(|frame| (frame, area))
        };
        out.insert(node as u32, sides.iter().filter_map(side).collect());
    }
    out
}

/// Triangles around a node, grouped: those that share an edge and are not separated by a crease are of one side.
fn sides(surface: &Surface, vectors: &[[f64; 3]], triangles: &[u32], limit: f64) -> Vec<Vec<u32>> {
    let smooth = |a: u32, b: u32| {
        let [v, w] = [a, b].map(|t| vectors[t as usize]);
        let [p, q] = [a, b].map(|t| surface.triangles()[t as usize]);
        let shared = p.iter().filter(|n| q.contains(n)).count();
        let product: f64 = v.iter().zip(&w).map(|(x, y)| x * y).sum();
        shared == 2 && product > limit * length(v) * length(w)
    };
    let mut left: Vec<u32> = triangles.to_vec();
    let mut out = Vec::new();
    while let Some(&first) = left.first() {
        let mut side = vec![first];
        left.remove(0);
        let mut next = 0;
        while next < side.len() {
            let from = side[next];
            let (joined, rest) = left.iter().partition(|&&t| smooth(from, t));
            left = rest;
            side.extend::<Vec<u32>>(joined);
            next += 1;
        }
        out.push(side);
    }
    out
}

/// Outward vector of a triangle, of the length of its area.
fn area_vector(mesh: &TetMesh, surface: &Surface, triangle: &[u32; 3]) -> [f64; 3] {
    let [a, b, c] = triangle.map(|n| mesh.points()[surface.nodes()[n as usize] as usize]);
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    [
        0.5 * (u[1] * v[2] - u[2] * v[1]),
        0.5 * (u[2] * v[0] - u[0] * v[2]),
        0.5 * (u[0] * v[1] - u[1] * v[0]),
    ]
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}
