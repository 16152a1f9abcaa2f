//! Overlaps of bodies that touch each other or an obstacle, which are there because straight facets stand for a curve.
//!
//! Nodes are on the curve, facets of a hollow side before it, those of a convex side behind it, and with them mid-nodes
//! on straight edges; an obstacle has no facets. What they make of gaps is known in the mean over a facet: a third of
//! the sum of the arcs over its edges, for any curve of second degree. Taken from the measured gaps, in the mean over
//! all contact of two bodies, it tells whether they touch or are pressed together. Gaps between linear facets that
//! cover one another are measured to the curve (`chords`), and have nothing of it.

use super::chords::{Chords, edges, normals};
use super::creases::area_vector;
use super::partners::Paired;
use super::points::{ContactPoint, of_contact};
use super::united::smooth_sets;
use crate::error::ContactError;
use crate::scene::{Closing, Gap, Scene};
use crate::tolerances::{ARC_ERROR, DEEP, DIGITS, FACETED, TOUCHING};
use signorini_fem_mesh::internal::{DisjointSets, Lists, distinct};
use signorini_fem_mesh::vec3::{cross, norm, sub};
use signorini_fem_mesh::{FacetTag, Surface, TetMesh};
use std::collections::HashMap;
use std::ops::Range;

/// An overlap and the largest distance of the facets there from their curve, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Overlap {
    pub(crate) contact: usize,
    pub(crate) node: u32,
    pub(crate) place: [f64; 3],
    pub(crate) depth: f64,
    pub(crate) sagitta: f64,
}

/// What was made of overlaps about as deep as facets are beside their curve.
#[derive(Debug, Default)]
pub(crate) struct FacetedOverlaps {
    /// The deepest of the first contact that presses all the same.
    pub(crate) pressing: Option<Overlap>,
    /// The deepest of those that are closed, and how many points of how many contacts.
    pub(crate) closed: Option<(Overlap, [usize; 2])>,
}

/// A contact with measured gaps and its sides: two, or that before an obstacle.
struct Faceted {
    index: usize,
    /// Its conditions.
    range: Range<usize>,
    /// Whether its overlaps may go; else they are meant.
    closes: bool,
    sides: Vec<BentSide>,
}

struct BentSide {
    tags: Vec<FacetTag>,
    surface: Surface,
    bends: HashMap<u32, Bend>,
}

/// How far the facets at a node are from the curve that they stand for, m.
#[derive(Debug, Clone, Copy, Default)]
struct Bend {
    /// In the mean; negative where they are before it.
    behind: f64,
    /// The largest height of an arc over an edge.
    sagitta: f64,
}

/// Closes the overlaps of bodies that touch but for their facets, and tells which contacts overlap about as much as
/// facets are beside the curve. Contacts that share nodes decide as one. Gaps that are told are meant, and so are those
/// that a history makes grow.
pub(super) fn close_faceted(
    scene: &Scene,
    paired: &[Paired],
    conditions: &mut [ContactPoint],
    rounding: f64,
) -> Result<FacetedOverlaps, ContactError> {
    let is_measured = |(index, paired): &(usize, &Paired)| {
        let contact = &scene.contacts[*index];
        match contact.gap {
            Gap::Measured => paired.is_mortar() && !contact.tied,
            // nodes of linear facets are on the curve
            Gap::Obstacle => scene.mesh.order() == 2,
            _ => false,
        }
    };
    let measured = || paired.iter().enumerate().filter(is_measured);
    let is_inside = |c: &ContactPoint| c.gap < -rounding;
    if !measured().any(|(index, _)| conditions[of_contact(conditions, index)].iter().any(is_inside)) {
        return Ok(FacetedOverlaps::default());
    }
    let faceted = measured().map(|(index, paired)| {
        let contact = &scene.contacts[index];
        let (own, partner) = if paired.swapped {
            (&contact.partner, &contact.tags)
        } else {
            (&contact.tags, &contact.partner)
        };
        let mut sides = vec![BentSide::new(&scene.mesh, own, paired.surface.clone())];
        if matches!(contact.gap, Gap::Measured) {
            let surface = Surface::new(&scene.mesh, partner)?;
            sides.push(BentSide::new(&scene.mesh, partner, surface));
        }
        Ok::<_, ContactError>(Faceted {
            index,
            range: of_contact(conditions, index),
            closes: matches!(contact.closing, Closing::Faceted) && contact.gap_history.is_none(),
            sides,
        })
    });
    let mut faceted = faceted.collect::<Result<Vec<_>, _>>()?;
    unite(&scene.mesh, &mut faceted)?;
    let mut out = FacetedOverlaps::default();
    for group in groups(&faceted) {
        let overlaps = group
            .iter()
            .filter_map(|f| Some((*f, f.deepest(conditions, rounding)?)));
        let overlaps: Vec<(&Faceted, Overlap)> = overlaps.collect();
        let depths = overlaps.iter().map(|(_, overlap)| *overlap);
        let Some(deepest) = depths.reduce(|a, b| if b.depth > a.depth { b } else { a }) else {
            continue;
        };
        if group[0].closes && touch(&group, conditions, deepest.depth) {
            let (known, mut counts) = out.closed.unwrap_or((deepest, [0; 2]));
            for faceted in group {
                let inside = conditions[faceted.range.clone()].iter_mut().filter(|c| is_inside(c));
                let points = inside.map(ContactPoint::close).count();
                counts = [counts[0] + points, counts[1] + usize::from(points > 0)];
            }
            let deepest = if deepest.depth > known.depth { deepest } else { known };
            out.closed = Some((deepest, counts)).filter(|(deepest, _)| deepest.depth > DIGITS * rounding);
            continue;
        }
        let presses = |(f, o): &(&Faceted, Overlap)| o.sagitta > FACETED * o.depth && !f.is_over(&scene.mesh, o);
        let first = || overlaps.into_iter().find(presses).map(|(_, overlap)| overlap);
        out.pressing = out.pressing.or_else(first);
    }
    Ok(out)
}

/// Bends sides that go on smoothly in one another as one: at a rim that is none normals are those of both.
fn unite(mesh: &TetMesh, faceted: &mut [Faceted]) -> Result<(), ContactError> {
    let mut sides: Vec<&mut BentSide> = faceted.iter_mut().flat_map(|f| &mut f.sides).collect();
    let surfaces: Vec<&Surface> = sides.iter().map(|side| &side.surface).collect();
    let united = Lists::by_number(&smooth_sets(&surfaces));
    for own in united.iter().filter(|own| own.len() > 1) {
        let tags = distinct(own.iter().flat_map(|k| sides[*k as usize].tags.iter().copied()));
        let bends = bends(mesh, &Surface::new(mesh, &tags)?);
        own.iter().for_each(|k| sides[*k as usize].bends.clone_from(&bends));
    }
    Ok(())
}

/// Contacts that share nodes, in their order; those that mean their overlaps alone.
fn groups(faceted: &[Faceted]) -> Vec<Vec<&Faceted>> {
    let (mut sets, mut seen) = (DisjointSets::new(faceted.len()), HashMap::new());
    for (k, one) in faceted.iter().enumerate().filter(|(_, one)| one.closes) {
        for node in one.sides.iter().flat_map(|side| side.surface.nodes()) {
            sets.join(*seen.entry(*node).or_insert(k), k);
        }
    }
    let groups = Lists::by_number(&sets.numbers());
    let group = |own: &[u32]| own.iter().map(|&k| &faceted[k as usize]).collect();
    groups.iter().map(group).collect()
}

/// Whether sides touch in the mean, after subtracting from their gaps what the facets add to them. Points further apart
/// than facets can bring them are left out.
fn touch(group: &[&Faceted], conditions: &[ContactPoint], deepest: f64) -> bool {
    let (mut gap, mut hollow, mut deep) = (0.0, 0.0, 0.0_f64);
    let bends = group
        .iter()
        .flat_map(|f| f.sides.iter().flat_map(|side| side.bends.values()));
    let reach = bends.map(|bend| bend.sagitta).fold(0.0, f64::max);
    for faceted in group {
        for point in conditions[faceted.range.clone()].iter().filter(|c| c.gap <= reach) {
            let own = point.sides.own.nodes();
            let partner = point.sides.partner.as_ref().map_or(&[][..], |side| side.nodes());
            let (mut open, mut before) = (point.gap, 0.0);
            for (side, nodes) in faceted.sides.iter().zip([own, partner]) {
                let at = |(node, weight): &(u32, f64)| side.bends.get(node).map_or(0.0, |bend| weight * bend.behind);
                let behind: f64 = nodes.iter().map(at).sum();
                // of gaps to the curve only what that is not known by
                let (taken, part) = if point.to_curve { (0.0, ARC_ERROR) } else { (behind, 1.0) };
                open -= taken;
                before += part * (-behind).max(0.0);
            }
            gap += point.area * open;
            hollow += point.area * before;
            deep = deep.max(before);
        }
    }
    hollow > 0.0 && gap >= -TOUCHING * hollow && deepest <= DEEP * deep
}

impl Faceted {
    /// The deepest overlap, and how far facets are from the curve there, as far as that is not taken from it.
    fn deepest(&self, conditions: &[ContactPoint], rounding: f64) -> Option<Overlap> {
        let own = conditions[self.range.clone()].iter();
        let point = own
            .min_by(|a, b| a.gap.total_cmp(&b.gap))
            .filter(|p| p.gap < -rounding)?;
        let nodes = point.sides.nodes().map(|n| n.0);
        let known = nodes.flat_map(|node| self.sides.iter().filter_map(move |side| side.bends.get(&node)));
        Some(Overlap {
            contact: self.index,
            node: point.node(),
            place: point.position,
            depth: -point.gap,
            sagitta: match point.to_curve {
                // facets are not in it
                true => 0.0,
                false => known.map(|bend| bend.sagitta).fold(0.0, f64::max),
            },
        })
    }

    /// Whether the nodes around one have others over them, so that facets are as far from the curve on both sides.
    fn is_over(&self, mesh: &TetMesh, overlap: &Overlap) -> bool {
        let [own, other] = &self.sides[..] else {
            return false;
        };
        let place = |node: &u32| mesh.points()[*node as usize];
        let is_over = |local: &u32| {
            let node = &own.surface.nodes()[*local as usize];
            let (from, normal) = (place(node), own.surface.frames()[*local as usize].normal);
            let across = |to: &u32| norm(cross(sub(place(to), from), normal));
            other.surface.nodes().iter().any(|to| across(to) <= overlap.sagitta)
        };
        let at = |t: &&[u32; 3]| t.iter().any(|&n| own.surface.nodes()[n as usize] == overlap.node);
        own.surface.triangles().iter().filter(at).flatten().all(is_over)
    }
}

impl BentSide {
    fn new(mesh: &TetMesh, tags: &[FacetTag], surface: Surface) -> Self {
        Self {
            tags: tags.to_vec(),
            bends: bends(mesh, &surface),
            surface,
        }
    }
}

/// How far the facets of a surface are from the curve at its nodes.
fn bends(mesh: &TetMesh, surface: &Surface) -> HashMap<u32, Bend> {
    let chords = Chords::new(mesh, surface, normals(surface));
    let mut corners = vec![Bend::default(); surface.nodes().len()];
    let mut areas = vec![0.0; corners.len()];
    let mut mids = Vec::new();
    for (&facet, t) in surface.facets().iter().zip(surface.triangles()) {
        let own = mesh.facet_mids(facet as usize);
        let edges = edges(*t);
        let arcs = [0, 1, 2].map(|k| chords.arc(edges[k], own.map(|mids| mids[k])));
        let area = norm(area_vector(mesh, surface, t));
        for n in t.map(|n| n as usize) {
            corners[n].behind += area * arcs.iter().sum::<f64>() / 3.0;
            corners[n].sagitta = arcs.iter().map(|arc| arc.abs()).fold(corners[n].sagitta, f64::max);
            areas[n] += area;
        }
        mids.extend(own.into_iter().flatten().zip(edges));
    }
    corners
        .iter_mut()
        .zip(areas)
        .for_each(|(bend, area)| bend.behind /= area);
    let mut bends: HashMap<u32, Bend> = surface.nodes().iter().copied().zip(corners.iter().copied()).collect();
    bends.extend(mids.into_iter().map(|(mid, ends)| {
        let [a, b] = ends.map(|end| corners[end as usize]);
        let bend = Bend {
            behind: 0.5 * (a.behind + b.behind),
            sagitta: a.sagitta.max(b.sagitta),
        };
        (mid, bend)
    }));
    bends
}
