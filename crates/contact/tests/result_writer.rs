//! Files of results: what is in them, when they are complete, and what happens where they cannot be written.
//! Stands alone, so that it runs with the feature `vtu` and no other.

use signorini_contact::{
    Analysis, Contact, ContactError, ContactState, DifferenceFormula, Flow, Friction, Load, Observer, Progress,
    ResultField, ResultWriter, Scene, Settings, Silent, Simulation, StepResult, Support,
};
use signorini_fem_mesh::output::OutputError;
use signorini_fem_mesh::{Brick, History, Hooke, Materials, brick};
use signorini_tfeti::internal::on_ranks;
use std::ffi::OsString;
use std::fs::{self, read, read_to_string};
use std::io::Write as _;
use std::path::{Path, PathBuf};

const STEPS: usize = 4;
/// The corner at (3, 1, 0).
const CORNER: u32 = 20;

/// A beam above a floor, pressed down and pulled, with a wall that it never reaches.
fn simulation_with(settings: Settings) -> Simulation {
    let mesh = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build().expect("brick");
    assert_eq!(mesh.points()[CORNER as usize], [3.0, 1.0, 0.0]);
    let steel = Hooke::isotropic(211.9e9, 0.277).expect("steel");
    let ramp = || History::ramp(1.0, 1.0).expect("ramp");
    let scene = Scene::new(mesh, Materials::uniform(steel))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30e8]).with_history(ramp()))
        .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(ramp()))
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(0.1)
                .with_friction(Friction::coulomb(0.3)),
        )
        .with_contact(Contact::rigid(brick::Y_MAX).with_gap(0.5))
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, STEPS).with_formula(DifferenceFormula::BACKWARD_EULER));
    Simulation::new(scene, settings).expect("set-up")
}

fn simulation() -> Simulation {
    simulation_with(Settings::default())
}

fn writer(folder: &Path) -> ResultWriter {
    ResultWriter::new(folder, "beam").with_probe(CORNER)
}

fn times(path: &Path) -> Vec<f64> {
    let list = read_to_string(path).expect("a list");
    let time = |part: &str| part.split('"').next().and_then(|t| t.parse().ok()).expect("a time");
    list.split("timestep=\"").skip(1).map(time).collect()
}

/// Whether a file is a whole one with a field of this name.
fn has(path: &Path, field: &str) -> bool {
    let text = read_to_string(path).expect("a file");
    assert!(text.ends_with("</VTKFile>\n"), "{}", path.display());
    text.contains(&format!("Name=\"{field}\""))
}

/// Files of the series of the bodies.
fn is_body(name: &OsString) -> bool {
    let name = name.to_str().expect("a name");
    name.starts_with("beam_0") || name == "beam.pvd"
}

/// Of several ranks each writes its tetrahedra, and one the rest, as one process does; a failure of one is one of all.
#[test]
fn several_ranks_write_together() {
    let [alone, together] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    // translates that share matrices would be of one rank
    let settings = Settings::default().with_share_translates(false);
    let mut one = simulation_with(settings.clone());
    let _ = one.run(&mut writer(alone.path())).expect("run");
    let runs = |folder: &Path| {
        on_ranks(2, |c| {
            let rank = c.rank();
            let mut simulation = simulation_with(settings.clone().with_communicator(c));
            let mut lines = Vec::new();
            let run = simulation.run(&mut (writer(folder), Progress::new(&mut lines)));
            (
                rank,
                run.map(|report| report.steps).map_err(|e| e.to_string()),
                lines.len(),
            )
        })
    };
    for run in runs(together.path()) {
        let (rank, steps, told) = run.expect("no panic");
        assert_eq!((steps, told > 0), (Ok(STEPS), rank == 0));
    }
    let names = |folder: &Path| {
        let entries = fs::read_dir(folder).expect("a folder");
        let mut names: Vec<_> = entries.map(|entry| entry.expect("an entry").file_name()).collect();
        names.sort();
        names
    };
    let common: Vec<_> = names(alone.path()).into_iter().filter(|n| !is_body(n)).collect();
    assert!(
        names(together.path())
            .into_iter()
            .filter(|n| !is_body(n))
            .eq(common.iter().cloned())
    );
    for name in &common {
        let [one, two] = [&alone, &together].map(|folder| read(folder.path().join(name)).expect("a file"));
        assert!(one == two, "{}", name.display());
    }
    assert_eq!(
        times(&together.path().join("beam.pvd")),
        times(&alone.path().join("beam.pvd"))
    );
    let cells = |path: PathBuf| -> usize {
        let text = read_to_string(path).expect("a piece");
        let number = text.split("NumberOfCells=\"").nth(1).and_then(|t| t.split('"').next());
        number.and_then(|n| n.parse().ok()).expect("a number")
    };
    for step in 0..=STEPS {
        let list = read_to_string(together.path().join(format!("beam_{step:04}.pvtu"))).expect("a list");
        let pieces = [0, 1].map(|rank| format!("beam_{step:04}_{rank}.vtu"));
        assert_eq!(list.matches("<Piece ").count(), 2);
        assert!(pieces.iter().all(|piece| list.contains(piece)), "{list}");
        let counts = pieces.map(|piece| cells(together.path().join(piece)));
        assert_eq!(
            counts.iter().sum::<usize>(),
            cells(alone.path().join(format!("beam_{step:04}.vtu")))
        );
        assert!(counts.iter().all(|count| *count > 0));
    }
    // a file where the folder should be
    for run in runs(&together.path().join("beam.csv")) {
        let (_, error, _) = run.expect("no panic");
        assert!(error.expect_err("cannot write").contains("beam.csv"));
    }
}

#[test]
fn the_files_are_these_and_begin_at_rest() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let mut writer = writer(folder.path());
    assert_eq!(writer.path(), path("beam.pvd"));
    let _ = simulation().run(&mut writer).expect("run");
    let mut names: Vec<String> = fs::read_dir(folder.path())
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("a name"))
        .collect();
    names.sort();
    let mut expected = vec!["beam.csv".to_owned(), "beam.pvd".into(), "beam_contact.pvd".into()];
    for k in 0..=STEPS {
        expected.extend([format!("beam_{k:04}.vtu"), format!("beam_contact_{k:04}.vtu")]);
    }
    expected.sort();
    assert_eq!(names, expected);
    for series in ["beam.pvd", "beam_contact.pvd"] {
        assert_eq!(times(&path(series)), [0.0, 0.25, 0.5, 0.75, 1.0]);
    }
    for k in 0..=STEPS {
        let (body, contact) = (
            path(&format!("beam_{k:04}.vtu")),
            path(&format!("beam_contact_{k:04}.vtu")),
        );
        for field in ["displacement", "von_mises"] {
            assert!(has(&body, field), "{field}");
        }
        for field in [
            "displacement",
            "contact_pressure",
            "friction_stress",
            "gap",
            "slip",
            "state",
            "contact",
        ] {
            assert!(has(&contact, field), "{field}");
        }
        assert!(!has(&body, "stress") && !has(&contact, "slip_rate"));
        assert_eq!(read_to_string(contact).expect("a file").matches("<Piece").count(), 2);
    }
    let table = read_to_string(path("beam.csv")).expect("a table");
    assert!(table.contains("-1 no contact point (held by a support, or nothing faces it), 0 open, 1 stick, 2 slip"));
}

/// Every number of the table has the bits of the result.
#[test]
fn the_table_has_the_numbers_of_the_results() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut writer = writer(folder.path());
    let mut simulation = simulation();
    let mut expected = Vec::new();
    while !simulation.is_finished() {
        let result = simulation.step().expect("step");
        writer.write(&result).expect("files");
        let (sum, reactions) = (result.summary(), result.reactions());
        let mut row = vec![
            result.step() as f64,
            result.time(),
            result.report().counters.products as f64,
            result.certificate().largest(),
            sum.active as f64,
            sum.stick as f64,
            sum.slip as f64,
        ];
        let supports = reactions.supports.iter().map(|s| s.resultant);
        for resultant in reactions.contacts.iter().copied().chain(supports) {
            row.extend(resultant.force.into_iter().chain(resultant.moment));
        }
        for sum in [0, 1].map(|k| *result.summary_of(k).expect("a contact")) {
            let friction = sum.friction_force.iter().map(|f| f * f).sum::<f64>().sqrt();
            row.extend([sum.area, sum.max_pressure, sum.normal_force, friction]);
        }
        row.extend(result.displacement()[CORNER as usize]);
        expected.push(row);
    }
    let table = read_to_string(folder.path().join("beam.csv")).expect("a table");
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    assert_eq!(
        head[..8],
        [
            "step",
            "time",
            "products",
            "status",
            "certificate",
            "touch",
            "stick",
            "slide"
        ]
    );
    assert_eq!(head[8], "contact_0_fx");
    assert_eq!(head[8 + 12], "support_0_fx");
    assert_eq!(head[8 + 18], "contact_0_area");
    assert_eq!(head[head.len() - 1], "node_20_uz");
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), expected.len());
    for (row, expected) in rows.iter().zip(&expected) {
        assert_eq!(row.len(), head.len());
        assert_eq!(row[3], "converged");
        let numbers = row.iter().enumerate().filter(|(k, _)| *k != 3);
        let numbers: Vec<f64> = numbers.map(|(_, v)| v.parse().expect("a number")).collect();
        assert_eq!(numbers, *expected);
    }
    // the last one touches, and rests on floor and support
    assert!(expected[STEPS - 1][4] > 0.0 && expected[STEPS - 1][9] > 0.0);
}

#[test]
fn fields_can_be_chosen() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let mut all = ResultWriter::new(folder.path(), "all").with_contact_name("floor");
    let more = [
        ResultField::Stress,
        ResultField::ContactForce,
        ResultField::Reaction,
        ResultField::Subdomain,
        ResultField::EstimatedError,
        ResultField::SlipRate,
    ];
    for field in more {
        all = all.with_field(field).with_field(field);
    }
    let mut few = ResultWriter::new(folder.path(), "few")
        .with_fields([ResultField::Gap])
        .with_every(3);
    let mut both = |result: &StepResult| match all.step(result) {
        Flow::Continue => few.step(result),
        other => other,
    };
    let _ = simulation().run(&mut both).expect("run");
    for field in more {
        assert!(has(&path("all_0000.vtu"), field.name()) || has(&path("floor_0000.vtu"), field.name()));
        assert!(has(&path("all_0004.vtu"), field.name()) || has(&path("floor_0004.vtu"), field.name()));
    }
    assert!(has(&path("few_contact_0001.vtu"), "gap") && !has(&path("few_contact_0001.vtu"), "state"));
    assert!(!has(&path("few_0001.vtu"), "displacement"));
    // every third and the last
    assert_eq!(times(&path("few.pvd")), [0.0, 0.75, 1.0]);
    assert_eq!(
        read_to_string(path("few.csv")).expect("a table").lines().count(),
        3 + STEPS
    );
}

#[test]
fn files_are_complete_after_each_step() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut writer = writer(folder.path());
    let mut check = |result: &StepResult| {
        let flow = writer.step(result);
        for series in ["beam", "beam_contact"] {
            let listed = times(&folder.path().join(format!("{series}.pvd")));
            assert_eq!(
                (listed.len(), listed[listed.len() - 1]),
                (result.step() + 2, result.time())
            );
            for k in 0..listed.len() {
                assert!(has(&folder.path().join(format!("{series}_{k:04}.vtu")), "displacement"));
            }
        }
        let table = read_to_string(folder.path().join("beam.csv")).expect("a table");
        assert_eq!(table.lines().count(), 3 + result.step() + 1);
        flow
    };
    let _ = simulation().run(&mut check).expect("run");
}

#[test]
fn a_folder_that_cannot_be_written_ends_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "in the way").expect("a file");
    let mut simulation = simulation();
    let Err(ContactError::Observer { step: 0, source }) = simulation.run(&mut writer(&file.join("out"))) else {
        panic!("an error is expected");
    };
    assert!(source.to_string().contains("file/out"), "{source}");
    // the step is kept, and the run goes on
    assert_eq!(simulation.run(&mut Silent).expect("the rest").steps, STEPS - 1);
}

/// A file that cannot be written leaves all before it; then the run goes on with the same files.
#[test]
fn a_failure_half_way_loses_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    fs::create_dir_all(path("beam_contact_0002.vtu/in_the_way")).expect("an obstacle");
    let (mut simulation, mut writer) = (simulation(), writer(folder.path()));
    let Err(error @ ContactError::Observer { step: 1, .. }) = simulation.run(&mut writer) else {
        panic!("an error is expected");
    };
    assert!(format!("{error:?}").contains("beam_contact_0002.vtu"), "{error:?}");
    assert_eq!(times(&path("beam_contact.pvd")), [0.0, 0.25]);
    let table = read(path("beam.csv")).expect("a table");
    assert_eq!(String::from_utf8_lossy(&table).lines().count(), 3 + 1);
    fs::remove_dir_all(path("beam_contact_0002.vtu")).expect("no obstacle");
    let result = simulation.result().expect("the step").clone();
    writer.write(&result).expect("the step that failed");
    let _ = simulation.run(&mut writer).expect("the rest");
    for series in ["beam.pvd", "beam_contact.pvd"] {
        assert_eq!(times(&path(series)), [0.0, 0.25, 0.5, 0.75, 1.0]);
    }
    let longer = read(path("beam.csv")).expect("a table");
    assert!(longer.starts_with(&table));
    assert_eq!(String::from_utf8_lossy(&longer).lines().count(), 3 + STEPS);
}

/// A full disk (a device that takes no byte) in the place of each file in turn: the error names the file and what to
/// do, what was written stays, and the step is written again once there is room.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_loses_nothing() {
    for full in ["beam_0002.vtu", "beam_contact_0002.vtu", "beam.pvd", "beam_contact.pvd"] {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        let (mut simulation, mut writer) = (simulation(), writer(folder.path()));
        let first = simulation.step().expect("step");
        writer.write(&first).expect("room");
        let before = times(&path("beam.pvd"));
        std::os::unix::fs::symlink("/dev/full", path(&format!("{full}.tmp"))).expect("a full disk");
        let second = simulation.step().expect("step");
        let error = writer.write(&second).expect_err("no room").to_string();
        for word in [full, "No space left", "make room"] {
            assert!(error.contains(word), "{error}");
        }
        assert!(times(&path("beam.pvd")).starts_with(&before));
        for k in 0..before.len() {
            assert!(has(&path(&format!("beam_{k:04}.vtu")), "displacement"));
        }
        writer.write(&second).expect("room again");
        let _ = simulation.run(&mut writer).expect("the rest");
        for series in ["beam.pvd", "beam_contact.pvd"] {
            assert_eq!(times(&path(series)), [0.0, 0.25, 0.5, 0.75, 1.0], "{full}");
        }
    }
}

/// A run that is resumed leaves the files of an unbroken one, bit for bit.
#[test]
fn a_resumed_run_goes_on_with_its_files() {
    let [whole, broken] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let _ = simulation().run(&mut writer(whole.path())).expect("run");
    let (mut first, mut files) = (simulation(), writer(broken.path()));
    for _ in 0..2 {
        files.write(&first.step().expect("step")).expect("files");
    }
    let state = first.state().clone();
    files.write(&first.step().expect("step")).expect("files");
    // a machine that stops leaves part of a row
    let table = fs::OpenOptions::new().append(true).open(broken.path().join("beam.csv"));
    table.expect("the table").write_all(b"1,0.5,7").expect("a part");
    let mut again = simulation();
    again.resume(state.clone()).expect("resume");
    let _ = again.run(&mut writer(broken.path())).expect("run");
    for entry in fs::read_dir(whole.path()).expect("a folder") {
        let name = entry.expect("an entry").file_name();
        let [a, b] = [&whole, &broken].map(|f| read(f.path().join(&name)).expect("a file"));
        assert!(a == b, "{}", name.display());
    }
    let mut other = simulation();
    other.resume(state).expect("resume");
    let Err(error) = other.run(&mut ResultWriter::new(broken.path(), "beam")) else {
        panic!("the table has a probe");
    };
    assert!(format!("{error:?}").contains("same choices"), "{error:?}");
}

#[test]
fn wrong_choices_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let result = simulation().step().expect("step");
    let probe = ResultWriter::new(folder.path(), "beam").with_probe(1000).write(&result);
    assert!(matches!(probe, Err(ContactError::Probe { node: 1000, nodes: 63 })));
    let name = ResultWriter::new(folder.path(), "a/b").write(&result);
    assert!(matches!(
        name,
        Err(ContactError::Output(OutputError::SeriesName { .. }))
    ));
    let shared = ResultWriter::new(folder.path(), "beam").with_contact_name("beam");
    assert!(matches!(
        { shared }.write(&result),
        Err(ContactError::Output(OutputError::SharedSeries { .. }))
    ));
}

/// States at the nodes, in the order of the surface.
#[test]
fn points_at_nodes_are_those_of_the_surface() {
    let mut simulation = simulation();
    let _ = simulation.run(&mut Silent).expect("run");
    let result = simulation.result().expect("a step");
    let points = result.points_at_nodes(0).expect("the floor");
    let nodes = result.surfaces()[0].nodes();
    assert_eq!(points.len(), nodes.len());
    for (node, point) in nodes.iter().zip(&points) {
        // the end at x = 0 is fixed
        let fixed = simulation.scene().mesh().points()[*node as usize][0] == 0.0;
        assert_eq!(point.is_none(), fixed);
        assert!(point.is_none_or(|p| p.node == *node && p.surface == 0));
    }
    let touching = |p: &&Option<&signorini_contact::PointState>| p.is_some_and(|p| p.state != ContactState::Open);
    assert_eq!(points.iter().filter(touching).count(), result.summary().active);
    assert!(result.points_at_nodes(2).is_none() && result.contact_pressure(2).is_none());
}

/// Supports and contacts that end leave their columns; the series goes on.
#[test]
fn stages_are_one_series() {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build().expect("brick");
    let steel = Hooke::isotropic(211.9e9, 0.277).expect("steel");
    let floor = || Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3));
    let scene = Scene::new(mesh, Materials::uniform(steel))
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(Support::fixed(brick::X_MAX).with_end(0.5))
        .with_load(Load::pressure(brick::Z_MAX, 1e8))
        .with_contact(floor().with_end(0.25))
        .with_contact(floor().with_start(0.75))
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, STEPS));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let report = simulation.run(&mut writer(folder.path())).expect("run");
    report.require_converged().expect("converged");
    assert_eq!(times(&folder.path().join("beam.pvd")), [0.0, 0.25, 0.5, 0.75, 1.0]);
    let table = read_to_string(folder.path().join("beam.csv")).expect("a table");
    let rows: Vec<&str> = table.lines().rev().take(STEPS).collect();
    assert!(rows[STEPS - 1].starts_with("0,0.25,"), "{table}");
    let counts: Vec<usize> = rows.iter().map(|row| row.split(',').count()).collect();
    assert!(counts.iter().all(|count| *count == counts[0]), "{table}");
}
