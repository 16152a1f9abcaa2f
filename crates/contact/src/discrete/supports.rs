//! Supports at the nodes of the mesh.

use crate::error::ContactError;
use crate::scene::Scene;
use crate::tolerances::ON_AXIS;
use signorini_fem_mesh::History;
use signorini_fem_mesh::vec3::{add, cross, dot, is_finite, norm, scale, sub};
use signorini_tfeti::internal::{PrescribedDirection, prescribed_directions};
use signorini_tfeti::{Directions, Motion, NodeSupport};
use std::collections::BTreeMap;

/// The supports of a scene, node by node.
#[derive(Debug)]
pub(crate) struct Supports {
    /// One a support of the scene.
    pub(crate) nodes: Vec<NodeSupport>,
    /// History of each displacement case. Equal histories are one case, so that equal displacements of a node that two
    /// supports share are recognised as equal.
    pub(crate) motions: Vec<History>,
    /// The directions that supports fix at each node, each by the first support that does.
    pub(crate) directions: BTreeMap<u32, Vec<PrescribedDirection>>,
}

impl Supports {
    pub(super) fn new(scene: &Scene) -> Result<Self, ContactError> {
        let mut motions: Vec<History> = Vec::new();
        let mut nodes = Vec::with_capacity(scene.supports.len());
        for (index, support) in scene.supports.iter().enumerate() {
            let own = scene.support_nodes(index)?;
            let (directions, values) = match support.axis {
                None => (support.directions.clone(), None),
                Some(axis) => about_axis(scene, index, axis, &own)?,
            };
            let mut one = NodeSupport::partial(own, directions);
            if let Some((given, history)) = &support.motion {
                let known = motions.iter().position(|known| known == history);
                let case = known.unwrap_or_else(|| {
                    motions.push(history.clone());
                    motions.len() - 1
                });
                one = one.with_motion(Motion {
                    case: case as u32,
                    values: values.unwrap_or_else(|| given.clone()),
                });
            }
            nodes.push(one);
        }
        let mut directions: BTreeMap<u32, Vec<_>> = BTreeMap::new();
        for direction in prescribed_directions(&nodes, scene.mesh.points().len())? {
            directions.entry(direction.node).or_default().push(direction);
        }
        Ok(Self {
            nodes,
            motions,
            directions,
        })
    }
}

/// Directions of a support, and its displacements if it moves.
type Given = (Directions, Option<Vec<[f64; 3]>>);

/// What is radial, tangential and axial along x, y, z, node by node.
fn about_axis(
    scene: &Scene,
    index: usize,
    (point, axis): ([f64; 3], [f64; 3]),
    nodes: &[u32],
) -> Result<Given, ContactError> {
    let support = &scene.supports[index];
    let along = scale(1.0 / norm(axis), axis);
    if !is_finite(along) || !is_finite(point) {
        let support = index;
        return Err(ContactError::SupportAxis { support, point, axis });
    }
    let arms = nodes.iter().map(|&n| sub(scene.mesh.points()[n as usize], point));
    let arms: Vec<_> = arms.collect();
    let size = arms.iter().map(|arm| norm(*arm)).fold(0.0, f64::max);
    let given = support.directions.vectors();
    let only_axial = given.iter().all(|d| d[..2] == [0.0; 2]);
    let mut frames = Vec::with_capacity(nodes.len());
    for (&node, arm) in nodes.iter().zip(arms) {
        let out = sub(arm, scale(dot(arm, along), along));
        let distance = norm(out);
        let radial = match distance > ON_AXIS * size {
            true => scale(1.0 / distance, out),
            false if only_axial => [0.0; 3],
            false => return Err(ContactError::OnAxis { support: index, node }),
        };
        frames.push([radial, cross(along, radial), along]);
    }
    let turned = |frame: &[[f64; 3]; 3], v: [f64; 3]| {
        let parts = frame.iter().zip(v).map(|(unit, part)| scale(part, *unit));
        parts.fold([0.0; 3], add)
    };
    let of_node = |(frame, own): (_, &Vec<_>)| own.iter().map(|v| turned(frame, *v)).collect();
    let lists = match &support.directions {
        Directions::EachNode(lists) => lists.clone(),
        _ => vec![given; nodes.len()],
    };
    if lists.len() != nodes.len() {
        // refused as it would be without an axis
        return Ok((support.directions.clone(), None));
    }
    let directions = Directions::EachNode(frames.iter().zip(&lists).map(of_node).collect());
    let values = support.motion.as_ref().map(|(values, _)| {
        let value = |k: usize| values[if values.len() == 1 { 0 } else { k }];
        frames
            .iter()
            .enumerate()
            .map(|(k, frame)| turned(frame, value(k)))
            .collect()
    });
    Ok((directions, values))
}
