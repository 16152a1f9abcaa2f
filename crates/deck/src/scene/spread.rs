//! Loads and displacements of nodes that stand for surfaces, on the nodes of these.
//!
//! A distributing coupling spreads force and moment as CalculiX and Abaqus do: nodes have the weights of their areas,
//! and forces grow linearly from their centroid, so that their sum and their moment are those of the node.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use signorini_fem_mesh::vec3::{Vec3, add, cross, scale, sub};

use super::couplings::Coupling;
use super::faces::FaceTable;
use super::known::Known;
use crate::error::DeckError;

/// How a surface takes the loads of its node.
pub(super) struct Spread {
    /// Nodes of the mesh, their parts of the area, and arms from the centroid.
    nodes: Vec<(u32, f64, Vec3)>,
    /// From the centroid to the node that is loaded.
    arm: Vec3,
    /// Inverse of the second moments of the weights.
    inverse: Matrix3<f64>,
}

/// Nodes of the surface of a coupling, with their parts of its area: none at the corners of plane quadratic faces.
pub(super) fn coupled_nodes(
    coupling: &Coupling,
    Known { raw, sections, .. }: Known,
    faces: &FaceTable,
) -> Result<BTreeMap<u32, f64>, DeckError> {
    sections.check_outside(coupling.surface, &coupling.word)?;
    let mut nodes = BTreeMap::new();
    for face in faces.of_surface(coupling.surface as u32) {
        let corners = face.corners(raw).map(|n| (n, 0.0));
        for (node, part) in corners.into_iter().chain(face.areas(raw)) {
            *nodes.entry(node).or_default() += part;
        }
    }
    if nodes.is_empty() {
        Err((coupling.word).cannot("the surface has no elastic faces; couple one of a body"))
    } else {
        Ok(nodes)
    }
}

impl Spread {
    pub(super) fn new(coupling: &Coupling, known: Known, faces: &FaceTable) -> Result<Self, DeckError> {
        let (model, raw) = (known.model, known.raw);
        let reference = model.nodes[coupling.node as usize].point;
        let all = coupled_nodes(coupling, known, faces)?;
        let whole: f64 = all.values().sum();
        let arm = |node: u32| sub(raw.points[node as usize], reference);
        let parts = all.iter().map(|(&node, area)| scale(area / whole, arm(node)));
        let centroid = parts.fold([0.0; 3], add);
        let mut second = Matrix3::zeros();
        let mut nodes = Vec::with_capacity(all.len());
        for (node, area) in all.into_iter().filter(|(_, area)| *area > 0.0) {
            let (part, arm) = (area / whole, sub(arm(node), centroid));
            let v = Vector3::from(arm);
            second += part * (Matrix3::identity() * v.norm_squared() - v * v.transpose());
            nodes.push((node, part, arm));
        }
        let inverse = second.try_inverse().filter(|m| m.iter().all(|v| v.is_finite()));
        Ok(Self {
            nodes,
            arm: scale(-1.0, centroid),
            inverse: inverse.ok_or_else(|| coupling.word.cannot("the surface has no area; check its nodes"))?,
        })
    }

    /// Forces at nodes of a component of the load, 0 to 2 of the force and 3 to 5 of the moment.
    pub(super) fn forces(&self, component: usize, value: f64) -> impl Iterator<Item = (u32, Vec3)> {
        let unit = [0, 1, 2].map(|c| if c == component % 3 { value } else { 0.0 });
        let (force, moment) = if component < 3 { (unit, cross(self.arm, unit)) } else { ([0.0; 3], unit) };
        let spin: Vec3 = (self.inverse * Vector3::from(moment)).into();
        let at = move |&(node, part, arm): &(u32, f64, Vec3)| (node, scale(part, add(force, cross(spin, arm))));
        self.nodes.iter().map(at)
    }
}
