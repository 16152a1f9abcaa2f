//! VTU files and PVD time series for ParaView (feature `vtu`).
//!
//! Arrays are binary: base64 inside the XML, 64-bit headers, little endian, compressed by zlib. `vtu` writes one
//! file, `grid` its points and cells, `xml` arrays, `pvd` a series of files that can be continued, also by several
//! processes, each with its piece.

mod grid;
mod pvd;
mod vtu;
mod xml;

use std::path::PathBuf;

pub use pvd::PvdSeries;
pub use vtu::{write_surfaces_vtu, write_vtu};

use crate::mesh::Surface;

/// A surface, the fields at its nodes, and those on its triangles.
pub type SurfaceFields<'a> = (&'a Surface, &'a [Field], &'a [Field]);

/// Values at the nodes or in the cells of a mesh, under a name.
///
/// ```
/// use signorini_fem_mesh::Brick;
/// use signorini_fem_mesh::output::{Field, PvdSeries};
///
/// # let directory = tempfile::tempdir()?;
/// # let folder = directory.path();
/// let mesh = Brick::new([1.0; 3], [2, 2, 2]).build()?;
/// let mut series = PvdSeries::create(folder, "block")?;
/// for step in 0..3 {
///     let height: Vec<f64> = mesh.points().iter().map(|p| p[2] * f64::from(step)).collect();
///     series.write(0.1 * f64::from(step), &mesh, &[Field::scalar("height", height)], &[])?;
/// }
/// assert!(folder.join("block.pvd").is_file() && folder.join("block_0002.vtu").is_file());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    name: String,
    components: usize,
    values: Vec<f64>,
}

impl Field {
    /// One number each.
    pub fn scalar(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            components: 1,
            values,
        }
    }

    /// A vector each.
    pub fn vector(name: impl Into<String>, values: &[[f64; 3]]) -> Self {
        Self {
            name: name.into(),
            components: 3,
            values: values.as_flattened().to_vec(),
        }
    }

    /// Symmetric tensors in Voigt order xx, yy, zz, yz, xz, xy, written in the order of VTK (xx,
    /// yy, zz, xy, yz, xz). The entries are taken as they are: halve engineering shear strains
    /// first if tensor components are meant.
    pub fn symmetric_tensor(name: impl Into<String>, values: &[[f64; 6]]) -> Self {
        let reorder = |v: &[f64; 6]| [v[0], v[1], v[2], v[5], v[3], v[4]];
        let values = values.iter().flat_map(reorder).collect();
        Self {
            name: name.into(),
            components: 6,
            values,
        }
    }
}

errors! {
    /// A file that cannot be written.
    OutputError {
        FieldLength { name: String, what: &'static str, given: usize, expected: usize, components: usize } =
            "field {name:?} has {given} values; {expected} are needed ({components} for each of the {what})";
        Unnamed { what: &'static str } =
            "a field on the {what} has an empty name; ParaView selects fields by name";
        RepeatedName { name: String, what: &'static str } =
            "two fields on the {what} are named {name:?}; rename one";
        PieceFields { number: usize } =
            "surface {number} (from 0) has other fields than the first; give all surfaces of a file the same ones";
        NotFinite { name: String, what: &'static str, index: usize, value: f64 } =
            "field {name:?} is {value} at number {index} of the {what}; values must be finite";
        Foreign { what: &'static str } =
            "the {what} does not belong to this mesh; write it with the mesh that it was made from";
        SeriesName { name: String } = "{name:?} cannot name a series; use a plain file name without folders";
        SharedSeries { name: String } =
            "two series in one folder are named {name:?}, and one would take the files of the other; rename one";
        Time { time: f64, before: f64 } =
            "time {time} of the series does not follow {before}; times must be finite and increase";
        NoSeries { path: PathBuf, r#source: std::io::Error } =
            "cannot read {}: {source}; to continue a series its list must be there, PvdSeries::create starts a new \
            one", path.display();
        BrokenSeries { path: PathBuf, line: usize, found: String, expected: String } =
            "line {line} of {} is {found:?}, but {expected} is needed; only lists written by PvdSeries under their \
            name can be continued, so restore the file or start a new series with PvdSeries::create", path.display();
        Read { path: PathBuf, r#source: std::io::Error } =
            "cannot read {}: {source}; make it readable, or begin anew under another name", path.display();
        ShortFile { path: PathBuf } =
            "{} is cut short; put a copy of it back, remove it, or continue from a time before it", path.display();
        Io { path: PathBuf, r#source: std::io::Error } =
            "cannot write {}: {source}; what was complete there stays: make room or give another folder, then go on",
            path.display();
    }
}
