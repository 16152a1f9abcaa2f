//! Files that take the place of others at once.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes a file that is complete at any moment: to `PATH.tmp` beside it, then to the disk, and only then in the
/// place of what was there. After a failure, a full disk or a kill in between, the old file is as it was; a kill may
/// leave `PATH.tmp`, which the next write takes over.
///
/// ```
/// # let directory = tempfile::tempdir()?;
/// # let path = directory.path().join("state.bin");
/// signorini_fem_mesh::internal::replace_file(&path, b"first")?;
/// signorini_fem_mesh::internal::replace_file(&path, b"second")?;
/// assert_eq!(std::fs::read(&path)?, b"second");
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// What the system says; the message names the file.
pub fn replace_file(path: impl AsRef<Path>, contents: &[u8]) -> io::Result<()> {
    replace(path.as_ref(), contents)
        .map_err(|(path, source)| io::Error::new(source.kind(), format!("{}: {source}", path.display())))
}

/// The same; the error has the file that failed.
pub(super) fn replace(path: &Path, contents: &[u8]) -> Result<(), (PathBuf, io::Error)> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".tmp");
    let beside = path.with_file_name(name);
    let failed = |source| (beside.clone(), source);
    let mut file = File::create(&beside).map_err(failed)?;
    // a rename may reach the disk before what was written does
    let written = file.write_all(contents).and_then(|()| file.sync_all());
    drop(file);
    let done = written
        .map_err(failed)
        .and_then(|()| fs::rename(&beside, path).map_err(|source| (path.to_path_buf(), source)));
    if done.is_err() {
        let _ = fs::remove_file(&beside);
        return done;
    }
    // where folders can be synced, the new name lasts, too
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    if let Ok(folder) = File::open(folder.unwrap_or(Path::new("."))) {
        let _ = folder.sync_all();
    }
    Ok(())
}
