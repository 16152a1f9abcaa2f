//! Wanted edge lengths for Gmsh: a view of scalar values at the corners of tetrahedra.

use std::fmt::Write;
use std::path::Path;

use super::GmshError;
use crate::files::replace::replace_file;
use crate::mesh::TetMesh;

/// Writes edge lengths at the nodes of a mesh, m, as a view that Gmsh takes for the background of the next mesh:
/// `gmsh -3 part.geo -bgm sizes.pos`, or in a script
///
/// ```text
/// gmsh.merge("sizes.pos")
/// view = gmsh.model.mesh.field.add("PostView")
/// gmsh.model.mesh.field.setNumber(view, "ViewIndex", 0)
/// gmsh.model.mesh.field.setAsBackgroundMesh(view)
/// for name in ["ExtendFromBoundary", "FromPoints", "FromCurvature"]:
///     gmsh.option.setNumber("Mesh.MeshSize" + name, 0)
/// ```
///
/// # Errors
/// [`GmshError::Sizes`] if there is not one positive length a node, [`GmshError::Write`] if the file cannot be written.
pub fn write_sizes(path: impl AsRef<Path>, mesh: &TetMesh, sizes: &[f64]) -> Result<(), GmshError> {
    let nodes = mesh.points().len();
    let good = sizes.iter().take_while(|s| s.is_finite() && **s > 0.0).count();
    if sizes.len() != nodes || good < nodes {
        return Err(GmshError::Sizes {
            nodes,
            found: sizes.len(),
            good,
        });
    }
    let mut text = String::from("View \"wanted edge length\" {\n");
    for tet in mesh.tets() {
        let places: Vec<String> = (tet.iter())
            .flat_map(|n| mesh.points()[*n as usize])
            .map(|c| format!("{c:e}"))
            .collect();
        let values = tet.map(|n| format!("{:.6e}", sizes[n as usize]));
        // writing into a string does not fail
        let _ = writeln!(text, "SS({}){{{}}};", places.join(","), values.join(","));
    }
    text.push_str("};\n");
    let path = path.as_ref();
    replace_file(path, text.as_bytes()).map_err(|source| GmshError::Write {
        path: path.into(),
        source,
    })
}
