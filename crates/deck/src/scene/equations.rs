//! Equations between nodes.

use signorini_contact::Equation;
use signorini_fem_mesh::vec3::scale;

use super::between::Follower;
use super::flats;
use super::known::Known;
use super::points::Room;
use super::supports::Supports;
use crate::error::{DeckError, Word};
use crate::model::{Target, Term};

/// The equations of the scene, each with its place; of sets one for each of their nodes, by ascending numbers.
pub(super) fn equations(known: Known, supports: &Supports) -> Result<Vec<(Equation, Word)>, DeckError> {
    let (model, rigid) = (known.model, &supports.rigid);
    let (mut out, mut room) = (Vec::with_capacity(model.equations.len()), Room::default());
    for given in &model.equations {
        let nodes = |term: &Term| {
            let mut nodes = known.sets.nodes.find(&term.target, &term.word)?;
            nodes.sort_unstable_by_key(|n| model.nodes[*n as usize].label);
            let unsorted = match &term.target {
                Target::Name(name) => model.unsorted.get(name),
                _ => None,
            };
            if let (Some(location), [_, _, ..]) = (unsorted, &nodes[..]) {
                return Err(term.word.cannot(format!(
                    "nodes of a set count by ascending numbers here, and this one is UNSORTED ({location}); name the nodes \
                    by their numbers"
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
                    Some(inside) => terms.push((inside, vector(known, term, inside)?)),
                }
            }
            let equation = points
                .into_iter()
                .fold(Equation::new(terms), |e, (k, v)| e.with_point(k, v));
            out.push((equation, given.word.clone()));
        }
    }
    for given in &model.flats {
        out.extend(flats::equations(known, given, &mut room)?);
    }
    out.extend(supports.followers.iter().filter_map(|follower| follow(known, follower)));
    Ok(out)
}

/// The equation that lets an added node follow those around it.
fn follow(known: Known, follower: &Follower) -> Option<(Equation, Word)> {
    let Follower { node, component, .. } = *follower;
    let vector = |n: u32| match known.transforms.frame(n, known.raw.points[n as usize]) {
        _ if !follower.turned => Some([0, 1, 2].map(|k| if k == component { 1.0 } else { 0.0 })),
        Ok(frame) => Some(frame[component]),
        Err(along) => (component == 2).then_some(along),
    };
    let around = known.raw.around(node).iter().filter(|part| part.1 != 0.0);
    let all = around.map(|(other, share)| (*other, -share)).chain([(node, 1.0)]);
    let terms: Option<Vec<_>> = all.map(|(n, share)| Some((n, scale(share, vector(n)?)))).collect();
    Some((Equation::new(terms?), follower.word.clone()))
}

/// What multiplies the displacement of a node of the mesh in a term.
fn vector(known: Known, term: &Term, node: u32) -> Result<[f64; 3], DeckError> {
    known.raw.single(node, &term.word)?;
    let at = (node, known.raw.points[node as usize]);
    known.transforms.force(at, term.component, term.coefficient, &term.word)
}
