//! Tied sides that move relative to each other: against motions of ties, held against loaded, hinges, a bolted joint.

use crate::common::*;
use crate::couplings::{POINT, YOUNG, assert_close, moved, six};
use signorini_contact::result::CouplingMotion;
use signorini_fem_mesh::mesh::drop_unused_nodes;
use signorini_fem_mesh::{SurfaceFrame, vec3};
use signorini_tfeti::internal::on_ranks;

/// The sides of a cut.
pub(crate) const FIRST: FacetTag = FacetTag(31);
pub(crate) const SECOND: FacetTag = FacetTag(32);

/// A mesh that is cut across where the centroids of tetrahedra pass a plane.
fn cut_at(mesh: &TetMesh, axis: usize, at: f64) -> TetMesh {
    let first = |tet: usize| Some(vec3::centroid(&mesh.tet_points(tet))[axis] < at);
    mesh.cut(first, [FIRST, SECOND]).expect("cut").0
}

/// A bar held at both ends and cut in the middle, along faces that are not plane where its mesh is not.
pub(crate) fn bar(order: usize, boxes: [usize; 3]) -> Scene {
    with_tie(order, boxes, Contact::tied(FIRST, SECOND))
}

pub(crate) fn with_tie(order: usize, boxes: [usize; 3], tie: Contact) -> Scene {
    let mesh = Brick::new([2.0, 1.0, 1.0], [6, 3, 3])
        .perturbed(0.1, 3)
        .build()
        .expect("brick");
    let mesh = cut_at(&mesh, 0, 0.9);
    let mesh = if order == 2 { mesh.raise_order().expect("order 2") } else { mesh };
    Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(Support::fixed(brick::X_MAX))
        .with_load(Load::body([0.0, 0.0, -3e6]))
        .with_contact(tie)
        .with_boxes(boxes)
}

pub(crate) fn end() -> Coupling {
    Coupling::relative(0, POINT)
}

/// The step, what the first side gets from the other, products, and the relative motion, zero where there is none.
fn solved(scene: Scene, what: &str) -> (Solved, Resultant, usize, CouplingMotion) {
    let mut simulation = Simulation::new(scene, Settings::default().with_tolerance(1e-9)).expect("set-up");
    let one = step(&mut simulation);
    assert_certified(&one, what);
    let result = simulation.result().expect("a step");
    let reactions = result.reactions_about(POINT);
    let products = one.report.counters.products;
    let motion = result.couplings().first().copied().unwrap_or_default();
    (one, reactions.contacts[0], products, motion)
}

pub(crate) const ALONG: [bool; 6] = [false, true, true, true, true, true];

/// A coupling that holds all motions at zero is the tie; one that moves the sides is a tie with this motion.
#[test]
fn held_in_all_motions_it_is_the_tie() {
    for (order, boxes) in [(1, [3, 1, 2]), (2, [2, 1, 1])] {
        for jump in [[0.0; 3], [-1e-4, 2e-5, 3e-5]] {
            let [x, y, z] = jump;
            let held = end()
                .with_held([true; 6])
                .with_motion([x, y, z, 0.0, 0.0, 0.0], moved());
            let found = solved(bar(order, boxes).with_coupling(held), "held");
            let tie = Contact::tied(FIRST, SECOND).with_motion(jump, moved());
            let expected = solved(with_tie(order, boxes, tie), "tied");
            assert_close(&found.0.displacement, &expected.0.displacement, 1e-7, "displacement");
            assert_close(&found.1.force, &expected.1.force, 1e-6, "force");
            assert!(found.2 <= expected.2 + 3, "{} and {} products", found.2, expected.2);
        }
    }
}

/// A half that is moved and nothing pulls at: forces are the rounding errors of its motion, which took 10,001 products
/// at order 2 and stagnated at tolerances below 2e-8.
#[test]
fn a_half_that_only_moves_takes_no_products() {
    for order in [1, 2] {
        let held = end().with_held([true; 6]);
        let held = held.with_motion([1e-4, 2e-5, 3e-5, 1e-5, -2e-5, 3e-5], moved());
        let bar = bar(order, [3, 1, 1]);
        let scene = Scene::new(bar.mesh().clone(), bar.materials().clone())
            .with_support(Support::fixed(brick::X_MIN))
            .with_contact(Contact::tied(FIRST, SECOND))
            .with_boxes([3, 1, 1])
            .with_coupling(held);
        for tolerance in [1e-6, 1e-9] {
            let mut simulation = Simulation::new(scene.clone(), at(tolerance)).expect("set-up");
            let one = step(&mut simulation);
            let products = one.report.counters.products;
            assert_eq!(one.report.status, StepStatus::Converged, "order {order}, {tolerance:e}");
            assert!(products <= 3, "order {order}, {tolerance:e}: {products} products");
        }
    }
}

/// Loads in the place of what holds make the same state, for any part of the motions, along any axis.
#[test]
fn loads_take_the_place_of_what_holds() {
    let motion = [-1e-4, 2e-5, 3e-5, 1e-5, -2e-5, 3e-5];
    let expected = solved(
        bar(1, [3, 1, 2]).with_coupling(end().with_held([true; 6]).with_motion(motion, moved())),
        "held",
    );
    let Resultant { force, moment, .. } = expected.1;
    let loaded = |held: Coupling| {
        bar(1, [3, 1, 2])
            .with_coupling(held)
            .with_load(Load::on_coupling(0, force, moment))
    };
    for held in [
        [false; 6],
        ALONG,
        [true, false, true, false, true, false],
        [true, true, true, false, false, false],
    ] {
        let kept = std::array::from_fn(|c| if held[c] { motion[c] } else { 0.0 });
        let found = solved(loaded(end().with_held(held).with_motion(kept, moved())), "loaded");
        assert_close(&found.0.displacement, &expected.0.displacement, 1e-6, "displacement");
        assert_close(&six(found.3.displacement, found.3.rotation), &motion, 1e-6, "motion");
        assert_close(&found.1.force, &force, 1e-6, "force");
        assert!(
            found.2 <= expected.2 + 5,
            "{held:?}: {} and {} products",
            found.2,
            expected.2
        );
    }
    // along an axis, the rest of the motion along those at right angles to it
    let axis = [1.0, 2.0, -2.0];
    let frame = SurfaceFrame::from_normal(axis).expect("an axis");
    let along = |v: [f64; 3]| [frame.normal, frame.tangents[0], frame.tangents[1]].map(|e| vec3::dot(e, v));
    let [[_, b, c], turn] = [[motion[0], motion[1], motion[2]], [motion[3], motion[4], motion[5]]].map(along);
    let kept = [0.0, b, c, turn[0], turn[1], turn[2]];
    let held = end().with_axis(axis).with_held(ALONG).with_motion(kept, moved());
    let found = solved(loaded(held), "along an axis");
    assert_close(
        &six(found.3.displacement, found.3.rotation),
        &motion,
        1e-6,
        "motion along an axis",
    );
}

/// An arm on a hinge, whose reaction follows from equilibrium alone.
#[test]
fn a_hinge_transfers_no_moment_about_its_axis() {
    for order in [1, 2] {
        let mesh = Brick::new([2.0, 1.0, 1.0], [20, 4, 4]).build().expect("brick");
        let mesh = cut_at(&mesh, 0, 0.9);
        let mesh = if order == 2 { mesh.raise_order().expect("order 2") } else { mesh };
        let place = [0.9, 0.5, 0.5];
        let scene = Scene::new(mesh, uniform(YOUNG, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_support(Support::components(brick::X_MAX, [false, false, true]))
            .with_load(Load::body([0.0, 0.0, -3e6]))
            .with_contact(Contact::tied(FIRST, SECOND))
            .with_coupling(Coupling::relative(0, place).with_held([true, true, true, true, false, true]))
            .with_boxes([4, 1, 1]);
        let mut simulation = Simulation::new(scene, Settings::default().with_tolerance(1e-9)).expect("set-up");
        assert_certified(&step(&mut simulation), "hinge");
        let result = simulation.result().expect("a step");
        let reactions = result.reactions_about(place);
        let hinge = reactions.contacts[0];
        assert!(hinge.moment[1].abs() < 1.0, "{hinge:?}");
        let roller = reactions.supports[1].resultant;
        assert!((roller.force[2] - 3e6 * 1.1 / 2.0).abs() < 1.0, "{roller:?}");
        assert!(result.couplings()[0].rotation[1].abs() > 1e-6);
        let rest = reactions.imbalance();
        assert!(
            vec3::norm(rest.force) < 1.0 && vec3::norm(rest.moment) < 1.0,
            "{rest:?}"
        );
    }
}

/// Facets between the bolt and the plates, and between these.
const UNDER_HEAD: FacetTag = FacetTag(41);
const ABOVE_NUT: FacetTag = FacetTag(42);
pub(crate) const UPPER_TOP: FacetTag = FacetTag(43);
const UPPER_BOTTOM: FacetTag = FacetTag(44);
const LOWER_TOP: FacetTag = FacetTag(45);
const LOWER_BOTTOM: FacetTag = FacetTag(46);
const LOWER_END: FacetTag = FacetTag(47);
pub(crate) const UPPER_END: FacetTag = FacetTag(48);

/// Boxes of cells of one length unit: what is inside, told by centroids, and tags of its boundary.
fn carved(
    (low, cells): ([f64; 3], [usize; 3]),
    keeps: impl Fn([f64; 3]) -> bool,
    tag: impl Fn([f64; 3], [f64; 3]) -> Option<FacetTag>,
) -> TetMesh {
    let all = Brick::new(cells.map(|n| n as f64 * CELL), cells)
        .build()
        .expect("cells");
    let at = |p: [f64; 3]| [0, 1, 2].map(|c| low[c] + p[c]);
    let mut points: Vec<_> = all.points().iter().map(|p| at(*p)).collect();
    let tets = all.tets().iter().filter(|tet| {
        let corners = tet.map(|n| points[n as usize]);
        keeps(vec3::centroid(&corners))
    });
    let mut tets: Vec<_> = tets.copied().collect();
    drop_unused_nodes(&mut points, &mut tets, &mut []);
    TetMesh::new(points, tets, Vec::new())
        .expect("a part")
        .tag_boundary(tag)
}

const CELL: f64 = 0.005;

/// Two plates, the lower one held at its left end, and a bolt of 10 mm with play in their holes.
pub(crate) fn joint(friction: f64, order: usize) -> Scene {
    joint_with(friction, order, None)
}

/// The same, perhaps with a washer below the head, of facets with these tags above and below.
pub(crate) fn joint_with(friction: f64, order: usize, washer: Option<[FacetTag; 2]>) -> Scene {
    let hole = |p: [f64; 3]| p[0].abs() > 2.0 * CELL || p[1].abs() > 2.0 * CELL;
    let plate = |z: f64, left: f64, top: FacetTag, bottom: FacetTag, end: FacetTag| {
        carved(([left, -4.0 * CELL, z], [10, 8, 2]), hole, move |p, n| match n {
            [_, _, z] if z > 0.9 => Some(top),
            [_, _, z] if z < -0.9 => Some(bottom),
            [x, ..] if x.abs() > 0.9 && p[0].abs() > 5.5 * CELL => Some(end),
            _ => None,
        })
    };
    let lower = plate(-2.0 * CELL, -6.0 * CELL, LOWER_TOP, LOWER_BOTTOM, LOWER_END);
    let upper = plate(0.0, -4.0 * CELL, UPPER_TOP, UPPER_BOTTOM, UPPER_END);
    let shank = |p: [f64; 3]| p[2].abs() > 2.0 * CELL || p[0].abs() < CELL && p[1].abs() < CELL;
    let bolt = carved(
        ([-3.0 * CELL, -3.0 * CELL, -4.0 * CELL], [6, 6, 8]),
        shank,
        |p, n| match n {
            [_, _, z] if z < -0.9 && (p[2] - 2.0 * CELL).abs() < 1e-9 => Some(UNDER_HEAD),
            [_, _, z] if z > 0.9 && (p[2] + 2.0 * CELL).abs() < 1e-9 => Some(ABOVE_NUT),
            _ => None,
        },
    );
    let bolt = cut_at(&bolt, 2, 0.5 * CELL);
    let (bolt, ring) = match washer {
        None => (bolt, None),
        Some([above, below]) => {
            let lift = |p: [f64; 3]| if p[2] > 1.5 * CELL { CELL } else { 0.0 };
            let bolt = bolt.map_points(|p| [p[0], p[1], p[2] + lift(p)]).expect("longer");
            let corner = [-4.0 * CELL, -4.0 * CELL, 2.0 * CELL];
            let ring = carved((corner, [8, 8, 1]), hole, move |_, n| match n {
                [_, _, z] if z > 0.9 => Some(above),
                [_, _, z] if z < -0.9 => Some(below),
                _ => None,
            });
            (bolt, Some(ring))
        }
    };
    let mesh = [&upper, &bolt].into_iter().chain(&ring);
    let mesh = mesh.fold(lower, |all, part| all.append(part).expect("one mesh"));
    let mesh = if order == 2 { mesh.raise_order().expect("order 2") } else { mesh };
    let rough = |a, b| Contact::between(a, b).with_friction(Friction::coulomb(friction));
    let scene = Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(LOWER_END))
        .with_contact(Contact::tied(FIRST, SECOND))
        .with_contact(rough(UPPER_BOTTOM, LOWER_TOP));
    let scene = match washer {
        None => scene.with_contact(rough(UNDER_HEAD, UPPER_TOP)),
        Some([above, below]) => scene
            .with_contact(rough(UNDER_HEAD, above))
            .with_contact(rough(below, UPPER_TOP)),
    };
    scene.with_contact(rough(ABOVE_NUT, LOWER_BOTTOM))
}

/// The bolt tightened to 10 kN until 1 s, then a force on the upper plate until 2 s.
pub(crate) fn tightened(scene: Scene, coupling: Coupling, factors: [f64; 3], pull: Load) -> Scene {
    let history =
        |[start, middle, end]: [f64; 3]| History::table(vec![(0.0, start), (1.0, middle), (2.0, end)]).expect("table");
    scene
        .with_coupling(coupling)
        .with_load(Load::on_coupling(0, [0.0, 0.0, 1e4], [0.0; 3]).with_history(history(factors)))
        .with_load(pull.with_history(history([0.0, 0.0, 1.0])))
        .with_analysis(Analysis::quasistatic(2.0, 4))
}

pub(crate) fn bolt() -> Coupling {
    Coupling::relative(0, [0.0; 3])
        .with_axis([0.0, 0.0, 1.0])
        .with_held(ALONG)
}

pub(crate) const AXIAL: [bool; 6] = [true, false, false, false, false, false];

/// Forces of the contacts at each step, and products.
pub(crate) fn contact_forces(simulation: &mut Simulation) -> Vec<(Vec<[f64; 3]>, usize)> {
    let mut out = Vec::new();
    while !simulation.is_finished() {
        let one = step(simulation);
        assert_certified(&one, &format!("{} s", one.time));
        let result = simulation.result().expect("a step");
        let reactions = result.reactions();
        let rest = vec3::norm(reactions.imbalance().force);
        assert!(rest < 1e-2, "{rest:e} N are left");
        out.push((
            reactions.contacts.iter().map(|c| c.force).collect(),
            one.report.counters.products,
        ));
    }
    out
}

/// The preload presses the plates onto each other, and friction between them holds a force across.
#[test]
fn a_bolted_joint_holds_by_friction() {
    for order in [1, 2] {
        let across = Load::force(UPPER_END, [1.5e3, 0.0, 0.0]);
        let scene = tightened(joint(0.2, order), bolt(), [0.0, 1.0, 1.0], across);
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let found = contact_forces(&mut simulation);
        for ((forces, products), [bolt, pull]) in found.iter().zip([[5e3, 0.0], [1e4, 0.0], [1e4, 750.0], [1e4, 1.5e3]])
        {
            for (force, sign) in forces.iter().zip([1.0, 1.0, 1.0, -1.0]) {
                assert!((force[2] - sign * bolt).abs() < 1e-3 * bolt, "{forces:?}");
            }
            // the bolt bends a little, and takes a part of it
            assert!((forces[1][0] - forces[0][0] + pull).abs() < 1.0, "{forces:?}");
            assert!(
                forces[1][0].abs() <= 0.2 * bolt && forces[0][0].abs() < 50.0,
                "{forces:?}"
            );
            assert!(*products < 150, "{products} products");
        }
        // more than friction holds, on both sides of the upper plate
        let across = Load::force(UPPER_END, [5e3, 0.0, 0.0]);
        let scene = tightened(joint(0.2, order), bolt(), [0.0, 1.0, 1.0], across);
        let error = Simulation::new(scene, Settings::default())
            .map(|_| ())
            .expect_err("slides");
        assert!(matches!(error, ContactError::NotHeld { step: 3, .. }), "{error}");
    }
}

/// Ranks and methods agree: the same bits, and the same state.
#[test]
fn ranks_and_methods_agree() {
    let scene = || {
        let pull = Load::force(UPPER_END, [1.5e3, 0.0, 0.0]);
        tightened(joint(0.2, 1), bolt().with_lock(AXIAL, 1.0), [0.0, 1.0, 0.0], pull)
    };
    let last = |settings: Settings| {
        let mut simulation = Simulation::new(scene(), settings).expect("set-up");
        rest(&mut simulation).pop().expect("steps").displacement
    };
    let alone = last(Settings::default());
    for count in [2, 3] {
        for run in on_ranks(count, |c| last(Settings::default().with_communicator(c))) {
            assert!(run.expect("no panic") == alone, "{count} ranks");
        }
    }
    let found = last(Settings::default().with_method(Method::paper()).with_tolerance(1e-7));
    assert_close(&found, &alone, 1e-3, "SMALSE");
}

#[test]
fn what_is_refused_says_why() {
    let refused = |scene: Scene| {
        let error = Simulation::new(scene, Settings::default())
            .map(|_| ())
            .expect_err("refused");
        error.to_string()
    };
    let bar = || bar(1, [2, 1, 1]);
    for (coupling, why) in [
        (Coupling::relative(1, POINT), "no tied contact of its number"),
        (end().with_axis([0.0; 3]), "its axis has no direction"),
        (end().with_lock(AXIAL, f64::NAN), "the time from which it is locked"),
        (
            end().with_motion([1e-3, 0.0, 0.0, 0.0, 0.0, 0.0], moved()),
            "a motion that it does not hold",
        ),
    ] {
        let message = refused(bar().with_coupling(coupling));
        assert!(message.contains(why), "{message}");
    }
    // the part behind a free slide is named, and not its motion relative to the other
    let slides = bar().with_coupling(end().with_held(ALONG));
    let only_first = Scene::new(slides.mesh().clone(), slides.materials().clone())
        .with_support(Support::fixed(brick::X_MIN))
        .with_contact(slides.contacts()[0].clone())
        .with_coupling(slides.couplings()[0].clone())
        .with_load(Load::force(brick::X_MAX, [1e5, 0.0, 0.0]));
    let message = refused(only_first.clone());
    assert!(
        message.contains("body 1 (with node") && !message.contains("together"),
        "{message}"
    );
    // and what leaves it free, in the names of the scene
    let free =
        "or hold coupling 0, which lets the sides of contact 0 move, in its displacement along (1.000, 0.000, 0.000)";
    assert!(message.contains(free), "{message}");
    // but not where a load is to move it
    let pushed = Load::on_coupling(0, [1e4, 0.0, 0.0], [0.0; 3]);
    let message = refused(only_first.clone().with_load(pushed));
    assert!(
        message.contains("body 1") && !message.contains("hold coupling"),
        "{message}"
    );
    let named = only_first.with_names(|part| matches!(part, Part::Coupling(0)).then(|| "the bolt".to_owned()));
    let message = refused(named);
    assert!(message.starts_with("coupling 0 is the bolt: "), "{message}");
    // a hinge, with another one that is held
    let arm = |held: Coupling| {
        Scene::new(slides.mesh().clone(), slides.materials().clone())
            .with_support(Support::fixed(brick::X_MIN))
            .with_contact(slides.contacts()[0].clone())
            .with_coupling(held)
            .with_load(Load::force(brick::X_MAX, [0.0, 0.0, 1e5]))
    };
    let hinge = Coupling::relative(0, [0.9, 0.5, 0.5]).with_held([true, true, true, true, false, true]);
    let message = refused(arm(hinge));
    assert!(
        message.contains("in its rotation about (0.000, 1.000, 0.000) (Coupling::with_held)"),
        "{message}"
    );
    // where no coupling is at fault none is named
    let whole = Scene::new(slides.mesh().clone(), slides.materials().clone())
        .with_contact(slides.contacts()[0].clone())
        .with_coupling(end().with_held(ALONG))
        .with_load(Load::force(brick::X_MAX, [0.0, 0.0, 1e5]));
    let message = refused(whole);
    assert!(!message.contains("coupling 0"), "{message}");
    let message = refused(bar().with_coupling(end()).with_coupling(end()));
    assert!(message.contains("another coupling says how"), "{message}");
    // rough on both sides
    let floor = |friction| Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(friction));
    let rubs = |friction| {
        bar()
            .with_contact(floor(friction))
            .with_coupling(end().with_held(ALONG))
    };
    let message = refused(rubs(0.3));
    assert!(
        message.contains("how they share the force is not determined"),
        "{message}"
    );
    assert!(Simulation::new(rubs(0.0), Settings::default()).is_ok());
    // held on both sides where the sides may turn
    let both = Support::components(brick::Y_MIN, [false, true, false]);
    let plane = bar().with_support(both.clone()).with_coupling(end().with_held(ALONG));
    assert!(Simulation::new(plane, Settings::default()).is_ok());
    let message = refused(bar().with_support(both).with_coupling(end()));
    assert!(message.contains("supports hold both sides"), "{message}");
}

/// Beside a plain tie it costs no products, held or loaded, with however many nodes and subdomains.
#[test]
fn it_costs_no_products() {
    for (cells, boxes) in [([24, 12, 12], [12, 6, 6]), ([36, 18, 18], [18, 9, 9])] {
        let mesh = Brick::new([2.0, 1.0, 1.0], cells).build().expect("brick");
        let mesh = cut_at(&mesh, 0, 1.0);
        let products = |coupling: Option<Coupling>, force: f64| {
            let wall = Contact::rigid(brick::X_MAX).with_friction(Friction::coulomb(0.3));
            let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
                .with_support(Support::fixed(brick::X_MIN))
                .with_contact(Contact::tied(FIRST, SECOND))
                .with_contact(wall)
                .with_load(Load::body([0.0, 0.0, -3e6]))
                .with_boxes(boxes);
            let scene = coupling.into_iter().fold(scene, Scene::with_coupling);
            let scene = match force {
                0.0 => scene,
                _ => scene.with_load(Load::on_coupling(0, [force, 0.0, 0.0], [0.0; 3])),
            };
            let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
            let one = step(&mut simulation);
            assert_certified(&one, "cost");
            one.report.counters.products
        };
        let tied = products(None, 0.0);
        let held = products(Some(end().with_held([true; 6])), 0.0);
        let loaded = products(Some(end().with_held(ALONG)), -1e8);
        assert!(
            held <= tied + 3 && loaded <= tied + 3,
            "{tied}, {held} and {loaded} products"
        );
    }
}
