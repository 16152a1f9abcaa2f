//! Rigid bodies: what belongs to them, how they move, and where they are a plane.
//!
//! The library knows a rigid half-space. A rigid surface is one, exactly, if it is flat, if all nodes that may
//! touch it lie over it, and if the body is held or moved along a straight line without turning. Anything else
//! is refused.

use std::collections::BTreeMap;

use signorini_contact::Contact;
use signorini_fem_mesh::vec3::{area_vector, dot, norm, sub};
use signorini_fem_mesh::{FacetTag, History};

use super::history::{Histories, Track};
use super::numbers::Sets;
use super::timeline::Timeline;
use crate::error::{DeckError, Word};
use crate::model::{FACES, Kind, Side, Target};

/// Deviation from a plane, and of a node from the rim of a surface, over its size, that is rounding.
const ROUNDING: f64 = 1e-9;

/// The nodes that say how a body moves, by position.
#[derive(Debug)]
struct Body {
    reference: u32,
    rotation: Option<u32>,
}

/// All rigid bodies and their elements.
#[derive(Debug)]
pub(super) struct RigidBodies {
    list: Vec<Body>,
    of_element: Vec<Option<u32>>,
}

/// A side of a rigid element: corners, counter-clockwise seen from outside.
#[derive(Debug)]
pub(super) struct RigidFace {
    corners: Vec<[f64; 3]>,
    body: u32,
}

/// Displacement of a body and its history; `None` if it is held.
pub(super) type Motion = Option<([f64; 3], History)>;

impl RigidBodies {
    pub(super) fn new(sets: &Sets) -> Result<Self, DeckError> {
        let model = sets.model;
        let mut of_element = vec![None; model.elements.len()];
        let mut list = Vec::with_capacity(model.rigid.len());
        for (index, body) in model.rigid.iter().enumerate() {
            let word = &body.elset.word;
            for element in sets.elements_of(&body.elset)? {
                if of_element[element as usize].replace(index as u32).is_some() {
                    let label = model.elements[element as usize].label;
                    let why = format!("element {label} is in another rigid body; keep one of them");
                    return Err(word.cannot(why));
                }
            }
            let node = |(target, word): &(Target, Word)| sets.one_node(target, word);
            list.push(Body {
                reference: node(&body.reference)?,
                rotation: body.rotation.as_ref().map(node).transpose()?,
            });
        }
        Ok(Self { list, of_element })
    }

    pub(super) fn of_element(&self, element: u32) -> Option<u32> {
        self.of_element[element as usize]
    }

    /// Whether a node of the deck, by position, says how a body moves.
    pub(super) fn has(&self, node: u32) -> bool {
        let all = self.list.iter();
        all.flat_map(|b| [Some(b.reference), b.rotation])
            .any(|n| n == Some(node))
    }

    /// Refuses bodies that share nodes with elastic elements, which would be bonded to them; `elastic` are the nodes
    /// that such elements use.
    pub(super) fn check_apart(&self, sets: &Sets, elastic: &[bool]) -> Result<(), DeckError> {
        let model = sets.model;
        let fault = |word: &Word, node: u32| {
            Err(word.cannot(format!(
                "node {} is of a rigid body and of elastic elements, and rigid parts of elastic bodies are not here; \
                hold or move the nodes with *BOUNDARY, or give the rigid body nodes of its own",
                model.nodes[node as usize].label
            )))
        };
        for (body, said) in self.list.iter().zip(&model.rigid) {
            let own = [Some(body.reference), body.rotation].into_iter().flatten();
            if let Some(node) = own.into_iter().find(|n| elastic[*n as usize]) {
                return fault(&said.reference.1, node);
            }
        }
        let all = model.elements.iter().zip(&self.of_element);
        for (element, _) in all.filter(|(_, body)| body.is_some()) {
            let nodes = sets.corners(element)?;
            if let Some(node) = nodes.into_iter().find(|n| elastic[*n as usize]) {
                return fault(&element.word(), node);
            }
        }
        Ok(())
    }

    /// A side of a rigid element, by its position.
    pub(super) fn face(&self, sets: &Sets, (element, side): (u32, Side), word: &Word) -> Result<RigidFace, DeckError> {
        let body = self.of_element(element).unwrap_or(0);
        let element = &sets.model.elements[element as usize];
        let nodes = sets.corners(element)?;
        let p = nodes.map(|n| sets.model.nodes[n as usize].point);
        let mut corners = match (element.kind, side) {
            (Kind::Solid, Side::Face(number)) => {
                let [a, b, c] = FACES[usize::from(number) - 1];
                // these faces are numbered counter-clockwise seen from inside
                vec![p[a], p[c], p[b]]
            }
            (Kind::Solid, _) => return Err(word.expected("faces S1 to S4 of solid elements")),
            (_, Side::Face(_)) => return Err(word.expected("SPOS or SNEG of rigid facets")),
            (Kind::Triangle, _) => p[..3].to_vec(),
            (Kind::Quadrilateral, _) => p.to_vec(),
        };
        if side == (Side::Facet { positive: false }) {
            corners.reverse();
        }
        Ok(RigidFace { corners, body })
    }

    /// How each body moves; `held` are the components 0 to 5 of its nodes that supports hold.
    pub(super) fn motions(
        &self,
        timeline: &Timeline,
        held: &BTreeMap<(u32, usize), Track>,
    ) -> Result<Vec<Motion>, DeckError> {
        let mut out = Vec::with_capacity(self.list.len());
        for (body, said) in self.list.iter().zip(&timeline.model.rigid) {
            let word = &said.reference.1;
            let mut histories = Histories::default();
            let mut value = [0.0; 3];
            for component in 0..6 {
                let own = held.get(&(body.reference, component));
                let other = body.rotation.filter(|_| component >= 3);
                let turned = other.and_then(|n| held.get(&(n, component - 3)));
                let Some(track) = own.or(turned) else {
                    return Err(word.cannot(format!(
                        "the rigid body is not held along component {} (of 6, rotations are 4 to 6); give \
                        its node *BOUNDARY, since only a held or moved obstacle can be said",
                        component + 1
                    )));
                };
                let Some((size, history)) = histories.add(timeline, track)? else {
                    continue;
                };
                if component >= 3 {
                    return Err(word.cannot("a rigid body that turns cannot be said; hold its rotations"));
                }
                if history > 0 {
                    let why = "the components of a rigid body's motion have different histories, and an obstacle has \
                    one; give them one amplitude";
                    return Err(word.cannot(why));
                }
                value[component] = size;
            }
            let moves = value.iter().any(|v| *v != 0.0);
            out.push(moves.then(|| (value, histories.at(0))));
        }
        Ok(out)
    }
}

/// The contact of the facets with a tag with a rigid surface, as one with a half-space. `over` are the nodes
/// that may touch it, with their numbers in the deck.
pub(super) fn half_space(
    faces: &[RigidFace],
    motions: &[Motion],
    tag: FacetTag,
    over: &[(u32, [f64; 3])],
) -> Result<Contact, String> {
    let body = faces[0].body;
    if faces.iter().any(|face| face.body != body) {
        return Err("the surface is on several rigid bodies; give a pair for each".into());
    }
    let triangles: Vec<[[f64; 3]; 3]> = faces
        .iter()
        .flat_map(|face| (1..face.corners.len() - 1).map(|i| [face.corners[0], face.corners[i], face.corners[i + 1]]))
        .collect();
    let largest = triangles
        .iter()
        .map(area_vector)
        .max_by(|a, b| norm(*a).total_cmp(&norm(*b)));
    let area = largest.unwrap_or_default();
    // without negative zeros
    let normal = area.map(|c| c / norm(area) + 0.0);
    let point = faces[0].corners[0];
    let size = norm(area).sqrt();
    if !(size > 0.0 && size.is_finite()) {
        return Err("the rigid surface has no area; check its nodes".into());
    }
    let height = |x: &[f64; 3]| dot(sub(*x, point), normal);
    let reach = triangles
        .iter()
        .flatten()
        .map(|x| norm(sub(*x, point)))
        .fold(size, f64::max);
    let flat = |t: &[[f64; 3]; 3]| {
        let own = area_vector(t);
        t.iter().all(|x| height(x).abs() <= ROUNDING * reach) && dot(own, normal) >= (1.0 - ROUNDING) * norm(own)
    };
    if !triangles.iter().all(flat) {
        return Err(
            "the rigid surface is not flat, and only a plane can be said exactly; give a plane, or a \
        gap that depends on the place in a program (Contact::with_gap_field)"
                .into(),
        );
    }
    for (label, x) in over {
        if !triangles.iter().any(|t| contains(t, normal, *x)) {
            return Err(format!(
                "node {label} of the other surface lies beside the rigid surface, where a half-space would \
                hold it as well; make the rigid surface larger or the other one smaller"
            ));
        }
    }
    let contact = Contact::half_space(tag, point, normal);
    Ok(match &motions[body as usize] {
        Some((displacement, history)) => contact.with_motion(*displacement, history.clone()),
        None => contact,
    })
}

/// Whether a point lies over a triangle, its rim included.
fn contains(triangle: &[[f64; 3]; 3], normal: [f64; 3], x: [f64; 3]) -> bool {
    (0..3).all(|i| {
        let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
        // twice the area on the inner side of the edge
        let inside = 2.0 * dot(area_vector(&[a, b, x]), normal);
        let edge = norm(sub(b, a));
        inside >= -ROUNDING * edge * (edge + norm(sub(x, a)))
    })
}
