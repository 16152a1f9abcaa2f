//! What a plan checks beside sizes: all that can be wrong with supports, contact, loads and laws, without stiffness or factors.
//!
//! Only the set-up can judge whether supports and contact hold the body against its loads: that needs the rigid motions of
//! all subdomains.

use crate::driven;
use crate::error::ContactError;
use crate::law;
use crate::model::{contact_nodes, supports};
use crate::scene::Scene;
use signorini_fem_mesh::{Decomposition, Surface, assemble_load};
use signorini_tfeti::{ContactNodes, held_points};

/// Refuses what [`Simulation::new`](crate::Simulation::new) would refuse, with the same error.
pub(crate) fn check(scene: &Scene, decomposition: &Decomposition) -> Result<(), ContactError> {
    let (supports, motions) = supports(scene)?;
    let places = scene.mesh.points();
    let mut nodes = ContactNodes {
        points: Vec::new(),
        friction: false,
    };
    if let Some(contact) = &scene.contact {
        let surface = Surface::new(&scene.mesh, &contact.tags)?;
        nodes = contact_nodes(contact, &surface)?;
        driven::check(scene, contact, &nodes, &supports, &motions)?;
    }
    // merges the supports, whether there is contact or not
    let held = held_points(&nodes, &supports, places.len())?;
    for (index, load) in scene.loads.iter().enumerate() {
        assemble_load(&scene.mesh, decomposition, &load.density)
            .map_err(|source| ContactError::Load { index, source })?;
    }
    let Some(contact) = &scene.contact else {
        return Ok(());
    };
    let mut held = held.iter().map(|h| h.node).peekable();
    // both in the order of the points
    let free = nodes.points.iter().map(|p| p.node);
    let free: Vec<_> = free
        .filter(|node| held.next_if_eq(node).is_none())
        .map(|node| (node, places[node as usize]))
        .collect();
    for &(node, place) in &free {
        contact.gap_at(node, place)?;
    }
    law::check(contact.friction(), free)
}
