//! Several bodies in one scene: none knows of another, however different their sizes are, but where they share nodes.

use crate::common::*;

const FAR: f64 = 10.0;

/// Tags of the second body.
fn other(tag: FacetTag) -> FacetTag {
    match tag {
        brick::Z_MIN => brick::Z_MIN,
        FacetTag(t) => FacetTag(t + 100),
    }
}

/// The first body: a clamped bar that is pressed on the floor.
fn bar() -> TetMesh {
    block([3.0, 1.0, 1.0], [6, 2, 2])
}

/// The second one: a block that lies on the floor, far from the first.
fn cube() -> TetMesh {
    block([1.0; 3], [3; 3])
        .map_points(|x| [x[0], x[1] + FAR, x[2]])
        .expect("moved")
        .map_tags(other)
}

fn on_the_floor(scene: Scene, friction: Friction) -> Scene {
    let parts = scene.mesh().components();
    scene
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
        .with_parts_as_given(parts)
        .with_analysis(paper_steps(1.0, 3))
}

fn bar_loads(scene: Scene) -> Scene {
    scene
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [2e6, 0.0, -2e7]).with_history(ramp()))
}

/// Loads of the block, times a factor: pressed and pushed, part of the floor slides.
fn cube_loads(scene: Scene, factor: f64) -> Scene {
    let top = other(brick::Z_MAX);
    let load = Load::traction(top, [factor * 2e6, 0.0, -factor * 1e7]);
    scene.with_load(load.with_history(ramp()))
}

fn both(young: f64) -> Scene {
    let bar = bar();
    let mesh = bar.append(&cube()).expect("two bodies");
    let regions = mesh.components();
    let steel = Hooke::isotropic(2e11, 0.3).expect("steel");
    let soft = Hooke::isotropic(young, 0.3).expect("soft");
    let materials = Materials::new(vec![(0, steel), (1, soft)]).expect("two materials");
    Scene::new(mesh.with_regions(regions).expect("regions"), materials)
}

/// Points of the last step that belong to a body, which must be certified.
fn last(scene: Scene, settings: Settings, keep: impl Fn(f64) -> bool, what: &str) -> Vec<PointState> {
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let positions: Vec<f64> = simulation
        .constrained_points()
        .iter()
        .map(|p| p.position()[1])
        .collect();
    let mut points = Vec::new();
    while !simulation.is_finished() {
        let result = step(&mut simulation);
        assert_certified(&result, what);
        points = result.points;
    }
    let kept = points.into_iter().zip(positions).filter(|(_, y)| keep(*y));
    kept.map(|(p, _)| p).collect()
}

fn of_the_bar(y: f64) -> bool {
    y < FAR / 2.0
}

fn of_the_block(y: f64) -> bool {
    y > FAR / 2.0
}

#[test]
fn a_light_body_is_solved_beside_a_heavy_one() {
    let friction = || Friction::coulomb(0.3);
    let alone = last(
        on_the_floor(cube_loads(Scene::new(cube(), uniform(2e11, 0.3)), 1.0), friction()),
        tight(),
        of_the_block,
        "block",
    );
    let bar = last(
        on_the_floor(bar_loads(Scene::new(bar(), uniform(2e11, 0.3))), friction()),
        tight(),
        of_the_bar,
        "bar",
    );
    for (young, factor) in [(2e11, 1e-12), (2e11, 1e-7), (2e11, 1e9), (2e4, 1e-7), (2e18, 1e7)] {
        // steps of the paper's methods are those of the softest body: without a preconditioner stiff ones wait for ever
        let count = if young == 2e11 { 3 } else { 1 };
        for method in methods().into_iter().take(count) {
            let what = format!("E {young:e}, loads times {factor:e}, {}", method.kind());
            let scene = || on_the_floor(cube_loads(bar_loads(both(young)), factor), friction());
            let settings = by(method.clone());
            let points = last(scene(), settings.clone(), of_the_block, &what);
            let scaled: Vec<f64> = forces(&points).iter().map(|f| f / factor).collect();
            let off = distance(&scaled, &forces(&alone));
            assert!(off < 2e-5, "{what}: the block is {off:e} off");
            let off = distance(&forces(&last(scene(), settings, of_the_bar, &what)), &forces(&bar));
            assert!(off < 2e-5, "{what}: the bar is {off:e} off");
        }
    }
}

#[test]
fn given_slip_bounds_keep_their_newtons() {
    let friction = || Friction::tresca(1.5e-3);
    let cube_alone = cube_loads(Scene::new(cube(), uniform(2e11, 0.3)), 1e-9);
    let held = |scene: Scene| scene.with_support(Support::fixed(other(brick::X_MIN)));
    let alone = last(
        on_the_floor(held(cube_alone), friction()),
        tight(),
        of_the_block,
        "block",
    );
    let scene = on_the_floor(held(cube_loads(bar_loads(both(2e11)), 1e-9)), friction());
    let points = last(scene, Settings::default(), of_the_block, "both");
    let off = distance(&forces(&points), &forces(&alone));
    assert!(off < 2e-5, "{off:e}");
    assert!(
        points.iter().any(|p| p.slip_bound > 0.0 && p.slip_rate > 0.0),
        "some slide"
    );
}

#[test]
fn a_body_that_only_moves_is_solved_beside_a_loaded_one() {
    let moved = |scene: Scene| {
        let top = Support::fixed(other(brick::Z_MAX));
        scene.with_support(top.with_motion([2e-13, 0.0, -1e-12], ramp()))
    };
    let friction = || Friction::coulomb(0.3);
    let alone = on_the_floor(moved(Scene::new(cube(), uniform(2e11, 0.3))), friction());
    let alone = last(alone, tight(), of_the_block, "block");
    let scene = on_the_floor(moved(bar_loads(both(2e11))), friction());
    let points = last(scene, Settings::default(), of_the_block, "both");
    let off = distance(&forces(&points), &forces(&alone));
    assert!(off < 2e-5, "{off:e}");
}

/// A soft block that its support moves without touching, beside a loaded bar: its forces are rounding errors.
#[test]
fn a_body_that_moves_without_forces_does_not_disturb_another() {
    let bar = last(
        on_the_floor(bar_loads(Scene::new(bar(), uniform(2e11, 0.3))), Friction::None),
        tight(),
        of_the_bar,
        "bar",
    );
    for (young, motion) in [(0.2, 1e-5), (2.0, 1e-5), (0.2, 1e-3), (2e11, 1e-5)] {
        let top = Support::fixed(other(brick::Z_MAX));
        let scene = bar_loads(both(young)).with_support(top.with_motion([motion, 0.0, motion], ramp()));
        let scene = on_the_floor(scene, Friction::None);
        let points = last(scene, Settings::default(), of_the_bar, "both");
        let off = distance(&forces(&points), &forces(&bar));
        assert!(off < 2e-5, "E {young:e}, motion {motion:e}: {off:e}");
    }
}

/// A force that nothing balances is found under another body's load 1e12 times as large.
#[test]
fn a_light_body_that_nothing_holds_is_refused() {
    let top = other(brick::Z_MAX);
    let scene = bar_loads(both(2e11)).with_load(Load::traction(top, [0.0, 0.0, 1e-5]));
    let error = Simulation::new(on_the_floor(scene, Friction::None), Settings::default());
    match error.expect_err("refused") {
        ContactError::NotHeld { body, force, .. } => {
            assert_eq!(body, 1);
            assert!((force - 1e-5).abs() < 1e-12, "{force:e}");
        }
        error => panic!("{error}"),
    }
}

/// A cube of side one and a block of length two beside it that share the nodes at one place.
fn joined(offset: [f64; 3]) -> TetMesh {
    let first = block([1.0; 3], [2, 2, 2]);
    let other = block([2.0, 1.0, 1.0], [4, 2, 2]);
    let mut points = first.points().to_vec();
    let number: Vec<u32> = other
        .points()
        .iter()
        .map(|p| {
            let p: [f64; 3] = std::array::from_fn(|c| p[c] + offset[c]);
            let same = |q: &[f64; 3]| (0..3).all(|c| (p[c] - q[c]).abs() < 1e-12);
            points.iter().position(same).unwrap_or_else(|| {
                points.push(p);
                points.len() - 1
            }) as u32
        })
        .collect();
    let renumber = |n: u32| number[n as usize];
    let mut tets = first.tets().to_vec();
    tets.extend(other.tets().iter().map(|t| t.map(renumber)));
    let mut facets = first.facets().to_vec();
    facets.extend(other.facets().iter().map(|f| {
        let mut f = *f;
        f.nodes = f.nodes.map(renumber);
        f.tag = second(f.tag);
        f
    }));
    TetMesh::new(points, tets, facets).expect("mesh")
}

/// The second body lies on the upper edge of the first at x = 1, z = 1.
fn lever() -> Scene {
    Scene::new(joined([1.0, 0.0, 1.0]), uniform(1e6, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(second(brick::Z_MAX), 500.0))
}

#[test]
fn a_hinge_that_nothing_stops_is_named() {
    for boxes in [[1, 1, 1], [3, 1, 2]] {
        match Simulation::new(lever().with_boxes(boxes), at(1e-9)) {
            Err(ContactError::NotHeld { mode, force, .. }) => {
                assert!(mode.contains("rotation"), "{mode}");
                assert!(force > 0.0);
            }
            Err(error) => panic!("{boxes:?}: {error}"),
            Ok(_) => panic!("{boxes:?}: accepted"),
        }
    }
}

/// A lever on a floor: the moment about the hinge is that of the load, W times 1.
#[test]
fn a_lever_rests_on_a_floor() {
    let weight = 500.0 * 2.0;
    let mut reference: Option<Vec<f64>> = None;
    for boxes in [[1, 1, 1], [2, 1, 2], [3, 2, 2]] {
        for method in methods() {
            let scene = lever()
                .with_contact(Contact::rigid(second(brick::Z_MIN)))
                .with_boxes(boxes);
            let place = scene.mesh().points().to_vec();
            let (_, results) = run(scene, at(1e-9).with_method(method.clone()));
            let moment: f64 = results[0]
                .points
                .iter()
                .map(|p| -p.normal_force * (place[p.node as usize][0] - 1.0))
                .sum();
            let what = format!("{boxes:?} {}", method.kind());
            assert!((moment / weight - 1.0).abs() < 1e-6, "{what}: {moment}");
            let u = &results[0].displacement;
            let first = reference.get_or_insert_with(|| u.clone());
            assert_close(u, first, 1e-5, &what);
        }
    }
}

/// A ball joint: one node shared; the other end is held along two directions.
#[test]
fn a_ball_joint_carries_its_share() {
    let corner = joined([1.0, 1.0, 1.0]);
    let scene = Scene::new(corner, uniform(1e6, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::new(LoadDensity::Pressure(second(brick::Z_MAX), 500.0)));
    let refused = Simulation::new(scene.clone(), at(1e-9));
    assert!(matches!(refused, Err(ContactError::NotHeld { .. })));
    let held = scene
        .with_support(Support::components(second(brick::X_MAX), [false, true, true]))
        .with_boxes([2, 1, 2]);
    let (simulation, _) = run(held, at(1e-9));
    let reactions = simulation.result().expect("a result").reactions();
    // 1000 N on the middle of a length of 2 m between the joint and the other end: half of it at either, and their
    // moment about the joint is that of a load half a metre beside it
    let joint = [0, 1, 2].map(|c| reactions.point[c] - 1.0);
    let half = [0.0, 0.0, 500.0];
    for (support, moment) in reactions.supports.iter().zip([[0.0; 3], [500.0, -1000.0, 0.0]]) {
        let Resultant { force, moment: own, .. } = support.resultant;
        let arm = cross(joint, force);
        assert!(distance(&force, &half) < 1e-6, "{force:?}");
        let off = [0, 1, 2].map(|c| own[c] + arm[c] - moment[c]);
        assert!(norm(&off) < 1e-3, "{off:?} N m beside {moment:?}");
    }
}

/// A brick that begins inside another one presses, though hardly anybody means it: said once, unless a gap is told.
#[test]
fn a_body_far_inside_another_one_is_told() {
    let base = block([2.0, 2.0, 1.0], [3, 3, 2]);
    let overlaps = |depth: f64, told: &dyn Fn(Contact) -> Contact| {
        let mesh = with_second(&lifted(&block([1.0; 3], [2; 3]), 1.0 - depth), &base);
        let contact = Contact::between(brick::Z_MIN, second(brick::Z_MAX));
        let scene = Scene::new(mesh, uniform(1e9, 0.3))
            .with_support(Support::fixed(second(brick::Z_MIN)))
            .with_support(Support::fixed(brick::Z_MAX))
            .with_load(Load::pressure(second(brick::Y_MAX), 1.0))
            .with_contact(told(contact));
        let plan = Plan::new(&scene, &Settings::default()).expect("plan");
        let large = |w: &&Warning| matches!(w, Warning::LargeOverlap { .. });
        plan.warnings().iter().find(large).cloned()
    };
    let measured = |contact: Contact| contact;
    let warning = overlaps(0.05, &measured).expect("a warning");
    let Warning::LargeOverlap {
        contact: 0,
        overlap,
        extent,
        ..
    } = warning
    else {
        panic!("{warning}");
    };
    // of the body that keeps the points, that with the larger facets
    assert!((overlap - 0.05).abs() < 1e-12 && extent == 2.0, "{warning}");
    assert!(
        warning.to_string().contains("5.000e-2 inside") && warning.to_string().contains(" 2.5 %"),
        "{warning}"
    );
    assert_eq!(overlaps(0.01, &measured), None);
    assert_eq!(overlaps(0.05, &|contact| contact.with_gap(-0.05)), None);
    assert_eq!(overlaps(0.05, &|contact| contact.with_gap(0.0)), None);
}

/// A shim between plates that slide on each other: with one coefficient on both sides it may be anywhere on their way,
/// which is told; the smaller one of two lets it go.
#[test]
fn a_shim_that_slides_on_both_sides_has_no_place() {
    const WAY: f64 = 1e-4;
    const TOP: FacetTag = FacetTag(56);
    let shim = block([0.8, 0.8, 0.1], [3, 3, 1]);
    let plate = block([1.0, 1.0, 0.4], [4, 4, 2]).map_tags(|tag| FacetTag(tag.0 + 50));
    let plate = plate
        .map_points(|x| [x[0] - 0.1, x[1] - 0.1, x[2] + 0.1])
        .expect("moved");
    let [under, side] = [brick::Z_MIN, brick::X_MIN].map(|tag| FacetTag(tag.0 + 50));
    assert_eq!(TOP.0, brick::Z_MAX.0 + 50);
    let mesh = shim.append(&plate).expect("bodies");
    for (below, above, expected) in [(0.3, 0.3, true), (0.3, 0.25, false), (0.25, 0.3, false)] {
        let pressed = History::table(vec![(0.0, 0.0), (1.0, 1.0), (3.0, 1.0)]).expect("table");
        let drawn = History::table(vec![(0.0, 0.0), (1.0, 0.0), (3.0, 2.0)]).expect("table");
        let rough = |contact: Contact, coefficient| contact.with_friction(Friction::coulomb(coefficient));
        let scene = Scene::new(mesh.clone(), steel())
            .with_contact(rough(Contact::rigid(brick::Z_MIN), below))
            .with_contact(rough(Contact::between(brick::Z_MAX, under).with_gap(0.0), above))
            .with_load(Load::pressure(TOP, 1e6).with_history(pressed))
            .with_support(Support::components(side, [true, false, false]).with_motion([WAY, 0.0, 0.0], drawn))
            .with_analysis(Analysis::quasistatic(3.0, 3));
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        while !simulation.is_finished() {
            assert_certified(&step(&mut simulation), "shim");
        }
        let result = simulation.result().expect("steps");
        let found = result.warnings();
        let neutral = found.iter().find(|w| matches!(w.plain(), Warning::NeutralPlace { .. }));
        assert_eq!(neutral.is_some(), expected, "{below} {above}: {found:?}");
        if let Some(Warning::NeutralPlace {
            step,
            body,
            mode,
            range,
            ..
        }) = neutral
        {
            assert_eq!((*step, *body), (2, 0), "{mode}");
            assert!(
                mode.contains("(1.000, 0.000, 0.000)") || mode.contains("(-1.000, 0.000, 0.000)"),
                "{mode}"
            );
            assert!((range / WAY - 1.0).abs() < 0.01, "{range:e}");
        }
    }
}

/// A block that is drawn over another one keeps its partners in four steps as in one: more steps alone silenced that.
#[test]
fn slips_past_the_facets_of_a_partner_are_named_in_any_number_of_steps() {
    let scene = |way: f64, steps| {
        let cube = block([1.0; 3], [2; 3]);
        Scene::new(with_second(&cube, &lifted(&cube, 1.0)), uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_support(Support::fixed(second(brick::Z_MAX)).with_motion([way, 0.0, -1e-3], ramp()))
            .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(0.2)))
            .with_analysis(Analysis::quasistatic(1.0, steps))
    };
    for (way, long) in [(0.8, true), (0.3, false)] {
        for steps in [1, 4] {
            let mut simulation = Simulation::new(scene(way, steps), Settings::default()).expect("set-up");
            let report = simulation.run(&mut Silent).expect("run");
            let found = report.warnings().iter().any(|w| matches!(w, Warning::LongSlip { .. }));
            assert_eq!(found, long, "{way} in {steps} steps");
        }
    }
}
