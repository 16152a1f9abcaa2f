//! States as bytes: what was stored and read back is the same state, and continues bit for bit.
//! Stands alone, so that it runs with the feature `checkpoint` and no other.

mod stages;

use allocation_counter::measure;
use signorini_contact::{
    Accuracy, Analysis, Coefficient, Contact, ContactError, DifferenceFormula, Every, Flow, Friction, Load, Method,
    RunReport, Scene, Settings, Silent, Simulation, State, StepResult, Support, Warning,
};
use signorini_fem_mesh::{Brick, History, Hooke, Materials, brick};
use signorini_tfeti::internal::on_ranks;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A coarse relative of the benchmark.
fn simulation(friction: &Friction, settings: &Settings) -> Simulation {
    let mesh = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build().expect("brick");
    let steel = Hooke::isotropic(211.9e9, 0.277).expect("steel");
    let ramp = History::ramp(1.0, 1.0).expect("ramp");
    let pull = History::table(vec![(0.0, 0.0), (0.4, 1.0), (0.7, 0.0), (1.0, 1.0)]).expect("table");
    let scene = Scene::new(mesh, Materials::uniform(steel))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30e8]).with_history(ramp))
        .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(pull))
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(0.1)
                .with_friction(friction.clone()),
        )
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 4).with_formula(DifferenceFormula::PAPER));
    Simulation::new(scene, settings.clone()).expect("set-up")
}

fn continues_bit_for_bit(settings: &Settings) {
    let weakening = Coefficient::Exponential {
        fixed: 0.3,
        kinetic: 0.1,
        decay: 0.05,
    };
    for friction in [Friction::coulomb(0.3), Friction::Coulomb(weakening)] {
        let mut whole = simulation(&friction, settings);
        let mut stored = Vec::new();
        while !whole.is_finished() {
            stored.push(whole.state().to_bytes().expect("encode"));
            let _ = whole.step().expect("step");
        }
        for (k, bytes) in stored.iter().enumerate() {
            let state = State::from_bytes(bytes).expect("decode");
            assert_eq!(state.to_bytes().expect("encode"), *bytes);
            let mut again = simulation(&friction, settings);
            again.resume(state).expect("resume");
            let _ = again.run(&mut Silent).expect("run");
            assert!(again.state() == whole.state(), "resumed after {k} steps");
            let last = |s: &Simulation| s.result().expect("a step").torn_displacement().to_vec();
            assert_eq!(last(&again), last(&whole), "resumed after {k} steps");
        }
    }
}

#[test]
fn with_the_default_method() {
    continues_bit_for_bit(&Settings::default());
}

#[test]
fn with_the_papers_methods() {
    for method in [Method::paper(), Method::one_loop()] {
        continues_bit_for_bit(&Settings::default().with_method(method));
    }
}

#[test]
fn with_accuracies_by_estimates() {
    for accuracy in [Accuracy::Relative(1e-5), Accuracy::balanced()] {
        continues_bit_for_bit(&Settings::default().with_accuracy(accuracy));
    }
}

#[test]
fn a_step_that_did_not_converge_stays_named() {
    let one_product = signorini_qp::ActiveSetSettings::default().with_max_products(1);
    let settings = Settings::default()
        .with_method(Method::ActiveSet(one_product))
        .with_max_fallback_products(1);
    let mut simulation = simulation(&Friction::coulomb(0.3), &settings);
    let _ = simulation.run(&mut Silent).expect("run");
    let named = simulation.state().unconverged_history();
    assert!(named.is_some());
    let state = State::from_bytes(&simulation.state().to_bytes().expect("encode")).expect("decode");
    assert_eq!(state.unconverged_history(), named);
}

/// A folder of a test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("signorini-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        Self(path)
    }

    /// Names in it, ascending.
    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("folder");
        let mut names: Vec<String> = entries
            .map(|e| e.expect("entry").file_name().into_string().expect("name"))
            .collect();
        names.sort();
        names
    }

    fn change(&self, name: &str, change: impl FnOnce(&mut Vec<u8>)) {
        let path = self.0.join(name);
        let mut bytes = std::fs::read(&path).expect("read");
        change(&mut bytes);
        std::fs::write(path, bytes).expect("write");
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn rough() -> Simulation {
    simulation(&Friction::coulomb(0.3), &Settings::default())
}

/// Runs in a folder, every step stored, until so many steps are solved in all.
fn run_until(steps: usize, folder: &Path) -> Result<(Simulation, RunReport), ContactError> {
    let mut simulation = rough();
    let mut observer = |result: &StepResult| {
        if result.step() + 1 == steps { Flow::Stop } else { Flow::Continue }
    };
    let report = simulation.run_or_resume(folder, 1, &mut observer)?;
    Ok((simulation, report))
}

fn unbroken() -> Simulation {
    let mut simulation = rough();
    let _ = simulation.run(&mut Silent).expect("run");
    simulation
}

fn assert_same_end(simulation: &Simulation) {
    let whole = unbroken();
    assert!(simulation.state() == whole.state());
    let last = |s: &Simulation| s.result().expect("a step").torn_displacement().to_vec();
    assert_eq!(last(simulation), last(&whole));
}

#[test]
fn a_run_in_a_folder_goes_on_with_the_same_bits() {
    for broken in 1..4 {
        let folder = Folder::new(&format!("resume-{broken}"));
        let (_, report) = run_until(broken, &folder.0).expect("first");
        assert_eq!(report.steps, broken);
        let (second, report) = run_until(4, &folder.0).expect("second");
        assert_eq!(report.steps, 4 - broken);
        assert_same_end(&second);
        assert_eq!(folder.names(), ["step-00000003.state", "step-00000004.state"]);
        // what is complete solves nothing more
        let (third, report) = run_until(4, &folder.0).expect("third");
        assert_eq!(report.steps, 0);
        assert!(third.is_finished() && third.state() == second.state());
    }
}

/// An empty folder says that nothing is solved, whatever a simulation has solved: it went on from where it stood.
#[test]
fn an_empty_folder_begins_anew() {
    let (folder, mut used) = (Folder::new("anew"), rough());
    (0..2).for_each(|_| _ = used.step().expect("step"));
    let report = used.run_or_resume(&folder.0, 1, &mut Silent).expect("run");
    assert_eq!(report.steps, 4);
    assert_same_end(&used);
}

/// Two ranks store what one process reads, and the other way round; ranks that see different folders are told.
#[test]
fn checkpoints_of_several_ranks_are_those_of_one_process() {
    let settings = Settings::default().with_share_translates(false);
    let until = |steps: usize, folder: &Path, settings: &Settings| {
        let mut simulation = simulation(&Friction::coulomb(0.3), settings);
        let mut observer = |result: &StepResult| if result.step() + 1 == steps { Flow::Stop } else { Flow::Continue };
        let report = simulation.run_or_resume(folder, 1, &mut observer);
        report.map(|report| (report.steps, simulation.state().to_bytes().expect("encode")))
    };
    let on_ranks = |count: usize, steps: usize, folder: &(dyn Fn(usize) -> PathBuf + Sync)| {
        let found = on_ranks(count, |c| {
            until(steps, &folder(c.rank()), &settings.clone().with_communicator(c))
        });
        found.into_iter().map(|run| run.expect("no panic")).collect::<Vec<_>>()
    };
    let folder = Folder::new("whole-of-ranks");
    let (_, whole) = until(4, &folder.0, &settings).expect("one process");
    let folder = Folder::new("ranks");
    for run in on_ranks(2, 1, &|_| folder.0.clone()) {
        assert_eq!(run.expect("two ranks").0, 1);
    }
    assert_eq!(folder.names(), ["step-00000001.state"]);
    assert_eq!(until(2, &folder.0, &settings).expect("one process").0, 1);
    for run in on_ranks(3, 4, &|_| folder.0.clone()) {
        assert_eq!(run.expect("three ranks"), (2, whole.clone()));
    }
    let other = Folder::new("ranks-elsewhere");
    until(1, &other.0, &settings).expect("one process");
    for run in on_ranks(2, 4, &|rank| [&folder, &other][rank].0.clone()) {
        let error = run.expect_err("different ones").to_string();
        assert!(error.contains("a folder that all of them see"), "{error}");
    }
    // what rank 0 alone cannot do ends the others, too: a folder that is a file, a checkpoint that is a folder
    std::fs::create_dir_all(&other.0).expect("folder");
    let file = other.0.join("file");
    std::fs::write(&file, "").expect("file");
    let taken = Folder::new("ranks-taken");
    std::fs::create_dir_all(taken.0.join("step-00000001.state").join("full")).expect("folder");
    let on_taken = |_: usize| taken.0.clone();
    let on_file = |_: usize| file.clone();
    let cases: [(&(dyn Fn(usize) -> PathBuf + Sync), &str); 2] =
        [(&on_file, "file"), (&on_taken, "step-00000001.state")];
    for (folder, named) in cases {
        let mut runs = on_ranks(2, 4, folder).into_iter();
        let [first, second] =
            [runs.next(), runs.next()].map(|run| run.expect("a rank").expect_err("refused").to_string());
        assert!(first.contains(named), "{first}");
        assert!(second.contains("rank 0 failed") || second.contains(named), "{second}");
    }
}

/// Every third step and the last; the last also where the observer stops, and no step that it failed at.
#[test]
fn checkpoints_are_stored_every_few_steps_and_at_the_end() {
    let folder = Folder::new("every");
    let mut whole = rough();
    let mut seen = Vec::new();
    let mut look = |_: &StepResult| {
        seen.push(if folder.0.exists() { folder.names() } else { Vec::new() });
        Flow::Continue
    };
    let _ = whole.run_or_resume(&folder.0, 3, &mut look).expect("run");
    assert_eq!(seen[..3], [Vec::<String>::new(), Vec::new(), Vec::new()]);
    assert_eq!(seen[3], ["step-00000003.state"]);
    assert_eq!(folder.names(), ["step-00000003.state", "step-00000004.state"]);

    let folder = Folder::new("fails");
    let mut simulation = rough();
    let mut fails = |result: &StepResult| match result.step() {
        2 => Flow::from(Err::<(), _>("full disk")),
        _ => Flow::Continue,
    };
    let error = simulation.run_or_resume(&folder.0, 1, &mut fails).expect_err("full");
    assert!(error.to_string().contains("full disk"), "{error}");
    assert_eq!(folder.names(), ["step-00000001.state", "step-00000002.state"]);
    // the same simulation goes back to what is stored, and the observer is told of the step again
    let mut steps = Vec::new();
    let mut look = |result: &StepResult| {
        steps.push(result.step());
        Flow::Continue
    };
    let _ = simulation.run_or_resume(&folder.0, 1, &mut look).expect("run");
    assert_eq!(steps, [2, 3]);
    assert_same_end(&simulation);

    let error = rough().run_or_resume(&folder.0, 0, &mut Silent).expect_err("zero");
    assert!(error.to_string().contains("every = 0"), "{error}");
}

#[test]
fn a_damaged_newest_checkpoint_gives_way_to_the_one_before() {
    let cut: fn(&mut Vec<u8>) = |bytes| bytes.truncate(bytes.len() / 2);
    let flipped: fn(&mut Vec<u8>) = |bytes| {
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
    };
    for (name, damage) in [("cut", cut), ("flipped", flipped), ("empty", Vec::clear)] {
        let folder = Folder::new(name);
        let _ = run_until(3, &folder.0).expect("first");
        // what a kill leaves while a file is written is none
        std::fs::write(folder.0.join("step-00000004.state.tmp"), [1, 2]).expect("write");
        folder.change("step-00000003.state", damage);
        let (second, report) = run_until(4, &folder.0).expect("second");
        assert_eq!(report.steps, 2, "{name}");
        let Warning::DamagedCheckpoint { path, reason, taken } = &report.warnings()[0] else {
            panic!("{name}: {:?}", report.warnings());
        };
        assert!(
            path.ends_with("step-00000003.state.damaged") && path.exists(),
            "{}",
            path.display()
        );
        assert!(
            taken.ends_with("step-00000002.state") && reason.contains("damaged"),
            "{reason}"
        );
        assert!(report.warnings()[0].to_string().contains("the one before"));
        assert_same_end(&second);
        let (_, report) = run_until(4, &folder.0).expect("third");
        assert!(
            !report
                .warnings()
                .iter()
                .any(|w| matches!(w, Warning::DamagedCheckpoint { .. }))
        );
    }
}

#[test]
fn checkpoints_that_cannot_be_used_are_named_and_left() {
    let folder = Folder::new("both");
    let _ = run_until(3, &folder.0).expect("first");
    folder.change("step-00000003.state", Vec::clear);
    folder.change("step-00000002.state", |bytes| bytes[20] ^= 4);
    let error = run_until(4, &folder.0).map(|_| ()).expect_err("damaged").to_string();
    for word in [
        "step-00000003.state: ",
        "step-00000002.state: ",
        "none of those",
        "start anew",
    ] {
        assert!(error.contains(word), "{error}");
    }
    assert_eq!(folder.names(), ["step-00000002.state", "step-00000003.state"]);

    // another scene: twice as many boxes
    let folder = Folder::new("foreign");
    let other = rough().scene().clone().with_boxes([6, 1, 1]);
    let mut other = Simulation::new(other, Settings::default()).expect("set-up");
    let mut stop = |_: &StepResult| Flow::Stop;
    let _ = other.run_or_resume(&folder.0, 1, &mut stop).expect("run");
    let error = run_until(4, &folder.0).map(|_| ()).expect_err("foreign").to_string();
    for word in ["step-00000001.state", "another scene", "a folder of its own"] {
        assert!(error.contains(word), "{error}");
    }
    assert_eq!(folder.names(), ["step-00000001.state"]);
}

/// Reading what is not there asks for no room.
#[test]
fn a_state_that_is_not_there_is_looked_for() {
    let folder = Folder::new("none");
    let text = State::load(folder.0.join("one.state"))
        .map(|_| ())
        .expect_err("none")
        .to_string();
    assert!(
        text.contains("one.state") && text.contains("path") && !text.contains("room"),
        "{text}"
    );
}

/// The third checkpoint finds a full disk (a device that takes no byte): an error with file and remedy, those before
/// stay, and the run goes on from them once there is room.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_the_checkpoints_before() {
    let folder = Folder::new("full");
    std::fs::create_dir_all(&folder.0).expect("folder");
    let full = folder.0.join("step-00000003.state.tmp");
    std::os::unix::fs::symlink("/dev/full", full).expect("a full disk");
    let error = run_until(4, &folder.0).map(|_| ()).expect_err("no room");
    let text = error.to_string();
    for word in ["step-00000003.state", "No space left", "make room"] {
        assert!(text.contains(word), "{text}");
    }
    assert_eq!(folder.names(), ["step-00000001.state", "step-00000002.state"]);
    let (second, report) = run_until(4, &folder.0).expect("room again");
    assert_eq!(report.steps, 2);
    assert_same_end(&second);
}

/// A flag that is set ends the run after the step, with its checkpoint, and the report says so.
#[test]
fn a_flag_ends_the_run_after_the_step() {
    let folder = Folder::new("flag");
    let stop = Arc::new(AtomicBool::new(false));
    let mut simulation = rough();
    let mut asked = |result: &StepResult| {
        stop.store(result.step() == 1, Ordering::Relaxed);
        Flow::Continue
    };
    let report = simulation.run_or_resume(&folder.0, 3, &mut (&mut asked, stop.clone()));
    let report = report.expect("run");
    assert!(report.stopped && report.steps == 2);
    assert_eq!(folder.names(), ["step-00000002.state"]);
    stop.store(false, Ordering::Relaxed);
    let report = simulation.run_or_resume(&folder.0, 3, &mut stop.clone()).expect("run");
    assert!(!report.stopped && report.steps == 2);
    assert_same_end(&simulation);
    // a stop after the last step has stopped nothing
    let mut last = |result: &StepResult| if result.step() == 3 { Flow::Stop } else { Flow::Continue };
    assert!(!rough().run(&mut last).expect("run").stopped);
}

#[test]
fn checkpoints_are_stored_by_time() {
    let stored = |every: Every| {
        let folder = Folder::new(&format!("time-{every:?}").replace(' ', ""));
        let mut seen = 0;
        let mut look = |_: &StepResult| {
            seen += folder.names().len();
            Flow::Continue
        };
        let _ = rough().run_or_resume(&folder.0, every, &mut look).expect("run");
        assert_eq!(folder.names().last().map(String::as_str), Some("step-00000004.state"));
        seen
    };
    // before the steps there are 0, 1, 2 and 2 files; by the hour there is none before the end
    assert_eq!(stored(Duration::ZERO.into()), 5);
    assert_eq!(stored(Duration::from_secs(3600).into()), 0);
}

/// Halved steps are resumed between the user's times only, with the same bits, from bytes as well.
#[test]
fn halved_steps_go_on_from_a_folder() {
    let few = signorini_qp::ActiveSetSettings::default().with_max_products(12);
    let settings = Settings::default()
        .with_method(Method::ActiveSet(few))
        .with_max_fallback_products(1)
        .with_step_halving(4);
    let new = || simulation(&Friction::coulomb(0.3), &settings);
    let mut whole = new();
    let report = whole.run(&mut Silent).expect("run");
    assert!(report.counters.halvings > 0);
    let folder = Folder::new("halved");
    for _ in 0..4 {
        let _ = new()
            .run_or_resume(&folder.0, 1, &mut |_: &StepResult| Flow::Stop)
            .expect("run");
    }
    let mut again = new();
    let _ = again.run_or_resume(&folder.0, 1, &mut Silent).expect("run");
    assert!(again.state() == whole.state());
}

/// The bytes with another payload and the checksum that belongs to it.
fn resealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let sum = bytes[12..].iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    bytes[4..12].copy_from_slice(&sum.to_le_bytes());
    bytes
}

/// Bytes made on purpose, which the checksum does not find: lengths beyond all bounds, numbers that are none, cuts. An
/// answer, no memory for what is not there, and what can be read is refused or can be gone on from.
#[test]
fn made_up_bytes_are_refused_or_harmless() {
    let mut simulation = rough();
    let _ = simulation.step().expect("step");
    let whole = simulation.state().to_bytes().expect("encode");
    let mut good = 0;
    let mut try_one = |bytes: Vec<u8>, what: &str| {
        let bytes = resealed(bytes);
        let mut state = None;
        let used = measure(|| state = Some(State::from_bytes(&bytes)));
        // postcard believes a length up to a megabyte before the numbers come
        let most = 16 * 1024 * 1024 + 16 * bytes.len() as u64;
        assert!(used.bytes_max < most, "{what}: {} bytes", used.bytes_max);
        if let Some(Ok(state)) = state {
            good += 1;
            if let Err(error) = simulation.resume(state) {
                assert!(matches!(error, ContactError::Checkpoint { .. }), "{what}: {error}");
            }
        }
    };
    for at in 12..whole.len() {
        for new in [0x00, 0x01, 0x7f, 0x80, 0xff] {
            let mut bytes = whole.clone();
            bytes[at] = new;
            try_one(bytes, "one byte");
        }
        if at % 7 == 0 {
            // a length of 2^63 in the encoding of postcard, in the place of what is there, and between
            let long = [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f];
            let mut bytes = whole.clone();
            bytes.splice(at..(at + 9).min(whole.len()), long);
            try_one(bytes, "long");
            let mut bytes = whole.clone();
            bytes.splice(at..at, long);
            try_one(bytes, "longer");
            try_one(whole[..at].to_vec(), "cut");
        }
    }
    assert!(good > 100, "{good}");
}
