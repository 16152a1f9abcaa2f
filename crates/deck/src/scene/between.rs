//! What holds the nodes that the division of elements adds: what holds all nodes around them.

use std::collections::{BTreeMap, BTreeSet};

use signorini_fem_mesh::{History, HistoryError};

use super::held::{Held, Key, Owner, common};
use super::known::Known;
use super::timeline::{Acting, Beginning};
use crate::error::{DeckError, Fault, Word};
use crate::tolerances::TURNED;

/// The components of the nodes around an added node, with their shares in one of its own: along x, y or z, or,
/// `turned`, along its axes, if all have the same.
fn shares(
    known: Known,
    (node, around): (u32, &[(u32, f64)]),
    component: usize,
    turned: bool,
) -> Option<Vec<(Key, f64)>> {
    let axes = known.transforms.of(node);
    if turned {
        let alike = |&(other, share): &(u32, f64)| {
            let is_same = known.transforms.of(other) == axes;
            is_same.then_some(((other, component), share))
        };
        return around.iter().map(alike).collect();
    }
    let mut out = Vec::with_capacity(around.len());
    for &(other, share) in around {
        match known.transforms.frame(other, known.raw.points[other as usize]) {
            Ok(frame) => {
                let parts = (0..3).filter(|&k| frame[k][component].abs() > TURNED);
                out.extend(parts.map(|k| ((other, k), share * frame[k][component])));
            }
            // on the axis of cylindrical ones there is no other direction
            Err(along) if along[component].abs() > 1.0 - TURNED => out.push(((other, 2), share * along[component])),
            Err(_) => return None,
        }
    }
    Some(out)
}

/// An equation that lets an added node follow those around it: the node, the component along x, y and z, or `turned`
/// along the axes that all have, and the word of an equation that names one of them.
pub(super) struct Follower {
    pub(super) node: u32,
    pub(super) component: usize,
    pub(super) turned: bool,
    pub(super) word: Word,
}

impl Follower {
    /// The components that it says something of.
    pub(super) fn keys(&self, known: Known) -> impl Iterator<Item = Key> {
        let all = !self.turned && known.transforms.of(self.node).is_some();
        let (node, own) = (self.node, self.component);
        (0..3).filter(move |&c| all || c == own).map(move |c| (node, c))
    }
}

/// What follows: where equations name some of the components around a node, and supports hold the others in all steps,
/// but not all of them. Of cylindrical axes all three are one displacement, which is interpolated along x, y and z.
pub(super) fn followers(known: Known, held: &BTreeMap<Key, Held>) -> Result<Vec<Follower>, DeckError> {
    let mut named: BTreeMap<Key, Word> = BTreeMap::new();
    for given in &known.model.equations {
        for term in &given.terms {
            for node in known.sets.nodes.find(&term.target, &term.word)? {
                if let Some(inside) = known.raw.in_mesh(node) {
                    named
                        .entry((inside, term.component))
                        .or_insert_with(|| given.word.clone());
                }
            }
        }
    }
    let is_held = |key: &Key| held.get(key).is_some_and(|held| held.span == [None; 2]);
    let mut out = Vec::new();
    for added in known.raw.added().filter(|_| !named.is_empty()) {
        let (node, around) = added;
        // a node on both sides of a cut has two displacements
        if around
            .iter()
            .any(|(other, _)| known.raw.with_copies(*other).nth(1).is_some())
        {
            continue;
        }
        let follower = |component: usize, turned: bool| {
            let parts = shares(known, added, component, turned)?;
            let is_said = |(key, _): &(Key, f64)| named.contains_key(key) || is_held(key);
            let word = parts.iter().find_map(|(key, _)| named.get(key))?.clone();
            let free = parts.iter().any(|(key, _)| !is_held(key));
            (free && parts.iter().all(is_said)).then_some(Follower {
                node,
                component,
                turned,
                word,
            })
        };
        let ways = |turned: bool| (0..3).filter_map(|c| follower(c, turned)).collect::<Vec<_>>();
        let straight = ways(false);
        if known.transforms.of(node).is_some() && straight.len() < 3 {
            out.extend(ways(true))
        } else {
            out.extend(straight)
        }
    }
    Ok(out)
}

/// The targets of supports, and by which of them what is held is given.
pub(super) struct Targets<'a> {
    pub(super) owners: &'a mut Vec<Owner>,
    pub(super) given: &'a BTreeMap<Key, BTreeSet<usize>>,
}

impl Targets<'_> {
    /// The first that gives all of some components; if there is none, one of its own.
    fn of(&mut self, keys: &[Key], parts: &[(f64, &Held)], word: &Word) -> usize {
        let is_given = |owner: &usize| {
            keys.iter()
                .all(|key| self.given.get(key).is_some_and(|by| by.contains(owner)))
        };
        let of_first = keys.first().and_then(|key| self.given.get(key));
        let found = of_first.and_then(|by| by.iter().copied().find(is_given));
        // of what moves with a rigid body nothing is given by itself
        let several: BTreeSet<usize> = parts.iter().map(|part| part.1.owner).collect();
        let one = several.first().copied().filter(|_| several.len() == 1);
        found.or(one).unwrap_or_else(|| {
            let names: Vec<&str> = several.iter().map(|owner| self.owners[*owner].0.as_str()).collect();
            let name = format!("between {}", names.join(" and "));
            let known = self.owners.iter().position(|other| other.0 == name);
            known.unwrap_or_else(|| {
                self.owners.push((name, word.clone()));
                self.owners.len() - 1
            })
        })
    }
}

/// What holds added nodes, as long as all nodes around them are held, with the displacement that the element of the
/// deck has there. `all` is what is held of nodes of the mesh.
pub(super) fn between<'a>(
    known: Known,
    all: impl Iterator<Item = (Key, &'a Held)>,
    targets: &mut Targets,
) -> Result<Vec<(Key, Held)>, DeckError> {
    let mut of_key: BTreeMap<Key, Vec<&Held>> = BTreeMap::new();
    for (key, held) in all {
        of_key.entry(key).or_default().push(held);
    }
    let mut out = Vec::new();
    for added in known.raw.added() {
        let turned = known.transforms.of(added.0).is_some();
        for component in 0..3 {
            let shares = shares(known, added, component, turned);
            let helds = |parts: Vec<(Key, f64)>| {
                let held = |(key, share): (Key, f64)| Some((key, share, of_key.get(&key)?));
                parts.into_iter().map(held).collect::<Option<Vec<_>>>()
            };
            let Some(parts) = shares.and_then(helds) else {
                continue;
            };
            let keys: Vec<Key> = parts.iter().map(|part| part.0).collect();
            let mut spans = vec![[None; 2]];
            for (_, _, helds) in &parts {
                let both = |span: &Acting| {
                    helds
                        .iter()
                        .filter_map(|held| common(*span, held.span))
                        .collect::<Vec<_>>()
                };
                spans = spans.iter().flat_map(both).collect();
            }
            for span in spans {
                let acts = |held: &&&Held| common(span, held.span) == Some(span);
                let parts = parts
                    .iter()
                    .map(|(_, share, helds)| Some((*share, *helds.iter().find(acts)?)));
                let Some(parts) = parts.collect::<Option<Vec<_>>>() else {
                    continue;
                };
                let Some(held) = sum(known, &parts)? else {
                    continue;
                };
                let owner = targets.of(&keys, &parts, &held.track.word);
                let held = Held { owner, span, ..held };
                let copies = known.raw.with_copies(added.0);
                out.extend(copies.map(|node| ((node, component), held.clone())));
            }
        }
    }
    Ok(out)
}

/// The sum of displacements, which begins with the last of them, along a straight line if one of these does; `None` of
/// none.
fn sum(known: Known, parts: &[(f64, &Held)]) -> Result<Option<Held>, DeckError> {
    let begins = |held: &Held| (held.span[0], held.beginning(known.timeline));
    let Some(&(_, last)) = parts
        .iter()
        .max_by_key(|part| (part.1.span[0], part.0 != 0.0, begins(part.1).1))
    else {
        return Ok(None);
    };
    let stays = |held: &Held| begins(held).1 == Beginning::Stay;
    if let Some((_, fixed)) = parts.iter().find(|part| stays(part.1)) {
        let from = fixed.span[0].unwrap_or(0);
        let rests =
            |held: &Held| held.span[0].is_none_or(|own| own < from) && held.track.rests_from(from, known.timeline);
        return match parts.iter().find(|part| !stays(part.1) && !rests(part.1)) {
            None => Ok(Some((*fixed).clone())),
            Some((_, moves)) => Err(moves.track.word.cannot(
                "this moves nodes beside others that are FIXED, on elements that are divided here; give all of them FIXED",
            )),
        };
    }
    let whole = (parts.iter().map(|part| part.0).sum::<f64>() - 1.0).abs() < TURNED;
    if whole && parts.iter().all(|part| part.1.track.says_as(&last.track)) {
        return Ok(Some(last.clone()));
    }
    let line = known.timeline.span(last.span[0]);
    let line = line.filter(|_| begins(last).1 == Beginning::Line);
    let mut moves = Vec::with_capacity(parts.len());
    for (share, held) in parts {
        let Some((value, points)) = held.track.course(known.timeline) else {
            continue;
        };
        let fault = |e| held.track.word.fault(Fault::History(e));
        let history = History::table(points).map_err(fault)?;
        // the line begins where the node is, and so with what of others is there already
        let before = line.filter(|_| begins(held) != begins(last)).map(|span| {
            let (start, end) = (span.start, span.end);
            (start, end, history.value(start))
        });
        moves.push((share * value, history, before));
    }
    let course = match &moves[..] {
        [(_, first, None), more @ ..] if more.iter().all(|m| m.2.is_none() && m.1.points() == first.points()) => {
            (moves.iter().map(|m| m.0).sum(), first.clone())
        }
        _ => joined(&moves).map_err(|e| last.track.word.fault(Fault::History(e)))?,
    };
    let track = last.track.moving(course.0, course.1);
    Ok(Some(Held { track, ..last.clone() }))
}

/// A value, its factor in time, and, where it does not begin, but a line does, this with the factor at its start.
type Move = (f64, History, Option<(f64, f64, f64)>);

/// The sum of several as one.
fn joined(moves: &[Move]) -> Result<(f64, History), HistoryError> {
    let lines = moves
        .iter()
        .filter_map(|m| m.2)
        .flat_map(|(start, end, _)| [start, end]);
    let points = moves.iter().flat_map(|m| m.1.points().iter().map(|p| p.0));
    let mut times: Vec<f64> = points.chain(lines).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let one = |(value, history, before): &Move, time: f64| {
        let left = before.map_or(0.0, |(start, end, left)| {
            left * ((end - time) / (end - start)).clamp(0.0, 1.0)
        });
        value * (history.value(time) - left)
    };
    let values: Vec<f64> = times
        .iter()
        .map(|time| moves.iter().map(|m| one(m, *time)).sum())
        .collect();
    let largest = values
        .iter()
        .copied()
        .fold(0.0, |m: f64, v| if v.abs() > m.abs() { v } else { m });
    let history = if largest == 0.0 {
        History::constant(0.0)
    } else {
        History::table(times.into_iter().zip(values.iter().map(|v| v / largest)).collect())?
    };
    Ok((largest, history))
}
