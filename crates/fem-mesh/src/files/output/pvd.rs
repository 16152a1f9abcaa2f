//! A time series: one VTU file a step and a PVD file that lists them.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::tolerances::SAME_TIME;

use super::grid::Grid;
use super::vtu::{write_cells, write_pieces, write_pvtu};
use super::xml::escape;
use super::{Field, OutputError, SurfaceFields};
use crate::files::replace::replace;
use crate::mesh::TetMesh;

const HEAD: [&str; 3] = [
    "<?xml version=\"1.0\"?>",
    "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">",
    "  <Collection>",
];
/// What a complete file of a step ends with.
const END_OF_FILE: &[u8] = b"</VTKFile>\n";
const FOOT: [&str; 2] = ["  </Collection>", "</VTKFile>"];

/// A time series in a folder: `name.pvd` and `name_0000.vtu`, `name_0001.vtu`, ...
///
/// The list is written anew after every step. It and the files of the steps are written beside their place, with
/// `.tmp` at the end of their names, and then take it. They are therefore complete at any moment, also when the
/// computation stops half way or the disk is full. A step whose writing failed does not count and can be written again;
/// after [`PvdSeries::write_part`] failed in one process, all open the series again. Points and cells of the last file
/// are kept in memory, as they are and encoded, for the next file if it has the same.
///
/// A run that is resumed continues its series with [`PvdSeries::open`] or
/// [`PvdSeries::open_before`]:
///
/// ```
/// use signorini_fem_mesh::Brick;
/// use signorini_fem_mesh::output::PvdSeries;
///
/// # let directory = tempfile::tempdir()?;
/// # let folder = directory.path();
/// let mesh = Brick::new([1.0; 3], [2, 2, 2]).build()?;
/// let mut series = PvdSeries::create(folder, "block")?;
/// for time in [0.0, 0.1, 0.2] {
///     series.write(time, &mesh, &[], &[])?;
/// }
/// // later, from a state saved after time 0.1
/// let mut series = PvdSeries::open_before(folder, "block", 0.2)?;
/// assert_eq!(series.times(), [0.0, 0.1]);
/// series.write(0.2, &mesh, &[], &[])?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct PvdSeries {
    folder: PathBuf,
    name: String,
    times: Vec<f64>,
    /// Whether a step is a list of pieces of several processes.
    lists: Vec<bool>,
    /// Of the last file.
    grids: Vec<Grid>,
}

impl PvdSeries {
    /// Starts a series and creates the folder if it does not exist. A series of this name that is
    /// there is overwritten, file by file from number 0; [`PvdSeries::open`] continues it.
    ///
    /// # Errors
    /// [`OutputError`] if the name is not a plain file name or the folder cannot be created.
    pub fn create(folder: impl AsRef<Path>, name: &str) -> Result<Self, OutputError> {
        let series = Self::new(folder.as_ref(), name)?;
        fs::create_dir_all(&series.folder).map_err(|source| OutputError::Io {
            path: series.folder.clone(),
            source,
        })?;
        Ok(series)
    }

    /// Continues the series that is in the folder: reads the times from its list, and the next
    /// step gets the next number.
    ///
    /// # Errors
    /// [`OutputError`] if the name is not a plain file name, or the list is missing or not as this
    /// type writes it, or one of the files that it names is cut short.
    pub fn open(folder: impl AsRef<Path>, name: &str) -> Result<Self, OutputError> {
        let series = Self::listed(folder.as_ref(), name)?;
        series.check_files()?;
        Ok(series)
    }

    /// What the list says.
    fn listed(folder: &Path, name: &str) -> Result<Self, OutputError> {
        let mut series = Self::new(folder, name)?;
        let path = series.path();
        let list = fs::read_to_string(&path).map_err(|source| OutputError::NoSeries { path, source })?;
        series.read(&list)?;
        Ok(series)
    }

    /// As [`PvdSeries::open`], without the steps at `time` and later (times that agree to a
    /// relative 1e-9 count as the same), for a run that is resumed from an earlier state and
    /// writes them again. The list and the files stay as they are until the next step is written.
    /// Then the list ends with that step, and files of dropped steps are replaced one by one.
    ///
    /// # Errors
    /// [`OutputError`] as [`PvdSeries::open`], and if `time` is not finite.
    pub fn open_before(folder: impl AsRef<Path>, name: &str, time: f64) -> Result<Self, OutputError> {
        let mut series = Self::listed(folder.as_ref(), name)?;
        if !time.is_finite() {
            let before = series.last();
            return Err(OutputError::Time { time, before });
        }
        let limit = time - SAME_TIME * time.abs();
        series.times.retain(|&t| t < limit);
        series.lists.truncate(series.times.len());
        series.check_files()?;
        Ok(series)
    }

    /// No file is cut short. One that is not there is not missed: its owner has put it elsewhere.
    fn check_files(&self) -> Result<(), OutputError> {
        for step in 0..self.times.len() {
            let path = self.folder.join(self.file_name(step, self.lists[step]));
            let end = match File::open(&path) {
                Ok(file) => last_bytes(file).map_err(|source| OutputError::Read {
                    path: path.clone(),
                    source,
                })?,
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
                Err(source) => return Err(OutputError::Read { path, source }),
            };
            if end != END_OF_FILE {
                return Err(OutputError::ShortFile { path });
            }
        }
        Ok(())
    }

    fn new(folder: &Path, name: &str) -> Result<Self, OutputError> {
        if Path::new(name).file_name().is_none_or(|file| file != name) || name.contains('\\') {
            return Err(OutputError::SeriesName { name: name.into() });
        }
        Ok(Self {
            folder: folder.to_path_buf(),
            name: name.into(),
            times: Vec::new(),
            lists: Vec::new(),
            grids: Vec::new(),
        })
    }

    /// Writes the mesh and its fields at a time, and the list.
    ///
    /// # Errors
    /// [`OutputError`] as [`write_vtu`](super::write_vtu), and if the time does not follow the last one.
    pub fn write(
        &mut self,
        time: f64,
        mesh: &TetMesh,
        point_fields: &[Field],
        cell_fields: &[Field],
    ) -> Result<(), OutputError> {
        self.check(time)?;
        let file = (&*self.next_file(), &mut self.grids);
        write_cells(file, mesh, |_| true, point_fields, cell_fields)?;
        self.list(time, false)
    }

    /// As [`PvdSeries::write`] by several processes, of which each calls this with its number `rank`, from 0, and the
    /// process of each tetrahedron: each writes its tetrahedra into `name_0000_RANK.vtu`, process 0 lists these in
    /// `name_0000.pvtu` and that in `name.pvd`. A list is complete when all processes have written.
    ///
    /// # Errors
    /// [`OutputError`] as [`PvdSeries::write`], and if there are not as many `owners` as tetrahedra.
    pub fn write_part(
        &mut self,
        time: f64,
        mesh: &TetMesh,
        (owners, rank): (&[u32], u32),
        point_fields: &[Field],
        cell_fields: &[Field],
    ) -> Result<(), OutputError> {
        self.check(time)?;
        if owners.len() != mesh.tets().len() {
            return Err(OutputError::Foreign { what: "list of owners" });
        }
        let step = self.times.len();
        let name = |rank: u32| format!("{}_{step:04}_{rank}.vtu", self.name);
        let file = (&*self.folder.join(name(rank)), &mut self.grids);
        write_cells(file, mesh, |tet| owners[tet] == rank, point_fields, cell_fields)?;
        if rank > 0 {
            self.times.push(time);
            self.lists.push(true);
            return Ok(());
        }
        let all: BTreeSet<u32> = owners.iter().copied().collect();
        let pieces: Vec<String> = all.into_iter().map(name).collect();
        let path = self.folder.join(self.file_name(step, true));
        write_pvtu(&path, &pieces, point_fields, cell_fields)?;
        self.list(time, true)
    }

    /// Writes surfaces and their fields at a time (see [`write_surfaces_vtu`](super::write_surfaces_vtu)), and the list.
    ///
    /// # Errors
    /// [`OutputError`] as [`write_surfaces_vtu`](super::write_surfaces_vtu), and if the time does not follow the last one.
    pub fn write_surfaces(
        &mut self,
        time: f64,
        mesh: &TetMesh,
        surfaces: &[SurfaceFields<'_>],
    ) -> Result<(), OutputError> {
        self.check(time)?;
        write_pieces((&self.next_file(), &mut self.grids), mesh, surfaces)?;
        self.list(time, false)
    }

    /// The file to open in ParaView.
    pub fn path(&self) -> PathBuf {
        self.folder.join(format!("{}.pvd", self.name))
    }

    /// Times of the steps written so far, with those that an opened series had.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    fn check(&self, time: f64) -> Result<(), OutputError> {
        let before = self.last();
        if time.is_finite() && time > before {
            Ok(())
        } else {
            Err(OutputError::Time { time, before })
        }
    }

    fn last(&self) -> f64 {
        self.times.last().copied().unwrap_or(f64::NEG_INFINITY)
    }

    fn file_name(&self, step: usize, is_list: bool) -> String {
        let kind = if is_list { "pvtu" } else { "vtu" };
        format!("{}_{step:04}.{kind}", self.name)
    }

    fn next_file(&self) -> PathBuf {
        self.folder.join(self.file_name(self.times.len(), false))
    }

    /// Writes the list with one more step, which counts if that succeeds.
    fn list(&mut self, time: f64, is_list: bool) -> Result<(), OutputError> {
        self.times.push(time);
        self.lists.push(is_list);
        let written = replace(&self.path(), self.text().as_bytes());
        if written.is_err() {
            self.times.pop();
            self.lists.pop();
        }
        written.map_err(|(path, source)| OutputError::Io { path, source })
    }

    fn text(&self) -> String {
        let mut xml = HEAD.join("\n");
        for (step, (time, is_list)) in self.times.iter().zip(&self.lists).enumerate() {
            let file = escape(&self.file_name(step, *is_list));
            // Writing to a string cannot fail.
            let _ = write!(
                xml,
                "\n    <DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{file}\"/>"
            );
        }
        for line in FOOT {
            let _ = write!(xml, "\n{line}");
        }
        xml + "\n"
    }

    /// Takes the times of a list, which must be the one that is written of them.
    fn read(&mut self, list: &str) -> Result<(), OutputError> {
        let lines: Vec<&str> = list.lines().collect();
        for line in lines.iter().skip(HEAD.len()) {
            let time: Option<f64> = line.split('"').nth(1).and_then(|time| time.parse().ok());
            let Some(time) = time.filter(|t| t.is_finite() && *t > self.last()) else {
                break;
            };
            self.times.push(time);
            self.lists.push(line.contains(".pvtu\""));
        }
        let text = self.text();
        let wanted: Vec<&str> = text.lines().collect();
        let Some(line) = (0..lines.len().max(wanted.len())).find(|&k| lines.get(k) != wanted.get(k)) else {
            return Ok(());
        };
        let expected = match wanted.get(line) {
            None => "the end of the file".into(),
            Some(end) if *end == FOOT[0] => format!("a step with a time later than the one before, or {end:?},"),
            Some(wanted) => format!("{wanted:?}"),
        };
        Err(OutputError::BrokenSeries {
            path: self.path(),
            line: line + 1,
            found: lines.get(line).copied().unwrap_or_default().into(),
            expected,
        })
    }
}

/// As many bytes as a complete file ends with; fewer of a shorter one.
fn last_bytes(mut file: File) -> std::io::Result<Vec<u8>> {
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(END_OF_FILE.len() as u64)))?;
    let mut end = Vec::new();
    file.take(END_OF_FILE.len() as u64).read_to_end(&mut end)?;
    Ok(end)
}
