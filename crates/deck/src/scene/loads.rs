//! `*CLOAD`, `*DLOAD` and `*DSLOAD` of all steps as loads.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use signorini_contact::Load;
use signorini_fem_mesh::internal::distinct;
use signorini_fem_mesh::vec3::{norm, scale, sub};
use signorini_fem_mesh::{FacetTag, LoadDensity};

use super::faces::{FaceTable, Known};
use super::history::{Histories, Track};
use super::materials::sections;
use super::spread::Spread;
use crate::error::{DeckError, Word};
use crate::model::{Components, Condition, Conditions, CouplingLaw, DistributedKind, FORCE, Given, Target};

/// Most different pressures that get tags of their own. More become forces at nodes, which are the same for
/// linear elements.
const PRESSURES: usize = 100;

/// Difference of unit vectors that is rounding of what a deck writes.
const TURNED: f64 = 1e-5;

/// Loads that share a history, by its position, and their place among all.
type Groups<T> = BTreeMap<usize, (usize, T)>;

/// What a force is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Place {
    /// A node of the mesh.
    Node(u32),
    /// The surface of a coupling, by its position.
    Coupling(usize),
}

/// A load of the volume: elements, what it is, and the component.
type BodyKey = (Target, bool, usize);

/// All loads, with the pressures noted in the table of faces.
#[derive(Debug, Default)]
pub(super) struct Loads {
    histories: Histories,
    /// Value, history, place among all.
    pressures: Vec<(f64, usize, usize)>,
    forces: Groups<BTreeMap<u32, [f64; 3]>>,
    bodies: Vec<(usize, usize, [f64; 3])>,
    /// The targets in the order of the deck.
    words: Vec<Word>,
}

/// A condition by what it acts on.
struct Tracks<K>(BTreeMap<K, Track>);

impl<K: Ord> Tracks<K> {
    fn remove(&mut self, step: usize) {
        self.0.values_mut().for_each(|track| track.remove(step));
    }

    /// Notes a value. Another one in the same step is added, if it may be and has the same amplitude.
    fn set(
        &mut self,
        key: K,
        (step, order, adds): (usize, usize, bool),
        mut given: Given,
        word: &Word,
    ) -> Result<(), DeckError> {
        let track = self.0.entry(key).or_insert_with(|| Track::new(order, word));
        if let Some(before) = track.given_in(step) {
            if !adds || before.amplitude != given.amplitude {
                return Err(word.cannot(if adds {
                    "a force along this component is given in this step already, with another amplitude; \
                    put them on different nodes, or give one amplitude"
                } else {
                    "such a load is given there in this step already; add the values and give their sum once"
                }));
            }
            given.value += before.value;
        }
        track.set(step, given);
        Ok(())
    }
}

impl Loads {
    /// The loads of all steps; `surfaces` are the faces of each surface.
    pub(super) fn new(known: Known, surfaces: &[Vec<u32>], faces: &mut FaceTable) -> Result<Self, DeckError> {
        let mut forces = Tracks(BTreeMap::new());
        let mut pressures = Tracks(BTreeMap::new());
        let mut bodies = Tracks(BTreeMap::new());
        let mut gravity = BTreeMap::new();
        let mut loads = Self::default();
        for (step, given) in known.model.steps.iter().enumerate() {
            known.forces(&mut forces, step, &given.forces, &mut loads.words)?;
            if given.distributed.removes() {
                pressures.remove(step);
                bodies.remove(step);
                gravity.clear();
            }
            for line in &given.distributed.lines {
                let order = loads.words.len();
                loads.words.push(line.word.clone());
                one_gravity(&mut gravity, line)?;
                let to = (&mut pressures, &mut bodies);
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
        loads.bodies(known, &bodies)?;
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
                let area = face.area_vector(known.raw);
                for node in face.loaded(known.raw) {
                    self.force(history, order, node, area.map(|a| -value * a / 3.0));
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

    /// Gravity and forces per volume: one density where all elements have the same, else forces at nodes.
    fn bodies(&mut self, known: Known, tracks: &Tracks<BodyKey>) -> Result<(), DeckError> {
        type Group = (Target, bool, usize);
        let mut groups: BTreeMap<Group, (usize, [f64; 3], &Track)> = BTreeMap::new();
        for ((target, gravity, component), track) in &tracks.0 {
            let found = self.histories.add(known.timeline, track)?;
            if let Some((value, history)) = found {
                let key = (target.clone(), *gravity, history);
                let group = groups.entry(key).or_insert((track.order, [0.0; 3], track));
                group.1[*component] = value;
            }
        }
        for ((target, gravity, history), (order, value, track)) in groups {
            let Known { sets, raw, .. } = known;
            let elements = sets.elements.find(&target, &track.word)?;
            // rigid ones are held, whatever pulls them
            let elements: Vec<u32> = elements.into_iter().filter_map(|e| raw.tet(e)).collect();
            if elements.is_empty() {
                continue;
            }
            let densities = match gravity {
                true => known.densities(&elements, track)?,
                false => vec![1.0; elements.len()],
            };
            let same = densities.iter().all(|d| *d == densities[0]);
            if same && elements.len() == raw.tets.len() {
                let density = densities[0];
                self.bodies.push((order, history, value.map(|v| density * v)));
                continue;
            }
            for (&element, density) in elements.iter().zip(densities) {
                for (node, part) in raw.shares(element) {
                    let share = part * density * raw.volume(element);
                    self.force(history, order, node, value.map(|v| share * v));
                }
            }
        }
        Ok(())
    }

    fn force(&mut self, history: usize, order: usize, node: u32, force: [f64; 3]) {
        let group = self.forces.entry(history);
        let (first, list) = group.or_insert_with(|| (order, BTreeMap::new()));
        *first = order.min(*first);
        let sum = list.entry(node).or_insert([0.0; 3]);
        for c in 0..3 {
            sum[c] += force[c];
        }
    }

    /// The loads of the scene, in the order of the deck, each with the first word that asks for it; `tags` are those of
    /// the faces.
    pub(super) fn lower(self, faces: &FaceTable, tags: &[FacetTag]) -> Vec<(Load, Word)> {
        let mut out: Vec<(usize, LoadDensity, usize)> = Vec::new();
        for (number, (value, history, order)) in (0..).zip(&self.pressures) {
            let with = faces.list.iter().zip(tags);
            let with = with.filter(|(face, _)| face.pressure == Some(number));
            let tags = distinct(with.map(|(_, tag)| *tag));
            let pressure = |tag| (*order, LoadDensity::pressure(tag, *value), *history);
            out.extend(tags.into_iter().map(pressure));
        }
        for (history, (order, forces)) in self.forces {
            let forces = forces.into_iter().collect();
            out.push((order, LoadDensity::nodal_forces(forces), history));
        }
        for (order, history, value) in self.bodies {
            out.push((order, LoadDensity::body(value), history));
        }
        out.sort_by_key(|load| load.0);
        let load = |(order, density, history): (usize, LoadDensity, usize)| {
            let load = Load::new(density).with_history(self.histories.at(history));
            (load, self.words[order].clone())
        };
        out.into_iter().map(load).collect()
    }
}

/// Refuses gravity along another direction than before; `directions` are those that stand.
fn one_gravity<'a>(
    directions: &mut BTreeMap<&'a Target, [f64; 3]>,
    line: &'a Condition<DistributedKind>,
) -> Result<(), DeckError> {
    let DistributedKind::Gravity(direction) = line.kind else {
        return Ok(());
    };
    let unit = scale(1.0 / norm(direction), direction);
    match directions.insert(&line.target, unit) {
        Some(before) if norm(sub(before, unit)) > TURNED => Err(line.word.cannot(
            "gravity along another direction stands there, which CalculiX keeps beside this and Abaqus replaces; give \
            one vector, in a later step with OP=NEW",
        )),
        _ => Ok(()),
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
                let place = self.place_of_force(node, line)?;
                for component in (0..6).filter(|&c| line.kind.on[c]) {
                    tracks.set((place, component), (step, order, true), line.given, &line.word)?;
                }
            }
        }
        Ok(())
    }

    /// What a force at a node of the deck, by position, is on.
    fn place_of_force(self, node: u32, line: &Condition<Components>) -> Result<Place, DeckError> {
        let rotation = line.kind.rotation.as_ref();
        if let Some((index, coupling)) = self.couplings.of(node) {
            let CouplingLaw::Distributing { moments } = coupling.law else {
                return Err(line.word.cannot(
                    "a surface that keeps its shape and moves under a force is not here; spread the force with \
                    *DISTRIBUTING",
                ));
            };
            return match rotation.filter(|_| (0..3).any(|c| line.kind.on[3 + c] && !moments[c])) {
                Some(word) => {
                    Err(word.cannot("the *DISTRIBUTING of this node does not name the component; add it there"))
                }
                None => Ok(Place::Coupling(index)),
            };
        }
        let inside = self.raw.in_mesh(node).ok_or_else(|| {
            let label = self.model.nodes[node as usize].label;
            line.word.cannot(format!(
                "no elastic element uses node {label}, so that a force there acts on nothing; load nodes of the body"
            ))
        })?;
        match rotation {
            Some(word) => Err(word.expected(FORCE)),
            None => Ok(Place::Node(inside)),
        }
    }

    fn distributed(
        self,
        (pressures, bodies): (&mut Tracks<u32>, &mut Tracks<BodyKey>),
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
            DistributedKind::Surface => {
                let Target::Name(name) = &line.target else {
                    return Ok(());
                };
                let found = self.model.surfaces.find("surface", name, word)?;
                if surfaces[found].is_empty() {
                    return Err(word.cannot("a pressure on a rigid surface acts on nothing; load an elastic one"));
                }
                surfaces[found].clone()
            }
            DistributedKind::Gravity(direction) => {
                // so that an unknown set is refused here
                self.sets.elements.find(&line.target, word)?;
                let length = norm(*direction);
                for (c, d) in direction.iter().enumerate() {
                    let key = (line.target.clone(), true, c);
                    let value = given.value * (d / length);
                    bodies.set(key, when, Given { value, ..given }, word)?;
                }
                return Ok(());
            }
            DistributedKind::Body(component) => {
                self.sets.elements.find(&line.target, word)?;
                let key = (line.target.clone(), false, *component);
                return bodies.set(key, when, given, word);
            }
        };
        for face in faces {
            pressures.set(face, when, given, word)?;
        }
        Ok(())
    }

    /// Densities of elements, that of the material of their section.
    fn densities(self, elements: &[u32], track: &Track) -> Result<Vec<f64>, DeckError> {
        let Known { model, raw, sets, .. } = self;
        let sections = sections(raw, sets)?;
        let sections = sections.ok_or_else(|| track.word.cannot("gravity needs materials; give *SOLID SECTION"))?;
        let mut of_section = Vec::with_capacity(model.sections.len());
        for section in &model.sections {
            of_section.push((model.material(section)?.density, &section.material.name));
        }
        let density = |&element: &u32| {
            let (density, name) = of_section[sections[element as usize] as usize];
            density.ok_or_else(|| {
                let why = format!("gravity needs a density; give material {name} *DENSITY");
                track.word.cannot(why)
            })
        };
        elements.iter().map(density).collect()
    }
}
