//! What a scene alone shows of what is hardly meant.

use crate::discrete::{ContactPoint, DiscreteScene, Extents};
use crate::report::Warning;
use crate::scene::{Contact, Coupling, Equation, Friction, Gap, Load, Scene, Support};
use crate::tolerances::{FACETED, LARGE_COEFFICIENT, LARGE_GAP, LOCKING};
use signorini_fem_mesh::vec3::{add, cross, dot, norm, scale, sub};
use signorini_fem_mesh::{History, Surface, TetMesh};

/// Warnings of a scene, each kind once. One pass over the contact points; bodies are measured only where a contact
/// begins nowhere near its obstacle.
pub(super) fn warnings(scene: &Scene, discrete: &DiscreteScene) -> Vec<Warning> {
    let points = &discrete.points;
    let listed = scene.materials.listed();
    let present = regions(scene, &listed);
    let found = [
        idle(scene, discrete),
        unused_materials(listed, &present),
        locking(scene, &present),
        large_gap(scene, discrete),
        faceted_overlap(scene, discrete),
        large_coefficient(scene, points),
    ];
    found.into_iter().flatten().collect()
}

/// Whether nothing acts at any step, so that all results are zero.
fn idle(scene: &Scene, discrete: &DiscreteScene) -> Option<Warning> {
    let ever = |history: &History| scene.analysis.times().iter().any(|&t| history.value(t) != 0.0);
    let pushes =
        |(load, forces): (&Load, &Vec<Vec<f64>>)| ever(&load.history) && forces.iter().flatten().any(|f| *f != 0.0);
    let pulled = |support: &Support| {
        let motion = support.motion.as_ref();
        motion.is_some_and(|(ways, history)| ever(history) && ways.iter().flatten().any(|w| *w != 0.0))
    };
    let guided = |coupling: &Coupling| {
        let moves = |(way, history): &([f64; 6], History)| ever(history) && way.iter().any(|w| *w != 0.0);
        coupling.motions().iter().any(moves)
    };
    let parts = |equation: &Equation| {
        let value = equation.value.as_ref();
        value.is_some_and(|(value, history)| *value != 0.0 && ever(history))
    };
    let presses = |p: &ContactPoint| p.gap < -discrete.rounding || scene.contacts[p.surface].changes_gap();
    let acts = scene.loads.iter().zip(&discrete.loads).any(pushes)
        || scene.supports.iter().any(pulled)
        || scene.couplings.iter().any(guided)
        || scene.equations.iter().any(parts)
        || scene.contacts.iter().any(Contact::moves)
        || discrete.points.iter().any(presses);
    let held = !scene.supports.is_empty() || !scene.springs.is_empty() || !scene.couplings.is_empty();
    let held = held || !scene.equations.is_empty();
    (!acts).then_some(Warning::NothingActs { held })
}

/// The regions of the mesh, ascending; one of them where one law fills all.
fn regions(scene: &Scene, listed: &[u32]) -> Vec<u32> {
    match listed.is_empty() {
        true => scene.mesh.regions().first().copied().into_iter().collect(),
        false => scene.mesh.distinct_regions(),
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

/// The first contact whose nearest point is further away than its body is long.
fn large_gap(scene: &Scene, discrete: &DiscreteScene) -> Option<Warning> {
    let mut nearest: Vec<Option<&ContactPoint>> = vec![None; scene.contacts.len()];
    for point in &discrete.points {
        let best = &mut nearest[point.surface];
        if best.is_none_or(|known| point.gap.abs() < known.gap.abs()) {
            *best = Some(point);
        }
    }
    // a body is no smaller than its parts: that is enough for most scenes
    let part = |node: u32| Extents::of_part(&scene.mesh, &discrete.decomposition, node);
    let far = |p: &&ContactPoint| p.gap.abs() > discrete.rounding.max(LARGE_GAP * part(p.node()));
    let mut far = nearest.into_iter().flatten().filter(far).peekable();
    far.peek()?;
    let extents = Extents::new(&scene.mesh, &discrete.decomposition);
    let point = far.find(|p| p.gap.abs() > LARGE_GAP * extents.at(p.node()))?;
    Some(Warning::LargeGap {
        contact: point.surface,
        node: point.node(),
        place: point.position,
        gap: point.gap,
        extent: extents.at(point.node()),
    })
}

/// The first contact whose overlap is measured between facets that are too far from the curve that they stand for.
fn faceted_overlap(scene: &Scene, discrete: &DiscreteScene) -> Option<Warning> {
    discrete.apart.iter().find_map(|&(index, swapped)| {
        let contact = &scene.contacts[index];
        let own = discrete.points.iter().filter(|p| p.surface == index);
        let point = own.min_by(|a, b| a.gap.total_cmp(&b.gap))?;
        if !matches!(contact.gap, Gap::Measured) || -point.gap <= discrete.rounding {
            return None;
        }
        let other = if swapped { &contact.tags } else { &contact.partner };
        let other = Surface::new(&scene.mesh, other).ok()?;
        let nodes: Vec<u32> = point.sides.nodes().map(|n| n.0).collect();
        let own = &discrete.surfaces[index];
        let sagitta = [own, &other].map(|s| sagitta(&scene.mesh, s, &nodes));
        let sagitta = sagitta[0].max(sagitta[1]);
        if are_over(&scene.mesh, point, own, &other, sagitta) {
            return None;
        }
        (sagitta > FACETED * -point.gap).then(|| Warning::FacetedOverlap {
            contact: index,
            node: point.node(),
            place: point.position,
            overlap: -point.gap,
            sagitta,
        })
    })
}

/// Whether the nodes around a point have others over them, so that facets are as far from the curve on both sides.
fn are_over(mesh: &TetMesh, point: &ContactPoint, own: &Surface, other: &Surface, within: f64) -> bool {
    let place = |node: &u32| mesh.points()[*node as usize];
    let is_over = |local: &u32| {
        let (from, normal) = (
            place(&own.nodes()[*local as usize]),
            own.frames()[*local as usize].normal,
        );
        let across = |to: &u32| norm(cross(sub(place(to), from), normal));
        other.nodes().iter().any(|to| across(to) <= within)
    };
    near(own, &[point.node()]).all(|(_, nodes)| nodes.iter().all(is_over))
}

/// The facets at some nodes.
fn near<'a>(surface: &'a Surface, nodes: &'a [u32]) -> impl Iterator<Item = (u32, &'a [u32; 3])> {
    let facets = surface.facets().iter().copied().zip(surface.triangles());
    facets.filter(|(_, t)| t.iter().any(|&n| nodes.contains(&surface.nodes()[n as usize])))
}

/// The largest distance, m, of the middle of an edge from the arc between its ends, of the facets at some nodes; none
/// where mid-nodes are on it.
fn sagitta(mesh: &TetMesh, surface: &Surface, nodes: &[u32]) -> f64 {
    let edges = near(surface, nodes).flat_map(|(facet, t)| {
        let mids = (mesh.order() == 2).then(|| mesh.facet_mids(facet as usize));
        (0..3).map(move |k| ([t[k], t[(k + 1) % 3]].map(|n| n as usize), mids.map(|m| m[k])))
    });
    let far = edges.map(|([a, b], mid)| {
        let place = |node: u32| mesh.points()[node as usize];
        let [from, to] = [a, b].map(|n| place(surface.nodes()[n]));
        let [m, n] = [a, b].map(|n| surface.frames()[n].normal);
        let arc = 0.125 * dot(sub(to, from), sub(n, m));
        let off = mid.map_or([0.0; 3], |mid| sub(place(mid), scale(0.5, add(from, to))));
        // at rims normals are those of one facet, and an arc seems to be half as high
        let bent = 0.5 * dot(off, add(m, n)) * arc.signum() > 0.5 * arc.abs();
        if bent { 0.0 } else { arc }
    });
    far.map(f64::abs).fold(0.0, f64::max)
}

/// The largest coefficient, if it is too large, at whatever slip rate where that is known and else at rest.
fn large_coefficient(scene: &Scene, points: &[ContactPoint]) -> Option<Warning> {
    let coefficient = |point: &ContactPoint| match scene.contacts[point.surface].friction() {
        Friction::Coulomb(law) => {
            let at_rest = || law.value(point.node(), point.position, 0.0).ok();
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
