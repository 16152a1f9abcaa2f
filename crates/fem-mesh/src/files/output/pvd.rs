//! A time series: one VTU file a step and a PVD file that lists them.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::tolerances::SAME_TIME;

use super::{Field, OutputError, SurfaceFields, write_surfaces_vtu, write_vtu};
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
/// `.tmp` at the end of their names, and then take it ([`replace_file`](crate::replace_file)). They are therefore
/// complete at any moment, also when the computation stops half way or the disk is full. A step whose writing failed
/// does not count and can be written again.
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
    /// type writes it, or one of its files is cut short.
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
        series.check_files()?;
        Ok(series)
    }

    /// No file is cut short. One that is not there is not missed: its owner has put it elsewhere.
    fn check_files(&self) -> Result<(), OutputError> {
        for step in 0..self.times.len() {
            let path = self.folder.join(self.file_name(step));
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

    /// Writes surfaces and their fields at a time (see [`write_surfaces_vtu`]), and the list.
    ///
    /// # Errors
    /// [`OutputError`] as [`write_surfaces_vtu`], and if the time does not follow the last one.
    pub fn write_surfaces(
        &mut self,
        time: f64,
        mesh: &TetMesh,
        surfaces: &[SurfaceFields<'_>],
    ) -> Result<(), OutputError> {
        self.check(time)?;
        write_surfaces_vtu(self.next_file(), mesh, surfaces)?;
        self.list(time)
    }

    /// The file to open in ParaView.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        self.folder.join(format!("{}.pvd", self.name))
    }

    /// Times of the steps written so far, with those that an opened series had.
    #[must_use]
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

    fn file_name(&self, step: usize) -> String {
        format!("{}_{step:04}.vtu", self.name)
    }

    fn next_file(&self) -> PathBuf {
        self.folder.join(self.file_name(self.times.len()))
    }

    fn list(&mut self, time: f64) -> Result<(), OutputError> {
        let mut xml = HEAD.join("\n");
        for (step, time) in self.times.iter().chain([&time]).enumerate() {
            let [before, after] = self.entry(step);
            // Writing to a string cannot fail.
            let _ = write!(xml, "\n{before}{time}{after}");
        }
        for line in FOOT {
            let _ = write!(xml, "\n{line}");
        }
        xml.push('\n');
        replace(&self.path(), xml.as_bytes()).map_err(|(path, source)| OutputError::Io { path, source })?;
        self.times.push(time);
        Ok(())
    }

    /// The line of a step in the list, before and after its time.
    fn entry(&self, step: usize) -> [String; 2] {
        let file = escape(&self.file_name(step));
        [
            "    <DataSet timestep=\"".into(),
            format!("\" group=\"\" part=\"0\" file=\"{file}\"/>"),
        ]
    }

    /// Takes the times of a list that `list` wrote.
    fn read(&mut self, list: &str) -> Result<(), OutputError> {
        let lines: Vec<&str> = list.lines().collect();
        let broken = |line: usize, expected: String| OutputError::BrokenSeries {
            path: self.path(),
            line: line + 1,
            found: lines.get(line).copied().unwrap_or_default().into(),
            expected,
        };
        let same = |line: usize, expected: &str| match lines.get(line) {
            Some(found) if *found == expected => Ok(()),
            _ => Err(broken(line, format!("{expected:?}"))),
        };
        for (line, expected) in HEAD.into_iter().enumerate() {
            same(line, expected)?;
        }
        let mut times: Vec<f64> = Vec::new();
        loop {
            let line = HEAD.len() + times.len();
            if lines.get(line) == Some(&FOOT[0]) {
                break;
            }
            let [before, after] = self.entry(times.len());
            let time = lines
                .get(line)
                .and_then(|found| found.strip_prefix(&*before)?.strip_suffix(&*after))
                .and_then(|time| time.parse().ok())
                .filter(|&t: &f64| t.is_finite() && times.last().is_none_or(|&last| t > last));
            let Some(time) = time else {
                let expected = format!(
                    "a line {:?} with a time later than the one before, or {:?},",
                    format!("{before}...{after}"),
                    FOOT[0]
                );
                return Err(broken(line, expected));
            };
            times.push(time);
        }
        let end = HEAD.len() + times.len() + FOOT.len();
        same(end - 1, FOOT[1])?;
        if lines.len() > end {
            return Err(broken(end, "the end of the file".into()));
        }
        self.times = times;
        Ok(())
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

/// The characters that XML reserves inside an attribute.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
