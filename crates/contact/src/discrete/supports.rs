//! Supports at the nodes of the mesh.

use crate::error::ContactError;
use crate::scene::Scene;
use signorini_fem_mesh::History;
use signorini_tfeti::internal::{PrescribedDirection, prescribed_directions};
use signorini_tfeti::{Motion, NodeSupport};
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
            let mut one = NodeSupport::partial(scene.support_nodes(index)?, support.directions.clone());
            if let Some((values, history)) = &support.motion {
                let known = motions.iter().position(|known| known == history);
                let case = known.unwrap_or_else(|| {
                    motions.push(history.clone());
                    motions.len() - 1
                });
                one = one.with_motion(Motion {
                    case: case as u32,
                    values: values.clone(),
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
