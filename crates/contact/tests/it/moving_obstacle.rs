//! Obstacles that move: a plate drawn from under a block is a block drawn over a plate.

use crate::common::*;

const WAY: f64 = 2e-3;
const PRESSURE: f64 = 1e3;

fn there_and_back() -> History {
    History::table(vec![(0.0, 0.0), (0.5, 1.0), (1.0, -0.5)]).expect("table")
}

fn scene(contact: Contact, top: Support, formula: DifferenceFormula, boxes: [usize; 3]) -> Scene {
    Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e6, 0.3))
        .with_contact(contact)
        .with_support(top)
        .with_load(Load::body([0.0, 0.0, -PRESSURE]))
        .with_boxes(boxes)
        .with_analysis(Analysis::quasistatic(1.0, 6).with_formula(formula))
}

fn floor(friction: Friction) -> Contact {
    Contact::rigid(brick::Z_MIN).with_friction(friction)
}

/// The upper nodes are held along the plane and move freely across it.
fn top() -> Support {
    Support::components(brick::Z_MAX, [true, true, false])
}

fn plate_is_block(law: Friction) {
    let way = [WAY, 0.5 * WAY, 0.0];
    for formula in [DifferenceFormula::BACKWARD_EULER, DifferenceFormula::PAPER] {
        for method in methods() {
            let boxes = [2, 1, 1];
            let plate = floor(law.clone()).with_motion(way.map(|c| -c), there_and_back());
            let moving = scene(plate, top(), formula, boxes);
            let drawn = top().with_motion(way, there_and_back());
            let drawn = scene(floor(law.clone()), drawn, formula, boxes);
            let settings = at(1e-9).with_method(method.clone());
            let (_, a) = run(moving, settings.clone());
            let (_, b) = run(drawn, settings);
            for (a, b) in a.iter().zip(&b) {
                let what = format!("{law:?} {} at {}", method.kind(), a.time);
                let shift = there_and_back().value(a.time);
                let relative: Vec<f64> = b
                    .displacement
                    .iter()
                    .enumerate()
                    .map(|(k, u)| u - shift * way[k % 3])
                    .collect();
                assert_close(&a.displacement, &relative, 1e-5, &what);
                let (x, y) = (forces(&a.points), forces(&b.points));
                assert_close(&x, &y, 1e-5, &what);
                let [p, q] = [a, b].map(|l| l.summary.friction_work);
                assert!((p - q).abs() <= 1e-5 * q.abs().max(1e-3), "{what}: {p} {q}");
                let [p, q] = [a, b].map(|l| l.summary.max_slip_rate);
                assert!((p - q).abs() <= 1e-5 * q.abs().max(1e-6), "{what}: {p} {q}");
                assert_eq!(b.summary.obstacle_work, 0.0);
            }
            let slides = |p: &PointState| p.state == ContactState::Slip;
            assert!(a.iter().any(|l| l.points.iter().any(slides)));
        }
    }
}

#[test]
fn a_plate_under_a_block_is_a_block_over_a_plate_with_coulombs_law() {
    plate_is_block(Friction::coulomb(0.3));
}

#[test]
fn a_plate_under_a_block_is_a_block_over_a_plate_with_trescas_law() {
    plate_is_block(Friction::tresca(200.0));
}

#[test]
fn a_plate_under_a_block_is_a_block_over_a_plate_with_a_coefficient_that_falls() {
    plate_is_block(weakening());
}

/// What the plate does to the block is friction and elastic energy: with implicit steps up to a part that falls with
/// the step.
#[test]
fn the_work_of_the_obstacle_is_stored_or_lost() {
    let miss = |steps: usize| {
        let plate = floor(Friction::coulomb(0.3)).with_motion([WAY, 0.0, 0.0], there_and_back());
        let scene = Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e6, 0.3))
            .with_contact(plate)
            .with_support(Support::fixed(brick::Z_MAX).with_motion([0.0, 0.0, -WAY], ramp()))
            .with_analysis(Analysis::quasistatic(1.0, steps));
        let mesh = scene.mesh().clone();
        let materials = scene.materials().clone();
        let (_, results) = run(scene, at(1e-9));
        let energy = |u: &[f64]| fields::strain_energy(&mesh, &materials, u).expect("energy");
        let mut sum = 0.0;
        let (mut lost, mut dragged, mut before) = (0.0, 0.0, 0.0);
        for result in &results {
            lost += result.summary.friction_work;
            dragged += result.summary.obstacle_work;
            // the top carries what the floor pushes up
            let down = WAY * (result.time - before);
            sum += result.summary.normal_force * down;
            before = result.time;
        }
        assert!(dragged > 0.0 && lost > 0.0);
        let stored = energy(&results[results.len() - 1].displacement);
        (dragged + sum - lost - stored) / dragged
    };
    let (coarse, fine) = (miss(8), miss(32));
    assert!(coarse.abs() < 0.5 && fine.abs() < 0.4 * coarse.abs(), "{coarse} {fine}");
}

/// An obstacle that comes up: the gap closes, then the block is pressed against its support.
#[test]
fn an_obstacle_that_rises_closes_the_gap() {
    let (gap, rise) = (1e-3, 3e-3);
    let scene = Scene::new(block([1.0; 3], [2, 2, 2]), uniform(1e6, 0.0))
        .with_contact(
            floor(Friction::None)
                .with_gap(gap)
                .with_motion([0.0, 0.0, rise], ramp()),
        )
        .with_support(Support::fixed(brick::Z_MAX))
        .with_boxes([1, 1, 2])
        .with_analysis(paper_steps(1.0, 6));
    let (simulation, results) = run(scene, at(1e-9));
    assert!(simulation.plan().effects.moving_obstacle);
    for result in &results {
        let depth = (rise * result.time - gap).max(0.0);
        let force = result.summary.normal_force;
        assert!((force - 1e6 * depth).abs() < 1e-4, "{}: {force}", result.time);
        let open = (gap - rise * result.time).max(0.0);
        for point in &result.points {
            assert!((point.gap - open).abs() < 1e-10);
        }
    }
}

/// Nodes that supports hold still while the plate goes away under them slide.
#[test]
fn nodes_that_are_held_slide_on_a_plate_that_moves() {
    let plate = floor(Friction::coulomb(0.2)).with_motion([0.0, WAY, 0.0], ramp());
    let still = Support::components(brick::Z_MIN, [true, true, false]);
    let scene = scene(plate, still, DifferenceFormula::BACKWARD_EULER, [1, 1, 1]);
    for result in run(scene, at(1e-9)).1 {
        let friction = result.summary.friction_force[1];
        assert!((friction - 0.2 * 2.0 * PRESSURE).abs() < 1e-5, "{friction}");
        assert!((result.summary.obstacle_work - friction * WAY / 6.0).abs() < 1e-9);
    }
}

#[test]
fn obstacles_that_move_are_checked() {
    let refused = |contact: Contact, place: Place| {
        let scene = Scene::new(block([1.0; 3], [2, 2, 2]), uniform(1e6, 0.3))
            .with_contact(contact)
            .with_support(Support::fixed(place))
            .with_analysis(paper_steps(1.0, 4));
        Simulation::new(scene, at(1e-9)).err()
    };
    let up = floor(Friction::None).with_gap(0.1);
    let x = || Place::Tag(brick::X_MIN);
    let inside = refused(up.clone().with_motion([0.0, 0.0, 0.2], ramp()), x());
    assert!(matches!(
        inside,
        Some(ContactError::SupportInObstacle { time, .. }) if (time - 0.75).abs() < 1e-12
    ));
    let bad = refused(up.clone().with_motion([f64::NAN, 0.0, 0.0], ramp()), x());
    assert!(matches!(bad, Some(ContactError::ContactValue { .. })));
    let wild = History::function(|t| 1.0 / (t - 0.5));
    let bad = refused(up.with_motion([0.0, 0.0, -0.1], wild), x());
    assert!(matches!(
        bad,
        Some(ContactError::HistoryValue {
            part: Part::Contact(_),
            ..
        })
    ));
}

/// Traces are relative to the obstacle, and its place follows from the time: a run goes on from a state bit for bit.
#[test]
fn a_run_over_a_moving_plate_continues() {
    let make = || {
        let plate = floor(Friction::coulomb(0.3)).with_motion([WAY, 0.0, 0.0], there_and_back());
        let scene = scene(plate, top(), DifferenceFormula::PAPER, [2, 1, 1]);
        Simulation::new(scene, Settings::default()).expect("set-up")
    };
    let mut whole = make();
    let mut first = make();
    for _ in 0..3 {
        first.step().expect("step");
    }
    let mut second = make();
    second.resume(first.state().clone()).expect("resume");
    let (all, rest) = (rest(&mut whole), rest(&mut second));
    for (a, b) in all[3..].iter().zip(&rest) {
        assert_eq!(bits(a), bits(b));
        assert_eq!(a.summary.obstacle_work, b.summary.obstacle_work);
    }
}

/// A block that friction alone holds between a floor and a plate that comes down: forces grow in proportion, and no
/// step after the first has anything to solve, whether points stick among those that slide or none does.
#[test]
fn what_is_squeezed_in_proportion_is_solved_before_it_starts() {
    let block = |cells| Brick::new([1.5, 1.0, 1.0], cells).perturbed(0.15, 7).build();
    for (cells, boxes, coefficient) in [([6, 4, 4], [1, 1, 1], 0.3), ([9, 6, 6], [3, 2, 2], 0.1)] {
        let rough = |tag| Contact::rigid(tag).with_friction(Friction::coulomb(coefficient));
        let scene = Scene::new(block(cells).expect("mesh"), uniform(1e3, 0.4))
            .with_contact(rough(brick::Z_MIN))
            .with_contact(rough(brick::Z_MAX).with_motion([0.0, 0.0, -0.05], ramp()))
            .with_boxes(boxes)
            .with_analysis(Analysis::quasistatic(1.0, 4));
        let (_, results) = run(scene, Settings::default());
        assert!(results.iter().all(|r| r.summary.slip > 0));
        assert_eq!(results[3].summary.slip < results[3].summary.active, coefficient == 0.3);
        let products: Vec<usize> = results.iter().map(|r| r.report.counters.products).collect();
        assert_eq!(products[1..], [2; 3], "{products:?}");
    }
}

/// A floor without a gap, drawn along and tilted: where it touches the body has its height.
#[test]
fn a_floor_that_is_drawn_and_tilts_is_where_it_stands() {
    let (way, angle, pivot) = (0.1, 0.05, 1.2);
    let floor = floor(Friction::None)
        .with_motion([way, 0.0, 0.0], ramp())
        .with_rotation(
            [pivot, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            History::ramp(1.0, angle).expect("ramp"),
        );
    let scene = Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e6, 0.3))
        .with_contact(floor)
        .with_support(Support::components(brick::Z_MAX, [true, true, false]))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e5]))
        .with_analysis(Analysis::quasistatic(1.0, 2));
    let mesh = scene.mesh().clone();
    let (_, results) = run(scene, at(1e-9));
    for result in &results {
        let (shift, turn) = (way * result.time, angle * result.time);
        let closed = || result.points.iter().filter(|p| p.state != ContactState::Open);
        assert_eq!(closed().count(), 15);
        for node in closed().map(|p| p.node as usize) {
            let height = turn * (pivot + shift - mesh.points()[node][0]);
            let up = result.displacement[3 * node + 2];
            assert!((up - height).abs() <= 1e-9, "{up} {height}");
        }
    }
}

/// A contact that has ended says nothing: its obstacle may go where it turns normals, or is nearer than another one.
#[test]
fn obstacles_of_contacts_that_have_ended_go_anywhere() {
    let line = |values: [f64; 3]| History::table((0..).map(f64::from).zip(values).collect()).expect("table");
    let held = |contacts: Vec<Contact>| {
        let scene = Scene::new(block([1.0; 3], [2, 2, 2]), uniform(1e6, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_analysis(Analysis::quasistatic(2.0, 2));
        contacts.into_iter().fold(scene, Scene::with_contact)
    };
    let ball = Contact::obstacle(brick::Z_MAX, Obstacle::sphere([0.5, 0.5, 11.0], 10.0))
        .with_motion([0.0, 0.0, -1e-3], line([0.0, 1.0, 0.0]))
        .with_motion([5.0, 0.0, 0.0], line([0.0, 0.0, 1.0]));
    let error = refused(&held(vec![ball.clone()]));
    assert!(matches!(error, ContactError::TurnedNormal { time: 2.0, .. }), "{error}");
    let (_, results) = run(held(vec![ball.with_end(1.0)]), at(1e-9));
    assert!(results[0].summary.normal_force > 0.0);
    assert!(norm(&results[1].displacement) < 1e-9 * norm(&results[0].displacement));
    // two ceilings on one side, of which the first comes nearer when it has ended
    let ceiling = |hole: f64| {
        let field = move |place: [f64; 3]| if place[0] < -1.0 { hole } else { 0.1 };
        let ceiling = Contact::rigid(brick::Z_MAX).with_gap_field(field);
        ceiling.with_motion([3.0, 0.0, 0.0], line([0.0, 0.0, 1.0]))
    };
    let both = |first: Contact| held(vec![first, ceiling(0.1)]);
    let error = refused(&both(ceiling(0.0)));
    assert!(matches!(error, ContactError::SharedNode { .. }), "{error}");
    Plan::new(&both(ceiling(0.0).with_end(1.0)), &Settings::default()).expect("ended");
}
