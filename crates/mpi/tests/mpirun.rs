//! The examples under `mpirun`: the same numbers as one process, and an end when a rank dies.
//!
//! Needs `mpirun` of the MPI that the package is built with; more ranks than cores are meant.

#[path = "../../../studies/examples/brick/main.rs"]
#[allow(dead_code, unreachable_pub)]
mod brick;

use clap::Parser;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// What differs from run to run: seconds, and memory, of which each rank has its own.
const OWN: [&str; 4] = ["setup_seconds", "solve_seconds", "peak_rss_bytes", "setup_bytes"];

/// Runs an example of this package, which `cargo test` has built.
fn mpirun(ranks: usize, example: &str, arguments: &[&str]) -> Output {
    let own = std::env::current_exe().expect("a test");
    let folder = own.parent().and_then(Path::parent).expect("target/PROFILE/deps");
    let mut command = Command::new("mpirun");
    // Open MPI 4 and 5: as root in a container, and more ranks than cores
    for (name, value) in [
        ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
        ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
        ("OMPI_MCA_rmaps_base_oversubscribe", "1"),
        ("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe"),
        // what a rank prints at its end stays short enough to be passed on in one piece
        ("RUST_BACKTRACE", "0"),
    ] {
        command.env(name, value);
    }
    command
        .args(["-n", &ranks.to_string()])
        .arg(folder.join("examples").join(example));
    command.args(arguments).output().expect("mpirun is in the path")
}

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// The runs of a file without what differs from run to run, and the bytes of matrices of each.
fn records(path: &Path) -> (Vec<Value>, Vec<u64>) {
    let text = std::fs::read_to_string(path).expect("JSON");
    let mut runs: Vec<Value> = serde_json::from_str(&text).expect("runs");
    let bytes = runs
        .iter()
        .map(|run| run["setup_bytes"].as_u64().expect("bytes"))
        .collect();
    for run in &mut runs {
        let fields = run.as_object_mut().expect("a record");
        OWN.iter().for_each(|field| assert!(fields.remove(*field).is_some()));
    }
    (runs, bytes)
}

fn same_as_one_process(line: &str, name: &str) {
    let out = scratch(name);
    let json = |ranks: usize| out.join(format!("{ranks}.json"));
    let folder = out.to_str().expect("a name").to_owned();
    let words = |ranks: usize| {
        let json = json(ranks).to_str().expect("a name").to_owned();
        let own = [
            "--quiet",
            "--threads",
            "1",
            "--vtu-every",
            "0",
            "--out",
            &folder,
            "--json",
            &json,
        ];
        let all = line.split(' ').chain(own);
        all.map(str::to_owned).collect::<Vec<String>>()
    };
    let options = brick::BrickOptions::parse_from(std::iter::once("brick".to_owned()).chain(words(1)));
    let mut table = Vec::new();
    brick::execute(&options, &mut table).expect("one process");
    let (plain, whole) = records(&json(1));
    for ranks in [2, 4] {
        let words = words(ranks);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let output = mpirun(ranks, "brick_mpi", &words);
        assert!(output.status.success(), "{ranks} ranks: {output:?}");
        let printed = String::from_utf8_lossy(&output.stdout);
        assert_eq!(
            printed.matches("Table 6.1").count(),
            1,
            "rank 0 alone prints: {printed}"
        );
        let (runs, bytes) = records(&json(ranks));
        assert_eq!(runs, plain, "{ranks} ranks");
        assert!(
            bytes.iter().zip(&whole).all(|(own, whole)| own < whole),
            "{bytes:?} of {whole:?}"
        );
    }
}

#[test]
fn ranks_have_the_numbers_of_one_process() {
    same_as_one_process("--n 3 --loading c --steps 10", "classes");
    same_as_one_process("--n 2 --loading b --steps 5 --perturb", "perturbed");
}

#[test]
fn a_rank_that_dies_ends_all() {
    for (how, message) in [
        ("error", "rank 2: error: the disk is full"),
        ("panic", "rank 2: panicked"),
        ("exit", "non-zero"),
    ] {
        let start = Instant::now();
        let output = mpirun(3, "rank_dies", &[how]);
        assert!(!output.status.success(), "{how}");
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "{how}: {:?}",
            start.elapsed()
        );
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(message), "{how}: {said}");
    }
}
