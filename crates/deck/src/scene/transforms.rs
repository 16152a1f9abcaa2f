//! Axes of nodes: supports and forces along them.

use std::collections::BTreeMap;

use signorini_contact::{Directions, Support};
use signorini_fem_mesh::History;
use signorini_fem_mesh::internal::cylindrical;
use signorini_fem_mesh::vec3::{Vec3, combine, norm, scale, sub, unit};

use super::couplings::Couplings;
use super::mesh::Raw;
use super::numbers::Sets;
use super::points::Points;
use super::rigid::RigidBodies;
use crate::error::{DeckError, Word};
use crate::model::{Axes, Target, rectangular};

/// The axes of the nodes of the mesh that have their own.
#[derive(Debug, Default)]
pub(super) struct Transforms {
    axes: Vec<Axes>,
    of_node: BTreeMap<u32, usize>,
}

impl Transforms {
    pub(super) fn new(
        sets: &Sets,
        bodies: &RigidBodies,
        (couplings, points): (&Couplings, &Points),
        raw: &Raw,
    ) -> Result<Self, DeckError> {
        let model = sets.model;
        let mut out = Self::default();
        for (index, transform) in model.transforms.iter().enumerate() {
            let word = &transform.nset.word;
            // the same axes, given by several cards
            let index = out
                .axes
                .iter()
                .position(|axes| *axes == transform.axes)
                .unwrap_or(index);
            let target = Target::Name(transform.nset.name.clone());
            for node in sets.nodes.find(&target, word)? {
                let label = model.nodes[node as usize].label;
                if bodies.has(node) || couplings.of(node).is_some() || points.has(node) {
                    let why =
                        format!("node {label} stands for a rigid body or a surface, or alone, along x, y, z here");
                    return Err(word.cannot(why));
                }
                let Some(inside) = raw.in_mesh(node) else { continue };
                for inside in raw.with_copies(inside) {
                    if out.of_node.insert(inside, index).is_some() {
                        let why = format!("node {label} has axes already; give each node one *TRANSFORM");
                        return Err(word.cannot(why));
                    }
                }
            }
            out.axes.push(transform.axes);
        }
        let between = |(node, around): (u32, &[(u32, f64)])| {
            let axes = out.of(around[0].0)?;
            let same = around.iter().all(|other| out.of(other.0) == Some(axes));
            same.then(|| raw.with_copies(node).map(move |node| (node, axes)))
        };
        let new: Vec<_> = raw.added().filter_map(between).flatten().collect();
        out.of_node.extend(new);
        Ok(out)
    }

    /// The position of the axes of a node.
    pub(super) fn of(&self, node: u32) -> Option<usize> {
        self.of_node.get(&node).copied()
    }

    /// A component of a force on a node at a place along x, y, z.
    pub(super) fn force(
        &self,
        (node, place): (u32, Vec3),
        component: usize,
        value: f64,
        word: &Word,
    ) -> Result<Vec3, DeckError> {
        let unit = match self.frame(node, place) {
            Ok(frame) => frame[component],
            Err(along) if component == 2 => along,
            Err(_) => return Err(word.cannot("a node of it lies on its axis, where nothing is radial or tangential")),
        };
        Ok(scale(value, unit))
    }

    /// The axes of a node at a place; on the axis of cylindrical ones that is all there is.
    pub(super) fn frame(&self, node: u32, place: Vec3) -> Result<[Vec3; 3], Vec3> {
        match self.of(node).map(|index| self.axes[index]) {
            None => Ok([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
            Some(Axes::Rectangular(points)) => Ok(rectangular(points)),
            Some(Axes::Cylindrical([a, b])) => {
                let (along, arm) = (unit(sub(b, a)), sub(place, a));
                cylindrical(arm, along, norm(arm)).ok_or(along)
            }
        }
    }

    /// A support that holds components of nodes with the same axes, and its displacements.
    pub(super) fn support(
        &self,
        axes: Option<usize>,
        (nodes, on): (Vec<u32>, [bool; 3]),
        motion: Option<(Vec<Vec3>, History)>,
    ) -> Support {
        let axes = axes.map(|index| self.axes[index]);
        let frame = match axes {
            Some(Axes::Rectangular(points)) => Some(rectangular(points)),
            _ => None,
        };
        let directions = match (on, frame) {
            ([true, true, true], _) => Directions::All,
            (on, None) => Directions::Components(on),
            (on, Some(frame)) => Directions::Vectors((0..3).filter(|&c| on[c]).map(|c| frame[c]).collect()),
        };
        let mut support = Support::partial(nodes, directions);
        if let Some((mut values, history)) = motion {
            if let Some(frame) = frame {
                values.iter_mut().for_each(|v| *v = combine(&frame, *v));
            }
            support = match values[..] {
                [one] => support.with_motion(one, history),
                _ => support.with_motions(values, history),
            };
        }
        match axes {
            Some(Axes::Cylindrical([a, b])) => support.with_axis(a, sub(b, a)),
            _ => support,
        }
    }
}
