//! Bodies that reach beyond what they stand on, on meshes that do not match: they topple where they must, whichever
//! side is named first.

use crate::common::*;

/// A plank of 1 N and length 1 that reaches beyond a fixed block of the same length by `over`.
fn overhangs(cells: [usize; 3], order: u8, over: f64, swap: bool) -> bool {
    let lower = block([1.0, 0.5, 0.25], [cells[0], cells[2], 1]);
    let upper = block([1.0, 0.5, 0.25], [cells[1], cells[2], 1])
        .map_points(|[x, y, z]| [x + over, y, z + 0.25])
        .expect("moved");
    let (under, top) = (second(brick::Z_MIN), brick::Z_MAX);
    let [first, other] = if swap { [top, under] } else { [under, top] };
    let mesh = in_order(with_second(&lower, &upper), order);
    let scene = Scene::new(mesh, uniform(2e11, 0.3))
        .with_support(Support::fixed(brick::Z_MIN))
        .with_contact(Contact::between(first, other).with_friction(Friction::coulomb(0.5)))
        .with_load(Load::body([0.0, 0.0, -8.0]));
    let result = Simulation::new(scene, Settings::default()).and_then(|mut s| s.step());
    match result {
        Ok(result) => result.report().status.converged(),
        Err(ContactError::NotHeld { .. }) => false,
        Err(error) => panic!("{cells:?} {order} {over} {swap}: {error}"),
    }
}

fn in_order(mesh: TetMesh, order: u8) -> TetMesh {
    match order {
        2 => mesh.raise_order().expect("order 2"),
        _ => mesh,
    }
}

/// Points at nodes beyond the block had levers that it does not have: planks stood that reach beyond by up to 0.95, and
/// pulled its edge up.
#[test]
fn planks_topple_beyond_their_middle() {
    for cells in [
        [3, 3, 2],
        [4, 4, 1],
        [7, 7, 2],
        [1, 1, 1],
        [3, 4, 2],
        [5, 1, 2],
        [8, 2, 2],
    ] {
        for (swap, order) in [(false, 1), (true, 1), (false, 2), (true, 2)] {
            // means of quadratic facets lie within these
            let most = if order == 1 { 0.499 } else { 0.3 };
            for (over, stands) in [(0.3, true), (most, true), (0.501, false), (0.53, false), (0.9, false)] {
                let found = overhangs(cells, order, over, swap);
                assert_eq!(found, stands, "{cells:?}, {order}, {over}, {swap}");
            }
        }
    }
}

/// A plank on two narrow supports: each has half of it; one had up to 0.55.
#[test]
fn supports_of_a_plank_are_pressed_alike() {
    for (cells, under) in [(4, 4), (8, 8), (4, 5), (10, 3)] {
        for (swap, order) in [(false, 1), (true, 1), (false, 2), (true, 2)] {
            let foot = |from: f64| {
                block([0.2, 0.5, 0.25], [under, 2, 1])
                    .map_points(|[x, y, z]| [x + from, y, z])
                    .expect("moved")
            };
            let plank = block([1.0, 0.5, 0.25], [cells, 2, 1])
                .map_points(|[x, y, z]| [x, y, z + 0.25])
                .expect("moved");
            let mesh = foot(-0.1)
                .append(&foot(0.9).map_tags(|t| FacetTag(t.0 + 200)))
                .expect("feet");
            let top = [brick::Z_MAX, FacetTag(brick::Z_MAX.0 + 200)];
            let mesh = in_order(with_second(&mesh, &plank), order);
            let mut scene = Scene::new(mesh, uniform(2e11, 0.3))
                .with_support(Support::fixed(brick::Z_MIN))
                .with_support(Support::fixed(FacetTag(brick::Z_MIN.0 + 200)))
                .with_load(Load::body([0.0, 0.0, -8.0]));
            for top in top {
                let under = second(brick::Z_MIN);
                let [first, other] = if swap { [top, under] } else { [under, top] };
                scene = scene.with_contact(Contact::between(first, other).with_friction(Friction::coulomb(0.5)));
            }
            let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
            let result = simulation.step().expect("step");
            let forces: Vec<f64> = result
                .reactions()
                .contacts
                .iter()
                .map(|contact| contact.force[2].abs())
                .collect();
            assert!(
                forces.iter().all(|f| (f - 0.5).abs() < 0.03),
                "{cells} {under} {order} {swap}: {forces:?}"
            );
        }
    }
}

/// A column of loose cubes that its weight, inclined, topples by a thousandth: no friction would hold it. That took
/// seconds to be told, growing with the fifth power of their number.
#[test]
fn columns_that_topple_are_refused_at_once() {
    let count = 12;
    let cube = |k: usize| {
        block([1.0; 3], [1; 3])
            .map_points(|[x, y, z]| [x, y, z + k as f64])
            .expect("moved")
            .map_tags(|t| FacetTag(t.0 + 10 * k as u32))
    };
    let mesh = (1..count).fold(cube(0), |mesh, k| mesh.append(&cube(k)).expect("column"));
    let column = |inclined: f64| {
        let scene = Scene::new(mesh.clone(), uniform(1e9, 0.3))
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.7)))
            .with_load(Load::body([inclined * 1e4 / count as f64, 0.0, -1e4]));
        (1..count).fold(scene, |scene, k| {
            let [under, top] = [(brick::Z_MIN, k), (brick::Z_MAX, k - 1)].map(|(t, k)| FacetTag(t.0 + 10 * k as u32));
            scene.with_contact(Contact::between(under, top).with_friction(Friction::coulomb(0.7)))
        })
    };
    let refused = Simulation::new(column(1.001), Settings::default()).map(|_| ());
    assert!(
        matches!(refused, Err(ContactError::NotHeld { friction: None, .. })),
        "{refused:?}"
    );
    assert_certified(&solve(column(0.99), Settings::default()), "a column that stands");
}

/// A block that ends just beyond nodes of a coarser plate: those beyond them have no points, and the others have their
/// areas. Farther beyond they have their own.
#[test]
fn covers_that_end_beside_nodes_are_shared_out() {
    for order in [1, 2] {
        for (beyond, columns) in [(0.0, 3), (1e-3, 3), (0.01, 3), (0.2, 4)] {
            let plate = block([2.0, 1.0, 0.5], [4, 2, 1]);
            let upper = block([1.0 + beyond, 1.0, 0.5], [5, 3, 1]);
            let mesh = in_order(with_second(&plate, &lifted(&upper, 0.5)), order);
            let scene = Scene::new(mesh, uniform(2e11, 0.3))
                .with_support(Support::fixed(brick::Z_MIN))
                .with_contact(
                    Contact::between(brick::Z_MAX, second(brick::Z_MIN)).with_friction(Friction::coulomb(0.5)),
                )
                .with_load(Load::traction(second(brick::Z_MAX), [0.0, 0.0, -1e6]));
            let (_, results) = run(scene, Settings::default());
            let points = &results[0].points;
            let area: f64 = points.iter().map(|p| p.area).sum();
            assert!((area - 1.0 - beyond).abs() < 1e-12, "{order} {beyond}: {area}");
            assert_eq!(points.len(), 3 * columns, "{order} {beyond}");
            assert!(results[0].report.status.converged(), "{order} {beyond}");
        }
    }
}
