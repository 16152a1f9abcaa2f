//! Obstacles that end at an edge, and what lies over it.

use crate::common::*;

/// A table that ends at x: a box of triangles, or an open sheet.
fn table(end: f64, is_box: bool) -> Obstacle {
    table_at(0.0, end, is_box)
}

/// The same at some height.
fn table_at(height: f64, end: f64, is_box: bool) -> Obstacle {
    let whole = block([end + 1.0, 3.0, 1.0], [1; 3]);
    let whole = whole.map_points(|[x, y, z]| [x - 1.0, y - 1.0, z - 1.0 + height]);
    let whole = whole.expect("box");
    let mut facets = whole.facets().to_vec();
    facets.retain(|facet| is_box || facet.tag == brick::Z_MAX);
    let triangles: Vec<[u32; 3]> = facets.iter().map(|facet| facet.nodes).collect();
    Obstacle::surface(whole.points(), &triangles).expect("a table")
}

/// A block [0, 2] x [0, 1] x [0, 0.5] with node rows at 1 and 1.2, whose end is moved along the table.
fn over_the_edge(contact: Contact, way: f64) -> Scene {
    of_order(1, contact, way)
}

fn of_order(order: usize, contact: Contact, way: f64) -> Scene {
    let mesh = block([2.0, 1.0, 0.5], [10, 3, 3]);
    let mesh = match order {
        2 => mesh.raise_order().expect("quadratic"),
        _ => mesh,
    };
    Scene::new(mesh, uniform(1e6, 0.3))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e3]))
        .with_support(Support::components(brick::X_MIN, [true, false, false]).with_motion([way, 0.0, 0.0], ramp()))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_contact(contact)
}

/// Nodes on the edge are met along the normal of the side that lies on the table, those beside it are free: they slide
/// over the edge.
#[test]
fn a_block_over_the_edge_of_a_table_is_held_by_what_is_below() {
    for end in [1.0, 1.03, 1.1999, 1.2 - 1e-12] {
        for way in [0.0, -0.01] {
            let gap = move |x: [f64; 3]| if x[0] > end + 1e-9 { 1.0 } else { 0.0 };
            let floor = Contact::rigid(brick::Z_MIN).with_gap_field(gap);
            let expected = solve(over_the_edge(floor, way), at(1e-8));
            for is_box in [true, false] {
                let contact = Contact::obstacle(brick::Z_MIN, table(end, is_box));
                let found = solve(over_the_edge(contact, way), at(1e-8));
                assert_close(
                    &found.displacement,
                    &expected.displacement,
                    1e-6,
                    &format!("{end} {way} {is_box}"),
                );
            }
        }
    }
}

/// A table that moves below nodes that lay beside it holds them, too.
#[test]
fn a_table_may_move_below_what_is_beside_it() {
    for (is_box, order) in [(true, 1), (false, 1), (true, 2), (false, 2)] {
        let of = |end: f64, way: f64| {
            let contact = Contact::obstacle(brick::Z_MIN, table(end, is_box)).with_motion([way, 0.0, 0.0], ramp());
            solve(of_order(order, contact, 0.0), at(1e-8))
        };
        let (moved, there) = (of(1.03, 0.2), of(1.23, 0.0));
        let what = format!("box {is_box}, order {order}");
        assert_eq!(moved.summary.active, there.summary.active, "{what}");
        assert_close(&moved.displacement, &there.displacement, 1e-6, &what);
    }
}

/// What the body itself moves over a table is warned of: the table has no say there.
#[test]
fn what_comes_over_the_edge_of_a_table_is_warned_of() {
    let warnings = |way: f64| {
        let contact = Contact::obstacle(brick::Z_MIN, table(1.03, true));
        let mut simulation = Simulation::new(over_the_edge(contact, way), at(1e-8)).expect("set-up");
        simulation.step().expect("step").warnings()
    };
    let turned = |w: &Warning| matches!(w, Warning::TurnedNormal { .. });
    assert!(!warnings(-0.1).iter().any(turned));
    assert!(warnings(-0.2).iter().any(turned));
}

/// The signed distance to such a box as a user writes it.
fn own_distance(end: f64) -> Obstacle {
    let beside = move |x: [f64; 3]| [(x[0] - end).max(0.0), x[2].max(0.0)];
    let distance = move |x: [f64; 3]| match beside(x) {
        [0.0, 0.0] => (x[0] - end).max(x[2]),
        [a, b] => a.hypot(b),
    };
    let gradient = move |x: [f64; 3]| match beside(x) {
        [0.0, 0.0] if x[2] >= x[0] - end => [0.0, 0.0, 1.0],
        [0.0, 0.0] => [1.0, 0.0, 0.0],
        [a, b] => [a / a.hypot(b), 0.0, b / a.hypot(b)],
    };
    Obstacle::from_distance(distance, gradient)
}

/// A quadratic block is held by as much of a table as a linear one. Means of distances to its edge, or of a gap that
/// jumps there, left one node, and the block 300 times as soft. A table that comes from far below is the same, and
/// turns nothing.
#[test]
fn a_quadratic_block_over_the_edge_of_a_table_lies_on_what_is_below() {
    let held = |order: usize, contact: Contact| {
        let found = solve(of_order(order, contact, 0.0), at(1e-8));
        let sinks = found.displacement.chunks_exact(3).map(|u| -u[2]);
        (found.summary.active, sinks.fold(0.0, f64::max))
    };
    for end in [1.9, 1.7, 1.55] {
        let beyond = move |x: [f64; 3]| if x[0] > end + 1e-9 { 1.0 } else { 0.0 };
        let lies = |obstacle| Contact::obstacle(brick::Z_MIN, obstacle);
        let comes = |obstacle| lies(obstacle).with_motion([0.0, 0.0, 0.3], ramp());
        let (touched, linear) = held(1, lies(table(end, true)));
        for (what, contact) in [
            ("box", lies(table(end, true))),
            ("sheet", lies(table(end, false))),
            ("function", lies(own_distance(end))),
            ("gap that jumps", Contact::rigid(brick::Z_MIN).with_gap_field(beyond)),
            ("normals of the body", lies(table(end, true)).with_body_normals()),
            ("one normal", lies(table(end, false)).with_normal([0.0, 0.0, -1.0])),
            ("box from below", comes(table_at(-0.3, end, true))),
            ("sheet from below", comes(table_at(-0.3, end, false))),
        ] {
            let (active, sinks) = held(2, contact);
            assert!(active.abs_diff(touched) <= 1, "{what}, {end}: {active} {touched}");
            assert!(
                (sinks / linear - 1.0).abs() < 0.1,
                "{what}, {end}: {sinks:e} {linear:e}"
            );
        }
    }
}

/// A side that a floor runs along is no side that it holds: the distance to the floor counted along the floor.
#[test]
fn a_floor_does_not_hold_the_sides_of_a_body() {
    let bottom = |tags: &[FacetTag]| {
        let floor = Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0]);
        let floor = tags.iter().fold(floor, |floor, tag| floor.with_tag(*tag));
        let scene = Scene::new(block([1.0; 3], [2; 3]), uniform(1e6, 0.3))
            .with_support(Support::components(brick::X_MIN, [true, false, false]))
            .with_support(Support::components(brick::Y_MIN, [false, true, false]))
            .with_load(Load::pressure(brick::Z_MAX, 1e4))
            .with_contact(floor.with_body_normals());
        solve(scene, at(1e-9)).displacement
    };
    assert_close(&bottom(&[brick::X_MAX]), &bottom(&[]), 1e-7, "free to grow");
}

/// Hexagons have their edges at the default angle of a crease, however they lie.
#[test]
fn hexagons_have_six_creases() {
    for turn in [0.0_f64, 0.2, 0.3, 0.7] {
        let corner = |k: usize| {
            let angle = turn + std::f64::consts::PI * k as f64 / 3.0;
            [angle.cos(), angle.sin()]
        };
        // a prism of six wedges around its axis
        let mut points = vec![[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        for k in 0..6 {
            let [x, y] = corner(k);
            points.extend([[x, y, 0.0], [x, y, 1.0]]);
        }
        let (mut tets, mut facets) = (Vec::new(), Vec::new());
        for k in 0..6_u32 {
            let [a, b] = [2 + 2 * k, 2 + 2 * ((k + 1) % 6)];
            tets.extend([[0, a, b, 1], [a, b, 1, b + 1], [a, b + 1, 1, a + 1]]);
            let side = |nodes: [u32; 3]| Facet {
                nodes,
                tag: FacetTag(5),
            };
            facets.extend([side([a, b, b + 1]), side([a, b + 1, a + 1])]);
        }
        for tet in &mut tets {
            let at = |k: usize| points[tet[k] as usize];
            let [p, q, r, s] = [at(0), at(1), at(2), at(3)];
            let d = |a: [f64; 3]| [a[0] - p[0], a[1] - p[1], a[2] - p[2]];
            let [q, r, s] = [d(q), d(r), d(s)];
            let volume = q[0] * (r[1] * s[2] - r[2] * s[1]) - q[1] * (r[0] * s[2] - r[2] * s[0])
                + q[2] * (r[0] * s[1] - r[1] * s[0]);
            if volume < 0.0 {
                tet.swap(2, 3);
            }
        }
        let mesh = TetMesh::new(points, tets, facets).expect("a prism");
        let scene = Scene::new(mesh, uniform(1e6, 0.3))
            .with_support(Support::fixed(vec![0, 1]))
            .with_contact(Contact::rigid(FacetTag(5)).with_gap(0.1));
        let simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        // two at each of the twelve nodes
        assert_eq!(simulation.constrained_points().len(), 24, "turned by {turn}");
    }
}
