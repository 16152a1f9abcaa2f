//! Supports at the nodes of the mesh.

use crate::error::ContactError;
use crate::scene::Scene;
use signorini_fem_mesh::History;
use signorini_fem_mesh::internal::cylindrical;
use signorini_fem_mesh::vec3::{combine, is_finite, norm, sub, unit};
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
            if !scene.acts(support.span) {
                nodes.push(NodeSupport::partial(own, Directions::Nothing));
                continue;
            }
            let (directions, values) = match support.axis {
                None => (support.directions.clone(), None),
                Some(axis) => about_axis(scene, index, axis, &own)?,
            };
            let mut one = NodeSupport::partial(own, directions);
            if let Some((given, history)) = &support.motion {
                one = one.with_motion(Motion {
                    case: case_of(&mut motions, history),
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

    /// Takes nodes, ascending, out of all supports.
    pub(super) fn release(&mut self, nodes: &[u32]) {
        let held = self.directions.len();
        self.directions.retain(|node, _| nodes.binary_search(node).is_err());
        if self.directions.len() < held {
            self.nodes.iter_mut().for_each(|support| support.release(nodes));
        }
    }

    /// The displacement case of a history.
    pub(super) fn case(&mut self, history: &History) -> u32 {
        case_of(&mut self.motions, history)
    }
}

/// The case of a history, which is a new one if it is not known.
fn case_of(motions: &mut Vec<History>, history: &History) -> u32 {
    let known = motions.iter().position(|known| known == history);
    known.unwrap_or_else(|| {
        motions.push(history.clone());
        motions.len() - 1
    }) as u32
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
    let along = unit(axis);
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
        frames.push(match cylindrical(arm, along, size) {
            Some(frame) => frame,
            None if only_axial => [[0.0; 3], [0.0; 3], along],
            None => return Err(ContactError::OnAxis { support: index, node }),
        });
    }
    let lists = match &support.directions {
        Directions::EachNode(lists) => lists,
        _ => &vec![given; nodes.len()],
    };
    // as many lists as were given: another number than that of the nodes is refused with the others
    let of_node = |(own, frame): (&Vec<_>, _)| own.iter().map(|v| combine(frame, *v)).collect();
    let directions = lists.iter().zip(frames.iter().cycle()).map(of_node).collect();
    let values = support.motion.as_ref().map(|(values, _)| {
        let value = |(frame, v): (_, &[f64; 3])| combine(frame, *v);
        frames.iter().zip(values.iter().cycle()).map(value).collect()
    });
    Ok((Directions::EachNode(directions), values))
}
