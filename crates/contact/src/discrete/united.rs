//! Contacts that go on smoothly in one another, as patches do into which a curve is cut, have their sides found as one.

use super::crossing::crossing;
use super::means::opened;
use super::partners::{Found, Paired, Partners};
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
    let mesh = &scene.mesh;
    let mut out: Vec<Option<Paired>> = Vec::with_capacity(scene.contacts.len());
    let mut apart: Vec<Apart> = Vec::new();
    for one in scene.contacts.iter().enumerate() {
        out.push(match Paired::matching(mesh, one, rounding)? {
            Found::Paired(paired) => Some(opened(scene, one.0, paired)?),
            Found::Apart(sides) => {
                apart.push((one.0, sides));
                None
            }
        });
    }
    for mut group in groups(scene, apart) {
        let members: Vec<usize> = group.iter().map(|(index, _)| *index).collect();
        let (index, first) = (members[0], &scene.contacts[members[0]]);
        let crossing = crossing(scene, &members);
        let found =
            |contact: &Contact, sides| Paired::mortar((mesh, &scene.materials), (index, contact), sides, &crossing);
        if group.len() == 1 {
            out[index] = group.pop().map(|(_, sides)| found(first, sides)).transpose()?;
            continue;
        }
        let mut whole = first.clone();
        let all = |side: fn(&Contact) -> &[FacetTag]| {
            distinct(members.iter().flat_map(|k| side(&scene.contacts[*k]).iter().copied()))
        };
        (whole.tags, whole.partner) = (all(|c| &c.tags), all(|c| &c.partner));
        let sides = [Surface::new(mesh, &whole.tags)?, Surface::new(mesh, &whole.partner)?];
        let whole = found(&whole, sides)?;
        for (index, part) in share_out(scene, group, whole) {
            out[index] = Some(part);
        }
    }
    Ok(out.into_iter().flatten().collect())
}

/// A contact whose meshes do not match, with its sides.
type Apart = (usize, [Surface; 2]);

/// What each contact of a group has of the sides of all.
fn share_out(scene: &Scene, group: Vec<Apart>, whole: Paired) -> Vec<(usize, Paired)> {
    let sides = group.into_iter().map(|(index, [first, second])| {
        let contact = &scene.contacts[index];
        let (own, other) = if whole.swapped { (second, &contact.tags) } else { (first, &contact.partner) };
        let other = other.iter().flat_map(|tag| scene.mesh.nodes_on(*tag));
        (index, own, other.collect())
    });
    let sides: Vec<(usize, Surface, HashSet<u32>)> = sides.collect();
    let mut parts: Vec<Vec<_>> = sides.iter().map(|(_, own, _)| vec![None; own.nodes().len()]).collect();
    let seen = match whole.partners {
        Partners::Mortar(seen) => seen,
        Partners::Nodes(_) | Partners::Obstacle => Vec::new(),
    };
    for (node, seen) in whole.surface.nodes().iter().zip(seen) {
        let Some(seen) = seen else { continue };
        let mut most = None::<(f64, usize, usize)>;
        for (k, (_, own, other)) in sides.iter().enumerate() {
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
    let part = |((index, surface, _), nodes): ((usize, Surface, HashSet<u32>), _)| {
        let part = Paired {
            surface,
            fixed: whole.fixed,
            partners: Partners::Mortar(nodes),
            swapped: whole.swapped,
        };
        (index, part)
    };
    sides.into_iter().zip(parts).map(part).collect()
}

/// Those of these contacts that go on in one another on both sides and have gaps of one kind; each in a group.
fn groups(scene: &Scene, of: Vec<Apart>) -> Vec<Vec<Apart>> {
    if of.len() < 2 {
        return of.into_iter().map(|one| vec![one]).collect();
    }
    let sets = smooth_sets(&of.iter().flat_map(|(_, sides)| sides).collect::<Vec<_>>());
    let mut out: Vec<(&[u32], Vec<Apart>)> = Vec::new();
    for (one, own) in of.into_iter().zip(sets.chunks(2)) {
        let alike = |other: &Apart| are_alike(&scene.contacts[other.0], &scene.contacts[one.0]);
        let joins = |(sets, group): &&mut (&[u32], Vec<Apart>)| *sets == own && group.iter().all(alike);
        match out.iter_mut().find(joins) {
            Some((_, group)) => group.push(one),
            None => out.push((own, vec![one])),
        }
    }
    out.into_iter().map(|(_, group)| group).collect()
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
