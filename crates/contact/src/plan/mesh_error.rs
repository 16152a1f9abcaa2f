//! The error of the mesh that is to be expected before anything is solved.
//!
//! What decides are edges, rims and bending, and all of them scale with the thickness of a body. So the error is taken
//! as a constant of the order times a power of the cells over the thickness, `2 V / S` with the volume and the surface:
//! within a factor of two and a half on the studies' parts, where equal numbers of tetrahedra leave 16 % and 48 %. Of
//! 132 random assemblies 104 were within a factor of 3, 128 of 5: small spots of contact on balls and rollers leave
//! more, thin quadratic leaves and bolted plates less.

use crate::discrete::DiscreteScene;
use crate::report::Warning;
use crate::scene::Scene;
use crate::tolerances::{ERROR_FALLS, ERROR_OF_ONE, HELD_FACET};
use signorini_fem_mesh::vec3::{area_vector, dot, norm};

/// The error to expect, relative in the energy norm; `None` where linear tetrahedra lock, and where supports hold the
/// whole surface. A facet whose normal they hold is none: the body goes on behind a plane of symmetry.
pub(super) fn expected(scene: &Scene, discrete: &DiscreteScene, warnings: &[Warning]) -> Option<f64> {
    let mesh = &scene.mesh;
    if warnings.iter().any(|w| matches!(w, Warning::Locking { .. })) {
        return None;
    }
    let held = |node: u32, normal: [f64; 3]| {
        let directions = discrete.supports.merged.directions(node).iter();
        let along = directions.map(|d| dot(d.direction, normal).powi(2));
        along.sum::<f64>() >= 1.0 - HELD_FACET
    };
    let mut surface = 0.0;
    for facet in mesh.boundary_facets() {
        let area = area_vector(&facet.nodes.map(|node| mesh.points()[node as usize]));
        let length = norm(area);
        let normal = area.map(|v| v / length);
        if !facet.nodes.iter().all(|&node| held(node, normal)) {
            surface += length;
        }
    }
    let volume = mesh.total_volume();
    // the edge of a cube that six tetrahedra fill
    let edge = (6.0 * volume / mesh.tets().len() as f64).cbrt();
    let layers = 2.0 * volume / surface / edge;
    let error = ERROR_OF_ONE[mesh.order() - 1] * layers.powf(-ERROR_FALLS);
    (surface > 0.0 && error.is_finite()).then_some(error.min(1.0))
}
