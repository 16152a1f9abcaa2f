//! Contacts that go on smoothly in one another, as patches do into which a curve is cut, have their sides found as one.

use super::crossing::crossing;
use super::means::opened;
use super::partners::{Paired, Partners};
use crate::error::ContactError;
use crate::scene::{Contact, Gap, Scene};
use crate::tolerances::SHARP;
use signorini_fem_mesh::internal::{DisjointSets, distinct};
use signorini_fem_mesh::vec3::dot;
use signorini_fem_mesh::{FacetTag, Surface};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Finds the sides of all contacts. Of a group whose meshes do not match each node has one point, in that contact whose
/// other side it sees most of, and of these in the first.
pub(super) fn pair(scene: &Scene, rounding: f64) -> Result<Vec<Paired>, ContactError> {
    let contacts = scene.contacts.iter().enumerate();
    let matching = contacts.map(|(index, contact)| {
        let paired = Paired::matching(&scene.mesh, (index, contact), rounding)?;
        paired.map(|p| opened(&scene.mesh, (index, contact), p)).transpose()
    });
    let mut out = matching.collect::<Result<Vec<_>, _>>()?;
    let apart: Vec<usize> = (0..out.len()).filter(|k| out[*k].is_none()).collect();
    for group in groups(scene, &apart)? {
        let crossing = crossing(scene, &group);
        let found = |contact: &Contact| Paired::apart((&scene.mesh, &scene.materials), (group[0], contact), &crossing);
        let first = &scene.contacts[group[0]];
        if let [index] = group[..] {
            out[index] = Some(found(first)?);
            continue;
        }
        let mut whole = first.clone();
        let all = |side: fn(&Contact) -> &[FacetTag]| {
            distinct(group.iter().flat_map(|k| side(&scene.contacts[*k]).iter().copied()))
        };
        (whole.tags, whole.partner) = (all(|c| &c.tags), all(|c| &c.partner));
        let parts = share_out(scene, &group, found(&whole)?)?;
        group
            .into_iter()
            .zip(parts)
            .for_each(|(index, part)| out[index] = Some(part));
    }
    Ok(out.into_iter().flatten().collect())
}

/// What each contact of a group has of their sides.
fn share_out(scene: &Scene, group: &[usize], whole: Paired) -> Result<Vec<Paired>, ContactError> {
    let sides = group.iter().map(|k| {
        let contact = &scene.contacts[*k];
        let [own, other] = if whole.swapped {
            [&contact.partner, &contact.tags]
        } else {
            [&contact.tags, &contact.partner]
        };
        let other = other.iter().flat_map(|tag| scene.mesh.nodes_on(*tag));
        Ok((Surface::new(&scene.mesh, own)?, other.collect::<HashSet<u32>>()))
    });
    let sides = sides.collect::<Result<Vec<_>, ContactError>>()?;
    let mut parts: Vec<Vec<_>> = sides.iter().map(|(own, _)| vec![None; own.nodes().len()]).collect();
    let seen = match whole.partners {
        Partners::Mortar(seen) => seen,
        Partners::Nodes(_) | Partners::Obstacle => Vec::new(),
    };
    for (node, seen) in whole.surface.nodes().iter().zip(seen) {
        let Some(seen) = seen else { continue };
        let mut most = None::<(f64, usize, usize)>;
        for (k, (own, other)) in sides.iter().enumerate() {
            let Some(local) = own.local(*node) else { continue };
            let of_it = seen.partner.iter().filter(|(node, _)| other.contains(node));
            let share: f64 = of_it.map(|(_, weight)| weight.abs()).sum();
            if most.is_none_or(|(known, ..)| share > known) {
                most = Some((share, k, local));
            }
        }
        if let Some((_, k, local)) = most {
            parts[k][local] = Some(seen);
        }
    }
    let parts = sides.into_iter().zip(parts).map(|((surface, _), nodes)| Paired {
        surface,
        fixed: whole.fixed,
        partners: Partners::Mortar(nodes),
        swapped: whole.swapped,
    });
    Ok(parts.collect())
}

/// Those of these contacts that go on in one another on both sides and have gaps of one kind; each in a group.
fn groups(scene: &Scene, of: &[usize]) -> Result<Vec<Vec<usize>>, ContactError> {
    if of.len() < 2 {
        return Ok(of.iter().map(|k| vec![*k]).collect());
    }
    let contacts = || of.iter().map(|k| &scene.contacts[*k]);
    let surfaces = contacts().flat_map(|c| [&c.tags, &c.partner]);
    let surfaces = surfaces.map(|tags| Surface::new(&scene.mesh, tags));
    let surfaces: Vec<Surface> = surfaces.collect::<Result<_, _>>()?;
    let sets = smooth_sets(&surfaces.iter().collect::<Vec<_>>());
    let mut out: Vec<(&[u32], Vec<usize>)> = Vec::new();
    for ((k, contact), own) in of.iter().zip(contacts()).zip(sets.chunks(2)) {
        let joins = |(sets, group): &&mut (&[u32], Vec<usize>)| {
            *sets == own && group.iter().all(|k| are_alike(&scene.contacts[*k], contact))
        };
        match out.iter_mut().find(joins) {
            Some((_, group)) => group.push(*k),
            None => out.push((own, vec![*k])),
        }
    }
    Ok(out.into_iter().map(|(_, group)| group).collect())
}

/// Whether gaps of two contacts are measured alike, and neither has as its second side what the other has as its first.
/// Laws of friction may differ.
fn are_alike(a: &Contact, b: &Contact) -> bool {
    let same_gap = match (&a.gap, &b.gap) {
        (Gap::None, Gap::None) | (Gap::Measured, Gap::Measured) => true,
        (Gap::Constant(one), Gap::Constant(other)) => one == other,
        _ => false,
    };
    let is_plain = |c: &Contact| !c.tied && !c.moves();
    let turns = |one: &Contact, other: &Contact| one.tags.iter().any(|tag| other.partner.contains(tag));
    same_gap
        && !turns(a, b)
        && !turns(b, a)
        && [a, b].into_iter().all(is_plain)
        && (a.normal, a.crease, a.closing) == (b.normal, b.crease, b.closing)
        && (a.compliance, a.span, &a.gap_history) == (b.compliance, b.span, &b.gap_history)
}

/// For each surface the number of its set: surfaces that go on smoothly in one another are one.
pub(super) fn smooth_sets(surfaces: &[&Surface]) -> Vec<u32> {
    // of each two that share nodes the least cosine between their normals
    let mut cosines: BTreeMap<[usize; 2], f64> = BTreeMap::new();
    let mut seen: HashMap<u32, Vec<(usize, [f64; 3])>> = HashMap::new();
    for (k, surface) in surfaces.iter().enumerate() {
        for (node, frame) in surface.nodes().iter().zip(surface.frames()) {
            let known = seen.entry(*node).or_default();
            for (other, normal) in known.iter() {
                let least = cosines.entry([*other, k]).or_insert(1.0);
                *least = least.min(dot(frame.normal, *normal));
            }
            known.push((k, frame.normal));
        }
    }
    let mut sets = DisjointSets::new(surfaces.len());
    for ([k, j], _) in cosines.into_iter().filter(|(_, least)| *least > SHARP) {
        sets.join(k, j);
    }
    sets.numbers()
}
