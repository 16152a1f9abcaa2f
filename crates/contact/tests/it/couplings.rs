//! Rigid couplings: against supports that say the same, held against loaded, closed forms, between bodies, refusals.

use crate::common::*;
use signorini_contact::result::CouplingMotion;
use signorini_fem_mesh::vec3::{add, cross, sub};
use signorini_tfeti::internal::on_ranks;

pub(crate) const YOUNG: f64 = 2e11;
/// Beside the end of the bar.
pub(crate) const POINT: [f64; 3] = [2.3, 0.4, 1.2];
/// Displacements and rotations of it.
pub(crate) const MOTION: [f64; 6] = [1e-4, -2e-4, 3e-4, 2e-4, -1e-4, 3e-4];

/// A bar held at one end, cut into so many boxes.
pub(crate) fn bar(boxes: [usize; 3]) -> Scene {
    let mesh = Brick::new([2.0, 1.0, 1.0], [6, 3, 3])
        .perturbed(0.1, 3)
        .build()
        .expect("brick");
    Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::body([0.0, 0.0, -3e6]))
        .with_boxes(boxes)
}

pub(crate) fn end() -> Coupling {
    Coupling::rigid(brick::X_MAX, POINT)
}

/// The same without the nodes that could touch a floor.
fn above() -> Coupling {
    let mesh = bar([1; 3]).mesh().clone();
    let nodes = mesh.nodes_on(brick::X_MAX).into_iter();
    let nodes: Vec<u32> = nodes.filter(|n| mesh.points()[*n as usize][2] > 1e-9).collect();
    Coupling::rigid(nodes, POINT)
}

/// On a floor with friction below its first half.
pub(crate) fn on_floor(scene: Scene) -> Scene {
    let floor = Contact::rigid(brick::Z_MIN).with_gap_field(|x| if x[0] < 1.2 { 1e-6 } else { 1.0 });
    scene.with_contact(floor.with_friction(Friction::coulomb(0.3)))
}

/// The displacement, the motion of the coupling, and what holds it about its point.
fn solved(scene: Scene) -> (Vec<f64>, CouplingMotion, Resultant) {
    solved_with(scene, Settings::default().with_tolerance(1e-9))
}

fn solved_with(scene: Scene, settings: Settings) -> (Vec<f64>, CouplingMotion, Resultant) {
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let one = step(&mut simulation);
    assert_certified(&one, "coupled");
    let result = simulation.result().expect("a step");
    let reactions = result.reactions_about(POINT);
    let out = reactions.imbalance();
    let size = norm(reactions.loads.force) + norm(reactions.couplings[0].force);
    assert!(norm(out.force) + norm(out.moment) < 1e-6 * size, "{out:?}");
    (one.displacement, result.couplings()[0], reactions.couplings[0])
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

pub(crate) fn assert_close(a: &[f64], b: &[f64], within: f64, what: &str) {
    let size = b.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert!(
            (a - b).abs() <= within * size,
            "{what}, {k}: {a:e} and {b:e} of {size:e}"
        );
    }
}

pub(crate) fn six(a: [f64; 3], b: [f64; 3]) -> [f64; 6] {
    [a[0], a[1], a[2], b[0], b[1], b[2]]
}

/// The parts of a motion that are held.
fn masked(motion: [f64; 6], held: [bool; 6]) -> [f64; 6] {
    std::array::from_fn(|c| if held[c] { motion[c] } else { 0.0 })
}

pub(crate) fn moved() -> History {
    History::constant(1.0)
}

/// All motions prescribed: supports of its nodes say the same, and have the same resultant; whether alone or on a
/// floor.
#[test]
fn held_in_all_motions_it_is_a_support() {
    let with_floor: [fn(Scene) -> Scene; 2] = [|scene| scene, on_floor];
    for floor in with_floor {
        let coupled = floor(bar([3, 1, 2])).with_coupling(above().with_held([true; 6]).with_motion(MOTION, moved()));
        let ([x, y, z, a, b, c], mesh) = (MOTION, coupled.mesh().clone());
        let nodes: Vec<u32> = match above().place() {
            Some(Place::Nodes(nodes)) => nodes.clone(),
            _ => Vec::new(),
        };
        let at = |n: &u32| add([x, y, z], cross([a, b, c], sub(mesh.points()[*n as usize], POINT)));
        let values = nodes.iter().map(at).collect();
        let support = Support::fixed(nodes.clone()).with_motions(values, moved());
        let (found, motion, held) = solved(coupled);
        let supported = floor(bar([3, 1, 2])).with_support(support);
        let mut simulation = Simulation::new(supported, Settings::default().with_tolerance(1e-9)).expect("set-up");
        let expected = step(&mut simulation);
        assert_close(&found, &expected.displacement, 1e-7, "displacement");
        assert_close(&six(motion.displacement, motion.rotation), &MOTION, 1e-9, "motion");
        let reaction = simulation.result().expect("a step").reactions_about(POINT).supports[1].resultant;
        assert_close(&held.force, &reaction.force, 1e-6, "force");
        assert_close(&held.moment, &reaction.moment, 1e-6, "moment");
    }
}

/// What holds a motion, as a load, makes it; any part of the motions held, the others loaded, gives the same state.
#[test]
fn loads_take_the_place_of_what_holds() {
    let (expected, _, held) =
        solved(on_floor(bar([2, 1, 1])).with_coupling(above().with_held([true; 6]).with_motion(MOTION, moved())));
    let all = six(held.force, held.moment);
    for still in [
        [false; 6],
        [true, true, false, true, true, true],
        [false, true, false, false, true, false],
    ] {
        let part = |of: bool, c: usize| if still[c] == of { 0.0 } else { all[c] };
        let [force, moment] = [0, 3].map(|first| [0, 1, 2].map(|c| part(true, first + c)));
        let scene = on_floor(bar([2, 1, 1]))
            .with_coupling(above().with_held(still).with_motion(masked(MOTION, still), moved()))
            .with_load(Load::on_coupling(0, force, moment));
        let (found, motion, held) = solved(scene);
        assert_close(&found, &expected, 1e-6, &format!("{still:?}"));
        assert_close(&six(motion.displacement, motion.rotation), &MOTION, 1e-6, "motion");
        let reaction: Vec<f64> = (0..6).map(|c| part(false, c)).collect();
        assert_close(
            &six(held.force, held.moment)[..3],
            &reaction[..3],
            1e-5 * norm(held.force).max(1.0),
            "reaction",
        );
    }
}

/// A bar without lateral strain, drawn by a force: strain and motion are known in closed form.
#[test]
fn a_bar_is_drawn_by_its_end() {
    let mesh = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).build().expect("brick");
    let sides = [brick::Y_MIN, brick::Y_MAX, brick::Z_MIN, brick::Z_MAX];
    let inner = |n: &u32| mesh.points()[*n as usize][0] < 1.99;
    let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3)).with_support(Support::fixed(brick::X_MIN));
    let scene = sides.into_iter().fold(scene, |scene, side| {
        let across = if side == brick::Y_MIN || side == brick::Y_MAX { 1 } else { 2 };
        let nodes: Vec<u32> = mesh.nodes_on(side).into_iter().filter(inner).collect();
        scene.with_support(Support::components(nodes, [1, 2, 3].map(|c| c == across + 1)))
    });
    let held = [false, true, true, true, true, true];
    let scene = scene
        .with_coupling(Coupling::rigid(brick::X_MAX, [2.0, 0.5, 0.5]).with_held(held))
        .with_load(Load::on_coupling(0, [1e8, 0.0, 0.0], [0.0; 3]));
    let (_, motion, _) = solved(scene);
    // E (1 - nu) / ((1 + nu) (1 - 2 nu)) of stress over strain
    let stiff = YOUNG * 0.7 / (1.3 * 0.4);
    assert_close(&motion.displacement, &[2.0 * 1e8 / stiff, 0.0, 0.0], 1e-9, "drawn");
}

/// The cut, the number of processes and the preconditioner are not seen in the result; the coupling has its products.
#[test]
fn cuts_and_processes_do_not_count() {
    let scene = |boxes| {
        on_floor(bar(boxes))
            .with_coupling(above().with_held([false, true, false, true, false, false]))
            .with_load(Load::on_coupling(0, [-1e7, 0.0, -2e6], [0.0, 3e5, 1e5]))
    };
    let (expected, motion, _) = solved(scene([1, 1, 1]));
    for boxes in [[3, 1, 1], [3, 2, 2], [6, 1, 1]] {
        for preconditioner in [Preconditioner::Lumped, Preconditioner::Dirichlet] {
            let settings = Settings::default()
                .with_tolerance(1e-9)
                .with_preconditioner(preconditioner);
            let (found, other, _) = solved_with(scene(boxes), settings);
            assert_close(&found, &expected, 1e-6, &format!("{boxes:?}"));
            assert_close(&other.displacement, &motion.displacement, 1e-6, "motion");
        }
    }
    let alone = solved_with(scene([3, 2, 1]), Settings::default()).0;
    for count in [2, 3] {
        for run in on_ranks(count, |c| {
            solved_with(scene([3, 2, 1]), Settings::default().with_communicator(c)).0
        }) {
            assert!(run.expect("no panic") == alone, "{count} ranks");
        }
    }
}

/// The methods of the paper agree with the default one.
#[test]
fn methods_agree() {
    let scene = || {
        on_floor(bar([2, 1, 1]))
            .with_coupling(above().with_held([false, true, false, true, false, false]))
            .with_load(Load::on_coupling(0, [-1e7, 0.0, -2e6], [0.0, 3e5, 1e5]))
    };
    let (expected, ..) = solved(scene());
    let settings = Settings::default().with_method(Method::paper()).with_tolerance(1e-7);
    let (found, ..) = solved_with(scene(), settings);
    assert_close(&found, &expected, 1e-4, "SMALSE");
}

/// One coupling holds two bodies together, of which only one has supports; and a body is lifted off a floor by its
/// coupling.
#[test]
fn bodies_hang_on_couplings() {
    let first = Brick::new([1.0; 3], [3; 3]).build().expect("brick");
    let second = first.map_points(|[x, y, z]| [x + 1.5, y, z]).expect("moved");
    let near = |mesh: &TetMesh, at: f64| -> Vec<u32> {
        let all = (0..).zip(mesh.points());
        all.filter(|(_, x)| (x[0] - at).abs() < 1e-9).map(|(n, _)| n).collect()
    };
    let mesh = first.append(&second).expect("two bodies");
    let plate = [near(&mesh, 1.0), near(&mesh, 1.5)].concat();
    let left = near(&mesh, 0.0);
    let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
        .with_support(Support::fixed(left))
        .with_coupling(Coupling::rigid(plate, [1.25, 0.5, 0.5]))
        .with_load(Load::body([0.0, 0.0, -3e6]));
    let (found, motion, held) = solved(scene);
    assert_eq!(held, Resultant::default());
    // between both it is rigid
    for (node, x) in mesh
        .points()
        .iter()
        .enumerate()
        .filter(|(_, x)| x[0] > 0.99 && x[0] < 1.51)
    {
        let by = add(motion.displacement, cross(motion.rotation, sub(*x, [1.25, 0.5, 0.5])));
        let size = norm(motion.displacement);
        assert!(
            norm(sub(by, [0, 1, 2].map(|c| found[3 * node + c]))) < 1e-7 * size,
            "node {node}"
        );
    }
    let lifted = Scene::new(first, uniform(YOUNG, 0.3))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
        .with_coupling(Coupling::rigid(brick::Z_MAX, [0.5, 0.5, 1.5]));
    let pressed = lifted
        .clone()
        .with_load(Load::on_coupling(0, [1e6, 0.0, -1e7], [0.0; 3]));
    let mut simulation = Simulation::new(pressed, Settings::default()).expect("set-up");
    assert_certified(&step(&mut simulation), "pressed");
    let floor = simulation.result().expect("a step").reactions().contact.force;
    assert_close(&floor, &[-1e6, 0.0, 1e7], 1e-6, "floor");
    let drawn = lifted.with_load(Load::on_coupling(0, [0.0, 0.0, 1e7], [0.0; 3]));
    let refused = Simulation::new(drawn, Settings::default())
        .map(|_| ())
        .expect_err("nothing holds it");
    assert!(matches!(refused, ContactError::NotHeld { .. }), "{refused}");
}

/// A rigid side in contact with another body, without friction and with: the coupling presses, the punch stays plane.
#[test]
fn a_rigid_side_touches_another_body() {
    let punch = Brick::new([0.6, 0.6, 0.5], [3; 3]).build().expect("brick");
    let punch = punch
        .map_points(|[x, y, z]| [x + 0.2, y + 0.2, z + 1.0])
        .expect("moved");
    let (punch, _) = (punch.map_tags(|t| FacetTag(t.0 + 100)), ());
    let base = Brick::new([1.0; 3], [4; 3]).build().expect("brick");
    let mesh = base.append(&punch).expect("two bodies");
    let foot = FacetTag(brick::Z_MIN.0 + 100);
    let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::Z_MIN))
        .with_contact(Contact::between(brick::Z_MAX, foot).with_friction(Friction::coulomb(0.4)))
        .with_coupling(Coupling::rigid(foot, POINT).with_held([true, true, false, true, true, true]))
        .with_load(Load::on_coupling(0, [0.0, 0.0, -5e8], [0.0; 3]));
    let (found, motion, _) = solved(scene);
    assert!(motion.displacement[2] < -1e-4, "{motion:?}");
    for node in mesh.nodes_on(foot) {
        let off = found[3 * node as usize + 2] - motion.displacement[2];
        assert!(off.abs() < 1e-7 * motion.displacement[2].abs(), "{off:e}");
    }
}

/// Checkpoints fit scenes with the same couplings.
#[test]
fn states_know_their_couplings() {
    let scene = |coupling: Coupling, held: bool| {
        let all = [held, true, false, true, false, false];
        on_floor(bar([2, 1, 1]))
            .with_coupling(coupling.with_held(all))
            .with_load(Load::on_coupling(0, [-1e7, 0.0, -2e6], [0.0; 3]).with_history(ramp()))
            .with_analysis(Analysis::quasistatic(1.0, 4))
    };
    let mut whole = Simulation::new(scene(above(), false), Settings::default()).expect("set-up");
    let _ = [step(&mut whole), step(&mut whole)];
    let state = whole.state().clone();
    let resume = |scene: Scene| {
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        simulation.resume(state.clone()).map(|()| simulation)
    };
    let mut other = resume(scene(above(), false)).expect("the same scene");
    assert_eq!(bits(&step(&mut other)), bits(&step(&mut whole)));
    let Some(Place::Nodes(nodes)) = above().place().cloned() else {
        panic!("single nodes")
    };
    let fewer = Coupling::rigid(&nodes[1..], POINT);
    let split = |at: usize| {
        let [a, b] = [&nodes[..at], &nodes[at..]].map(|own| Coupling::rigid(own, POINT));
        on_floor(bar([2, 1, 1])).with_coupling(a).with_coupling(b)
    };
    let mut halves = Simulation::new(split(6), Settings::default()).expect("set-up");
    let _ = step(&mut halves);
    let mut others = Simulation::new(split(5), Settings::default()).expect("set-up");
    assert!(others.resume(halves.state().clone()).is_err(), "other nodes");
    for scene in [scene(fewer, false), scene(above(), true)] {
        let error = resume(scene).map(|_| ()).expect_err("another scene");
        assert!(matches!(error, ContactError::Checkpoint { .. }), "{error}");
    }
}

/// On planes of symmetry supports of its nodes say what the coupling says: a quarter of a block pressed by a rigid
/// plate is the whole one.
#[test]
fn a_quarter_is_the_whole() {
    let scene = |size: f64, cells: usize| {
        let mesh = Brick::new([size, size, 1.0], [cells, cells, 3]).build().expect("brick");
        Scene::new(mesh, uniform(YOUNG, 0.3))
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
            .with_load(Load::on_coupling(0, [0.0, 0.0, -1e8 * size * size], [0.0; 3]))
    };
    let held = [true, true, false, true, true, true];
    let plate = |at: f64| Coupling::rigid(brick::Z_MAX, [at, at, 1.0]).with_held(held);
    let quarter = scene(1.0, 3)
        .with_support(Support::components(brick::X_MAX, [true, false, false]))
        .with_support(Support::components(brick::Y_MAX, [false, true, false]))
        .with_coupling(plate(1.0));
    let (found, motion, _) = solved(quarter.clone());
    let (expected, other, _) = solved(scene(2.0, 6).with_coupling(plate(1.0)));
    // the meshes are not mirrored
    assert_close(&motion.displacement, &other.displacement, 2e-3, "pressed");
    assert!(found.iter().all(|u| u.is_finite()) && expected.len() > found.len());
    // likewise where the plate moves, but along the plane only
    let pressed = |x: f64| {
        let down = [x, 0.0, -1e-4, 0.0, 0.0, 0.0];
        let plate = plate(1.0).with_held([true; 6]).with_motion(down, moved());
        let scene = scene(1.0, 3).with_support(Support::components(brick::X_MAX, [true, false, false]));
        scene
            .with_support(Support::components(brick::Y_MAX, [false, true, false]))
            .with_coupling(plate)
    };
    let (_, motion, _) = solved(pressed(0.0));
    assert!((motion.displacement[2] + 1e-4).abs() < 1e-12);
    let refused = Simulation::new(pressed(1e-6), Settings::default())
        .map(|_| ())
        .expect_err("contradictory");
    assert!(refused.to_string().contains("or moves it"), "{refused}");
    // what the coupling leaves free a support of its nodes cannot hold
    let free = scene(1.0, 3)
        .with_support(Support::components(brick::X_MAX, [true, false, false]))
        .with_coupling(plate(1.0).with_held([true, true, false, true, true, false]));
    let refused = Simulation::new(free, Settings::default())
        .map(|_| ())
        .expect_err("contradictory");
    assert!(refused.to_string().contains("a support holds it"), "{refused}");
}

/// Held couplings take the products of supports, loaded ones those of a traction, whatever the number of subdomains.
#[test]
fn couplings_cost_no_products() {
    for cells in [[12, 6, 6], [24, 12, 12]] {
        let mesh = Brick::new([2.0, 1.0, 1.0], cells).build().expect("brick");
        let nodes = mesh.nodes_on(brick::X_MAX).into_iter();
        let nodes: Vec<u32> = nodes.filter(|n| mesh.points()[*n as usize][2] > 1e-9).collect();
        let count = |change: &dyn Fn(Scene) -> Scene| {
            let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
                .with_support(Support::fixed(brick::X_MIN))
                .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e7]))
                .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)));
            solve(change(scene), Settings::default()).report.counters.products
        };
        let (motion, axial) = ([1e-4, 0.0, 0.0], [1e-4, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let plate = || Coupling::rigid(nodes.clone(), [2.0, 0.5, 0.5]);
        let supported = count(&|s| s.with_support(Support::fixed(nodes.clone()).with_motion(motion, moved())));
        let held = count(&|s| s.with_coupling(plate().with_held([true; 6]).with_motion(axial, moved())));
        let pressed = count(&|s| s.with_load(Load::force(brick::X_MAX, [2e7, 0.0, 0.0])));
        let force = || Load::on_coupling(0, [2e7, 0.0, 0.0], [0.0; 3]);
        let loaded = count(&|s| s.with_coupling(plate()).with_load(force()));
        let guided = plate().with_held([false, true, false, true, false, true]);
        let guided = count(&|s| s.with_coupling(guided.clone()).with_load(force()));
        assert!(
            held <= supported + 3 && loaded <= pressed + 3 && guided <= pressed + 3,
            "{cells:?}: {held} {supported}, {loaded} {guided} {pressed}"
        );
    }
}

/// Two blocks meshed apart, the upper one pressed, drawn and turned by its rigid top: what holds it, as a load, makes
/// the same state, its motion is that of its nodes, and the estimate bounds the energy that a loose tolerance leaves.
#[test]
fn random_pairs_are_moved_by_couplings() {
    for seed in 0..12 {
        let mut dice = random(seed);
        let cells = |dice: &mut rand_pcg::Pcg64Mcg| [0, 1, 2].map(|_| 2 + dice.random_range(0..3));
        let lower = Brick::new([1.2, 1.2, 0.6], cells(&mut dice)).perturbed(0.1, seed);
        let upper = Brick::new([0.8, 0.8, 0.5], cells(&mut dice)).build().expect("brick");
        let upper = upper
            .map_points(|[x, y, z]| [x + 0.2, y + 0.2, z + 0.6])
            .expect("moved");
        let mut mesh = with_second(&lower.build().expect("brick"), &upper);
        if seed % 4 == 0 {
            mesh = mesh.raise_order().expect("order 2");
        }
        let mut any = |size: f64| [0, 1, 2].map(|_| dice.random_range(-size..size));
        let (beside, drawn, turned) = (any(1.0), any(1e-4), any(1e-4));
        let motion = [drawn[0], drawn[1], -4e-4 + drawn[2], turned[0], turned[1], turned[2]];
        let held: [bool; 6] = std::array::from_fn(|_| dice.random());
        let friction = match dice.random_range(0..3) {
            0 => Friction::None,
            _ => Friction::coulomb(dice.random_range(0.0..0.5)),
        };
        let free = matches!(friction, Friction::None);
        let point = [0.6 + beside[0], 0.6 + beside[1], 1.1 + beside[2]];
        let scene = |coupling: Coupling, force, moment| {
            Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
                .with_support(Support::fixed(brick::Z_MIN))
                .with_contact(Contact::between(brick::Z_MAX, second(brick::Z_MIN)).with_friction(friction.clone()))
                .with_coupling(coupling)
                .with_load(Load::on_coupling(0, force, moment))
                .with_subdomains(2 + seed as usize % 4)
        };
        let top = |held: [bool; 6]| {
            let plate = Coupling::rigid(second(brick::Z_MAX), point).with_held(held);
            plate.with_motion(masked(motion, held), moved())
        };
        let settings = Settings::default().with_tolerance(1e-9);
        let all = scene(top([true; 6]), [0.0; 3], [0.0; 3]);
        let mut simulation = Simulation::new(all.clone(), settings.clone()).expect("set-up");
        let exact = step(&mut simulation);
        assert_certified(&exact, "held");
        let resultant = simulation.result().expect("a step").reactions_about(point).couplings[0];
        let mut loose = Simulation::new(all, at(1e-3)).expect("set-up");
        let rough = step(&mut loose);
        let error = loose.result().expect("a step").algebraic_error();
        let off = energy_distance(loose.scene(), &rough.displacement, &exact.displacement);
        assert!(
            error.energy.sqrt() > 0.5 * off || off < 1e-9 * error.elastic.sqrt(),
            "seed {seed}: {error:?} {off:e}"
        );
        // without friction nothing holds the upper block along the plane
        let held = [0, 1, 2, 3, 4, 5].map(|c| held[c] || free && [0, 1, 5].contains(&c));
        let all = six(resultant.force, resultant.moment);
        let part = |c: usize| if held[c] { 0.0 } else { all[c] };
        let [force, moment] = [0, 3].map(|first| [0, 1, 2].map(|c| part(first + c)));
        let mut simulation = Simulation::new(scene(top(held), force, moment), settings).expect("set-up");
        let loaded = step(&mut simulation);
        assert_certified(&loaded, &format!("seed {seed}, {held:?}"));
        assert_close(
            &loaded.displacement,
            &exact.displacement,
            1e-5,
            &format!("seed {seed}, {held:?}"),
        );
        let found = simulation.result().expect("a step").couplings()[0];
        for node in mesh.nodes_on(second(brick::Z_MAX)) {
            let arm = sub(mesh.points()[node as usize], point);
            let by = add(found.displacement, cross(found.rotation, arm));
            let own = [0, 1, 2].map(|c| loaded.displacement[3 * node as usize + c]);
            assert!(norm(sub(by, own)) < 1e-7 * norm(own), "seed {seed}, node {node}");
        }
    }
}
