//! A time series: one VTU file a step and a PVD file that lists them.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use super::{Field, OutputError, write_surface_vtu, write_vtu, write_vtu_pieces};
use crate::decomposition::Decomposition;
use crate::mesh::TetMesh;
use crate::surface::Surface;

/// A time series in a folder: `name.pvd` and `name_0000.vtu`, `name_0001.vtu`, ...
///
/// The list is written anew after every step, so that it is complete at any moment, also when the
/// computation stops half way.
#[derive(Debug)]
pub struct PvdSeries {
    folder: PathBuf,
    name: String,
    times: Vec<f64>,
}

impl PvdSeries {
    /// Starts a series and creates the folder if it does not exist.
    ///
    /// # Errors
    /// [`OutputError`] if the name is not a plain file name or the folder cannot be created.
    pub fn create(folder: impl AsRef<Path>, name: &str) -> Result<Self, OutputError> {
        let folder = folder.as_ref().to_path_buf();
        if Path::new(name).file_name().is_none_or(|file| file != name) || name.contains('\\') {
            return Err(OutputError::SeriesName { name: name.into() });
        }
        fs::create_dir_all(&folder).map_err(|source| OutputError::Io {
            path: folder.clone(),
            source,
        })?;
        Ok(Self {
            folder,
            name: name.into(),
            times: Vec::new(),
        })
    }

    /// Writes the mesh and its fields at a time, and the list.
    ///
    /// # Errors
    /// [`OutputError`] as [`write_vtu`], and if the time does not follow the last one.
    pub fn write(
        &mut self,
        time: f64,
        mesh: &TetMesh,
        point_fields: &[Field],
        cell_fields: &[Field],
    ) -> Result<(), OutputError> {
        self.check(time)?;
        write_vtu(self.next_file(), mesh, point_fields, cell_fields)?;
        self.list(time)
    }

    /// As [`PvdSeries::write`], each subdomain as a piece (see [`write_vtu_pieces`]).
    ///
    /// # Errors
    /// [`OutputError`] as [`write_vtu_pieces`], and if the time does not follow the last one.
    pub fn write_pieces(
        &mut self,
        time: f64,
        mesh: &TetMesh,
        decomposition: &Decomposition,
        point_fields: &[Field],
        cell_fields: &[Field],
    ) -> Result<(), OutputError> {
        self.check(time)?;
        write_vtu_pieces(
            self.next_file(),
            mesh,
            decomposition,
            point_fields,
            cell_fields,
        )?;
        self.list(time)
    }

    /// Writes a surface and its fields at a time (see [`write_surface_vtu`]), and the list.
    ///
    /// # Errors
    /// [`OutputError`] as [`write_surface_vtu`], and if the time does not follow the last one.
    pub fn write_surface(
        &mut self,
        time: f64,
        mesh: &TetMesh,
        surface: &Surface,
        point_fields: &[Field],
        cell_fields: &[Field],
    ) -> Result<(), OutputError> {
        self.check(time)?;
        write_surface_vtu(self.next_file(), mesh, surface, point_fields, cell_fields)?;
        self.list(time)
    }

    /// The file to open in ParaView.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        self.folder.join(format!("{}.pvd", self.name))
    }

    /// Times of the steps written so far.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    fn check(&self, time: f64) -> Result<(), OutputError> {
        let before = self.times.last().copied().unwrap_or(f64::NEG_INFINITY);
        if time.is_finite() && time > before {
            Ok(())
        } else {
            Err(OutputError::Time { time, before })
        }
    }

    fn file_name(&self, step: usize) -> String {
        format!("{}_{step:04}.vtu", self.name)
    }

    fn next_file(&self) -> PathBuf {
        self.folder.join(self.file_name(self.times.len()))
    }

    fn list(&mut self, time: f64) -> Result<(), OutputError> {
        self.times.push(time);
        let mut xml = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" \
             byte_order=\"LittleEndian\">\n  <Collection>\n",
        );
        for (step, time) in self.times.iter().enumerate() {
            let file = escape(&self.file_name(step));
            // Writing to a string cannot fail.
            let _ = writeln!(
                xml,
                "    <DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{file}\"/>"
            );
        }
        xml.push_str("  </Collection>\n</VTKFile>\n");
        fs::write(self.path(), xml).map_err(|source| OutputError::Io {
            path: self.path(),
            source,
        })
    }
}

/// The characters that XML reserves inside an attribute.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
