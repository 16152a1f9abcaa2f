//! Ctrl-C: a run in a process of its own is interrupted, and goes on.

use crate::deck;
use std::fs::{self, read_to_string};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Tells the process of its own what to run.
const PART: &str = "SIGNORINI_TEST_PART";

fn folder() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("ctrl_c")
}

/// Arguments of the command, with files in folders of this name.
fn arguments(part: &Path, name: &str) -> Vec<String> {
    let path = |end: &str| folder().join(format!("{name}-{end}")).display().to_string();
    let part = part.display().to_string();
    [part, "--out".into(), path("out"), "--states".into(), path("states")].into()
}

/// Not a test: what the process of its own does.
#[test]
fn the_interrupted_command() {
    if let Ok(part) = std::env::var(PART) {
        deck::command(arguments(Path::new(&part), "broken").into_iter()).expect("the command");
    }
}

#[test]
fn ctrl_c_ends_a_run_after_the_step_and_it_goes_on() {
    let _ = fs::remove_dir_all(folder());
    fs::create_dir_all(folder()).expect("a folder");
    // the pad of the examples in fifty steps
    let deck_text = include_str!("../../decks/pad.inp").replace("0.25, 1.", "0.02, 1.");
    let part = folder().join("pad.inp");
    fs::write(&part, deck_text).expect("a deck");

    let mut child = Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "signal::the_interrupted_command", "--nocapture"])
        .env(PART, &part)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a process");
    let mut lines = BufReader::new(child.stderr.take().expect("its progress")).lines();
    let steps = lines.find(|line| line.as_ref().is_ok_and(|l| l.contains(" of 51 steps")));
    assert!(steps.is_some(), "no step");
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .expect("kill")
            .success()
    );
    lines.for_each(drop);
    assert_eq!(child.wait().expect("its end").code(), Some(130));

    let rows = |name: &str| read_to_string(folder().join(format!("{name}-out/pad.csv"))).expect("a table");
    let broken = rows("broken");
    let stored: Vec<String> = fs::read_dir(folder().join("broken-states"))
        .expect("states")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    let steps = broken.lines().count() - 3;
    assert!(steps < 51, "the run was not interrupted");
    assert_eq!(stored, [format!("step-{steps:08}.state")]);

    // the same command goes on, and leaves what an unbroken run leaves
    deck::command(arguments(&part, "broken").into_iter()).expect("the rest");
    deck::command(arguments(&part, "whole").into_iter()).expect("all");
    let whole = rows("whole");
    assert!(whole.starts_with(&broken) && whole.lines().count() == 3 + 51);
    assert!(rows("broken") == whole, "other bits");
}
