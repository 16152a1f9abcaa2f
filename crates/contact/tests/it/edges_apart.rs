//! Contacts that a scene names apart stay apart where they share nodes, at any angle between them; on a flat side the
//! nearer obstacle acts with its own law.

use crate::common::*;

/// How deep nodes are inside an obstacle with one normal, over the largest displacement.
fn depth(scene: &Scene, result: &Solved, tag: FacetTag, normal: [f64; 3], gap: f64) -> f64 {
    let u = result.displacement.as_chunks::<3>().0;
    let size = result.displacement.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let nodes = scene.mesh().nodes_on(tag).into_iter();
    let along = |k: u32| (0..3).map(|c| u[k as usize][c] * normal[c]).sum::<f64>();
    nodes.map(|k| along(k) - gap).fold(f64::NEG_INFINITY, f64::max) / size
}

/// A floor, and a wall that leans outwards such that their normals differ by so many degrees.
fn leaning(degrees: f64, friction: f64, gap: f64) -> (Scene, [f64; 3]) {
    let slope = degrees.to_radians();
    let lean = 1.0 / slope.tan();
    let mesh = block([1.0; 3], [4, 4, 4])
        .map_points(|[x, y, z]| [x * (1.0 + lean * z), y, z])
        .expect("mesh");
    let side = |tag| Contact::rigid(tag).with_friction(Friction::coulomb(friction));
    let scene = Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::body([-1e7, 0.0, -4e7]))
        .with_contact(side(brick::Z_MIN))
        .with_contact(side(brick::X_MAX).with_gap(gap))
        .with_boxes([2, 1, 1]);
    (scene, [slope.sin(), 0.0, -slope.cos()])
}

/// The edge of two contacts that meet at an edge was 45 % of the largest displacement inside the floor, and certified.
#[test]
fn edges_of_any_angle_stay_outside_both_obstacles() {
    for degrees in [20.0, 35.0, 50.0, 59.9, 65.0, 90.0] {
        for friction in [0.0, 0.3] {
            let (scene, wall) = leaning(degrees, friction, 2e-3);
            let result = solve(scene.clone(), Settings::default());
            assert_eq!(result.points.len(), 45);
            let floor = depth(&scene, &result, brick::Z_MIN, [0.0, 0.0, -1.0], 0.0);
            let wall = depth(&scene, &result, brick::X_MAX, wall, 2e-3);
            assert!(floor < 1e-6 && wall < 1e-6, "{degrees} {friction}: {floor:e} {wall:e}");
        }
    }
}

const RIGHT: FacetTag = FacetTag(77);

/// A block whose lower side has the tag `RIGHT` beyond the middle, and a kink of so many radians there.
fn kinked(angle: f64) -> TetMesh {
    let mesh = block([2.0, 1.0, 1.0], [8, 2, 4]);
    let facet = |f: &Facet| {
        let x = f.nodes.map(|n| mesh.points()[n as usize][0]);
        let right = f.tag == brick::Z_MIN && x.iter().sum::<f64>() > 3.0;
        Facet {
            tag: if right { RIGHT } else { f.tag },
            ..*f
        }
    };
    let facets = mesh.facets().iter().map(facet).collect();
    let (points, tets) = (mesh.points().to_vec(), mesh.tets().to_vec());
    TetMesh::new(points, tets, facets)
        .expect("mesh")
        .map_points(|[x, y, z]| [x, y, z + (1.0 - z) * angle.tan() * (x - 1.0).max(0.0)])
        .expect("mesh")
}

/// Pressed by 1 mm and moved along by 2 mm.
fn pressed(mesh: TetMesh, left: Contact, right: Contact) -> Scene {
    Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::Z_MAX).with_motion([2e-3, 0.0, -1e-3], History::constant(1.0)))
        .with_contact(left)
        .with_contact(right)
        .with_boxes([2, 1, 1])
}

/// Normals that hardly differ are rows that hardly differ: solved for at any angle, with the result of a flat side in
/// the end.
#[test]
fn the_smaller_the_angle_the_more_it_is_one_side() {
    let of = |angle: f64, friction: f64, settings: Settings| {
        let side = |tag| Contact::rigid(tag).with_friction(Friction::coulomb(friction));
        let scene = pressed(kinked(angle), side(brick::Z_MIN), side(RIGHT));
        let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
        let result = step(&mut simulation);
        let found = result.certificate.largest();
        // rows that nearly depend on one another leave the certificate above the tolerance, not above its limit
        assert!(result.report.status.converged() && found < 3e-5, "{found:e}");
        for (tag, normal) in [
            (brick::Z_MIN, [0.0, 0.0, -1.0]),
            (RIGHT, [angle.sin(), 0.0, -angle.cos()]),
        ] {
            let depth = depth(&scene, &result, tag, normal, 0.0);
            assert!(depth < 3e-5, "{angle:e}: {depth:e}");
        }
        (result.points.len(), result.summary.normal_force)
    };
    for friction in [0.0, 0.3] {
        let (points, flat) = of(0.0, friction, Settings::default());
        assert_eq!(points, 27);
        for settings in methods().map(by) {
            for exponent in 1..9 {
                let angle = 10.0_f64.powi(-exponent);
                let (points, force) = of(angle, friction, settings.clone());
                // one point where coordinates hardly tell the normals apart
                assert_eq!(points, if exponent <= 5 { 30 } else { 27 }, "{angle:e}");
                let off = (force / flat - 1.0).abs();
                assert!(off < 2.0 * angle + 2e-6, "{angle:e}: {off:e}");
            }
        }
    }
}

/// On a flat side the node is one point: of the first contact where the obstacles are as far, else of the nearer one.
#[test]
fn on_a_flat_side_the_law_is_that_of_the_obstacle_that_is_touched() {
    // [gap, coefficient] of both
    for (left, right, first) in [
        ([0.0, 0.4], [0.0, 0.1], true),
        ([2e-4, 0.4], [2e-4 * (1.0 + 1e-13), 0.1], true),
        ([2e-4 * (1.0 + 1e-13), 0.4], [2e-4, 0.1], true),
        ([0.0, 0.4], [2e-4, 0.1], true),
        ([2e-4, 0.4], [0.0, 0.1], false),
    ] {
        for swap in [false, true] {
            let side = |tag, [gap, mu]: [f64; 2]| {
                let law = Friction::coulomb(mu);
                Contact::rigid(tag).with_gap(gap).with_friction(law)
            };
            let (a, b) = (side(brick::Z_MIN, left), side(RIGHT, right));
            let (a, b) = if swap { (b, a) } else { (a, b) };
            let mesh = kinked(0.0);
            let places = mesh.points().to_vec();
            let (_, results) = run(pressed(mesh, a, b), Settings::default());
            assert_eq!(results[0].points.len(), 27);
            let as_far = (left[0] - right[0]).abs() < 1e-12;
            // which of them is the left one, and whose the edge is
            let of_left = usize::from(swap);
            let of_edge = match (as_far, first) {
                (true, _) => 0,
                (false, true) => of_left,
                (false, false) => 1 - of_left,
            };
            let mut edge = 0.0;
            for point in &results[0].points {
                let x = places[point.node as usize][0];
                let expected = match x - 1.0 {
                    d if d.abs() < 1e-9 => of_edge,
                    d if d < 0.0 => of_left,
                    _ => 1 - of_left,
                };
                assert_eq!(point.surface, expected, "{x}");
                let [_, mu] = if expected == of_left { left } else { right };
                assert!((point.slip_bound + mu * point.normal_force).abs() < 1e-6);
                if (x - 1.0).abs() < 1e-9 {
                    edge += point.area;
                }
            }
            // a strip of half a cell on each side that is touched
            let strips = if as_far { 2.0 } else { 1.0 };
            assert!((edge - 0.125 * strips).abs() < 1e-12, "{edge}");
            let deep = results[0].points.iter().map(|p| -p.gap).fold(0.0, f64::max);
            assert!(deep < 1e-9, "{deep:e}");
        }
    }
}

/// A block half on another one and half on the floor: nodes of the border touch both, along one normal.
#[test]
fn a_partner_and_an_obstacle_are_two() {
    let upper = kinked(0.0);
    let under = |tag: FacetTag| FacetTag(tag.0 + 100);
    let lower = block([1.0, 1.0, 0.5], [4, 2, 2])
        .map_points(|[x, y, z]| [x, y, z - 0.5])
        .expect("mesh")
        .map_tags(under);
    let mesh = upper.append(&lower).expect("two bodies");
    for boxes in [[1, 1, 1], [2, 1, 2]] {
        let pair = Contact::between(brick::Z_MIN, under(brick::Z_MAX));
        let scene = pressed(mesh.clone(), pair, Contact::rigid(RIGHT))
            .with_support(Support::fixed(under(brick::Z_MIN)))
            .with_boxes(boxes);
        let simulation = Simulation::new(scene.clone(), Settings::default()).expect("set-up");
        // 5 x 3 pairs and as many on the floor, 3 nodes in both
        assert_eq!(simulation.constrained_points().len(), 30);
        let result = solve(scene.clone(), Settings::default());
        let floor = depth(&scene, &result, RIGHT, [0.0, 0.0, -1.0], 0.0);
        assert!(floor < 1e-6, "{floor:e}");
    }
}

/// A brick whose lower side has another tag beyond x = 1.
fn two_tags() -> TetMesh {
    let mesh = block([2.0, 1.0, 1.0], [4, 2, 2]);
    let points = mesh.points().to_vec();
    let facets = mesh.facets().iter().map(|f| {
        let mut facet = *f;
        let x = f.nodes.iter().map(|n| points[*n as usize][0]).sum::<f64>() / 3.0;
        if f.tag == brick::Z_MIN && x > 1.0 {
            facet.tag = RIGHT;
        }
        facet
    });
    let facets = facets.collect();
    TetMesh::new(points.clone(), mesh.tets().to_vec(), facets).expect("mesh")
}

#[test]
fn the_nearer_obstacle_acts_at_nodes_that_two_contacts_share() {
    let press = 1e-3;
    let (near, far) = (0.0, 0.4 * press);
    let mesh = two_tags();
    let border: Vec<u32> = (0..)
        .zip(mesh.points())
        .filter(|(_, x)| x[0] == 1.0 && x[2] == 0.0)
        .map(|(n, _)| n)
        .collect();
    assert_eq!(border.len(), 3);
    let part = |tag, gap, mu| Contact::rigid(tag).with_gap(gap).with_friction(Friction::coulomb(mu));
    let (first, second) = (part(brick::Z_MIN, near, 0.4), part(RIGHT, far, 0.1));
    for contacts in [[first.clone(), second.clone()], [second, first]] {
        let nearer = contacts.iter().position(|c| c.tags() == [brick::Z_MIN]);
        let scene = Scene::new(mesh.clone(), uniform(1e6, 0.3))
            .with_support(Support::fixed(brick::Z_MAX).with_motion([1e-2, 0.0, -press], History::constant(1.0)));
        let scene = contacts.into_iter().fold(scene, Scene::with_contact);
        let result = solve(scene, tight());
        for &node in &border {
            // no deeper than the nearer obstacle lets it
            let down = -result.displacement[3 * node as usize + 2];
            assert!(down <= near + 1e-9 * press, "node {node}: {down:e}");
            let pressed = result
                .points
                .iter()
                .filter(|p| p.node == node && p.normal_force < -1e-3);
            let pressed: Vec<_> = pressed.collect();
            assert_eq!(pressed.len(), 1, "{pressed:?}");
            let (point, force) = (pressed[0], -pressed[0].normal_force);
            assert_eq!(Some(point.surface), nearer);
            assert!((point.slip_bound - 0.4 * force).abs() <= 1e-9 * force);
            let friction = norm(&point.friction_force);
            assert!((friction - 0.4 * force).abs() <= 1e-6 * force, "{point:?}");
        }
        // beyond the border the other part counts
        let beyond = result.points.iter().filter(|p| Some(p.surface) != nearer);
        assert!(beyond.clone().count() >= 6);
        for point in beyond {
            assert!((point.slip_bound + 0.1 * point.normal_force).abs() < 1e-9);
        }
    }
}

/// A block on a plate of coarser cells, pressed and pushed at its top: it tips where the push times its height is the
/// pressing force times half its width. Points on the plate, up to a cell beyond the block, held it up to 1.5 times
/// that.
#[test]
fn a_block_on_a_coarse_plate_tips_over_its_own_edge() {
    for order in [1, 2] {
        for cells in [5, 10] {
            let shifted = |[x, y, z]: [f64; 3]| [x + 14.0, y + 14.0, z + 5.0];
            let block = |lengths, cells| match order {
                1 => block(lengths, cells),
                _ => block(lengths, cells).raise_order().expect("order 2"),
            };
            let plate = block([40.0, 40.0, 5.0], [cells, cells, 1]);
            let foot = block([12.0, 12.0, 10.0], [6, 6, 5]).map_points(shifted).expect("moved");
            let pushed = |part: f64| {
                let contact = Contact::between(second(brick::Z_MIN), brick::Z_MAX);
                let scene = Scene::new(with_second(&plate, &foot), uniform(2.1e5, 0.3))
                    .with_support(Support::fixed(brick::Z_MIN))
                    .with_load(Load::traction(second(brick::Z_MAX), [part * 40.0 * 0.6, 0.0, -40.0]))
                    .with_contact(contact.with_friction(Friction::coulomb(2.0)));
                let mut simulation = Simulation::new(scene, Settings::default())?;
                simulation.step().map(|result| result.report().status.converged())
            };
            assert!(matches!(pushed(0.8), Ok(true)), "{order} {cells}: below");
            for beyond in [1.03, 1.3] {
                assert!(!matches!(pushed(beyond), Ok(true)), "{order} {cells}: {beyond}");
            }
        }
    }
}

/// A roof on a roof: one contact of both sides acts at the ridge along neither, which is told; two contacts do not.
#[test]
fn creases_between_bodies_are_told() {
    let roof = |below: f64, slope: f64| {
        let slope = slope.to_radians().tan();
        kinked(0.0)
            .map_points(|[x, y, z]| [x, y, z - below - slope * (x - 1.0).abs()])
            .expect("roof")
    };
    let told = |slope: f64, contacts: &[Contact]| {
        let mesh = with_second(&roof(0.0, slope), &roof(1.0, slope));
        let scene = Scene::new(mesh, uniform(1e9, 0.3))
            .with_support(Support::fixed(second(brick::Z_MIN)))
            .with_support(Support::fixed(second(RIGHT)))
            .with_load(Load::body([0.0, 0.0, -1e6]));
        let scene = contacts
            .iter()
            .fold(scene, |scene, contact| scene.with_contact(contact.clone()));
        let plan = Plan::new(&scene, &Settings::default()).expect("plan");
        let found = plan.warnings().iter().filter_map(|w| match w {
            Warning::CreaseBetween { place, angle, .. } => Some((*place, *angle)),
            _ => None,
        });
        found.collect::<Vec<_>>()
    };
    let whole = Contact::between(brick::Z_MIN, second(brick::Z_MAX)).with_tag(RIGHT);
    let found = told(40.0, std::slice::from_ref(&whole));
    assert!(
        matches!(found[..], [([x, _, z], angle)] if x == 1.0 && z == 0.0 && (angle - 80.0).abs() < 1e-9),
        "{found:?}"
    );
    assert!(told(20.0, std::slice::from_ref(&whole)).is_empty());
    assert!(told(40.0, &[whole.with_crease(180.0)]).is_empty());
    let halves = [brick::Z_MIN, RIGHT].map(|side| Contact::between(side, second(brick::Z_MAX)));
    assert!(told(40.0, &halves).is_empty());
}
