//! What a plan checks beside sizes: all that can be wrong with supports, contact, loads and laws, without stiffness or factors.
//!
//! Only the set-up can judge whether supports and contact hold the body against its loads: that needs the rigid motions of
//! all subdomains.

use super::overflow::{check_gaps, check_load, check_materials, check_motions};
use super::penetration::check_penetration;
use super::points::Found;
use super::supports::{contact_constraints, lower_supports};
use crate::error::ContactError;
use crate::scene::{Scene, check_laws};
use signorini_fem_mesh::{Decomposition, assemble_load};
use signorini_qp::vector;
use signorini_tfeti::prescribed_points;

/// Refuses what [`Simulation::new`](crate::Simulation::new) would refuse of materials, supports, contact, loads and laws, with the same
/// error; not subdomains that cannot be factored.
pub(crate) fn check_scene(
    scene: &Scene,
    decomposition: &Decomposition,
    found: &Found,
) -> Result<(), ContactError> {
    check_materials(scene)?;
    check_motions(scene)?;
    let (supports, motions) = lower_supports(scene)?;
    let places = scene.mesh.points();
    check_gaps(scene, found)?;
    let candidates = &found.points;
    check_penetration(scene, candidates, &supports, &motions)?;
    // merges the supports, whether there is contact or not
    let nodes = contact_constraints(scene, candidates.iter());
    let held = prescribed_points(&nodes, &supports, places.len())?;
    for (index, load) in scene.loads.iter().enumerate() {
        let local = assemble_load(&scene.mesh, decomposition, &load.density)
            .map_err(|source| ContactError::Load { index, source })?;
        check_load(scene, index, largest_force(&local))?;
    }
    let mut held = held.iter().map(|h| h.point).peekable();
    // both in the order of the points
    let free = candidates
        .iter()
        .enumerate()
        .filter(|(k, _)| held.next_if_eq(k).is_none());
    check_laws(free.map(|(_, c)| {
        let friction = scene.contacts[c.surface].friction();
        (friction, c.node, places[c.node as usize])
    }))
}

/// The largest component of the nodal forces of all subdomains, N; NaN if one is none.
pub(crate) fn largest_force(local: &[Vec<f64>]) -> f64 {
    let largest = local.iter().map(|f| vector::max_abs(f));
    largest.fold(0.0, |a, b| if b.is_nan() { b } else { a.max(b) })
}
