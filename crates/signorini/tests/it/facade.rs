//! A program that knows the facade only.

use signorini::prelude::*;
use signorini::qp::{ProductSet, QpError, Segment};

fn scene(levels: usize) -> Result<Scene, Error> {
    let mesh = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build()?;
    let steel = Hooke::isotropic(211.9e9, 0.277)?;
    Ok(Scene::new(mesh, Materials::uniform(steel))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]).with_history(History::ramp(1.0, 1.0)?))
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(0.1)
                .with_friction(Friction::coulomb(0.3)),
        )
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, levels)))
}

#[derive(Default)]
struct Diary {
    started: Option<usize>,
    times: Vec<f64>,
    finished: Option<usize>,
    stop_after: Option<usize>,
}

impl Observer for Diary {
    fn started(&mut self, _plan: &Plan, levels: usize) {
        self.started = Some(levels);
    }

    fn step(&mut self, frame: &StepResult) -> Flow {
        assert!(frame.certificate().largest() <= 1e-6);
        self.times.push(frame.time());
        if self.stop_after == Some(self.times.len()) { Flow::Stop } else { Flow::Continue }
    }

    fn finished(&mut self, levels: usize) {
        self.finished = Some(levels);
    }
}

#[test]
fn an_observer_sees_every_level_and_may_stop_the_run() -> Result<(), Error> {
    let mut simulation = Simulation::new(scene(4)?, Settings::default())?;
    let mut diary = Diary {
        stop_after: Some(2),
        ..Diary::default()
    };
    simulation.run(&mut diary)?.require_converged()?;
    assert_eq!((diary.started, diary.finished), (Some(4), Some(2)));
    assert!(!simulation.is_finished());
    let mut rest = Diary::default();
    simulation.run(&mut rest)?.require_converged()?;
    assert_eq!((rest.started, rest.finished), (Some(2), Some(2)));
    diary.times.extend(rest.times);
    assert_eq!(diary.times, [0.25, 0.5, 0.75, 1.0]);
    assert!(simulation.is_finished());
    Ok(())
}

#[test]
fn a_closure_is_an_observer() -> Result<(), Error> {
    let mut simulation = Simulation::new(scene(3)?, Settings::default())?;
    let mut touching = Vec::new();
    let report = simulation.run(&mut |frame: &StepResult| {
        touching.push(frame.summary().active);
        Flow::Continue
    })?;
    assert!(report.converged() && report.steps == 3);
    assert_eq!(touching.len(), 3);
    assert!(touching.last() > Some(&0));
    Ok(())
}

/// Lists and pairs of observers, owned or lent, are observers: all are told, and one that stops is enough.
#[test]
fn observers_compose() -> Result<(), Error> {
    let mut simulation = Simulation::new(scene(3)?, Settings::default())?;
    let (mut first, mut second) = (0, 0);
    let mut stop = |result: &StepResult| {
        first += 1;
        if result.step() == 1 { Flow::Stop } else { Flow::Continue }
    };
    let mut count = |_: &StepResult| {
        second += 1;
        Flow::Continue
    };
    let owned: Box<dyn Observer> = Box::new(Silent);
    let lent: Vec<&mut dyn Observer> = vec![&mut stop, &mut count];
    let report = simulation.run(&mut (owned, lent))?;
    assert!(report.stopped && report.steps == 2);
    assert_eq!((first, second), (2, 2));
    Ok(())
}

#[test]
fn an_observer_that_fails_ends_the_run_with_its_error() -> Result<(), Error> {
    let mut simulation = Simulation::new(scene(3)?, Settings::default())?;
    let mut room = 1;
    let outcome = simulation.run(&mut |_: &StepResult| {
        room -= 1;
        Flow::from(if room < 0 { Err(std::io::Error::other("the disk is full")) } else { Ok(()) })
    });
    let Err(error @ ContactError::Observer { step: 1, .. }) = outcome else {
        panic!("an error is expected, not {outcome:?}");
    };
    assert_eq!(error.to_string(), "observer, after step 1: the disk is full");
    assert_eq!(simulation.state().step(), 2);
    simulation.run(&mut Silent)?.require_converged()?;
    assert!(simulation.is_finished());
    Ok(())
}

/// What a `main` that returns the error prints: the sentence, and what its sources add.
#[test]
fn errors_print_their_sentences() -> Result<(), Error> {
    #[derive(Debug)]
    struct Outer(std::io::Error);
    impl std::fmt::Display for Outer {
        fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("no frame was kept")
        }
    }
    impl std::error::Error for Outer {
        fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
            Some(&self.0)
        }
    }
    let mut simulation = Simulation::new(scene(1)?, Settings::default())?;
    let full = || Outer(std::io::Error::other("the disk is full"));
    let outcome = simulation.run(&mut |_: &StepResult| Flow::from(Err::<(), _>(full())));
    let error = Error::from(outcome.expect_err("an observer that fails"));
    assert_eq!(
        format!("{error:?}"),
        "observer, after step 0: no frame was kept: the disk is full"
    );
    let io = Error::from(std::io::Error::other("the disk is full"));
    assert_eq!(format!("{io:?}"), "the disk is full");
    Ok(())
}

/// Errors that tell what is inside them do not give it as their source again, so that reports of chains repeat nothing.
#[test]
fn no_source_repeats_what_is_told() -> Result<(), Error> {
    let io = || std::io::Error::other("the disk is full");
    let fallen = || ContactError::UnconvergedHistory { step: 1 };
    let observed = ContactError::Observer {
        step: 0,
        source: fallen().into(),
    };
    let named = ContactError::Named {
        names: "contact 0 is the floor".to_owned(),
        source: Box::new(observed),
    };
    let loaded = scene(1)?.with_load(Load::pressure(FacetTag(99), 1.0));
    let far = Brick::new([f64::MAX; 3], [1; 3]).build().expect_err("no volume");
    let segment = Segment::Discs { radii: vec![-1.0] };
    for (error, inner) in [
        (Error::from(io()), io().to_string()),
        (Error::from(named), fallen().to_string()),
        (
            Simulation::new(loaded, Settings::default()).expect_err("no tag").into(),
            "tag 99".to_owned(),
        ),
        (Error::from(far), "brick: ".to_owned()),
        (
            QpError::from(ProductSet::new(vec![segment]).expect_err("a radius")).into(),
            "radius -1".to_owned(),
        ),
    ] {
        let text = error.to_string();
        assert!(text.contains(&inner), "{text}");
        assert!(std::error::Error::source(&error).is_none(), "{text}");
    }
    Ok(())
}

#[test]
fn a_frame_gives_stress_energy_and_states() -> Result<(), Error> {
    let mut simulation = Simulation::new(scene(1)?, Settings::default())?;
    let nodes = simulation.scene().mesh().points().len();
    let elements = simulation.scene().mesh().tets().len();
    let frame = simulation.step()?;
    assert_eq!(frame.displacement().len(), nodes);
    assert_eq!(frame.stress().len(), elements);
    // one step from rest: twice the energy is the work of all forces on the displacements; facets of a brick are equal
    let (energy, points, u) = (frame.strain_energy(), frame.points(), frame.displacement());
    let facets = frame.scene().mesh().facets().iter();
    let top: Vec<_> = facets.filter(|f| f.tag == brick::Z_MAX).collect();
    let down: f64 = top.iter().flat_map(|f| f.nodes).map(|n| u[n as usize][2]).sum();
    let load = -3e9 * 3.0 * down / (3 * top.len()) as f64;
    let along = |p: &PointState| (0..3).map(|c| p.force()[c] * u[p.node as usize][c]).sum::<f64>();
    let work = load + points.iter().map(along).sum::<f64>();
    assert!((work / (2.0 * energy) - 1.0).abs() < 1e-6, "{work:e} {energy:e}");
    let pressing = points.iter().filter(|p| p.state != ContactState::Open).count();
    assert_eq!(pressing, frame.summary().active);
    assert!(energy > 0.0 && pressing > 0);
    Ok(())
}

#[test]
fn the_plan_is_a_table_of_effects() -> Result<(), Error> {
    let plan = Plan::new(&scene(4)?, &Settings::default())?;
    let text = plan.to_string();
    for part in ["Coulomb", "gaps 1.000e-1 to 1.000e-1", "4 steps", "active-set"] {
        assert!(text.contains(part), "'{part}' is not in\n{text}");
    }
    Ok(())
}

#[test]
fn a_scene_tells_what_it_was_made_of() -> Result<(), Error> {
    let pull = History::ramp(2.0, 1.0)?;
    let scene = scene(2)?
        .with_support(Support::components(vec![3, 5], [true, false, false]).with_motion([1e-3, 0.0, 0.0], pull.clone()))
        .with_load(Load::body([0.0, 0.0, -1.0]).with_history(pull.clone()));
    let [clamp, moved] = scene.supports() else {
        panic!("two supports")
    };
    assert_eq!(clamp.place(), &Place::Tag(brick::X_MIN));
    assert_eq!(clamp.directions(), &Directions::All);
    assert!(clamp.motion().is_none());
    assert_eq!(moved.place(), &Place::Nodes(vec![3, 5]));
    assert_eq!(moved.directions().vectors(), [[1.0, 0.0, 0.0]]);
    assert_eq!(moved.motion(), Some((&[[1e-3, 0.0, 0.0]][..], &pull)));
    let [_, weight] = scene.loads() else {
        panic!("two loads")
    };
    assert!(matches!(weight.density(), Some(LoadDensity::Body([_, _, z])) if *z == -1.0));
    assert_eq!(weight.history(), &pull);
    assert_eq!(scene.partition(), &Partition::Boxes([3, 1, 1]));
    let contact = scene.contacts().first().expect("contact");
    assert_eq!(contact.tags(), [brick::Z_MIN]);
    Ok(())
}
