//! `*BOUNDARY` of all steps as supports.

use std::collections::{BTreeMap, BTreeSet};

use signorini_contact::{Coupling, Support};
use signorini_fem_mesh::History;

use super::between::{Follower, Targets, between, followers};
use super::couplings::Coupling as Node;
use super::faces::FaceTable;
use super::held::{Held, Key, Owner, Said};
use super::history::Histories;
use super::known::Known;
use super::pretension::ONE;
use super::rigid::{FreeLead, Lead, all_components, rigid_components};
use super::spread::coupled_nodes;
use super::timeline::{Acting, Beginning};
use crate::error::{DeckError, Word};
use crate::model::{COMPONENT, Components, Condition, Ignored, Target};

/// Name of what is given on nodes by their numbers.
const SINGLE: &str = "nodes";

/// Held components by node of the mesh and component, and by position of nodes of rigid bodies and couplings.
#[derive(Default)]
struct Table {
    held: BTreeMap<Key, Held>,
    rigid: BTreeMap<Key, Held>,
    /// Of the former those that are released.
    released: Vec<(Key, Held)>,
    /// The targets that give what is held of nodes of the mesh.
    given: BTreeMap<Key, BTreeSet<usize>>,
    /// The first and the last step that lock the node of a section.
    locks: BTreeMap<u32, [usize; 2]>,
    owners: Vec<Owner>,
    ignored: Vec<Ignored>,
}

/// What is rigid and not held in all components, or loaded, and points of equations.
pub(super) struct Rigid {
    /// Its reference node, by position in the deck.
    pub(super) reference: u32,
    pub(super) coupling: Coupling,
    pub(super) word: Word,
}

/// Supports with the names of their targets, and what moves rigid bodies.
pub(super) struct Supports {
    pub(super) list: Vec<Support>,
    pub(super) names: Vec<Owner>,
    /// Added nodes that equations hold.
    pub(super) followers: Vec<Follower>,
    pub(super) leads: Vec<Result<Lead, FreeLead>>,
    pub(super) rigid: Vec<Rigid>,
    /// Rotations that are held where there are none.
    pub(super) ignored: Vec<Ignored>,
}

/// One support for each target and its moving or fixed components; `loaded` are the reference nodes that have loads.
/// `contacts` is the number of those before the sections.
pub(super) fn supports(
    known: Known,
    faces: &FaceTable,
    loaded: &BTreeMap<u32, Word>,
    contacts: usize,
) -> Result<Supports, DeckError> {
    let mut table = Table::default();
    for line in &known.model.supports {
        table.add(known, None, line)?;
    }
    for (step, given) in known.model.steps.iter().enumerate() {
        let removes = given.boundary.removes();
        if removes && step == 0 {
            table = Table::default();
        } else if removes {
            let all = table.held.values_mut().chain(table.rigid.values_mut());
            all.for_each(|held| held.track.remove(step));
        }
        for line in &given.boundary.lines {
            table.add(known, Some(step), line)?;
        }
        let gone = table.held.iter().filter(|(_, held)| held.track.is_removed_in(step));
        for key in gone.map(|(key, _)| *key).collect::<Vec<Key>>() {
            table.release(key, step);
        }
        let rigid = table.rigid.iter().find(|(_, held)| held.track.is_removed_in(step));
        let released = rigid.map(|(key, _)| (known.model.nodes[key.0 as usize].label, key.1));
        let mut locked = table.locks.iter().filter(|(_, lock)| removes && lock[1] < step);
        let unlocked = || {
            locked
                .next()
                .map(|(node, _)| (known.model.nodes[*node as usize].label, 0))
        };
        if let (Some((label, component)), Some((word, _))) = (released.or_else(unlocked), &given.boundary.first) {
            return Err(word.cannot(format!(
                "this releases component {} of node {label}; what is held of a rigid body, a coupling or a node of \
                equations in the first step is held to the end, so give it again here",
                component + 1,
            )));
        }
    }
    table.note_loads(known)?;
    let track = |node, component| table.rigid.get(&(node, component)).map(|held| &held.track);
    known.bodies.check_rotations(known.timeline, track)?;
    let rigid = table.couple(known, faces, (loaded, contacts))?;
    let held = std::mem::take(&mut table.rigid);
    let held = held.into_iter().map(|(key, held)| (key, held.track)).collect();
    let leads = known.bodies.leads(known.model, &held);
    let ignored = std::mem::take(&mut table.ignored);
    let followers = table.hold_between(known)?;
    let (list, names) = table.lower(known)?;
    Ok(Supports {
        list,
        names,
        followers,
        leads,
        rigid,
        ignored,
    })
}

impl Table {
    fn owner(&mut self, target: &Target, word: &Word) -> usize {
        let name = match target {
            Target::Number(_) => SINGLE,
            Target::Name(name) => name,
            Target::All => "all",
        };
        let known = self.owners.iter().position(|owner| owner.0 == name);
        known.unwrap_or_else(|| {
            self.owners.push((name.to_owned(), word.clone()));
            self.owners.len() - 1
        })
    }

    /// Ends a component before a step.
    fn release(&mut self, key: Key, step: usize) {
        if let Some(mut held) = self.held.remove(&key) {
            held.track.forget(step);
            held.span[1] = Some(step);
            self.released.push((key, held));
        }
    }

    /// Notes a line of a step, or of the part before the first.
    fn add(&mut self, known: Known, step: Option<usize>, line: &Condition<Components>) -> Result<(), DeckError> {
        let owner = self.owner(&line.target, &line.word);
        let (mut found, mut turned) = (false, None);
        for node in known.sets.nodes.find(&line.target, &line.word)? {
            let section = known.sections.of(node).is_some();
            if section && line.kind.on[1..].contains(&true) {
                return Err(line.word.cannot(ONE));
            }
            if line.kind.fixed.is_none() && self.locks.contains_key(&node) {
                let why = "the node is FIXED, and stays so; remove one of both";
                return Err(line.word.cannot(why));
            }
            if let (Some(fixed), true) = (&line.kind.fixed, line.given.value != 0.0) {
                return Err(fixed.cannot("what is FIXED stays as the steps before left it; remove the value"));
            }
            if let (Some(fixed), Some(step), true) = (&line.kind.fixed, step, section) {
                if self.rigid.contains_key(&(node, 0)) {
                    return Err(fixed.cannot("its displacement is prescribed, and stays so; remove one of both"));
                }
                self.locks.entry(node).or_insert([step; 2])[1] = step;
                found = true;
                continue;
            }
            let inside = known.raw.in_mesh(node);
            let is_rigid = known.bodies.has(node) || known.couplings.moves(node) || known.points.has(node);
            if let (Some(fixed), true) = (&line.kind.fixed, is_rigid) {
                let why = "of a rigid body, a coupling or equations this is not read; give the displacement that the steps \
                    before reached";
                return Err(fixed.cannot(why));
            }
            let (map, key, components) = match inside {
                _ if known.bodies.has(node) || known.couplings.moves(node) => (&mut self.rigid, node, 6),
                _ if known.points.has(node) => (&mut self.rigid, node, 3),
                Some(inside) => (&mut self.held, inside, 3),
                None if known.couplings.of(node).is_some() => {
                    let why =
                        "a node of *DISTRIBUTING takes loads; hold the surface with *KINEMATIC, or hold its nodes";
                    return Err(line.word.cannot(why));
                }
                None => continue,
            };
            found = true;
            if let (3, Some(word)) = (components, &line.kind.rotation) {
                if line.given.value != 0.0 {
                    return Err(word.expected(COMPONENT));
                }
                turned = Some(word);
            }
            for component in (0..components).filter(|&c| line.kind.on[c]) {
                let label = known.model.nodes[node as usize].label;
                let what = format!("component {} of node {label}", component + 1);
                let new = !map.contains_key(&(key, component));
                let from = step.filter(|step| new && *step > 0);
                if from.is_some() && inside.is_none_or(|inside| (inside, components) != (key, 3)) {
                    return Err(line.word.cannot(format!(
                        "{what} is free in the steps before; what is held of a rigid body, a coupling or a node of \
                        equations in one step has to be held from the first one on"
                    )));
                }
                if let Some(inside) = inside {
                    self.given.entry((inside, component)).or_default().insert(owner);
                }
                let said = Said {
                    line,
                    owner,
                    step,
                    from,
                    what,
                };
                let copies = inside.map(|inside| known.raw.with_copies(inside).skip(1));
                for key in std::iter::once(key).chain(copies.into_iter().flatten()) {
                    said.note(map, (key, component), known.timeline)?;
                }
            }
        }
        if let Some(word) = turned {
            let why = "nodes of solid elements, and of equations, have no rotations to be held";
            self.ignored.push(Ignored::new(word, why));
        }
        if !found {
            let why = "no elastic element uses these nodes; hold nodes of the body";
            return Err(line.word.cannot(why));
        }
        Ok(())
    }

    /// Notes forces on what is locked.
    fn note_loads(&mut self, known: Known) -> Result<(), DeckError> {
        for (step, given) in known.model.steps.iter().enumerate().filter(|_| !self.locks.is_empty()) {
            for line in given.forces.lines.iter().filter(|line| line.given.value != 0.0) {
                let is_locked = |node: &u32| self.locks.get(node).is_some_and(|lock| lock[0] <= step);
                if known.sets.nodes.find(&line.target, &line.word)?.iter().any(is_locked) {
                    let why = "the node is FIXED, so that the force acts on nothing";
                    self.ignored.push(Ignored::new(&line.word, why));
                }
            }
        }
        Ok(())
    }

    /// Gives the nodes of what is rigid its displacements: of surfaces with *KINEMATIC, and of rigid bodies. What of it
    /// is free or `loaded` is a coupling.
    fn couple(
        &mut self,
        known: Known,
        faces: &FaceTable,
        (loaded, contacts): (&BTreeMap<u32, Word>, usize),
    ) -> Result<Vec<Rigid>, DeckError> {
        let mut out = Vec::new();
        let mut sections = contacts..;
        for coupling in known.couplings.0.iter().filter(|c| known.couplings.moves(c.node)) {
            if let Some(section) = known.sections.of(coupling.node) {
                let whole = section.coupling(sections.next().unwrap_or(contacts));
                out.push(self.tighten(known, coupling, whole)?);
                (0..6).for_each(|c| drop(self.rigid.remove(&(coupling.node, c))));
                continue;
            }
            let nodes = coupled_nodes(coupling, known, faces)?.into_keys().collect();
            let leads = (coupling.node, None);
            out.extend(self.move_rigidly(known, nodes, (leads, loaded), ("surface", &coupling.word))?);
            (0..6).for_each(|c| drop(self.rigid.remove(&(coupling.node, c))));
        }
        for ((nodes, reference, rotation), said) in known.bodies.nodes().zip(&known.model.rigid) {
            let elastic = known.raw.all_in_mesh(nodes);
            if !elastic.is_empty() {
                let leads = (reference, rotation);
                let coupling = self.move_rigidly(known, elastic, (leads, loaded), ("rigid body", &said.word))?;
                if coupling.is_some() && known.bodies.share(leads) {
                    return Err(said.reference.1.cannot(
                        "this node, or the ROT NODE, says how another rigid body moves, too, and what is free or loaded \
                         moves by itself here; make one body of both, or give this one nodes of its own",
                    ));
                }
                out.extend(coupling);
            } else if let Some(word) = loaded.get(&reference) {
                return Err(word.cannot(
                    "a rigid body without elastic nodes is held or moved here, not loaded; give its displacement with \
                     *BOUNDARY, whose reaction is the force, or load an elastic body whose surface *COUPLING with \
                     *KINEMATIC keeps rigid",
                ));
            }
        }
        for (node, word) in &known.points.0 {
            let held = rigid_components(&self.rigid, (*node, None));
            let point = Coupling::point(known.model.nodes[*node as usize].point);
            let point = point.with_held(held.each_ref().map(Option::is_some));
            out.push(moved(known, (*node, point), &held, word)?);
            (0..3).for_each(|c| drop(self.rigid.remove(&(*node, c))));
        }
        Ok(out)
    }

    /// A coupling of nodes of the mesh with a reference node and its rotation.
    fn coupling(
        &self,
        known: Known,
        nodes: Vec<u32>,
        leads: (u32, Option<u32>),
        word: &Word,
    ) -> Result<Rigid, DeckError> {
        let place = known.model.nodes[leads.0 as usize].point;
        let held = rigid_components(&self.rigid, leads);
        let coupling = Coupling::rigid(nodes, place).with_held(held.each_ref().map(Option::is_some));
        moved(known, (leads.0, coupling), &held, word)
    }

    /// The coupling of a section, which moves along its axis only.
    fn tighten(&self, known: Known, section: &Node, coupling: Coupling) -> Result<Rigid, DeckError> {
        let [first, ..] = rigid_components(&self.rigid, (section.node, None));
        let held = [first, None, None, None, None, None];
        let mut on = [true; 6];
        on[0] = held[0].is_some();
        let mut coupling = coupling.with_held(on);
        if let Some(&[step, _]) = self.locks.get(&section.node) {
            let start = known.timeline.spans.get(step).map_or(0.0, |span| span.start);
            coupling = coupling.with_lock([true, false, false, false, false, false], start);
        }
        moved(known, (section.node, coupling), &held, &section.word)
    }

    /// Gives nodes of the mesh the displacement of a reference node and its rotation; `what` they are, and its word. A
    /// coupling where not all of its components are held, it is loaded, nodes are held by themselves, too, or it turns
    /// and has several histories, of which a support has one.
    fn move_rigidly(
        &mut self,
        known: Known,
        nodes: Vec<u32>,
        (leads, loaded): ((u32, Option<u32>), &BTreeMap<u32, Word>),
        (what, word): (&str, &Word),
    ) -> Result<Option<Rigid>, DeckError> {
        // supports of single nodes are judged beside a coupling
        let apart = |node: &u32| (0..3).all(|c| !self.held.contains_key(&(*node, c)));
        let held = match all_components(rigid_components(&self.rigid, leads)) {
            Ok(held) if !loaded.contains_key(&leads.0) && nodes.iter().all(apart) => held,
            _ => return self.coupling(known, nodes, leads, word).map(Some),
        };
        let lead = Lead {
            tracks: held.each_ref().map(|held| held.track.clone()),
            about: known.model.nodes[leads.0 as usize].point,
            word: word.clone(),
        };
        if lead.turns_apart(known.timeline)? {
            return self.coupling(known, nodes, leads, word).map(Some);
        }
        let motion = lead.turning(known.timeline)?;
        for node in nodes {
            let label = known.raw.node_labels[node as usize];
            if known.transforms.of(node).is_some() {
                let why = format!("node {label} of this {what} has axes of its own; take it out of *TRANSFORM");
                return Err(word.cannot(why));
            }
            for (component, lead) in held[..3].iter().enumerate() {
                let mut held = lead.clone();
                if let Some(motion) = &motion {
                    let at = motion.at(known.raw.points[node as usize], component);
                    let at = at.unwrap_or((0.0, History::constant(0.0)));
                    held.track = held.track.with_course(at.0, at.1);
                }
                self.held.insert((node, component), held);
            }
        }
        Ok(None)
    }

    /// Holds added nodes with those around them; those that equations hold are given back.
    fn hold_between(&mut self, known: Known) -> Result<Vec<Follower>, DeckError> {
        let released = self.released.iter().map(|(key, held)| (*key, held));
        let all = self.held.iter().map(|(key, held)| (*key, held)).chain(released);
        let mut targets = Targets {
            owners: &mut self.owners,
            given: &self.given,
        };
        let mut new = between(known, all, &mut targets)?;
        let followers = followers(known, &self.held)?;
        let said: BTreeSet<Key> = followers.iter().flat_map(|follower| follower.keys(known)).collect();
        new.retain(|(key, _)| !said.contains(key));
        for (key, held) in new {
            match held.span[1] {
                None => drop(self.held.entry(key).or_insert(held)),
                Some(_) => self.released.push((key, held)),
            }
        }
        Ok(followers)
    }

    fn lower(
        self,
        Known {
            timeline, transforms, ..
        }: Known,
    ) -> Result<(Vec<Support>, Vec<Owner>), DeckError> {
        let mut histories = Histories::default();
        // by target, axes, first component, history, components, steps and beginning: nodes and their displacements
        type Group = (usize, Option<usize>, usize, Option<usize>, [bool; 3], Acting, Beginning);
        let mut groups: BTreeMap<Group, Vec<(u32, [f64; 3])>> = BTreeMap::new();
        let mut all: Vec<(Key, Held)> = self.held.into_iter().chain(self.released).collect();
        let part = |((node, component), held): &(Key, Held)| (*node, held.span, held.beginning(timeline), *component);
        all.sort_by_key(part);
        for of_node in all.chunk_by(|a, b| {
            let [a, b] = [a, b].map(part);
            (a.0, a.1, a.2) == (b.0, b.1, b.2)
        }) {
            let (node, span, beginning, _) = part(&of_node[0]);
            let mut moves = Vec::with_capacity(3);
            for ((_, component), held) in of_node {
                let motion = histories.add(timeline, &held.track)?;
                moves.push((*component, held.owner, motion));
            }
            let all: Vec<usize> = moves.iter().filter_map(|m| Some(m.2?.1)).collect();
            // one motion takes the components that stay at zero along, as part of it
            let one = all.first().filter(|h| all.iter().all(|o| o == *h)).copied();
            // by target and history: components and their displacements
            type Parts = BTreeMap<(usize, Option<usize>), ([bool; 3], [f64; 3])>;
            let mut parts = Parts::new();
            for (component, owner, motion) in moves {
                let history = motion.map(|m| m.1).or(one);
                let (on, value) = parts.entry((owner, history)).or_default();
                on[component] = true;
                value[component] = motion.map_or(0.0, |m| m.0);
            }
            for ((owner, history), (on, value)) in parts {
                let moves = value.iter().any(|v| *v != 0.0);
                let first = on.iter().position(|on| *on).unwrap_or(0);
                let key = (
                    owner,
                    transforms.of(node),
                    first,
                    history.filter(|_| moves),
                    on,
                    span,
                    beginning,
                );
                groups.entry(key).or_default().push((node, value));
            }
        }
        let (mut supports, mut names) = (Vec::new(), Vec::new());
        for ((owner, axes, _, history, on, span, beginning), nodes) in groups {
            let (nodes, mut values): (Vec<u32>, Vec<[f64; 3]>) = nodes.into_iter().unzip();
            if values.iter().all(|value| *value == values[0]) {
                values.truncate(1);
            }
            let motion = history.map(|history| (values, histories.at(history)));
            let support = transforms.support(axes, (nodes, on), motion);
            supports.push(timeline.during(support, span, beginning)?);
            names.push(self.owners[owner].clone());
        }
        Ok((supports, names))
    }
}

/// A coupling whose components that are held move as the steps say.
fn moved(
    known: Known,
    (reference, mut coupling): (u32, Coupling),
    held: &[Option<Held>; 6],
    word: &Word,
) -> Result<Rigid, DeckError> {
    let mut histories = Histories::default();
    let held = held.iter().enumerate();
    for (component, held) in held.filter_map(|(k, held)| Some((k, held.as_ref()?))) {
        if let Some((value, history)) = histories.add(known.timeline, &held.track)? {
            let mut motion = [0.0; 6];
            motion[component] = value;
            coupling = coupling.with_motion(motion, histories.at(history));
        }
    }
    let word = word.clone();
    Ok(Rigid {
        reference,
        coupling,
        word,
    })
}
