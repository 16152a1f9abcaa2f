//! Supports and contact points as `tfeti` wants them: at nodes.

use super::points::ContactPoint;
use crate::error::ContactError;
use crate::scene::Scene;
use signorini_fem_mesh::History;
use signorini_tfeti as tfeti;
use signorini_tfeti::{ContactConstraint, ContactConstraints};

/// The supports, and the history of each displacement case. Equal histories are one case, so that equal displacements of
/// a node that two supports share are recognised as equal.
pub(crate) fn lower_supports(
    scene: &Scene,
) -> Result<(Vec<tfeti::NodeSupport>, Vec<History>), ContactError> {
    let mut motions: Vec<History> = Vec::new();
    let mut out = Vec::with_capacity(scene.supports.len());
    for (index, support) in scene.supports.iter().enumerate() {
        let nodes = scene.support_nodes(index)?;
        let mut one = tfeti::NodeSupport::partial(nodes, support.directions.clone());
        if let Some((values, history)) = &support.motion {
            let case = match motions.iter().position(|known| known == history) {
                Some(case) => case,
                None => {
                    motions.push(history.clone());
                    motions.len() - 1
                }
            };
            one = one.with_motion(tfeti::Motion {
                case: case as u32,
                values: values.clone(),
            });
        }
        out.push(one);
    }
    Ok((out, motions))
}

/// The points as `tfeti` wants them.
pub(crate) fn contact_constraints<'a>(
    scene: &Scene,
    candidates: impl Iterator<Item = &'a ContactPoint>,
) -> ContactConstraints {
    let point = |c: &ContactPoint| {
        let contact = &scene.contacts[c.surface];
        ContactConstraint::new(c.node, c.frame)
            .with_partner(c.partner)
            .with_friction(contact.friction().is_some())
            .with_moving_obstacle(contact.motion.is_some())
    };
    candidates.map(point).collect()
}
