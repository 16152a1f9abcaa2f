//! Files of results, where scenes change hands or have names.

use crate::common::*;
use std::fs::read_to_string;

/// A clamped brick on a floor, with so many walls that it never reaches.
fn scene(cells: usize, walls: usize) -> Scene {
    let wall = |_| Contact::rigid(brick::Y_MAX).with_gap(0.5);
    let scene = pressed(cells, Friction::coulomb(0.3)).with_analysis(Analysis::quasistatic(1.0, 3));
    (0..walls).map(wall).fold(scene, Scene::with_contact)
}

fn simulation(cells: usize, walls: usize) -> Simulation {
    Simulation::new(scene(cells, walls), Settings::default()).expect("set-up")
}

/// A writer with open files that is given a step of another scene judges it as a new writer would.
#[test]
fn a_step_of_another_scene_is_judged_anew() {
    let (mut large, mut small, mut walled) = (simulation(4, 0), simulation(2, 0), simulation(4, 1));
    let [first, last] = [(); 2].map(|()| large.step().expect("step"));
    let [small, walled] = [&mut small, &mut walled].map(|s| [(); 2].map(|()| s.step().expect("step"))[1].clone());
    let folder = tempfile::tempdir().expect("a folder");
    let table = || read_to_string(folder.path().join("part.csv")).expect("a table");
    let mut writer = ResultWriter::new(folder.path(), "part").with_probe(300);
    writer.write(&first).expect("files");
    let error = writer.write(&small).expect_err("no such node");
    assert!(matches!(error, ContactError::Probe { node: 300, nodes: 63 }), "{error}");
    let error = writer.write(&walled).expect_err("other columns");
    assert!(matches!(error, ContactError::ResultTable { line: 3, .. }), "{error}");
    // what was there stays, and goes on
    writer.write(&last).expect("files");
    assert_eq!(table().lines().count(), 3 + 2);
}

/// The head tells what parts are called, in its comments: columns have numbers.
#[test]
fn the_head_tells_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let lines = |names: &'static str| -> Vec<String> {
        let scene = scene(2, 1).with_names(move |part| (part == Part::Contact(1)).then(|| names.to_owned()));
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let mut writer = ResultWriter::new(folder.path(), "part");
        writer.write(&simulation.step().expect("step")).expect("files");
        // what a part is called is no column: other names go on with the table
        let again = self::simulation(2, 1);
        let mut again = (again, ResultWriter::new(folder.path(), "part"));
        again.0.resume(simulation.state().clone()).expect("resume");
        again.1.write(&again.0.step().expect("step")).expect("goes on");
        writer.write(&simulation.step().expect("step")).expect("files");
        let table = read_to_string(folder.path().join("part.csv")).expect("a table");
        table.lines().map(str::to_owned).collect()
    };
    let told = lines("the \"wall\",\r\nof oak");
    assert_eq!(told.len(), 3 + 2);
    assert!(
        told[1].ends_with("2 slip; contact 1 is the \"wall\",  of oak"),
        "{}",
        told[1]
    );
    let columns: Vec<&str> = told[2].split(',').collect();
    assert!(columns.contains(&"contact_1_fx") && columns.contains(&"contact_1_max_pressure"));
    assert!(told[3..].iter().all(|row| row.split(',').count() == columns.len()));
}
