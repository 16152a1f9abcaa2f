//! `*CLOAD`, `*DLOAD` and `*DSLOAD` of all steps as loads.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use signorini_contact::Load;
use signorini_fem_mesh::internal::distinct;
use signorini_fem_mesh::vec3::{Vec3, scale, unit};
use signorini_fem_mesh::{FacetTag, LoadDensity};

use super::faces::FaceTable;
use super::history::{Histories, Tracks};
use super::known::Known;
use super::pretension::{ONE, Sections};
use super::spread::Spread;
use super::supports::Rigid;
use super::volume::Volume;
use crate::error::{DeckError, Word};
use crate::model::{Components, Condition, Conditions, CouplingLaw, DistributedKind, FORCE, Given, Target};

/// Most different pressures that get tags of their own. More become the same forces at nodes.
const PRESSURES: usize = 100;

/// Forces at nodes that share a history, by its position, and their place among all.
type Forces = BTreeMap<usize, (usize, BTreeMap<u32, Vec3>)>;

/// What a force is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Place {
    /// A node of the mesh.
    Node(u32),
    /// The surface of a distributing coupling, by its position.
    Coupling(usize),
    /// What is rigid, by its reference node in the deck.
    Rigid(u32),
}

/// All loads, with the pressures noted in the table of faces.
#[derive(Debug, Default)]
pub(super) struct Loads {
    histories: Histories,
    /// Value, history, place among all.
    pressures: Vec<(f64, usize, usize)>,
    forces: Forces,
    /// Forces and moments on what is rigid: by its reference node and history, with their place among all.
    rigid: BTreeMap<(u32, usize), (usize, [f64; 6])>,
    /// Loads of the whole mesh: place among all, density, history.
    bodies: Vec<(usize, LoadDensity, usize)>,
    /// The targets in the order of the deck.
    words: Vec<Word>,
}

impl Loads {
    /// The loads of all steps; `surfaces` are the faces of each surface.
    pub(super) fn new(known: Known, surfaces: &[Vec<u32>], faces: &mut FaceTable) -> Result<Self, DeckError> {
        let mut forces = Tracks::default();
        let (mut pressures, mut tractions) = (Tracks::default(), Tracks::default());
        let mut bodies = Volume::new(&known.raw.points);
        let mut loads = Self::default();
        for (step, given) in known.model.steps.iter().enumerate() {
            known.forces(&mut forces, step, &given.forces, &mut loads.words)?;
            if given.distributed.removes() {
                pressures.remove(step);
                tractions.remove(step);
                bodies.remove(step);
            }
            for line in &given.distributed.lines {
                let order = loads.words.len();
                loads.words.push(line.word.clone());
                let to = (&mut pressures, &mut tractions, &mut bodies);
                known.distributed(to, (step, order), line, surfaces, faces)?;
            }
        }
        let mut spreads = BTreeMap::new();
        for (&(place, component), track) in &forces.0 {
            let Some((value, history)) = loads.histories.add(known.timeline, track)? else {
                continue;
            };
            match place {
                Place::Node(node) => {
                    let at = (node, known.raw.points[node as usize]);
                    let force = known.transforms.force(at, component, value, &track.word)?;
                    loads.force(history, track.order, node, force);
                }
                Place::Rigid(reference) => {
                    let new = (track.order, [0.0; 6]);
                    let (order, forces) = loads.rigid.entry((reference, history)).or_insert(new);
                    *order = track.order.min(*order);
                    forces[component] += value;
                }
                Place::Coupling(index) => {
                    let spread = match spreads.entry(index) {
                        Entry::Occupied(made) => made.into_mut(),
                        Entry::Vacant(place) => place.insert(Spread::new(&known.couplings.0[index], known, faces)?),
                    };
                    for (node, force) in spread.forces(component, value) {
                        loads.force(history, track.order, node, force);
                    }
                }
            }
        }
        loads.pressures(known, &pressures, faces)?;
        for (&(face, component), track) in &tractions.0 {
            let Some((value, history)) = loads.histories.add(known.timeline, track)? else {
                continue;
            };
            for (node, area) in faces.list[face as usize].areas(known.raw) {
                let mut force = [0.0; 3];
                force[component] = value * area;
                loads.force(history, track.order, node, force);
            }
        }
        let Self { histories, forces, .. } = &mut loads;
        loads.bodies = bodies.lower(known, histories, |history, order, node, force| {
            add_force(forces, (history, order), node, force);
        })?;
        Ok(loads)
    }

    /// Groups pressures by value and history and notes the group of each face; forces at nodes if there are too many.
    fn pressures(&mut self, known: Known, tracks: &Tracks<u32>, faces: &mut FaceTable) -> Result<(), DeckError> {
        let mut of_face = Vec::with_capacity(tracks.0.len());
        let mut groups: BTreeMap<(u64, usize), usize> = BTreeMap::new();
        for (&face, track) in &tracks.0 {
            let found = self.histories.add(known.timeline, track)?;
            let Some((value, history)) = found else {
                continue;
            };
            let key = (value.to_bits(), history);
            let order = groups.entry(key).or_insert(track.order);
            *order = track.order.min(*order);
            of_face.push((face, value, history, track.order));
        }
        if groups.len() > PRESSURES {
            for (face, value, history, order) in of_face {
                let face = &faces.list[face as usize];
                for (node, area) in face.area_vectors(known.raw) {
                    self.force(history, order, node, scale(-value, area));
                }
            }
            return Ok(());
        }
        let mut numbers = BTreeMap::new();
        for (&(value, history), &order) in &groups {
            numbers.insert((value, history), self.pressures.len() as u32);
            let pressure = (f64::from_bits(value), history, order);
            self.pressures.push(pressure);
        }
        for (face, value, history, _) in of_face {
            let group = numbers.get(&(value.to_bits(), history));
            faces.list[face as usize].pressure = group.copied();
        }
        Ok(())
    }

    fn force(&mut self, history: usize, order: usize, node: u32, force: Vec3) {
        add_force(&mut self.forces, (history, order), node, force);
    }

    /// The reference nodes of what is rigid that have loads, by position, with the word of one.
    pub(super) fn on_rigid(&self) -> BTreeMap<u32, Word> {
        let word = |(key, load): (&(u32, usize), &(usize, [f64; 6]))| (key.0, self.words[load.0].clone());
        self.rigid.iter().map(word).collect()
    }

    /// The loads of the scene, in the order of the deck, each with the first word that asks for it; `tags` are those of
    /// the faces, `rigid` the couplings of the scene.
    pub(super) fn lower(
        self,
        faces: &FaceTable,
        tags: &[FacetTag],
        (rigid, sections): (&[Rigid], &Sections),
    ) -> Vec<(Load, Word)> {
        let mut out: Vec<(usize, Load, usize)> = Vec::new();
        for (number, (value, history, order)) in (0..).zip(&self.pressures) {
            let with = faces.list.iter().zip(tags);
            let with = with.filter(|(face, _)| face.pressure == Some(number));
            let tags = distinct(with.map(|(_, tag)| *tag));
            let pressure = |tag| (*order, Load::pressure(tag, *value), *history);
            out.extend(tags.into_iter().map(pressure));
        }
        for (history, (order, forces)) in self.forces {
            let forces = forces.into_iter().collect();
            out.push((order, Load::new(LoadDensity::NodalForces(forces)), history));
        }
        out.extend(
            self.bodies
                .into_iter()
                .map(|(order, density, history)| (order, Load::new(density), history)),
        );
        for ((reference, history), (order, [a, b, c, d, e, f])) in self.rigid {
            // loaded ones are couplings
            let number = rigid.iter().position(|r| r.reference == reference);
            let force = sections.of(reference).map_or([a, b, c], |section| section.force(a));
            let load = |number| (order, Load::on_coupling(number, force, [d, e, f]), history);
            out.extend(number.map(load));
        }
        out.sort_by_key(|load| load.0);
        let load = |(order, load, history): (usize, Load, usize)| {
            let load = load.with_history(self.histories.at(history));
            (load, self.words[order].clone())
        };
        out.into_iter().map(load).collect()
    }
}

/// Adds a force at a node to those with the same history.
fn add_force(forces: &mut Forces, (history, order): (usize, usize), node: u32, force: Vec3) {
    let (first, list) = forces.entry(history).or_insert_with(|| (order, BTreeMap::new()));
    *first = order.min(*first);
    let sum = list.entry(node).or_insert([0.0; 3]);
    for c in 0..3 {
        sum[c] += force[c];
    }
}

impl Known<'_> {
    fn forces(
        self,
        tracks: &mut Tracks<(Place, usize)>,
        step: usize,
        given: &Conditions<Components>,
        words: &mut Vec<Word>,
    ) -> Result<(), DeckError> {
        if given.removes() {
            tracks.remove(step);
        }
        for line in &given.lines {
            let order = words.len();
            words.push(line.word.clone());
            for node in self.sets.nodes.find(&line.target, &line.word)? {
                let (place, first) = self.place_of_force(node, line)?;
                for component in (0..6).filter(|&c| line.kind.on[c]).map(|c| first + c) {
                    tracks.set((place, component), (step, order, true), line.given, &line.word)?;
                }
            }
        }
        Ok(())
    }

    /// What a force at a node of the deck, by position, is on, and which component there its first one is.
    fn place_of_force(self, node: u32, line: &Condition<Components>) -> Result<(Place, usize), DeckError> {
        let rotation = line.kind.rotation.as_ref();
        if let Some((index, coupling)) = self.couplings.of(node) {
            let moments = match coupling.law {
                CouplingLaw::Distributing { moments } => moments,
                CouplingLaw::Pretension { .. } if line.kind.on[1..].contains(&true) => {
                    return Err(line.word.cannot(ONE));
                }
                _ => return Ok((Place::Rigid(node), 0)),
            };
            return match rotation.filter(|_| (0..3).any(|c| line.kind.on[3 + c] && !moments[c])) {
                Some(word) => {
                    Err(word.cannot("the *DISTRIBUTING of this node does not name the component; add it there"))
                }
                None => Ok((Place::Coupling(index), 0)),
            };
        }
        match (self.bodies.reference_of(node), rotation) {
            (Some((_, true)), Some(word)) => {
                return Err(word.cannot("components 1 to 3 of a ROT NODE are the moments; give these"));
            }
            (Some((reference, is_rotation)), _) => {
                return Ok((Place::Rigid(reference), if is_rotation { 3 } else { 0 }));
            }
            (None, _) => {}
        }
        match rotation {
            Some(word) if self.points.has(node) => return Err(word.expected(FORCE)),
            None if self.points.has(node) => return Ok((Place::Rigid(node), 0)),
            _ => {}
        }
        let inside = self.raw.in_mesh(node).ok_or_else(|| {
            let label = self.model.nodes[node as usize].label;
            line.word.cannot(format!(
                "no elastic element uses node {label}, so that a force there acts on nothing; load nodes of the body"
            ))
        })?;
        match rotation {
            Some(word) => Err(word.expected(FORCE)),
            None => self.raw.single(inside, &line.word).map(|()| (Place::Node(inside), 0)),
        }
    }

    fn distributed(
        self,
        (pressures, tractions, bodies): (&mut Tracks<u32>, &mut Tracks<(u32, usize)>, &mut Volume),
        (step, order): (usize, usize),
        line: &Condition<DistributedKind>,
        surfaces: &[Vec<u32>],
        table: &mut FaceTable,
    ) -> Result<(), DeckError> {
        let word = &line.word;
        let when = (step, order, false);
        let given = line.given;
        let faces = match &line.kind {
            DistributedKind::Face(number) => {
                let target = (&line.target, *number);
                table.of_target(self, target, word)?
            }
            DistributedKind::Surface | DistributedKind::Traction(_) => {
                let Target::Name(name) = &line.target else {
                    return Ok(());
                };
                let found = self.model.surfaces.find("surface", name, word)?;
                self.sections.check_outside(found, word)?;
                if surfaces[found].is_empty() {
                    return Err(word.cannot("a load on a rigid surface acts on nothing; load an elastic one"));
                }
                surfaces[found].clone()
            }
            DistributedKind::Volume(law) => {
                // so that an unknown set is refused here
                self.sets.elements.find(&line.target, word)?;
                return bodies.set(&line.target, law, when, given, word);
            }
        };
        for face in faces {
            let DistributedKind::Traction(direction) = &line.kind else {
                pressures.set(face, when, given, word)?;
                continue;
            };
            for (component, along) in unit(*direction).into_iter().enumerate() {
                let value = given.value * along;
                tractions.set((face, component), when, Given { value, ..given }, word)?;
            }
        }
        Ok(())
    }
}
