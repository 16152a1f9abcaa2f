//! What of a distance is rounding.

use crate::tolerances::ROUNDING;
use signorini_fem_mesh::TetMesh;

/// What of a distance between points of a mesh may be rounding, m.
pub(crate) fn rounding(mesh: &TetMesh) -> f64 {
    let largest = |m: f64, v: &f64| m.max(v.abs());
    ROUNDING * mesh.points().iter().flatten().fold(0.0, largest)
}
