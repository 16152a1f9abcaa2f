//! What of a distance is rounding.

use signorini_fem_mesh::TetMesh;

/// Distances below this share of the largest coordinate are rounding errors of what was computed from coordinates.
const ROUNDING: f64 = 1e-12;

/// What of a distance between points of a mesh may be rounding, m.
pub(crate) fn rounding(mesh: &TetMesh) -> f64 {
    let largest = |m: f64, v: &f64| m.max(v.abs());
    ROUNDING * mesh.points().iter().flatten().fold(0.0, largest)
}
