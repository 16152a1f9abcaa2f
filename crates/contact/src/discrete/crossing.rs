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
    let contacts = &scene.contacts;
    let mut out = vec![HashSet::new(); contacts.len()];
    let apart = |k: usize| paired[k].is_mortar() && !contacts[k].tied;
    let is_rough = |contact: &Contact| contact.friction().is_some() && !contact.tied;
    let may_cross = scene.mesh.order() == 1 && (0..paired.len()).any(apart) && contacts.iter().any(is_rough);
    if contacts.len() < 2 || !may_cross {
        return out;
    }
    let nodes = |contact: &Contact| -> HashSet<u32> {
        let tags = contact.tags.iter().chain(&contact.partner);
        tags.flat_map(|tag| scene.mesh.nodes_on(*tag)).collect()
    };
    let nodes: Vec<HashSet<u32>> = contacts.iter().map(nodes).collect();
    let times = scene.analysis.times();
    let go_on = |a: usize, b: usize| groups.iter().any(|group| group.contains(&a) && group.contains(&b));
    for a in (0..paired.len()).filter(|&k| apart(k)) {
        for b in (0..contacts.len()).filter(|&k| k != a) {
            let rough = is_rough(&contacts[a]) || is_rough(&contacts[b]);
            let meet = !contacts[b].tied && contacts[a].span.meets(&contacts[b].span, times);
            if rough && meet && !go_on(a, b) {
                let common: Vec<u32> = nodes[a].intersection(&nodes[b]).copied().collect();
                out[a].extend(&common);
                out[b].extend(common);
            }
        }
    }
    out
}
