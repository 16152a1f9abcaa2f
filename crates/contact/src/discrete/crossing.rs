//! Contacts that cross: nodes of a contact between bodies that another contact has, too.
//!
//! With all conditions of both, rows along a surface nearly depend on one another where meshes do not match: friction of
//! either acts along normals of the other, and active sets run in circles. So neither has friction there, on a strip
//! that is half a facet wide.

use super::partners::Paired;
use crate::scene::{Contact, Scene};
use std::collections::HashSet;

/// The nodes of each contact at which it has no friction, between linear meshes. Contacts of one group go on in one
/// another and do not cross.
pub(super) fn crossed(scene: &Scene, paired: &[Paired], groups: &[Vec<usize>]) -> Vec<HashSet<u32>> {
    let mut out = vec![HashSet::new(); scene.contacts.len()];
    let times = scene.analysis.times();
    let is_rough = |contact: &Contact| contact.friction().is_some() && !contact.tied;
    let nodes = |contact: &Contact| -> HashSet<u32> {
        let tags = contact.tags.iter().chain(&contact.partner);
        tags.flat_map(|tag| scene.mesh.nodes_on(*tag)).collect()
    };
    let apart = (0..paired.len()).filter(|&k| paired[k].is_mortar() && !scene.contacts[k].tied);
    for index in apart.filter(|_| scene.mesh.order() == 1) {
        let contact = &scene.contacts[index];
        let own = nodes(contact);
        let goes_on = |other: usize| {
            groups
                .iter()
                .any(|group| group.contains(&index) && group.contains(&other))
        };
        for (k, other) in scene.contacts.iter().enumerate() {
            let rough = is_rough(contact) || is_rough(other);
            if k == index || goes_on(k) || !rough || other.tied || !contact.span.meets(&other.span, times) {
                continue;
            }
            let common = nodes(other);
            let common = own.iter().filter(|node| common.contains(node));
            for node in common {
                out[index].insert(*node);
                out[k].insert(*node);
            }
        }
    }
    out
}
