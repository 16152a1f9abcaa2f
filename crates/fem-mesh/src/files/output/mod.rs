//! VTU files and PVD time series for ParaView (feature `vtu`).
//!
//! Arrays are binary: base64 inside the XML, 64-bit headers, little endian, compressed by zlib. `vtu` writes one file, `pvd` a
//! series of them that can be continued.

mod pvd;
mod vtu;

use std::path::PathBuf;

use thiserror::Error;

pub use pvd::PvdSeries;
pub use vtu::{write_surface_vtu, write_vtu, write_vtu_pieces};

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
    #[must_use]
    pub fn scalar(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            components: 1,
            values,
        }
    }

    /// Three numbers each, one after the other (a displacement as it is).
    #[must_use]
    pub fn vector(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            components: 3,
            values,
        }
    }

    /// Symmetric tensors in Voigt order xx, yy, zz, yz, xz, xy, written in the order of VTK (xx,
    /// yy, zz, xy, yz, xz). The entries are taken as they are: halve engineering shear strains
    /// first if tensor components are meant.
    #[must_use]
    pub fn symmetric_tensor(name: impl Into<String>, values: &[[f64; 6]]) -> Self {
        let reorder = |v: &[f64; 6]| [v[0], v[1], v[2], v[5], v[3], v[4]];
        let values = values.iter().flat_map(reorder).collect();
        Self {
            name: name.into(),
            components: 6,
            values,
        }
    }

    /// Name of the field.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// A file that cannot be written.
#[derive(Error)]
#[non_exhaustive]
pub enum OutputError {
    /// A field has the wrong number of values.
    #[error(
        "field {name:?} has {given} values; {expected} are needed ({components} for each of the {what})"
    )]
    FieldLength {
        /// Name of the field.
        name: String,
        /// `"nodes"` or `"cells"`.
        what: &'static str,
        /// Values given.
        given: usize,
        /// Values needed.
        expected: usize,
        /// Components of a value.
        components: usize,
    },
    /// A field has no name.
    #[error("a field on the {what} has an empty name; ParaView selects fields by name")]
    Unnamed {
        /// `"nodes"` or `"cells"`.
        what: &'static str,
    },
    /// Two fields have the same name.
    #[error("two fields on the {what} are named {name:?}; rename one")]
    RepeatedName {
        /// The name.
        name: String,
        /// `"nodes"` or `"cells"`.
        what: &'static str,
    },
    /// A value is NaN or infinite.
    #[error("field {name:?} is {value} at number {index} of the {what}; values must be finite")]
    NotFinite {
        /// Name of the field.
        name: String,
        /// `"nodes"` or `"cells"`.
        what: &'static str,
        /// Node or cell number.
        index: usize,
        /// The value.
        value: f64,
    },
    /// The decomposition or surface belongs to another mesh.
    #[error(
        "the {what} does not belong to this mesh; write it with the mesh that it was made from"
    )]
    Foreign {
        /// `"decomposition"` or `"surface"`.
        what: &'static str,
    },
    /// The name of a series has a path separator or is empty.
    #[error("{name:?} cannot name a series; use a plain file name without folders")]
    SeriesName {
        /// The name.
        name: String,
    },
    /// The time of a step is not later than the one before.
    #[error(
        "time {time} of the series does not follow {before}; times must be finite and increase"
    )]
    Time {
        /// The time given.
        time: f64,
        /// The time before, minus infinity at the start.
        before: f64,
    },
    /// The list of a series to continue cannot be read.
    #[error(
        "cannot read {}: {source}; to continue a series its list must be there, PvdSeries::create starts a new one",
        path.display()
    )]
    NoSeries {
        /// The list.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The list of a series to continue is not as [`PvdSeries`] writes it.
    #[error(
        "line {line} of {} is {found:?}, but {expected} is needed; only lists written by PvdSeries under their name can be continued, so restore the file or start a new series with PvdSeries::create",
        path.display()
    )]
    BrokenSeries {
        /// The list.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// The line, empty beyond the end of the file.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// The file system refuses.
    #[error("cannot write {}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}
