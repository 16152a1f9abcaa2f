//! Nodes that stay in a plane or on a line, as equations.

use signorini_contact::Equation;
use signorini_fem_mesh::SurfaceFrame;
use signorini_fem_mesh::internal::distinct;
use signorini_fem_mesh::vec3::{Vec3, cross, dot, far_apart, norm, scale, sub};

use super::known::Known;
use super::points::Room;
use crate::error::{DeckError, Word};
use crate::model::Flat;
use crate::tolerances::TURNED;

/// The equations of some nodes, and of those between them, each with its place: what a node moves across the plane, or
/// the line, is what three of them, or two, that are far apart say of its place.
pub(super) fn equations(known: Known, given: &Flat, room: &mut Room) -> Result<Vec<(Equation, Word)>, DeckError> {
    let mut nodes = Vec::new();
    for (target, word) in &given.nodes {
        for node in known.sets.nodes.find(target, word)? {
            let label = known.model.nodes[node as usize].label;
            let none = || word.cannot(format!("no element uses node {label}; name nodes of the body"));
            known.raw.single(known.raw.in_mesh(node).ok_or_else(none)?, word)?;
            nodes.push(node);
        }
    }
    let nodes = known.raw.all_in_mesh(&distinct(nodes));
    let places: Vec<Vec3> = nodes.iter().map(|n| known.raw.points[*n as usize]).collect();
    let Some(([a, b, c], off)) = far_apart(&places) else {
        return Err(given.word.cannot("it names no nodes; name some, or remove it"));
    };
    let [along, aside] = [b, c].map(|k| sub(places[k], places[a]));
    let normal = cross(along, aside);
    let frame = if given.is_line {
        SurfaceFrame::from_normal(along)
    } else {
        SurfaceFrame::from_normal(normal).filter(|_| off > TURNED)
    };
    let frame = frame.ok_or_else(|| {
        given
            .word
            .cannot("its nodes are in one place, or on a line, which is in many planes; name others, or take STRAIGHT")
    })?;
    let (basis, across): (&[usize], &[Vec3]) =
        if given.is_line { (&[a, b], &frame.tangents) } else { (&[a, b, c], &[frame.normal]) };
    // the shares of the basis at a place
    let shares = |place: Vec3| {
        let arm = sub(place, places[a]);
        if given.is_line {
            let t = dot(arm, along) / dot(along, along);
            [1.0 - t, t, 0.0]
        } else {
            let [u, v] = [cross(arm, aside), cross(along, arm)].map(|x| dot(normal, x) / dot(normal, normal));
            [1.0 - u - v, u, v]
        }
    };
    room.take(4 * nodes.len() * across.len(), &given.word)?;
    let mut out = Vec::new();
    for k in (0..nodes.len()).filter(|k| !basis.contains(k)) {
        let arm = sub(places[k], places[a]);
        let most = across.iter().map(|d| dot(*d, arm).abs()).fold(0.0, f64::max);
        if most > TURNED * norm(along) {
            let label = known.raw.node_labels[nodes[k] as usize];
            return Err(given.word.cannot(format!(
                "node {label} is {most:e} away from where the others are; move it, or remove it from the nodes"
            )));
        }
        let shares = shares(places[k]);
        for direction in across {
            let mut terms = vec![(nodes[k], *direction)];
            let others = basis.iter().zip(shares).filter(|(_, share)| *share != 0.0);
            terms.extend(others.map(|(b, share)| (nodes[*b], scale(-share, *direction))));
            out.push((Equation::new(terms), given.word.clone()));
        }
    }
    if out.is_empty() {
        Err((given.word).cannot("so few nodes are in one plane, or on one line, wherever they are; name more"))
    } else {
        Ok(out)
    }
}
