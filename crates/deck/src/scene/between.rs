//! What holds the nodes that the division of elements adds: what holds all nodes around them.

use std::collections::{BTreeMap, BTreeSet};

use signorini_fem_mesh::History;

use super::faces::Known;
use super::held::{Held, Key, common};
use super::timeline::Acting;
use crate::error::{DeckError, Fault};
use crate::tolerances::TURNED;

/// The components of the nodes around an added node, with their shares in one of its own: along x, y or z, or, `turned`,
/// along its axes, if all have the same.
pub(super) fn shares(
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
        let frame = known.transforms.frame(other, known.raw.points[other as usize]).ok()?;
        let parts = (0..3).filter(|&k| frame[k][component].abs() > TURNED);
        out.extend(parts.map(|k| ((other, k), share * frame[k][component])));
    }
    Some(out)
}

/// Names of the targets of supports, and by which of them what is held is given.
pub(super) struct Targets<'a> {
    pub(super) names: Vec<String>,
    pub(super) given: &'a BTreeMap<Key, BTreeSet<usize>>,
}

impl Targets<'_> {
    /// The first that gives all of some components; if there is none, one of its own.
    fn of(&mut self, keys: &[Key], owners: BTreeSet<usize>) -> usize {
        let is_given = |owner: &usize| {
            keys.iter()
                .all(|key| self.given.get(key).is_some_and(|by| by.contains(owner)))
        };
        let of_first = keys.first().and_then(|key| self.given.get(key));
        let found = of_first.and_then(|by| by.iter().copied().find(is_given));
        // of what moves with a rigid body nothing is given by itself
        let one = owners.first().copied().filter(|_| owners.len() == 1);
        found.or(one).unwrap_or_else(|| {
            let names: Vec<&str> = owners.iter().map(|owner| self.names[*owner].as_str()).collect();
            let name = format!("between {}", names.join(" and "));
            let known = self.names.iter().position(|other| *other == name);
            known.unwrap_or_else(|| {
                self.names.push(name);
                self.names.len() - 1
            })
        })
    }
}

/// What holds added nodes, as long as all nodes around them are held, with the displacement that the element of the deck
/// has there. `all` is what is held of nodes of the mesh.
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
                let owner = targets.of(&keys, parts.iter().map(|part| part.1.owner).collect());
                let held = Held { owner, span, ..held };
                let copies = known.raw.with_copies(added.0);
                out.extend(copies.map(|node| ((node, component), held.clone())));
            }
        }
    }
    Ok(out)
}

/// The sum of displacements, which begins as the last of them; `None` of none.
fn sum(known: Known, parts: &[(f64, &Held)]) -> Result<Option<Held>, DeckError> {
    let Some((_, last)) = parts.iter().max_by_key(|part| part.1.span[0]) else {
        return Ok(None);
    };
    let last: &Held = last;
    let whole = (parts.iter().map(|part| part.0).sum::<f64>() - 1.0).abs() < TURNED;
    if whole && parts.iter().all(|part| part.1.track.says_as(&last.track)) {
        return Ok(Some(last.clone()));
    }
    let mut moves = Vec::with_capacity(parts.len());
    for (share, held) in parts {
        if let Some((value, points)) = held.track.course(known.timeline) {
            let fault = |e| held.track.word.fault(Fault::History(e));
            moves.push((share * value, History::table(points).map_err(fault)?));
        }
    }
    let mut times: Vec<f64> = moves.iter().flat_map(|m| m.1.points().iter().map(|p| p.0)).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let value = |time: f64| {
        moves
            .iter()
            .map(|(value, history)| value * history.value(time))
            .sum::<f64>()
    };
    let values: Vec<f64> = times.iter().map(|time| value(*time)).collect();
    let largest = values
        .iter()
        .copied()
        .fold(0.0, |m: f64, v| if v.abs() > m.abs() { v } else { m });
    let history = match largest == 0.0 {
        true => Ok(History::constant(0.0)),
        false => History::table(times.into_iter().zip(values.iter().map(|v| v / largest)).collect()),
    };
    let history = history.map_err(|e| last.track.word.fault(Fault::History(e)))?;
    let track = last.track.moving(largest, history);
    Ok(Some(Held { track, ..last.clone() }))
}
