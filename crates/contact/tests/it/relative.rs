//! Tied sides that move relative to each other: against motions of ties, held against loaded, hinges, a bolted joint.

use crate::common::*;
use crate::couplings::{POINT, YOUNG, assert_close, moved};
use signorini_contact::result::CouplingMotion;
use signorini_fem_mesh::mesh::drop_unused_nodes;
use signorini_fem_mesh::{SurfaceFrame, vec3};

/// The sides of a cut.
const FIRST: FacetTag = FacetTag(31);
const SECOND: FacetTag = FacetTag(32);

/// A mesh that is cut across where the centroids of tetrahedra pass a plane.
fn cut_at(mesh: &TetMesh, axis: usize, at: f64) -> TetMesh {
    let first = |tet: usize| Some(vec3::centroid(&mesh.tet_points(tet))[axis] < at);
    mesh.cut(first, [FIRST, SECOND]).expect("cut").0
}

/// A bar held at both ends and cut in the middle, along faces that are not plane where its mesh is not.
fn bar(order: usize, boxes: [usize; 3]) -> Scene {
    with_tie(order, boxes, Contact::tied(FIRST, SECOND))
}

fn with_tie(order: usize, boxes: [usize; 3], tie: Contact) -> Scene {
    let mesh = Brick::new([2.0, 1.0, 1.0], [6, 3, 3])
        .perturbed(0.1, 3)
        .build()
        .expect("brick");
    let mesh = cut_at(&mesh, 0, 0.9);
    let mesh = if order == 2 {
        mesh.raise_order().expect("order 2")
    } else {
        mesh
    };
    Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(Support::fixed(brick::X_MAX))
        .with_load(Load::body([0.0, 0.0, -3e6]))
        .with_contact(tie)
        .with_boxes(boxes)
}

fn end() -> Coupling {
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

fn components(v: &CouplingMotion) -> [f64; 6] {
    let [a, b] = [v.displacement, v.rotation];
    [a[0], a[1], a[2], b[0], b[1], b[2]]
}

const ALONG: [bool; 6] = [false, true, true, true, true, true];

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
        assert_close(&components(&found.3), &motion, 1e-6, "motion");
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
    assert_close(&components(&found.3), &motion, 1e-6, "motion along an axis");
}

/// An arm on a hinge, whose reaction follows from equilibrium alone.
#[test]
fn a_hinge_transfers_no_moment_about_its_axis() {
    for order in [1, 2] {
        let mesh = Brick::new([2.0, 1.0, 1.0], [20, 4, 4]).build().expect("brick");
        let mesh = cut_at(&mesh, 0, 0.9);
        let mesh = if order == 2 {
            mesh.raise_order().expect("order 2")
        } else {
            mesh
        };
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
const UPPER_TOP: FacetTag = FacetTag(43);
const UPPER_BOTTOM: FacetTag = FacetTag(44);
const LOWER_TOP: FacetTag = FacetTag(45);
const LOWER_BOTTOM: FacetTag = FacetTag(46);
const LOWER_END: FacetTag = FacetTag(47);
const UPPER_END: FacetTag = FacetTag(48);

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
fn joint(friction: f64, order: usize) -> Scene {
    let plate = |z: f64, left: f64, top: FacetTag, bottom: FacetTag, end: FacetTag| {
        let hole = |p: [f64; 3]| p[0].abs() > 2.0 * CELL || p[1].abs() > 2.0 * CELL;
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
    let mesh = lower
        .append(&upper)
        .and_then(|both| both.append(&bolt))
        .expect("one mesh");
    let mesh = if order == 2 {
        mesh.raise_order().expect("order 2")
    } else {
        mesh
    };
    let rough = |a, b| Contact::between(a, b).with_friction(Friction::coulomb(friction));
    Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(LOWER_END))
        .with_contact(Contact::tied(FIRST, SECOND))
        .with_contact(rough(UPPER_BOTTOM, LOWER_TOP))
        .with_contact(rough(UNDER_HEAD, UPPER_TOP))
        .with_contact(rough(ABOVE_NUT, LOWER_BOTTOM))
}

#[test]
fn probe() {
    for order in [1, 2] {
        let ramp = History::ramp(1.0, 1.0).expect("ramp");
        let scene = joint(0.2, order)
            .with_coupling(
                Coupling::relative(0, [0.0; 3])
                    .with_axis([0.0, 0.0, 1.0])
                    .with_held(ALONG),
            )
            .with_load(Load::on_coupling(0, [0.0, 0.0, 1e4], [0.0; 3]).with_history(ramp))
            .with_load(
                Load::force(UPPER_END, [1.5e3, 0.0, 0.0])
                    .with_history(History::table(vec![(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)]).expect("table")),
            )
            .with_analysis(Analysis::quasistatic(2.0, 4));
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        println!("{}", simulation.plan());
        while !simulation.is_finished() {
            let one = step(&mut simulation);
            println!("{}", simulation.result().expect("step"));
            let result = simulation.result().expect("a step");
            let reactions = result.reactions();
            println!(
                "{} products, {:?}, contacts {:?}",
                one.report.counters.products,
                result.couplings()[0],
                reactions.contacts.iter().map(|c| c.force).collect::<Vec<_>>()
            );
        }
    }
}
