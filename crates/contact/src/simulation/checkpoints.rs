//! Runs that a kill does not end: states in a folder.
//!
//! Names have the number of steps solved, so that the newest is known without a list that could be damaged, too. Each
//! file is written beside its place, brought to the disk, and renamed.

use super::observer::Observer;
use super::simulation::Simulation;
use crate::error::ContactError;
use crate::report::{RunReport, Warning};
use crate::state::{State, explained, failed};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How often [`Simulation::run_or_resume`] stores a checkpoint, beside the last one. A number is one of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Every {
    /// After so many steps, counted from the first of the scene.
    Steps(usize),
    /// After the first step at whose end so much time has passed since the last checkpoint, or since the start.
    Time(Duration),
}

impl From<usize> for Every {
    fn from(steps: usize) -> Self {
        Self::Steps(steps)
    }
}

impl From<Duration> for Every {
    fn from(time: Duration) -> Self {
        Self::Time(time)
    }
}

/// Checkpoints that are kept: the newest and the one before.
const KEPT: usize = 2;

impl Simulation {
    /// [Runs](Self::run) from the newest checkpoint in a folder, or from the start where there is none, and stores a
    /// checkpoint every so many steps, or minutes, and after the last one, also where the observer stops (feature
    /// `checkpoint`). The same program, started again after a kill, goes on: with the same bits as a run that was
    /// never interrupted.
    ///
    /// The folder is made if need be; the newest checkpoint and the one before are kept, as `step-NUMBER.state`. It
    /// decides where the run goes on, also of a simulation that has solved steps already, which begins anew where it is
    /// empty. A checkpoint is stored after the observer was told of its step, and not where it failed: steps since the
    /// last one are solved and told again. A run whose last step is stored solves nothing more.
    ///
    /// A newest checkpoint that is damaged is kept as `step-NUMBER.state.damaged`, the one before is taken, and
    /// [`Warning::DamagedCheckpoint`] says so.
    ///
    /// # Errors
    /// As [`run`](Self::run). [`ContactError::Checkpoint`] where the newest checkpoint belongs to another scene, and
    /// where none that there are can be read; it names the files, which are left as they are.
    /// [`ContactError::CheckpointFile`] if the file system refuses; what was stored before is then as it was.
    /// [`ContactError::Setting`] for every zero steps.
    pub fn run_or_resume(
        &mut self,
        folder: impl AsRef<Path>,
        every: impl Into<Every>,
        observer: &mut (impl Observer + ?Sized),
    ) -> Result<RunReport, ContactError> {
        let folder = match folder.as_ref() {
            empty if empty.as_os_str().is_empty() => Path::new("."),
            folder => folder,
        };
        let every = every.into();
        ContactError::check(every != Every::Steps(0), "every", 0.0, "of at least one step")?;
        let warnings = self.resume_in_turn(folder)?;
        let mut stored_at = Instant::now();
        self.run_and_keep(observer, warnings, |simulation, last| {
            let step = simulation.state.step();
            let due = match every {
                Every::Steps(steps) => step.is_multiple_of(steps),
                Every::Time(time) => stored_at.elapsed() >= time,
            };
            let mut store = || {
                if (!last && !due) || simulation.plan().rank > 0 {
                    return Ok(());
                }
                simulation.state.save(folder.join(format!("step-{step:08}.state")))?;
                for (_, path) in stored(folder)?.into_iter().skip(KEPT) {
                    fs::remove_file(&path).map_err(failed("remove", &path))?;
                }
                stored_at = Instant::now();
                Ok(())
            };
            let own = store();
            simulation.together(own)
        })
    }

    /// What a process has done alone, once all have: where one fails all do.
    fn together<T>(&self, own: Result<T, ContactError>) -> Result<T, ContactError> {
        if self.plan().ranks == 1 {
            return own;
        }
        let fail = self.model.tfeti.gather(if own.is_ok() { 0.0 } else { 1.0 })?;
        match fail.iter().position(|fails| *fails > 0.0) {
            Some(rank) if own.is_ok() => Err(ContactError::Checkpoint {
                reason: format!("that of rank {rank} failed, see there"),
            }),
            _ => own,
        }
    }

    /// [`newest`] on rank 0, which makes the folder and sets damaged files aside, then on the others, which must find
    /// the same; all resume it together.
    fn resume_in_turn(&mut self, folder: &Path) -> Result<Option<Warning>, ContactError> {
        let root = self.plan().rank == 0;
        let first = || {
            fs::create_dir_all(folder).map_err(failed("write", folder))?;
            newest(folder)
        };
        let first = self.together(if root { first() } else { Ok(None) })?;
        let found = self.together(if root { Ok(first) } else { newest(folder) })?;
        let own = found.as_ref().map_or(0.0, |found| found.state.step() as f64);
        let steps = self.model.tfeti.gather(own)?;
        if steps.iter().any(|step| *step != own) {
            return Err(ContactError::Checkpoint {
                reason: format!(
                    "the ranks find different ones in {}; give them a folder that all of them see",
                    folder.display()
                ),
            });
        }
        let Some(Newest { state, path, warning }) = found else {
            if self.state.step() > 0 {
                self.resume(State::default())?;
            }
            return Ok(None);
        };
        let foreign = |reason: String| format!("{}: {reason}; or give this run a folder of its own", path.display());
        self.resume(state).map_err(|error| explained(error, foreign))?;
        Ok(warning)
    }
}

/// A checkpoint that is not damaged, and what newer ones are.
struct Newest {
    state: State,
    path: PathBuf,
    warning: Option<Warning>,
}

/// The newest checkpoint of a folder that is not damaged, if there are any; damaged ones are set aside.
fn newest(folder: &Path) -> Result<Option<Newest>, ContactError> {
    let mut damaged: Vec<(PathBuf, String)> = Vec::new();
    for (_, path) in stored(folder)? {
        match State::load(&path) {
            Ok(state) => {
                let warning = set_aside(damaged, path.clone())?;
                return Ok(Some(Newest { state, path, warning }));
            }
            Err(ContactError::UnreadableCheckpoint { reason }) => damaged.push((path, reason)),
            Err(other) => return Err(other),
        }
    }
    if damaged.is_empty() {
        return Ok(None);
    }
    let reasons: Vec<String> = damaged.into_iter().map(|(_, reason)| reason).collect();
    Err(ContactError::UnreadableCheckpoint {
        reason: format!(
            "none of those in {} can be read ({}); put copies of them back, or remove them to start anew",
            folder.display(),
            reasons.join(". ")
        ),
    })
}

/// Checkpoints of a folder, newest first, with their steps.
fn stored(folder: &Path) -> Result<Vec<(usize, PathBuf)>, ContactError> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed("read", folder))? {
        let name = entry.map_err(failed("read", folder))?.file_name();
        let number = name
            .to_str()
            .and_then(|n| n.strip_prefix("step-")?.strip_suffix(".state"));
        let digits = number.filter(|n| n.bytes().all(|b| b.is_ascii_digit()));
        if let Some(step) = digits.and_then(|n| n.parse().ok()) {
            found.push((step, folder.join(&name)));
        }
    }
    found.sort_by(|a, b| b.cmp(a));
    Ok(found)
}

/// Renames damaged checkpoints, so that they are neither taken for the newest nor removed.
fn set_aside(damaged: Vec<(PathBuf, String)>, taken: PathBuf) -> Result<Option<Warning>, ContactError> {
    let mut warning = None;
    for (path, reason) in damaged {
        let mut aside = path.clone().into_os_string();
        aside.push(".damaged");
        fs::rename(&path, &aside).map_err(failed("write", Path::new(&aside)))?;
        warning.get_or_insert(Warning::DamagedCheckpoint {
            path: aside.into(),
            reason,
            taken: taken.clone(),
        });
    }
    Ok(warning)
}
