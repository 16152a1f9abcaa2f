//! How far tied surfaces are apart, which CalculiX and Abaqus ask before they tie a node.
//!
//! Both tie the nodes of the first surface that are no farther from the second than the position tolerance, and move
//! them onto it unless told not to; CalculiX leaves the others free. Here nodes stay where they are, and what faces the
//! other surface is tied at any distance: nodes beyond the tolerance are refused, moves that do not happen reported.

use std::collections::BTreeMap;

use signorini_contact::Obstacle;
use signorini_fem_mesh::vec3::{add, area_vector, dot, norm, sub};

use super::faces::FaceTable;
use super::known::Known;
use crate::error::DeckError;
use crate::model::{Ignored, Law, Pair, Tie};
use crate::tolerances::{BEFORE, NO_TIE, TIE, TOGETHER};

/// Refuses a tie whose nodes are too far from the other surface; `surfaces` are the positions of both.
pub(super) fn check(
    known: Known,
    faces: &FaceTable,
    (pair, tie): (&Pair, &Tie),
    surfaces: [usize; 2],
) -> Result<Option<Ignored>, DeckError> {
    let raw = known.raw;
    let place = |triangle: &[u32; 3]| triangle.map(|n| raw.points[n as usize]);
    let [own, other] = surfaces.map(|s| faces.triangles_of(raw, s as u32));
    let radius = |t: &[u32; 3]| {
        let t = place(t);
        let rim: f64 = (0..3).map(|i| norm(sub(t[(i + 1) % 3], t[i]))).sum();
        2.0 * norm(area_vector(&t)) / rim
    };
    let size = other.iter().map(radius).sum::<f64>() / other.len() as f64;
    // faces are no part of two elements, and elements have volume
    let Ok(surface) = Obstacle::surface(&raw.points, &other) else {
        return Ok(None);
    };
    let mut normals: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    for triangle in &own {
        let area = area_vector(&place(triangle));
        for &node in triangle {
            let sum = normals.entry(node).or_default();
            *sum = add(*sum, area);
        }
    }
    let given = tie.tolerance.filter(|t| *t >= NO_TIE);
    let tolerance = given.unwrap_or(TIE * size);
    let mut farthest = (0.0, 0);
    for (node, normal) in normals {
        let (distance, gradient) = surface.distance(raw.points[node as usize]);
        let distance = distance.abs();
        let label = raw.node_labels[node as usize];
        if distance <= tolerance {
            if distance > farthest.0 {
                farthest = (distance, label);
            }
        } else if dot(normal, gradient).abs() > BEFORE * norm(normal) {
            if matches!(pair.law, Law::Contact(_)) {
                return Err(pair.slave.word.cannot(format!(
                    "node {label} is {distance:.3e} from {}: CalculiX pulls tied contact shut, here it stays as far apart; move \
                    the nodes, or write *TIE with a POSITION TOLERANCE",
                    pair.master.word.text
                )));
            }
            return Err(pair.slave.word.cannot(format!(
                "node {label} is {distance:.3e} from {}, more than the position tolerance {tolerance:.3e}{}: CalculiX would \
                not tie it, here all is tied that faces the other surface; give *TIE a larger POSITION TOLERANCE, or \
                leave these faces out",
                pair.master.word.text,
                if given.is_none() { " (2.5 % of a typical element size)" } else { "" },
            )));
        }
    }
    let (distance, label) = farthest;
    Ok((tie.adjust && distance > TOGETHER * size).then(|| {
        let why = format!(
            "nodes are not moved onto {}: node {label} stays {distance:.3e} away from it and is tied there; move it, or write \
            ADJUST=NO",
            pair.master.word.text
        );
        Ignored::new(&tie.word, why)
    }))
}
