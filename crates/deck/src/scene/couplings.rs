//! Loads and displacements of nodes that stand for surfaces.
//!
//! A distributing coupling spreads force and moment as CalculiX and Abaqus do: nodes have the weights of their areas,
//! and forces grow linearly from their centroid, so that their sum and their moment are those of the node.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use signorini_fem_mesh::vec3::{Vec3, add, cross, norm, scale, sub};

use super::faces::FaceTable;
use super::mesh::Raw;
use super::numbers::Sets;
use super::rigid::RigidBodies;
use crate::error::{DeckError, Word};
use crate::model::CouplingLaw;

/// A node of the deck, by position, and the surface for which it stands.
#[derive(Debug)]
pub(super) struct Coupling {
    pub(super) node: u32,
    pub(super) law: CouplingLaw,
    /// Its position, and the word that names it.
    surface: usize,
    pub(super) word: Word,
}

/// All couplings.
#[derive(Debug, Default)]
pub(super) struct Couplings(pub(super) Vec<Coupling>);

/// How a surface takes the loads of its node.
pub(super) struct Spread {
    /// Nodes of the mesh, their parts of the area, and arms from the centroid.
    nodes: Vec<(u32, f64, Vec3)>,
    /// From the centroid to the node that is loaded.
    arm: Vec3,
    /// Inverse of the second moments of the weights.
    inverse: Matrix3<f64>,
}

impl Couplings {
    pub(super) fn new(sets: &Sets, bodies: &RigidBodies, raw: &Raw) -> Result<Self, DeckError> {
        let mut list: Vec<Coupling> = Vec::with_capacity(sets.model.couplings.len());
        for said in &sets.model.couplings {
            let law = said.law;
            let law = law.ok_or_else(|| {
                let why = "the coupling does not say what it does; put *DISTRIBUTING or *KINEMATIC behind it";
                said.word.cannot(why)
            })?;
            let (target, word) = &said.reference;
            let node = sets.one_node(target, word)?;
            let other = match () {
                () if raw.in_mesh(node).is_some() => Some("belongs to an elastic element"),
                () if bodies.has(node) => Some("says how a rigid body moves"),
                () if list.iter().any(|other| other.node == node) => Some("stands for another surface"),
                () => None,
            };
            if let Some(other) = other {
                let label = sets.model.nodes[node as usize].label;
                let why = format!("node {label} {other}; give the coupling a node of its own");
                return Err(word.cannot(why));
            }
            let surface = &said.surface;
            list.push(Coupling {
                node,
                law,
                surface: sets.model.surfaces.find("surface", &surface.name, &surface.word)?,
                word: surface.word.clone(),
            });
        }
        Ok(Self(list))
    }

    /// The coupling of a node of the deck, by position.
    pub(super) fn of(&self, node: u32) -> Option<&Coupling> {
        self.0.iter().find(|coupling| coupling.node == node)
    }

    /// Whether a surface has the displacement of a node.
    pub(super) fn moves(&self, node: u32) -> bool {
        self.of(node).is_some_and(|c| c.law == CouplingLaw::Kinematic)
    }
}

impl Coupling {
    /// Nodes of its surface, with their parts of the area.
    pub(super) fn nodes(&self, raw: &Raw, faces: &FaceTable) -> Result<BTreeMap<u32, f64>, DeckError> {
        let mut nodes = BTreeMap::new();
        for face in faces.of_surface(self.surface as u32) {
            let part = norm(face.area_vector(raw)) / 3.0;
            face.nodes.iter().for_each(|n| *nodes.entry(*n).or_default() += 0.0);
            face.loaded(raw)
                .iter()
                .for_each(|n| *nodes.entry(*n).or_default() += part);
        }
        match nodes.is_empty() {
            true => Err(self
                .word
                .cannot("the surface has no elastic faces; couple one of a body")),
            false => Ok(nodes),
        }
    }

    pub(super) fn spread(&self, sets: &Sets, raw: &Raw, faces: &FaceTable) -> Result<Spread, DeckError> {
        let reference = sets.model.nodes[self.node as usize].point;
        let all = self.nodes(raw, faces)?;
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
        Ok(Spread {
            nodes,
            arm: scale(-1.0, centroid),
            inverse: inverse.ok_or_else(|| self.word.cannot("the surface has no area; check its nodes"))?,
        })
    }
}

impl Spread {
    /// Forces at nodes of a component of the load, 0 to 2 of the force and 3 to 5 of the moment.
    pub(super) fn forces(&self, component: usize, value: f64) -> impl Iterator<Item = (u32, Vec3)> {
        let unit = [0, 1, 2].map(|c| if c == component % 3 { value } else { 0.0 });
        let (force, moment) = match component < 3 {
            true => (unit, cross(self.arm, unit)),
            false => ([0.0; 3], unit),
        };
        let spin: Vec3 = (self.inverse * Vector3::from(moment)).into();
        let at = move |&(node, part, arm): &(u32, f64, Vec3)| (node, scale(part, add(force, cross(spin, arm))));
        self.nodes.iter().map(at)
    }
}
