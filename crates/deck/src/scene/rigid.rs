//! Rigid bodies: what belongs to them, how they move, and where they are a plane.
//!
//! A rigid surface is a half-space, exactly, if it is flat, if all nodes that may touch it lie over it, and if the body
//! does not turn. Any other one is a triangulated obstacle.

use std::collections::BTreeMap;

use signorini_contact::{Contact, Obstacle};
use signorini_fem_mesh::internal::distinct;
use signorini_fem_mesh::vec3::{Vec3, area_vector, cross, dot, norm, sub};
use signorini_fem_mesh::{FacetTag, History};

use super::history::{Histories, Track};
use super::numbers::Sets;
use super::rigid_face::{RigidFace, fan, triangles};
use super::timeline::Timeline;
use crate::error::{DeckError, Word};
use crate::lexer::Named;
use crate::model::{Kind, Model, RigidBody, Target};
use crate::tolerances::ROUNDING;

/// The nodes that say how a body moves, by position.
#[derive(Debug)]
struct Body {
    reference: u32,
    rotation: Option<u32>,
    /// Nodes of its elements and its set.
    nodes: Vec<u32>,
}

/// All rigid bodies and their elements.
#[derive(Debug)]
pub(super) struct RigidBodies {
    list: Vec<Body>,
    of_element: Vec<Option<u32>>,
}

/// A vector and its history; `None` if it is zero at all times.
type Course = Option<(Vec3, History)>;

/// What moves a body: its components 1 to 6 in time, all of them, the place of its node, and the word that names that.
#[derive(Debug)]
pub(super) struct Lead {
    pub(super) tracks: [Track; 6],
    pub(super) about: Vec3,
    pub(super) word: Word,
}

/// How a body moves: the displacements of a point, which add up, and its rotation about it, radians.
#[derive(Debug)]
pub(super) struct Motion {
    shifts: Vec<(Vec3, History)>,
    turn: Course,
    about: Vec3,
}

/// A component of a body, from 1, that is free, and the word that names its node.
#[derive(Debug)]
pub(super) struct FreeLead {
    component: usize,
    word: Word,
}

impl FreeLead {
    /// The error where the body is an obstacle.
    fn refused(&self) -> DeckError {
        self.word.cannot(format!(
            "the rigid body is not held along component {} (of 6, rotations are 4 to 6), and a rigid surface that \
            touches others is held or moved here, not loaded; give its node *BOUNDARY, or make the body elastic with a \
            *COUPLING, *KINEMATIC of its surface",
            self.component
        ))
    }
}

impl Lead {
    /// Three components as vectors, one for each history.
    fn courses(timeline: &Timeline, tracks: &[Track]) -> Result<Vec<(Vec3, History)>, DeckError> {
        let mut histories = Histories::default();
        let mut values: Vec<Vec3> = Vec::new();
        for (component, track) in tracks.iter().enumerate() {
            if let Some((size, history)) = histories.add(timeline, track)? {
                values.resize(values.len().max(history + 1), [0.0; 3]);
                values[history][component] = size;
            }
        }
        let moves = values.into_iter().enumerate().filter(|(_, value)| *value != [0.0; 3]);
        Ok(moves.map(|(history, value)| (value, histories.at(history))).collect())
    }

    /// The rotation; an error if its components have different histories.
    fn turn(&self, timeline: &Timeline) -> Result<Course, DeckError> {
        let mut courses = Self::courses(timeline, &self.tracks[3..])?;
        if courses.len() > 1 {
            let why = "the components of a rigid rotation have different histories: it would be about an axis that changes, and \
            there is one here; give its components one amplitude";
            return Err(self.word.cannot(why));
        }
        Ok(courses.pop())
    }

    /// The motion of an obstacle.
    pub(super) fn motion(&self, timeline: &Timeline) -> Result<Motion, DeckError> {
        Ok(Motion {
            shifts: Self::courses(timeline, &self.tracks[..3])?,
            turn: self.turn(timeline)?,
            about: self.about,
        })
    }

    /// The motion of what turns; where nothing turns, each component may have a history of its own.
    pub(super) fn turning(&self, timeline: &Timeline) -> Result<Option<Motion>, DeckError> {
        let turns = self.turn(timeline)?.is_some();
        turns.then(|| self.motion(timeline)).transpose()
    }

    /// Whether it turns while its components have different histories.
    pub(super) fn turns_apart(&self, timeline: &Timeline) -> Result<bool, DeckError> {
        let turns = !Self::courses(timeline, &self.tracks[3..])?.is_empty();
        let mut histories = Histories::default();
        let mut last = None;
        for track in &self.tracks {
            last = last.max(histories.add(timeline, track)?.map(|(_, history)| history));
        }
        Ok(turns && last > Some(0))
    }
}

impl Motion {
    /// A component of the displacement of a place, for small rotations, and its history; `None` if it is zero. Of what
    /// does not [turn apart](Lead::turns_apart).
    pub(super) fn at(&self, place: Vec3, component: usize) -> Option<(f64, History)> {
        let arm = sub(place, self.about);
        let shifts = self.shifts.iter().map(|(by, history)| (by[component], history));
        let turn = self
            .turn
            .iter()
            .map(|(by, history)| (cross(*by, arm)[component], history));
        let parts = shifts.chain(turn).filter(|part| part.0 != 0.0);
        let whole = parts.reduce(|(a, history), (b, _)| (a + b, history));
        whole.map(|(value, history)| (value, history.clone()))
    }
}

/// Whether some component of each body is not held, or loaded.
fn are_free(sets: &Sets, bodies: &[Body]) -> Result<Vec<bool>, DeckError> {
    let (model, steps) = (sets.model, || sets.model.steps.iter());
    let mut out = vec![false; bodies.len()];
    let mut held = vec![[false; 6]; bodies.len()];
    let forces = steps()
        .flat_map(|step| &step.forces.lines)
        .filter(|line| line.given.value != 0.0);
    for line in forces {
        let nodes = sets.nodes.find(&line.target, &line.word)?;
        let moves = |body: &Body| nodes.iter().any(|n| *n == body.reference || Some(*n) == body.rotation);
        out.iter_mut().zip(bodies).for_each(|(free, body)| *free |= moves(body));
    }
    // which a first step with OP=NEW clears
    let before = model
        .supports
        .iter()
        .filter(|_| !steps().next().is_some_and(|step| step.boundary.removes()));
    let lines = steps().flat_map(|step| &step.boundary.lines);
    for line in before.chain(lines) {
        let nodes = sets.nodes.find(&line.target, &line.word)?;
        for (held, body) in held.iter_mut().zip(bodies) {
            let rotation = body.rotation.filter(|node| *node != body.reference);
            let led = [(rotation, 3), (Some(body.reference), 0)];
            for (node, first) in led {
                if node.is_some_and(|node| nodes.contains(&node)) {
                    (first..6)
                        .filter(|c| line.kind.on[c - first])
                        .for_each(|c| held[c] = true);
                }
            }
        }
    }
    out.iter_mut()
        .zip(held)
        .for_each(|(free, held)| *free |= held.contains(&false));
    Ok(out)
}

impl RigidBodies {
    pub(super) fn new(sets: &Sets) -> Result<Self, DeckError> {
        let model = sets.model;
        let mut of_element = vec![None; model.elements.len()];
        let mut list = Vec::with_capacity(model.rigid.len());
        for (index, body) in model.rigid.iter().enumerate() {
            let mut nodes = Vec::new();
            if let Some(elset) = &body.elset {
                for element in sets.elements_of(elset)? {
                    let position = element as usize;
                    let element = &model.elements[position];
                    if of_element[position].replace(index as u32).is_some() {
                        let why = format!("element {} is in another rigid body; keep one of them", element.label);
                        return Err(elset.word.cannot(why));
                    }
                    nodes.extend(sets.nodes_of(element)?);
                }
            }
            if let Some(Named { name, word }) = &body.nset {
                nodes.extend(sets.nodes.find(&Target::Name(name.clone()), word)?);
            }
            let node = |(target, word): &(Target, Word)| sets.one_node(target, word);
            list.push(Body {
                reference: node(&body.reference)?,
                rotation: body.rotation.as_ref().map(node).transpose()?,
                nodes: distinct(nodes),
            });
        }
        // solid elements of what is free or loaded are elastic ones whose nodes are coupled
        let free = are_free(sets, &list)?;
        for (element, of) in model.elements.iter().zip(&mut of_element) {
            *of = of.filter(|body| !(matches!(element.kind, Kind::Solid(_)) && free[*body as usize]));
        }
        let references: Vec<u32> = list.iter().map(|body| body.reference).collect();
        for (body, said) in list.iter().zip(&model.rigid) {
            if let (Some(node), Some((_, word))) = (body.rotation, &said.rotation)
                && references.contains(&node)
            {
                let label = model.nodes[node as usize].label;
                return Err(word.cannot(format!(
                    "node {label} is a REF NODE, too, and its components 1 to 3 would be displacements and rotations; \
                    give the rotation a node of its own, or remove ROT NODE and hold 4 to 6 of REF NODE"
                )));
            }
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

    /// Whether the nodes that say how a body moves say so of another one, too.
    pub(super) fn share(&self, (reference, rotation): (u32, Option<u32>)) -> bool {
        let own = |n: u32| n == reference || Some(n) == rotation;
        let all = self.list.iter();
        all.filter(|b| own(b.reference) || b.rotation.is_some_and(own)).count() > 1
    }

    /// Refuses reference nodes that elastic elements use; `elastic` are those that do.
    pub(super) fn check_apart(&self, sets: &Sets, elastic: &[bool]) -> Result<(), DeckError> {
        for (body, said) in self.list.iter().zip(&sets.model.rigid) {
            let own = [Some(body.reference), body.rotation].into_iter().flatten();
            if let Some(node) = own.into_iter().find(|n| elastic[*n as usize]) {
                let label = sets.model.nodes[node as usize].label;
                let why = format!("node {label} belongs to an elastic element; give the rigid body a node of its own");
                return Err(said.reference.1.cannot(why));
            }
        }
        Ok(())
    }

    /// Refuses rotations of a ROT NODE itself, and those that it and REF NODE hold in two ways; `held` are the
    /// components of nodes that are held.
    pub(super) fn check_rotations<'a>(
        &self,
        timeline: &Timeline,
        held: impl Fn(u32, usize) -> Option<&'a Track>,
    ) -> Result<(), DeckError> {
        for (body, said) in self.list.iter().zip(&timeline.model.rigid) {
            let (Some(node), Some((_, word))) = (body.rotation, &said.rotation) else {
                continue;
            };
            for component in 3..6 {
                let Some(track) = held(node, component) else {
                    continue;
                };
                if Histories::default().add(timeline, track)?.is_some() {
                    return Err(track.word.cannot(format!(
                        "component {} of a ROT NODE means nothing, its components 1 to 3 are the rotation; give these",
                        component + 1
                    )));
                }
            }
            for component in 0..3 {
                let (Some(one), Some(other)) = (held(node, component), held(body.reference, component + 3)) else {
                    continue;
                };
                let mut histories = Histories::default();
                if histories.add(timeline, one)? != histories.add(timeline, other)? {
                    return Err(word.cannot(format!(
                        "component {} of this node and component {} of REF NODE are the same rotation, and they differ; \
                        keep one of them",
                        component + 1,
                        component + 4
                    )));
                }
            }
        }
        Ok(())
    }

    /// Nodes of the deck that move with a body, its reference node and the node of its rotation.
    pub(super) fn nodes(&self) -> impl Iterator<Item = (&[u32], u32, Option<u32>)> {
        self.list.iter().map(|b| (&*b.nodes, b.reference, b.rotation))
    }

    /// Position of the reference node whose motion a node says, and whether as its rotation.
    pub(super) fn reference_of(&self, node: u32) -> Option<(u32, bool)> {
        let body = (self.list.iter()).find(|b| b.reference == node || b.rotation == Some(node))?;
        Some((body.reference, body.reference != node))
    }

    /// What moves each body, or the component from 1 that is free; `held` are the components 0 to 5 of its nodes that
    /// supports hold.
    pub(super) fn leads(&self, model: &Model, held: &BTreeMap<(u32, usize), Track>) -> Vec<Result<Lead, FreeLead>> {
        let lead = |(body, said): (&Body, &RigidBody)| {
            let word = said.reference.1.clone();
            match all_components(rigid_components(held, (body.reference, body.rotation))) {
                Ok(tracks) => Ok(Lead {
                    tracks,
                    about: model.nodes[body.reference as usize].point,
                    word,
                }),
                Err(component) => Err(FreeLead { component, word }),
            }
        };
        self.list.iter().zip(&model.rigid).map(lead).collect()
    }
}

/// What the steps say about the six components of what is rigid: of its reference node, or of the node whose
/// displacement is its rotation.
pub(super) fn rigid_components<T: Clone>(
    held: &BTreeMap<(u32, usize), T>,
    (reference, rotation): (u32, Option<u32>),
) -> [Option<T>; 6] {
    [0, 1, 2, 3, 4, 5].map(|component: usize| {
        let own = held.get(&(reference, component));
        let other = || held.get(&(rotation?, component.checked_sub(3)?));
        own.or_else(other).cloned()
    })
}

/// All of them, or the first that is free, from 1.
pub(super) fn all_components<T>(held: [Option<T>; 6]) -> Result<[T; 6], usize> {
    let free = held.iter().position(Option::is_none);
    match held {
        [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f)] => Ok([a, b, c, d, e, f]),
        _ => Err(free.map_or(0, |component| component + 1)),
    }
}

/// The contact of the facets with a tag with a rigid surface that `word` names, and whether it is a half-space. `over`
/// are the places that may touch it.
pub(super) fn obstacle(
    faces: &[RigidFace],
    (timeline, leads): (&Timeline, &[Result<Lead, FreeLead>]),
    (tag, over): (FacetTag, &[Vec3]),
    word: &Word,
) -> Result<(Contact, bool), DeckError> {
    let body = faces[0].body;
    if faces.iter().any(|face| face.body != body) {
        return Err(word.cannot("the surface is on several rigid bodies; give a pair for each"));
    }
    let lead = leads[body as usize].as_ref().map_err(FreeLead::refused)?;
    let motion = lead.motion(timeline)?;
    let plane = if motion.turn.is_none() { plane(faces, over) } else { None };
    let mut contact = match plane {
        Some([point, normal]) => Contact::half_space(tag, point, normal),
        None => {
            let points = triangles(faces).concat();
            let triangles: Vec<[u32; 3]> = (0..points.len() as u32 / 3)
                .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
                .collect();
            let surface = Obstacle::surface(&points, &triangles);
            Contact::obstacle(
                tag,
                surface.map_err(|error| word.cannot(format!("the rigid surface is no obstacle: {error}")))?,
            )
        }
    };
    for (displacement, history) in &motion.shifts {
        contact = contact.with_motion(*displacement, history.clone());
    }
    if let Some((by, history)) = &motion.turn {
        let angle = norm(*by);
        let points = history
            .points()
            .iter()
            .map(|(time, factor)| (*time, factor * angle))
            .collect();
        let angle =
            History::table(points).map_err(|error| word.cannot(format!("the rotation of the rigid body: {error}")))?;
        contact = contact.with_rotation(motion.about, *by, angle);
    }
    Ok((contact, plane.is_some()))
}

/// A point and the outward normal of the plane of a surface, if it is flat and all places lie over it.
fn plane(faces: &[RigidFace], over: &[Vec3]) -> Option<[Vec3; 2]> {
    let triangles: Vec<[Vec3; 3]> = faces.iter().flat_map(|face| fan(&face.corners)).collect();
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
        return None;
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
    let mids = faces.iter().flat_map(|face| &face.mids);
    let is_flat = triangles.iter().all(flat) && mids.into_iter().all(|x| height(x).abs() <= ROUNDING * reach);
    let covers = |x: &Vec3| triangles.iter().any(|t| contains(t, normal, *x));
    (is_flat && over.iter().all(covers)).then_some([point, normal])
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
