//! The program, run as users do.

use std::fs::{create_dir_all, read_to_string, write};
use std::path::Path;
use std::process::{Command, Output};

const PAD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/decks/pad.inp");

fn run(model: &Path, options: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_signorini");
    let output = Command::new(program).arg(model).args(options).output();
    output.expect("the program runs")
}

fn told(output: &Output) -> [String; 2] {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned())
}

#[test]
fn a_deck_is_solved() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let options = ["--threads", "1", "--tolerance", "1e-5", "--subdomains", "4", "--out"];
    let output = run(
        Path::new(PAD),
        &[&options[..], &[out.to_str().expect("a path")]].concat(),
    );
    let [lines, errors] = told(&output);
    assert_eq!(output.status.code(), Some(0), "{errors}");
    assert!(
        lines.contains("*NODE FILE: ignored") && lines.contains("reaction at RAIL_BOTTOM"),
        "{lines}"
    );
    assert!(lines.contains("subdomains  4 "), "{lines}");
    let series = read_to_string(out.join("pad.pvd")).expect("a series");
    assert_eq!(series.matches("<DataSet").count(), 6);
}

#[test]
fn a_plan_solves_nothing() {
    let output = run(Path::new(PAD), &["--plan"]);
    let [lines, errors] = told(&output);
    assert_eq!(output.status.code(), Some(0), "{errors}");
    assert!(
        lines.contains("*NODE FILE: ignored") && lines.contains("subdomains"),
        "{lines}"
    );
    assert!(!lines.contains("reaction at") && errors.is_empty(), "{lines}{errors}");
}

#[test]
fn what_fails_is_told_and_ends_with_its_number() {
    let folder = tempfile::tempdir().expect("a folder");
    create_dir_all(folder.path()).expect("a folder");
    let part = folder.path().join("broken.inp");
    let text = read_to_string(PAD).expect("a deck");
    write(&part, text.replace("210000., 0.3", "210000., 0.7")).expect("a deck");
    let absent = folder.path().join("absent.inp");
    for (model, options, code, words) in [
        (&*part, &[][..], 1, "broken.inp:"),
        (&*absent, &[], 1, "absent.inp"),
        (Path::new(PAD), &["--tolerance", "7"], 1, "tolerance"),
        (Path::new(PAD), &["--subdomains", "many"], 2, "--subdomains"),
    ] {
        let output = run(model, options);
        let [_, errors] = told(&output);
        assert_eq!(output.status.code(), Some(code), "{errors}");
        assert!(errors.contains(words), "{errors}");
    }
}
