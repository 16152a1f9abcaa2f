//! Supports that start, and random stages.

use crate::common::*;
use signorini_qp::active_set::ActiveSetSettings;
use signorini_tfeti::internal::on_ranks;

/// A block on a floor, held at one side, pulled until time 2; its top may be clamped where it is.
fn grabbed(clamps: Vec<Support>, friction: Friction) -> Scene {
    let hat = History::table(vec![(0.0, 0.0), (2.0, 1.0), (3.0, 0.0)]).expect("table");
    let scene = Scene::new(block([2.0, 1.0, 1.0], [6, 3, 3]), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [4e7, 1e7, -1e8]).with_history(hat))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(4.0, 4));
    clamps.into_iter().fold(scene, Scene::with_support)
}

fn top(scene: &Scene, u: &[f64]) -> Vec<f64> {
    let nodes = scene.mesh().nodes_on(brick::Z_MAX).into_iter();
    nodes.flat_map(|n| [0, 1, 2].map(|c| u[3 * n as usize + c])).collect()
}

/// A support that starts holds its nodes where they are, or takes them back; the force that is taken away is its
/// reaction.
#[test]
fn a_support_that_starts_holds_nodes_where_they_are() {
    let clamp = || Support::fixed(brick::Z_MAX).with_start(2.0);
    let (simulation, held) = run(grabbed(vec![clamp()], Friction::None), tight());
    let scene = simulation.scene();
    let places = |k: usize| top(scene, &held[k].displacement);
    assert!(norm(&places(1)) > 1e-4);
    assert_close(&places(2), &places(1), 1e-9, "step 2");
    assert_close(&places(3), &places(1), 1e-9, "step 3");
    // nothing moves: the contact forces stay, and the reaction is the load that is gone
    assert_close(&forces(&held[3].points), &forces(&held[1].points), 1e-6, "forces");
    let result = simulation.result().expect("steps");
    // an edge of one of twelve parts of the top is the other support's
    let found = result.reactions().supports[1].resultant.force.map(|f| f * 12.0 / 11.0);
    assert_close(&found, &[8e7, 2e7, -2e8], 1e-6, "reaction");
    // back to rest, and to a place that is known: as if the support had always been there
    let line = |from, to| History::table(vec![(2.0, from), (4.0, to)]).expect("table");
    let (_, back) = run(
        grabbed(vec![clamp().with_fading(line(1.0, 0.0))], Friction::None),
        tight(),
    );
    let half: Vec<f64> = places(1).iter().map(|u| 0.5 * u).collect();
    assert_close(&top(scene, &back[2].displacement), &half, 1e-9, "half way");
    assert!(norm(&top(scene, &back[3].displacement)) < 1e-12);
    let to = [1e-4, 0.0, -3e-4];
    let moved = clamp().with_fading(line(1.0, 0.0)).with_motion(to, line(0.0, 1.0));
    let (_, moved) = run(grabbed(vec![moved], Friction::None), tight());
    // the clamped end keeps its nodes
    let mut free = scene.mesh().nodes_on(brick::Z_MAX);
    free.retain(|&n| scene.mesh().points()[n as usize][0] > 0.0);
    let always = Support::fixed(free).with_motion(to, History::constant(1.0));
    let (_, always) = run(grabbed(vec![always], Friction::None), tight());
    let off = relative_distance(scene, &moved[3].displacement, &always[3].displacement);
    assert!(off < 1e-7, "{off:e}");
}

/// The normal of a roller that starts differs from that of one before by rounding of the mesh: the plane stays free.
#[test]
fn a_roller_on_the_plane_of_another_holds_nothing_more() {
    let roller = |tilt: f64| Support::partial(brick::X_MAX, Directions::Vectors(vec![[tilt, 0.0, 1.0]]));
    let both = vec![roller(0.0), roller(1e-6).with_start(2.0)];
    let (_, results) = run(grabbed(both, Friction::None), tight());
    let [loaded, back] = [1, 3].map(|k: usize| norm(&results[k].displacement));
    assert!(loaded > 1e-4 && back < 1e-9 * loaded, "{loaded:e} {back:e}");
}

/// Supports on the same nodes keep their directions where one of them starts later: nodes stay on an inclined plane,
/// and move along z, or x, by what is told. They moved by the half.
#[test]
fn oblique_supports_that_start_keep_their_directions() {
    let way = 1e-4;
    let line = History::table(vec![(2.0, 0.0), (4.0, 1.0)]).expect("table");
    let incline = || Support::partial(brick::X_MAX, Directions::Vectors(vec![[1.0, 0.0, 1.0]]));
    let moved = |c: usize, by: f64| {
        let own = [0, 1, 2].map(|k| k == c);
        Support::components(brick::X_MAX, own).with_motion(own.map(|on| if on { by } else { 0.0 }), line.clone())
    };
    for (clamps, along, way) in [
        (vec![incline(), moved(2, way).with_start(2.0)], 2, way),
        (vec![moved(2, way).with_start(2.0), incline()], 2, way),
        (vec![incline().with_start(2.0), moved(0, -way)], 0, -way),
    ] {
        let (simulation, steps) = run(grabbed(clamps, Friction::None), tight());
        let size = norm(&steps[1].displacement);
        for node in simulation.scene().mesh().nodes_on(brick::X_MAX) {
            let at = |k: usize, c: usize| steps[k].displacement[3 * node as usize + c];
            for k in [2, 3] {
                let slid = at(k, along) - at(1, along) - way * line.value(steps[k].time);
                let lifted = at(k, 0) + at(k, 2) - at(1, 0) - at(1, 2);
                assert!(
                    slid.abs() < 1e-8 * size && lifted.abs() < 1e-8 * size,
                    "{slid:e} {lifted:e}"
                );
            }
        }
    }
}

/// Supports that start one after another, end, and share nodes with others that move, touch or are held for longer.
#[test]
fn supports_share_nodes_with_those_before() {
    let sides = |start: f64| {
        vec![
            // nodes of the clamped end and of contact points among them
            Support::fixed(brick::Y_MIN).with_start(start),
            Support::components(brick::Z_MIN, [false, false, true]).with_start(start + 1.0),
            Support::components(brick::Y_MIN, [false, true, true])
                .with_start(start)
                .with_end(start + 1.0),
        ]
    };
    for friction in [Friction::None, Friction::coulomb(0.3)] {
        let scene = grabbed(sides(1.0), friction);
        let (simulation, steps) = run(scene.clone(), tight());
        let mesh = simulation.scene().mesh();
        let at = |k: usize, tag: FacetTag, c: usize| -> Vec<f64> {
            let nodes = mesh.nodes_on(tag).into_iter();
            nodes.map(|n| steps[k].displacement[3 * n as usize + c]).collect()
        };
        for c in 0..3 {
            assert!((0..4).all(|k| norm(&at(k, brick::X_MIN, c)) < 1e-12));
            for k in [1, 2, 3] {
                assert_close(&at(k, brick::Y_MIN, c), &at(0, brick::Y_MIN, c), 1e-9, "side");
            }
        }
        let (floor, before) = (at(3, brick::Z_MIN, 2), at(1, brick::Z_MIN, 2));
        assert!(floor.iter().zip(before).all(|(a, b)| (a - b).abs() < 1e-12), "floor");
        assert!(norm(&simulation.result().expect("steps").reactions().imbalance().force) < 1.0);
        // the same from states, and on two ranks
        let last = bits(&steps[3]);
        let mut whole = Simulation::new(scene.clone(), tight()).expect("set-up");
        for k in 0..4 {
            let mut resumed = Simulation::new(scene.clone(), tight()).expect("set-up");
            resumed.resume(whole.state().clone()).expect("its state");
            assert!(
                bits(&rest(&mut resumed).pop().expect("steps")) == last,
                "after step {k}"
            );
            let _ = step(&mut whole);
        }
        let run = |settings: Settings| {
            let settings = settings.with_share_translates(false);
            rest(&mut Simulation::new(scene.clone(), settings).expect("set-up"))
                .iter()
                .map(bits)
                .collect::<Vec<_>>()
        };
        let alone = run(tight());
        for rank in on_ranks(2, |c| run(tight().with_communicator(c))) {
            assert!(rank.expect("no panic") == alone);
        }
    }
}

/// A place that a support would take its nodes to inside an obstacle is refused as soon as it is known.
#[test]
fn nodes_are_not_taken_into_obstacles() {
    let down = |way: f64| {
        let line = History::table(vec![(3.0, 0.0), (4.0, 1.0)]).expect("table");
        let support = Support::components(brick::Z_MIN, [false, false, true]).with_start(2.0);
        grabbed(vec![support.with_motion([0.0, 0.0, way], line)], Friction::None)
    };
    let mut simulation = Simulation::new(down(-1e-5), Settings::default()).expect("set-up");
    let _ = [step(&mut simulation), step(&mut simulation)];
    let state = simulation.state().clone();
    let error = simulation.step().map(drop).expect_err("inside");
    assert!(
        matches!(error, ContactError::SupportInObstacle { time: 4.0, .. }),
        "{error}"
    );
    assert!(*simulation.state() == state);
    let (_, up) = run(down(1e-5), at(1e-8));
    assert!(up[3].points.is_empty());
}

/// Without friction each step is a static scene of what acts in it: supports, obstacles and ties with random spans.
#[test]
fn random_stages_are_scenes_of_their_own() {
    let mut rng = random(7);
    for round in 0..24 {
        let order = rng.random_range(1..3);
        let own = block([2.0, 1.0, 1.0], [4, 2, 2]);
        let other = block([2.0, 1.0, 1.0], [[4, 2, 2], [3, 3, 2]][rng.random_range(0..2)]);
        let both = with_second(&own, &lifted(&other, 1.0));
        let mesh = if order == 2 { both.raise_order().expect("mid-nodes") } else { both };
        let mut span = || {
            let [a, b] = [0, 1].map(|_| f64::from(rng.random_range(0..5)));
            [a.min(b), a.max(b) + 1.0]
        };
        let spans: Vec<[f64; 2]> = (0..6).map(|_| span()).collect();
        let push = [(); 3].map(|()| 1e7 * rng.random_range(-1.0..1.0));
        let history = History::table((0..6).map(|k| (f64::from(k), rng.random_range(-1.0..1.0))).collect());
        let history = history.expect("table");
        let faces = [brick::X_MAX, brick::Y_MIN, second(brick::Z_MAX), second(brick::X_MAX)];
        let held: Vec<[bool; 3]> = faces.iter().map(|_| [(); 3].map(|()| rng.random_bool(0.6))).collect();
        // at one time only what acts then, or all with their spans
        let scene = |time: Option<f64>| {
            let acts = |span: &[f64; 2]| time.is_none_or(|t| span[0] < t && t <= span[1]);
            let mut scene = Scene::new(mesh.clone(), steel())
                .with_support(Support::fixed(brick::X_MIN))
                .with_support(Support::fixed(second(brick::X_MIN)))
                .with_load(Load::traction(brick::Z_MAX, push).with_history(history.clone()))
                .with_load(Load::traction(second(brick::Z_MAX), push.map(|f| -f)).with_history(history.clone()))
                .with_analysis(match time {
                    Some(time) => Analysis::Static { time },
                    None => Analysis::quasistatic(5.0, 5),
                });
            for ((face, held), span) in faces.iter().zip(&held).zip(&spans) {
                if held.contains(&true) && acts(span) {
                    let support = Support::components(*face, *held);
                    // back where they were at rest, at once
                    let fading = History::constant(0.0);
                    scene = scene.with_support(match time {
                        Some(_) => support,
                        None => support.with_start(span[0]).with_end(span[1]).with_fading(fading),
                    });
                }
            }
            let between = match round % 3 {
                0 => Contact::tied(brick::Z_MAX, second(brick::Z_MIN)),
                _ => Contact::between(brick::Z_MAX, second(brick::Z_MIN)),
            };
            let floor = Contact::rigid(brick::Z_MIN).with_gap(1e-6);
            for (contact, span) in [floor, between].into_iter().zip(&spans[4..]) {
                if acts(span) {
                    scene = scene.with_contact(match time {
                        Some(_) => contact,
                        None => contact.with_start(span[0]).with_end(span[1]),
                    });
                }
            }
            scene
        };
        let (simulation, steps) = run(scene(None), at(1e-8));
        for (k, found) in steps.iter().enumerate() {
            let (_, alone) = run(scene(Some((k + 1) as f64)), at(1e-8));
            let off = relative_distance(simulation.scene(), &found.displacement, &alone[0].displacement);
            assert!(off < 1e-5, "round {round}, step {k}: {off:e}");
        }
    }
}

/// Equations and supports that start say the same of nodes as well as a solve does; they were contradictions.
#[test]
fn supports_start_on_nodes_of_equations() {
    let mesh = || block([2.0, 1.0, 1.0], [4, 2, 2]);
    let node = |point: [f64; 3]| mesh().points().iter().position(|p| *p == point).expect("node") as u32;
    let (corner, other) = (node([2.0, 0.0, 1.0]), node([2.0, 1.0, 1.0]));
    let equal = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|d| {
        let back = d.map(|v: f64| -v);
        Equation::new([(corner, d), (other, back)])
    });
    let one = [Equation::new([(corner, [0.0, 1.0, 0.0])])];
    for equations in [&one[..], &equal] {
        for (settings, most) in [(Settings::default(), 1e-6), (tight(), 1e-9), (at(1e-3), 1e-3)] {
            let scene = Scene::new(mesh(), steel())
                .with_support(Support::fixed(brick::X_MIN))
                .with_support(Support::fixed([corner, other]).with_start(1.0))
                .with_load(Load::traction(brick::Z_MAX, [0.0, 2e7, -1e8]).with_history(ramp()))
                .with_analysis(Analysis::quasistatic(2.0, 2));
            let scene = equations.iter().cloned().fold(scene, Scene::with_equation);
            let mut simulation = Simulation::new(scene, settings).expect("set-up");
            let mut place = || {
                let result = step(&mut simulation);
                assert!(result.report.status.converged());
                [0, 1, 2].map(|c| result.displacement[3 * corner as usize + c])
            };
            let [before, held] = [place(), place()];
            assert_close(&held, &before, most, "place");
        }
    }
}

/// Where a step that failed has left nodes is history where a support holds them later.
#[test]
fn places_of_steps_that_failed_are_told() {
    let clamp = || vec![Support::fixed(brick::Z_MAX).with_start(2.0)];
    let few = by(Method::ActiveSet(ActiveSetSettings::default().with_max_products(1)));
    let few = few.with_max_fallback_products(1);
    let mut failed = Simulation::new(grabbed(clamp(), Friction::None), few).expect("set-up");
    let first = step(&mut failed);
    assert!(!first.report.status.converged());
    let mut simulation = Simulation::new(grabbed(clamp(), Friction::None), tight()).expect("set-up");
    simulation.resume(failed.state().clone()).expect("resume");
    let later = [(); 3].map(|()| step(&mut simulation).report.unconverged_history);
    assert_eq!(later, [Some(0); 3]);
}

/// A support that starts may be as deep in an obstacle as it is left, not lead on into it.
#[test]
fn supports_that_start_lead_into_no_obstacle() {
    let into = |depth: f64| {
        let line = History::table(vec![(2.0, 0.0), (4.0, 1.0)]).expect("table");
        let press = Support::components(brick::Z_MIN, [false, false, true]).with_start(2.0);
        let slide = Support::fixed(brick::Z_MAX).with_motion([1e-3, 0.0, 0.0], ramp());
        let scene = Scene::new(block([2.0, 1.0, 1.0], [6, 3, 3]), steel())
            .with_support(slide)
            .with_support(press.with_motion([0.0, 0.0, -depth], line))
            .with_contact(Contact::rigid(brick::Z_MIN))
            .with_analysis(Analysis::quasistatic(4.0, 4));
        let mut simulation = Simulation::new(scene, Settings::default())?;
        (0..4).try_for_each(|_| simulation.step().map(|_| ()))
    };
    into(0.0).expect("no motion");
    let error = into(9e-7).unwrap_err();
    assert!(matches!(error, ContactError::SupportInObstacle { .. }), "{error}");
}

/// As deep as it is left is, beside a clamp, a mean around a corner of quadratic facets, and what presses on a rough
/// surface. They were refused in the middle of the run.
#[test]
fn supports_start_where_contact_has_left_their_nodes() {
    for (quadratic, compliance, friction) in [
        (true, 0.0, 0.0),
        (true, 0.0, 0.3),
        (false, 1e-2, 0.0),
        (false, 1e-2, 0.3),
    ] {
        let mesh = block([2.0, 1.0, 1.0], [2, 1, 1]);
        let mesh = if quadratic { mesh.raise_order().expect("mesh") } else { mesh };
        let floor = Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(friction));
        for side in [brick::X_MAX, brick::Y_MAX] {
            let scene = Scene::new(mesh.clone(), uniform(1.0, 0.3))
                .with_support(Support::fixed(brick::X_MIN))
                .with_support(Support::fixed(side).with_start(2.0))
                .with_load(Load::pressure(brick::Z_MAX, 1e-3).with_history(ramp()))
                .with_contact(floor.clone().with_normal_compliance(compliance))
                .with_analysis(Analysis::quasistatic(4.0, 4));
            let (simulation, results) = run(scene, Settings::default());
            assert_eq!(simulation.plan().dual(), simulation.tfeti().dual_dim());
            let [before, after] = [1, 3].map(|k| results[k].displacement.as_chunks::<3>().0);
            let largest = before.iter().map(|u| norm(u)).fold(0.0, f64::max);
            for node in simulation.scene().mesh().nodes_on(side) {
                let [from, to] = [before, after].map(|u| u[node as usize]);
                let moved = norm(&[0, 1, 2].map(|c| to[c] - from[c])) / largest;
                assert!(moved < 1e-5, "{quadratic}, {compliance}, {friction}: {moved:e}");
            }
        }
    }
}

/// Under a constant load nothing moves where a support starts, though it holds a part of the mean that a contact row
/// takes: of quadratic elements on a floor, and of meshes that do not match.
#[test]
fn supports_that_start_under_a_constant_load_move_nothing() {
    let upper = |cells| block([2.0, 1.0, 1.0], cells);
    let lower = block([2.0, 1.0, 0.5], [5, 3, 1]);
    let lower = lower.map_points(|x| [x[0], x[1], x[2] - 0.5]).expect("moved");
    let lower = lower.map_tags(|tag| FacetTag(tag.0 + 10));
    let pair = upper([4, 2, 2]).append(&lower).expect("bodies");
    let base = FacetTag(brick::Z_MIN.0 + 10);
    let seat = FacetTag(brick::Z_MAX.0 + 10);
    let quadratic = |mesh: &TetMesh| mesh.raise_order().expect("order 2");
    let floor = Contact::rigid(brick::Z_MIN);
    let between = Contact::between(brick::Z_MIN, seat);
    let cases = [
        (quadratic(&upper([2, 1, 1])), floor, false),
        (quadratic(&pair), between.clone(), true),
        (pair, between, true),
    ];
    for (mesh, contact, two) in cases {
        let loaded = History::table(vec![(0.0, 0.0), (1.0, 1.0), (2.0, 1.0)]).expect("table");
        let mut scene = Scene::new(mesh, uniform(1e9, 0.3))
            .with_contact(contact.with_friction(Friction::coulomb(0.3)))
            .with_load(Load::pressure(brick::Z_MAX, 1e6).with_history(loaded.clone()))
            .with_load(Load::force(brick::X_MAX, [2e5, 0.0, 0.0]).with_history(loaded))
            .with_support(Support::fixed(brick::X_MIN).with_start(1.0))
            .with_analysis(Analysis::quasistatic(2.0, 2));
        if two {
            scene = scene.with_support(Support::fixed(base));
            scene = scene.with_support(Support::fixed(FacetTag(brick::X_MIN.0 + 10)).with_start(1.0));
        }
        let (simulation, steps) = run(scene, at(1e-8));
        let order = simulation.scene().mesh().order();
        let [before, after] = [0, 1].map(|k| &steps[k].displacement);
        assert_close(after, before, 1e-7, &format!("order {order}, two bodies {two}"));
        let result = simulation.result().expect("steps");
        let reaction = norm(&result.reactions().supports[0].resultant.force);
        assert!(reaction < 10.0, "{reaction:e}");
    }
}

/// A step is repeated with loads that only its stage holds, as coupled programs do: steps before it are solved, and
/// were judged again with these loads.
#[test]
fn a_stage_is_entered_again_with_its_own_loads() {
    let scene = Scene::new(block([1.0; 3], [2; 3]), steel())
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
        .with_support(Support::fixed(brick::X_MAX).with_start(1.0))
        .with_load(Load::pressure(brick::Z_MAX, 1e6))
        .with_analysis(Analysis::quasistatic(3.0, 3));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let _ = step(&mut simulation);
    let before = simulation.state().clone();
    let loads = || {
        vec![
            Load::pressure(brick::Z_MAX, 1e6),
            Load::force(brick::X_MIN, [-1e6, 0.0, 0.0]),
        ]
    };
    simulation.set_loads(loads()).expect("loads");
    let first = step(&mut simulation);
    simulation.resume(before).expect("the same step");
    assert_eq!(step(&mut simulation).displacement, first.displacement);
}

/// A warning of one stage alone is not taken for one of the whole run where that is resumed in another.
#[test]
fn a_resumed_run_has_the_warnings_of_all_stages() {
    let scene = || {
        Scene::new(block([1.0; 3], [2; 3]), steel())
            .with_support(Support::fixed(brick::Z_MAX))
            .with_contact(Contact::rigid(brick::Z_MIN).with_gap(-1e-5).with_end(1.0))
            .with_analysis(Analysis::quasistatic(3.0, 3))
    };
    let set_up = || Simulation::new(scene(), Settings::default()).expect("set-up");
    let mut simulation = set_up();
    let known = simulation.plan().warnings().to_vec();
    (0..2).for_each(|_| _ = step(&mut simulation));
    let mut resumed = set_up();
    resumed.resume(simulation.state().clone()).expect("its state");
    assert_eq!(resumed.plan().warnings(), known);
}

/// Friction that is stored in elastic slip stays where a support takes away, or gives back, a direction across it.
#[test]
fn elastic_slip_stays_where_supports_start_and_end() {
    // one that ends takes its own forces with it
    for (side, within) in [(Support::with_start as fn(_, _) -> _, 1e-6), (Support::with_end, 0.05)] {
        let across = side(Support::components(brick::Z_MIN, [false, true, false]), 1.0);
        let scene = Scene::new(block([1.0; 3], [2; 3]), uniform(1e9, 0.0))
            .with_contact(
                Contact::rigid(brick::Z_MIN)
                    .with_friction(Friction::coulomb(0.5))
                    .with_tangential_compliance(1e-9),
            )
            .with_support(Support::components(brick::Y_MIN, [false, true, false]))
            .with_support(across)
            .with_load(Load::force(brick::Z_MAX, [2e5, 0.0, -1e6]))
            .with_analysis(Analysis::quasistatic(3.0, 3));
        let (_, results) = run(scene, at(1e-9));
        for later in &results[1..] {
            assert_close(&later.displacement, &results[0].displacement, within, "at rest");
        }
    }
}
