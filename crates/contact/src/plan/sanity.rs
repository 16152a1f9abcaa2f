//! What a scene alone shows of what is hardly meant.

use super::never;
use super::unmerged::unmerged;
use crate::discrete::{ContactPoint, DiscreteScene, Extents, FacetedOverlaps, SurfaceSide, creases};
use crate::part::Part;
use crate::report::Warning;
use crate::scene::{Contact, ContactNormal, Friction, Gap, Scene};
use crate::tolerances::{LARGE_COEFFICIENT, LARGE_GAP, LARGE_OVERLAP, LOCKING};
use signorini_fem_mesh::History;
use std::collections::HashSet;

/// Warnings of a scene, each kind once. One pass over the contact points; bodies are measured only where a contact
/// begins nowhere near its obstacle.
pub(super) fn warnings(scene: &Scene, discrete: &DiscreteScene) -> Vec<Warning> {
    let points = &discrete.points;
    let listed = scene.materials.listed();
    let present = regions(scene, &listed);
    let [closed, pressing] = faceted_overlaps(discrete);
    let found = [
        idle(scene, discrete),
        never::between_steps(scene),
        never::zero_at_steps(scene, discrete),
        unmerged(scene, discrete),
        unused_materials(listed, &present),
        locking(scene, &present),
        idle_contact(scene, discrete),
        large_gap(scene, discrete),
        large_overlap(scene, discrete),
        closed,
        pressing,
        crease_between(scene, discrete),
        large_coefficient(scene, points),
    ];
    found.into_iter().flatten().collect()
}

/// Whether nothing acts at any step, so that all results are zero.
fn idle(scene: &Scene, discrete: &DiscreteScene) -> Option<Warning> {
    let ever = |history: &History| scene.analysis.times().iter().any(|&t| history.value(t) != 0.0);
    // an obstacle that moves need not meet anything
    let counts = |part: Part| if let Part::Contact(k) = part { scene.contacts[k].tied } else { true };
    let mut acting = never::acting(scene, discrete).filter(|(part, _)| counts(*part));
    // bodies that nothing else loads stay as they are, so that an obstacle acts once it overlaps with one
    let overlaps = |p: &ContactPoint, pose| p.gap_after(scene, pose).is_ok_and(|gap| gap < -discrete.rounding);
    let presses = |p: &ContactPoint| {
        let poses = &discrete.poses[p.surface];
        p.gap < -discrete.rounding || poses.iter().any(|pose| overlaps(p, pose))
    };
    let acts = acting.any(|(_, history)| ever(history)) || discrete.points.iter().any(presses);
    let held = !scene.supports.is_empty() || !scene.springs.is_empty() || !scene.couplings.is_empty();
    let held = held || !scene.equations.is_empty();
    (!acts).then_some(Warning::NothingActs { held })
}

/// The regions of the mesh, ascending; one of them where one law fills all.
fn regions(scene: &Scene, listed: &[u32]) -> Vec<u32> {
    if listed.is_empty() {
        scene.mesh.regions().first().copied().into_iter().collect()
    } else {
        scene.mesh.distinct_regions()
    }
}

fn unused_materials(mut listed: Vec<u32>, present: &[u32]) -> Option<Warning> {
    listed.retain(|region| present.binary_search(region).is_err());
    (!listed.is_empty()).then(|| Warning::UnusedMaterials {
        regions: listed,
        present: present.to_vec(),
    })
}

/// The region of linear tetrahedra that is least compressible, if it is too little so.
fn locking(scene: &Scene, present: &[u32]) -> Option<Warning> {
    if scene.mesh.order() > 1 {
        return None;
    }
    let poisson = |region: u32| scene.materials.get(region).ok()?.poisson();
    let ratios = present.iter().filter_map(|&r| Some((r, poisson(r)?)));
    let (region, poisson) = ratios.reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    (poisson > LOCKING).then_some(Warning::Locking { region, poisson })
}

/// The first contact without a point that supports leave free.
fn idle_contact(scene: &Scene, discrete: &DiscreteScene) -> Option<Warning> {
    let mut idle: Vec<bool> = scene.contacts.iter().map(|c| !c.tied && scene.acts(c.span)).collect();
    discrete.with_rows().for_each(|point| idle[point.surface] = false);
    let contact = idle.into_iter().position(|idle| idle)?;
    Some(Warning::IdleContact { contact })
}

/// The first contact whose nearest point is further away than its body is long.
fn large_gap(scene: &Scene, discrete: &DiscreteScene) -> Option<Warning> {
    let nearest = (0..scene.contacts.len()).filter_map(|index| least_gap(discrete, index, f64::abs));
    let (point, extent) = beyond(scene, discrete, LARGE_GAP, nearest)?;
    Some(Warning::LargeGap {
        contact: point.surface,
        node: point.node(),
        place: point.position,
        gap: point.gap,
        extent,
    })
}

/// The first contact whose deepest overlap is measured between bodies and strains one more than a press fit does.
fn large_overlap(scene: &Scene, discrete: &DiscreteScene) -> Option<Warning> {
    let is_measured = |(_, contact): &(usize, &Contact)| {
        let between = !contact.tied && !contact.partner.is_empty();
        between && contact.gap_history.is_none() && matches!(contact.gap, Gap::Measured)
    };
    let measured = scene.contacts.iter().enumerate().filter(is_measured);
    let deepest = measured.filter_map(|(index, _)| least_gap(discrete, index, |gap| gap));
    let deepest = deepest.filter(|point| point.gap < 0.0);
    let (point, extent) = beyond(scene, discrete, LARGE_OVERLAP, deepest)?;
    Some(Warning::LargeOverlap {
        contact: point.surface,
        node: point.node(),
        place: point.position,
        overlap: -point.gap,
        extent,
    })
}

/// The points of a contact. They are not in its order: a node of several has one point.
fn points_of(discrete: &DiscreteScene, contact: usize) -> impl Iterator<Item = &ContactPoint> {
    discrete.points.iter().filter(move |point| point.surface == contact)
}

/// The point of a contact whose gap is least as `size` has it.
fn least_gap(discrete: &DiscreteScene, index: usize, size: fn(f64) -> f64) -> Option<&ContactPoint> {
    points_of(discrete, index).min_by(|a, b| size(a.gap).total_cmp(&size(b.gap)))
}

/// The first of the points at a gap beyond that part of the length of its body, and that length.
fn beyond<'a>(
    scene: &Scene,
    discrete: &DiscreteScene,
    part: f64,
    points: impl Iterator<Item = &'a ContactPoint>,
) -> Option<(&'a ContactPoint, f64)> {
    // a body is no smaller than its parts: that is enough for most scenes
    let of_part = |node: u32| Extents::of_part(&scene.mesh, &discrete.decomposition, node);
    let far = |p: &&ContactPoint| p.gap.abs() > discrete.rounding.max(part * of_part(p.node()));
    let mut far = points.filter(far).peekable();
    far.peek()?;
    let extents = Extents::new(&scene.mesh, &discrete.decomposition);
    far.map(|p| (p, extents.at(p.node())))
        .find(|(p, extent)| p.gap.abs() > part * extent)
}

/// Overlaps about as deep as facets are beside the curve that they stand for: those that are closed, and those that
/// press.
fn faceted_overlaps(discrete: &DiscreteScene) -> [Option<Warning>; 2] {
    let FacetedOverlaps { pressing, closed } = &discrete.faceted;
    let closed = closed.map(|(deepest, [points, contacts])| Warning::ClosedOverlaps {
        contact: deepest.contact,
        node: deepest.node,
        place: deepest.place,
        overlap: deepest.depth,
        points,
        contacts,
    });
    let pressing = pressing.map(|deepest| Warning::FacetedOverlap {
        contact: deepest.contact,
        node: deepest.node,
        place: deepest.place,
        overlap: deepest.depth,
        sagitta: deepest.sagitta,
    });
    [closed, pressing]
}

/// The first crease of a side before another body that has points on both sides of it.
fn crease_between(scene: &Scene, discrete: &DiscreteScene) -> Option<Warning> {
    let meets = |contact: &Contact| !contact.partner.is_empty() && contact.normal() == ContactNormal::Body;
    let mut between = scene.contacts.iter().enumerate().filter(|(_, contact)| meets(contact));
    between.find_map(|(index, contact)| {
        let surface = &discrete.surfaces[index];
        let creases = creases(&scene.mesh, surface, contact.crease);
        let touching: HashSet<u32> = points_of(discrete, index).map(ContactPoint::node).collect();
        let touches = |local: u32| touching.contains(&surface.nodes()[local as usize]);
        let has_points = |side: &&SurfaceSide| {
            let mut triangles = side.triangles.iter().map(|t| surface.triangles()[*t as usize]);
            triangles.any(|t| t.iter().any(|&n| touches(n) && !creases.contains_key(&n)))
        };
        let meet = |(&local, sides): (&u32, &Vec<SurfaceSide>)| {
            let mut sides = sides.iter().filter(has_points).filter(|_| touches(local));
            let [one, other] = [sides.next()?, sides.next()?].map(|side| side.frame);
            Some((local, one.normal_part(other.normal).clamp(-1.0, 1.0).acos()))
        };
        // the first node, whatever the order of the table
        let (local, angle) = creases.iter().filter_map(meet).min_by_key(|found| found.0)?;
        let node = surface.nodes()[local as usize];
        Some(Warning::CreaseBetween {
            contact: index,
            node,
            place: scene.mesh.points()[node as usize],
            angle: angle.to_degrees(),
        })
    })
}

/// The largest coefficient, if it is too large, at whatever slip rate where that is known and else at rest.
fn large_coefficient(scene: &Scene, points: &[ContactPoint]) -> Option<Warning> {
    let coefficient = |point: &ContactPoint| match scene.contacts[point.surface].friction() {
        Friction::Coulomb(law) => {
            let at_rest = || law.value(point.at(), 0.0).ok();
            let along = law.largest(point.position).or_else(at_rest)?;
            Some(along * point.stretch.max(1.0))
        }
        _ => None,
    };
    let known = points.iter().filter_map(|p| Some((p, coefficient(p)?)));
    let (point, coefficient) = known.reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    (coefficient > LARGE_COEFFICIENT).then(|| Warning::LargeCoefficient {
        contact: point.surface,
        node: point.node(),
        place: point.position,
        coefficient,
    })
}
