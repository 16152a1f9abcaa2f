//! Equations between nodes.

use std::collections::BTreeMap;

use signorini_contact::Equation;
use signorini_fem_mesh::vec3::scale;

use super::between::shares;
use super::faces::Known;
use super::held::Key;
use super::points::Room;
use super::supports::Supports;
use crate::error::{DeckError, Word};
use crate::model::Term;

/// The equations of the scene, each with its place; of sets one for each of their nodes, by ascending numbers.
pub(super) fn equations(known: Known, supports: &Supports) -> Result<Vec<(Equation, Word)>, DeckError> {
    let (model, rigid) = (known.model, &supports.rigid);
    let unsorted = model
        .ignored
        .iter()
        .find(|ignored| ignored.word.eq_ignore_ascii_case("UNSORTED"));
    let (mut out, mut room) = (Vec::with_capacity(model.equations.len()), Room::default());
    // the first of each component of a node
    let mut named: BTreeMap<Key, &Word> = BTreeMap::new();
    for given in &model.equations {
        let nodes = |term: &Term| {
            let mut nodes = known.sets.nodes.find(&term.target, &term.word)?;
            nodes.sort_unstable_by_key(|n| model.nodes[*n as usize].label);
            if let (Some(unsorted), [_, _, ..]) = (unsorted, &nodes[..]) {
                return Err(term.word.cannot(format!(
                    "nodes of a set count by ascending numbers here, and a set of the deck is UNSORTED ({}); name the nodes \
                    by their numbers",
                    unsorted.location
                )));
            }
            Ok(nodes)
        };
        let nodes: Vec<Vec<u32>> = given.terms.iter().map(nodes).collect::<Result<_, _>>()?;
        let count = nodes.first().map_or(0, Vec::len);
        if let Some((term, _)) = (given.terms.iter().zip(&nodes)).find(|(_, n)| n.len() != 1 && n.len() != count) {
            return Err(term.word.cannot(
                "the set has another number of nodes than that of the first term; give one node, or a node for each of \
                its nodes",
            ));
        }
        room.take(count * nodes.len(), &given.word)?;
        for k in 0..count {
            let mut terms = Vec::with_capacity(given.terms.len());
            let mut points = Vec::new();
            for (term, nodes) in given.terms.iter().zip(&nodes) {
                let node = nodes[if nodes.len() == 1 { 0 } else { k }];
                match known.raw.in_mesh(node) {
                    None => {
                        let unit = [0, 1, 2].map(|c| if c == term.component { term.coefficient } else { 0.0 });
                        points.extend(
                            rigid
                                .iter()
                                .position(|r| r.reference == node)
                                .map(|point| (point, unit)),
                        );
                    }
                    Some(inside) => {
                        terms.push((inside, vector(known, term, inside)?));
                        named.entry((inside, term.component)).or_insert(&given.word);
                    }
                }
            }
            let equation = points
                .into_iter()
                .fold(Equation::new(terms), |e, (k, v)| e.with_point(k, v));
            out.push((equation, given.word.clone()));
        }
    }
    out.extend(follow(known, &named, &supports.held));
    Ok(out)
}

/// Equations that let added nodes follow those around them, as they do in the elements of the deck, where equations name
/// some of these, and supports hold the others: along x, y and z, or along axes that all have.
fn follow(known: Known, named: &BTreeMap<Key, &Word>, held: &BTreeMap<Key, Word>) -> Vec<(Equation, Word)> {
    let mut out = Vec::new();
    let axis = |node: u32, c: usize| {
        let frame = known.transforms.frame(node, known.raw.points[node as usize]).ok();
        frame.map(|frame| frame[c])
    };
    for added in known.raw.added().filter(|_| !named.is_empty()) {
        let (node, around) = added;
        // a node on both sides of a cut has two displacements
        if around
            .iter()
            .any(|(other, _)| known.raw.with_copies(*other).nth(1).is_some())
        {
            continue;
        }
        let word = |component: usize, turned: bool| {
            let parts = shares(known, added, component, turned)?;
            let is_said = |(key, _): &(Key, f64)| named.contains_key(key) || held.contains_key(key);
            let first = parts.iter().find_map(|(key, _)| named.get(key));
            first.filter(|_| parts.iter().all(is_said)).map(|word| (*word).clone())
        };
        let unit = |c: usize| [0, 1, 2].map(|k| if k == c { 1.0 } else { 0.0 });
        let straight = (0..3).filter_map(|c| Some((c, false, word(c, false)?)));
        let mut ways: Vec<(usize, bool, Word)> = straight.collect();
        if ways.is_empty() && known.transforms.of(node).is_some() {
            ways.extend((0..3).filter_map(|c| Some((c, true, word(c, true)?))));
        }
        for (component, turned, word) in ways {
            let vector = |n: u32| {
                if turned {
                    axis(n, component)
                } else {
                    Some(unit(component))
                }
            };
            let term = |(n, share): (u32, f64)| Some((n, scale(share, vector(n)?)));
            let around = around
                .iter()
                .filter(|part| part.1 != 0.0)
                .map(|(other, share)| (*other, -share));
            let terms: Option<Vec<_>> = around.chain([(node, 1.0)]).map(term).collect();
            out.extend(terms.map(|terms| (Equation::new(terms), word)));
        }
    }
    out
}

/// What multiplies the displacement of a node of the mesh in a term.
fn vector(known: Known, term: &Term, node: u32) -> Result<[f64; 3], DeckError> {
    if known.raw.with_copies(node).nth(1).is_some() {
        let label = known.raw.node_labels[node as usize];
        return Err(term.word.cannot(format!(
            "node {label} lies where a *PRE-TENSION SECTION cuts the body, and has two displacements; name another one"
        )));
    }
    let at = (node, known.raw.points[node as usize]);
    known.transforms.force(at, term.component, term.coefficient, &term.word)
}
