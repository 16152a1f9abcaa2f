//! `*BOUNDARY` of all steps as supports.

use std::collections::BTreeMap;

use signorini_contact::{Directions, Support};

use super::history::{Given, Histories, Track};
use super::mesh::Raw;
use super::numbers::Sets;
use super::timeline::Timeline;
use crate::error::{DeckError, Fault};
use crate::model::{Boundary, Model, Target};

/// Name of what is given on nodes by their numbers.
const SINGLE: &str = "nodes";

/// A held component of a node: the target that it is given on first, and what the steps say.
struct Held {
    owner: usize,
    track: Track,
    /// Given before the first step, which may say it anew.
    before: bool,
}

/// Held components by node of the mesh and component.
#[derive(Default)]
struct Table {
    held: BTreeMap<(u32, usize), Held>,
    owners: Vec<String>,
}

/// One support for each target and its moving or fixed components, and the names of the targets.
pub(super) fn supports(
    model: &Model,
    raw: &Raw,
    sets: &Sets,
    timeline: &Timeline,
) -> Result<(Vec<Support>, Vec<String>), DeckError> {
    let mut table = Table::default();
    for line in &model.supports {
        table.add(model, (raw, sets), None, line)?;
    }
    for (step, given) in model.steps.iter().enumerate() {
        let removes = given.boundary.removes();
        if removes && step == 0 {
            table = Table::default();
        } else if removes {
            table.held.values_mut().for_each(|h| h.track.remove(step));
        }
        for line in &given.boundary.lines {
            table.add(model, (raw, sets), Some(step), line)?;
        }
        let released = table.held.iter();
        let released = released.filter(|(_, held)| held.track.is_removed_in(step));
        if let (Some((&(node, component), _)), Some((place, word, _))) =
            (released.into_iter().next(), &given.boundary.first)
        {
            let text = format!(
                "this releases component {} of node {}; what is held in the first step is held to the end, so give it again here",
                component + 1,
                raw.node_labels()[node as usize]
            );
            return Err(DeckError::at(place, word, Fault::Cannot(text)));
        }
    }
    table.lower(model, timeline)
}

impl Table {
    fn owner(&mut self, target: &Target) -> usize {
        let name = match target {
            Target::Number(_) => SINGLE,
            Target::Name(name) => name,
        };
        let known = self.owners.iter().position(|owner| owner == name);
        known.unwrap_or_else(|| {
            self.owners.push(name.to_owned());
            self.owners.len() - 1
        })
    }

    /// Notes a line of a step, or of the part before the first.
    fn add(
        &mut self,
        model: &Model,
        (raw, sets): (&Raw, &Sets),
        step: Option<usize>,
        line: &Boundary,
    ) -> Result<(), DeckError> {
        let at = (&line.place, line.word.as_str());
        let fault = |text: String| DeckError::at(at.0, at.1, Fault::Cannot(text));
        let owner = self.owner(&line.target);
        let nodes = sets.nodes(model, raw, &line.target, at)?;
        let nodes: Vec<u32> = nodes.into_iter().filter_map(|n| raw.in_mesh(n)).collect();
        if nodes.is_empty() {
            return Err(fault(
                "no element uses these nodes; hold nodes of the body".into(),
            ));
        }
        let given = Given {
            value: line.value,
            amplitude: line.amplitude,
        };
        let now = step.unwrap_or(0);
        for node in nodes {
            for component in (0..3).filter(|&c| line.components[c]) {
                let next = self.held.len();
                let known = self.held.contains_key(&(node, component));
                if !known && now > 0 {
                    return Err(fault(format!(
                        "component {} of node {} is free in the steps before; what is held in one step has to be held from the first one on",
                        component + 1,
                        raw.node_labels()[node as usize]
                    )));
                }
                let held = self.held.entry((node, component)).or_insert_with(|| Held {
                    owner,
                    track: Track::new(next, at),
                    before: step.is_none(),
                });
                let again = !(held.before && step == Some(0));
                if let Some(before) = held.track.given_in(now)
                    && again
                    && before != given
                    && (before.value, given.value) != (0.0, 0.0)
                {
                    return Err(fault(format!(
                        "component {} of node {} is given {} and {} in one step; keep one of them",
                        component + 1,
                        raw.node_labels()[node as usize],
                        before.value,
                        given.value
                    )));
                }
                held.before = step.is_none();
                held.track.set(now, given);
            }
        }
        Ok(())
    }

    fn lower(
        self,
        model: &Model,
        timeline: &Timeline,
    ) -> Result<(Vec<Support>, Vec<String>), DeckError> {
        let mut histories = Histories::default();
        // by target, first component, history and components: nodes and their displacements
        type Key = (usize, usize, Option<usize>, [bool; 3]);
        let mut groups: BTreeMap<Key, Vec<(u32, [f64; 3])>> = BTreeMap::new();
        let mut held = self.held.into_iter().peekable();
        while let Some(((node, component), first)) = held.next() {
            let mut of_node = vec![(component, first)];
            while let Some(&((other, component), _)) = held.peek()
                && other == node
            {
                of_node.extend(held.next().map(|(_, held)| (component, held)));
            }
            let mut moves = Vec::with_capacity(3);
            for (component, held) in of_node {
                let motion = histories.add(model, timeline, &held.track)?;
                moves.push((component, held.owner, motion));
            }
            let all: Vec<usize> = moves.iter().filter_map(|m| Some(m.2?.1)).collect();
            // one motion takes the components that stay at zero along, as part of it
            let one = all.first().filter(|h| all.iter().all(|o| o == *h)).copied();
            let mut parts: BTreeMap<(usize, Option<usize>), ([bool; 3], [f64; 3])> =
                BTreeMap::new();
            for (component, owner, motion) in moves {
                let history = motion.map(|m| m.1).or(one);
                let (on, value) = parts.entry((owner, history)).or_default();
                on[component] = true;
                value[component] = motion.map_or(0.0, |m| m.0);
            }
            for ((owner, history), (on, value)) in parts {
                let moves = value.iter().any(|v| *v != 0.0);
                let first = on.iter().position(|on| *on).unwrap_or(0);
                let key = (owner, first, history.filter(|_| moves), on);
                groups.entry(key).or_default().push((node, value));
            }
        }
        let (mut supports, mut names) = (Vec::new(), Vec::new());
        for ((owner, _, history, on), nodes) in groups {
            let directions = match on {
                [true, true, true] => Directions::All,
                on => Directions::Components(on),
            };
            let numbers: Vec<u32> = nodes.iter().map(|n| n.0).collect();
            let mut support = Support::partial(numbers, directions);
            if let Some(history) = history {
                let history = histories.at(history);
                let first = nodes[0].1;
                support = if nodes.iter().all(|n| n.1 == first) {
                    support.with_motion(first, history)
                } else {
                    support.with_motions(nodes.iter().map(|n| n.1).collect(), history)
                };
            }
            supports.push(support);
            names.push(self.owners[owner].clone());
        }
        Ok((supports, names))
    }
}
