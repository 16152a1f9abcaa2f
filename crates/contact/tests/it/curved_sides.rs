//! Sides that are apart though their bodies are not: curved ones whose meshes do not match. Tied, and tied across a
//! distance, linear displacements are the same on both, and forces and moments balance.

use crate::common::*;
use signorini_fem_mesh::mesh::{drop_unused_nodes, merge_nodes};
use std::f64::consts::TAU;

const YOUNG: f64 = 1e3;

/// A ring about the z axis from a brick of radius, angle and height, closed where its ends meet.
pub(crate) fn ring(radii: [f64; 2], cells: [usize; 3], phase: f64, order: usize) -> TetMesh {
    closed(block([1.0; 3], cells), radii, phase, order)
}

/// A unit cube that is bent to a ring.
pub(crate) fn closed(mesh: TetMesh, radii: [f64; 2], phase: f64, order: usize) -> TetMesh {
    let mesh = match order {
        2 => mesh.raise_order().expect("order 2"),
        _ => mesh,
    };
    let place = |&[x, y, z]: &[f64; 3]| {
        let (radius, angle) = (radii[0] + x * (radii[1] - radii[0]), TAU * y + phase);
        [radius * angle.cos(), radius * angle.sin(), 8.0 * z]
    };
    let mut points: Vec<[f64; 3]> = mesh.points().iter().map(place).collect();
    let open = |f: &&Facet| f.tag != brick::Y_MIN && f.tag != brick::Y_MAX;
    let mut facets: Vec<Facet> = mesh.facets().iter().filter(open).copied().collect();
    if order == 2 {
        let mut tets = mesh.quadratic_tets();
        merge_nodes(&points, &mut tets, &mut facets, 1e-9);
        drop_unused_nodes(&mut points, &mut tets, &mut facets);
        return TetMesh::quadratic(points, tets, facets).expect("ring");
    }
    let mut tets = mesh.tets().to_vec();
    merge_nodes(&points, &mut tets, &mut facets, 1e-9);
    drop_unused_nodes(&mut points, &mut tets, &mut facets);
    TetMesh::new(points, tets, facets).expect("ring")
}

/// A shaft with a bore in a sleeve, of so many cells around.
fn shaft([inside, outside]: [usize; 2], order: usize) -> TetMesh {
    with_second(
        &ring([4.0, 10.0], [1, inside, 2], 0.0, order),
        &ring([10.0, 14.0], [1, outside, 3], 0.1, order),
    )
}

/// A patch of a shell about the origin.
fn shell(radii: [f64; 2], cells: [usize; 3], order: usize) -> TetMesh {
    let mesh = block([1.0; 3], cells);
    let mesh = match order {
        2 => mesh.raise_order().expect("order 2"),
        _ => mesh,
    };
    let place = |[x, y, z]: [f64; 3]| {
        let way = [(1.6 * (y - 0.5)).tan(), (1.6 * (z - 0.5)).tan(), 1.0];
        let radius = radii[0] + x * (radii[1] - radii[0]);
        way.map(|c| c * radius / norm(&way))
    };
    mesh.map_points(place).expect("shell")
}

/// A ball in its socket.
fn ball([inside, outside]: [usize; 2], order: usize) -> TetMesh {
    with_second(
        &shell([6.0, 10.0], [1, inside, inside], order),
        &shell([10.0, 13.0], [2, outside, outside + 1], order),
    )
}

fn tie(swap: bool) -> Contact {
    let (inner, outer) = (brick::X_MAX, second(brick::X_MIN));
    if swap { Contact::tied(outer, inner) } else { Contact::tied(inner, outer) }
}

/// The first body is turned where it is held; the other one turns with it.
fn turns_with(mesh: &TetMesh, held: FacetTag, tie: Contact, what: &str) {
    for axis in [[0.0, 0.0, 1e-3], [1e-3, 0.0, 0.0], [4e-4, -7e-4, 5e-4]] {
        let held = mesh.nodes_on(held);
        let motions = held.iter().map(|&n| cross(axis, mesh.points()[n as usize])).collect();
        let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
            .with_support(Support::fixed(held).with_motions(motions, History::constant(1.0)))
            .with_contact(tie.clone())
            .with_subdomains(3);
        let result = solve(scene, Settings::default());
        for (&x, u) in mesh.points().iter().zip(result.displacement.as_chunks::<3>().0) {
            let expected = cross(axis, x);
            let error = (0..3).map(|c| (u[c] - expected[c]).abs()).fold(0.0, f64::max);
            assert!(error < 1e-6 * 14e-3, "{what}, {axis:?}, {x:?}: {error:e}");
        }
    }
}

/// Rows that compared displacements across the distance of facets left the sleeve 4 % behind, and the socket 2 %.
#[test]
fn curved_sides_turn_together() {
    for order in [1, 2] {
        for cells in [[8, 8], [8, 12], [12, 8]] {
            for swap in [false, true] {
                let what = format!("shaft of order {order}, {cells:?}, {swap}");
                turns_with(&shaft(cells, order), brick::X_MIN, tie(swap), &what);
            }
        }
        for cells in [[3, 4], [5, 3]] {
            let what = format!("ball of order {order}, {cells:?}");
            turns_with(&ball(cells, order), brick::X_MIN, tie(false), &what);
        }
    }
}

/// Across a distance, on meshes that match and others.
#[test]
fn sides_at_a_distance_turn_together() {
    for order in [1, 2] {
        for (cells, distance) in [([2, 2, 2], 0.3), ([3, 3, 1], 0.3), ([2, 2, 2], 1.0), ([3, 3, 1], -0.1)] {
            let upper = lifted(&block([1.0; 3], cells), 1.0 + distance);
            let mut mesh = with_second(&block([1.0; 3], [2; 3]), &upper);
            if order == 2 {
                mesh = mesh.raise_order().expect("order 2");
            }
            let tie = Contact::tied(second(brick::Z_MIN), brick::Z_MAX);
            turns_with(
                &mesh,
                brick::Z_MIN,
                tie,
                &format!("order {order}, {cells:?}, {distance}"),
            );
        }
    }
}

/// The support of the shaft holds all of the torque on the sleeve; up to 1.5 % of it were missing.
#[test]
fn a_tied_sleeve_passes_its_torque_on() {
    for order in [1, 2] {
        for cells in [[12, 12], [12, 18], [18, 12]] {
            let around = |x: [f64; 3], _: [f64; 3]| [-x[1], x[0], 2.0];
            let scene = Scene::new(shaft(cells, order), uniform(YOUNG, 0.3))
                .with_support(Support::fixed(brick::X_MIN))
                .with_load(Load::new(LoadDensity::traction_field(second(brick::X_MAX), around)))
                .with_contact(tie(cells[0] > cells[1]));
            let mut simulation = Simulation::new(scene, tight()).expect("set-up");
            let result = simulation.step().expect("step");
            assert!(result.report().status.converged());
            let reactions = result.reactions();
            let (off, load) = (reactions.imbalance(), &reactions.loads);
            let what = format!("order {order}, {cells:?}: {off:?}");
            assert!(norm(&off.force) < 1e-9 * norm(&load.force), "{what}");
            assert!(norm(&off.moment) < 1e-9 * norm(&load.moment), "{what}");
            let through = &reactions.contacts[0];
            let sign = if cells[0] > cells[1] { 1.0 } else { -1.0 };
            let missing = load.moment[2] + sign * through.moment[2];
            assert!(missing.abs() < 1e-9 * load.moment[2], "{what}, {through:?}");
        }
    }
}

/// A sleeve that is pressed on and turned: its facets are as large as those of the shaft, but finer around or along.
/// With the points on the side that has more of them all of 5,561 (order 1) and 639 products (order 2) went round in
/// circles.
#[test]
fn a_sleeve_held_by_friction_turns_at_any_order_of_names() {
    for (order, most) in [(1, 100), (2, 200)] {
        for swap in [false, true] {
            let mesh = with_second(
                &ring([4.0, 10.0], [2, 18, 2], 0.0, order),
                &ring([10.0, 14.0], [2, 12, 3], 0.1, order),
            );
            let around = |x: [f64; 3], _: [f64; 3]| [-x[1], x[0], 0.0].map(|c| 0.05 / 14.0 * c);
            let (inner, outer) = (brick::X_MAX, second(brick::X_MIN));
            let [first, other] = if swap { [outer, inner] } else { [inner, outer] };
            let fit = Contact::between(first, other).with_gap(-0.05);
            let scene = Scene::new(mesh, uniform(YOUNG, 0.3))
                .with_support(Support::fixed(brick::X_MIN))
                .with_support(Support::components(second(brick::Z_MIN), [false, false, true]))
                .with_load(Load::new(LoadDensity::traction_field(second(brick::X_MAX), around)))
                .with_contact(fit.with_friction(Friction::coulomb(0.4)));
            let result = solve(scene, Settings::default());
            let (what, report) = (format!("order {order}, {swap}"), &result.report);
            assert_eq!(result.points.len(), 48, "{what}");
            assert!(
                !report.fallback && report.counters.products < most,
                "{what}: {report:?}"
            );
        }
    }
}

/// Forces on facets that touch and are apart have no moment together, where the gap is given and where a pressure
/// closes what coordinates say: 0.9 and 1.6 % of the torque were lost, and with sides of equal facets all of it, for
/// want of a circumference where normals of nodes and of facets differ.
#[test]
fn a_sleeve_held_by_friction_passes_its_torque_on() {
    let cases = [
        (1, [12, 18], Some(-0.05)),
        (1, [18, 12], Some(-0.05)),
        (1, [12, 12], None),
        (2, [12, 18], Some(-0.05)),
        (2, [12, 12], None),
    ];
    for (order, cells, gap) in cases {
        let around = |x: [f64; 3], _: [f64; 3]| [-x[1], x[0], 0.0].map(|c| 0.01 / 14.0 * c);
        let fit = Contact::between(brick::X_MAX, second(brick::X_MIN)).with_friction(Friction::coulomb(0.6));
        let scene = Scene::new(shaft(cells, order), uniform(YOUNG, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_support(Support::components(second(brick::Z_MIN), [false, false, true]))
            .with_load(Load::new(LoadDensity::traction_field(second(brick::X_MAX), around)));
        let scene = match gap {
            Some(gap) => scene.with_contact(fit.with_gap(gap)),
            None => scene
                .with_contact(fit)
                .with_load(Load::pressure(second(brick::X_MAX), 5.0)),
        };
        let mut simulation = Simulation::new(scene, tight()).expect("set-up");
        let result = simulation.step().expect("step");
        let (reactions, report) = (result.reactions(), result.report());
        let what = format!("order {order}, {cells:?}, {gap:?}: {report:?}");
        assert!(report.status.converged() && report.counters.products < 350, "{what}");
        let (load, between) = (reactions.loads.moment[2], &reactions.contact);
        assert!(norm(&between.force) < 1e-12 * load, "{what}, {between:?}");
        assert!(norm(&between.moment) < 1e-11 * load, "{what}, {between:?}");
        let held = reactions.of_supports().moment[2];
        assert!((held + load).abs() < 1e-9 * load, "{what}: {held} of {load}");
        assert!((reactions.contacts[0].moment[2] - load).abs() < 1e-9 * load, "{what}");
    }
}

/// A bush of rubber, bonded to a shaft and pressed into a bore of steel: it can go nowhere, so that its pressure is
/// Lame's only if its volume is: here up to 6 %. With the points on the larger facets of the bore, between which it
/// bulged, 42 % were lost.
#[test]
fn rubber_that_can_go_nowhere_keeps_its_pressure() {
    let [within, radius, outside] = [8.0, 10.0, 14.0];
    let (bush, bore) = (
        ring([within, radius], [2, 24, 2], 0.0, 2),
        ring([radius, outside], [2, 16, 3], 0.0, 2),
    );
    let regions = [&bush, &bore].into_iter().zip(0..);
    let regions = regions.flat_map(|(mesh, region)| std::iter::repeat_n(region, mesh.tets().len()));
    let mesh = with_second(&bush, &bore)
        .with_regions(regions.collect())
        .expect("regions");
    let laws = [(10.0, 0.499), (2e5, 0.3)];
    let hooke = |region: usize| Hooke::isotropic(laws[region].0, laws[region].1).expect("Hooke");
    let sides = [brick::Z_MIN, brick::Z_MAX]
        .into_iter()
        .flat_map(|tag| [tag, second(tag)]);
    // held at the radius h, u = a (r - h^2 / r): the stress along r is a E / (1 + nu) (1 / (1 - 2 nu) + h^2 / r^2)
    let gives = |(young, poisson): (f64, f64), held: f64| {
        let square = (held / radius).powi(2);
        let stress = young / (1.0 + poisson) * (1.0 / (1.0 - 2.0 * poisson) + square);
        radius * (1.0 - square).abs() / stress
    };
    let interference = 0.1;
    let pressure = interference / (gives(laws[0], within) + gives(laws[1], outside));
    for swap in [false, true] {
        let (inner, outer) = (brick::X_MAX, second(brick::X_MIN));
        let [first, other] = if swap { [outer, inner] } else { [inner, outer] };
        let scene = Scene::new(
            mesh.clone(),
            Materials::new(vec![(0, hooke(0)), (1, hooke(1))]).expect("laws"),
        )
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(Support::fixed(second(brick::X_MAX)))
        .with_contact(Contact::between(first, other).with_gap(-interference));
        let scene = sides.clone().fold(scene, |scene, tag| {
            scene.with_support(Support::components(tag, [false, false, true]))
        });
        let result = solve(scene, Settings::default());
        assert_pressure(&result.points, pressure, 0.1, &format!("{swap}"));
        let products = result.report.counters.products;
        assert!(result.points.len() == 72 && products < 1200, "{swap}: {products}");
    }
}

/// A shoe on a shaft, with mid-nodes on the circle.
fn shoe([inside, outside]: [usize; 2]) -> TetMesh {
    with_second(&ring([4.0, 10.0], [1, inside, 2], 0.0, 2), &single_shoe(outside))
}

fn single_shoe(cells: usize) -> TetMesh {
    let shoe = block([1.0; 3], [1, cells, 2]).raise_order().expect("order 2");
    let place = |[x, y, z]: [f64; 3]| {
        let (radius, angle) = (10.0 + 3.0 * x, 0.1 + 1.2 * y);
        [radius * angle.cos(), radius * angle.sin(), 8.0 * z]
    };
    shoe.map_points(place).expect("shoe")
}

/// What slides without friction has no moment about the axis that it slides about, wherever it is pressed. With the
/// normals of whole facets 1.2 to 2.3 % of force times radius were left, for friction a false torque of a tenth.
#[test]
fn normal_forces_of_quadratic_sides_have_no_moment_about_their_axis() {
    for (cells, most) in [([24, 4], 1e-4), ([18, 6], 1e-4), ([12, 3], 5e-4), ([24, 8], 1e-4)] {
        for angle in [0.1_f64, 1.3] {
            let way = [-0.05 * angle.cos(), -0.05 * angle.sin(), 0.0];
            let pushed = Support::fixed(second(brick::X_MAX)).with_motion(way, History::constant(1.0));
            let scene = Scene::new(shoe(cells), uniform(YOUNG, 0.3))
                .with_support(Support::fixed(brick::X_MIN))
                .with_support(pushed)
                .with_contact(Contact::between(second(brick::X_MIN), brick::X_MAX).with_gap(0.0));
            let mut simulation = Simulation::new(scene, tight()).expect("set-up");
            let result = simulation.step().expect("step");
            let (moment, size) = (
                result.reactions().contacts[0].moment[2],
                10.0 * result.summary().normal_force,
            );
            let products = result.report().counters.products;
            let what = format!("{cells:?}, {angle}: {:.1e}, {products} products", moment / size);
            assert!(result.report().status.converged() && products < 80, "{what}");
            assert!(moment.abs() < most * size, "{what}");
        }
    }
}

/// The same on rigid obstacles, which turn in place. With their normals at corners 0.12 to 0.80 % were left by shoes,
/// 0.15 to 0.73 % by caps.
#[test]
fn normal_forces_of_round_obstacles_have_no_moment_about_their_centre() {
    let drum = Obstacle::cylinder([0.0; 3], [0.0, 0.0, 1.0], 10.0);
    let ball = Obstacle::sphere([0.0; 3], 10.0);
    let shoes = [3, 4, 6, 8].map(|cells| (format!("shoe {cells}"), single_shoe(cells), drum.clone(), 2..3));
    let caps = [3, 4, 6].map(|cells| {
        let cap = shell([10.0, 13.0], [1, cells, cells + 1], 2);
        (format!("cap {cells}"), cap, ball.clone(), 0..3)
    });
    let turns = |contact: Contact| contact.with_rotation([0.0; 3], [0.0, 0.0, 1.0], History::constant(1.0));
    for (what, mesh, obstacle, axes) in shoes.into_iter().chain(caps) {
        for angle in [0.1_f64, 1.3] {
            let way = match axes.len() {
                1 => [-0.05 * angle.cos(), -0.05 * angle.sin(), 0.0],
                _ => [0.02 * angle.cos(), 0.02 * angle.sin(), -0.05],
            };
            let pushed = Support::fixed(brick::X_MAX).with_motion(way, History::constant(1.0));
            let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
                .with_support(pushed)
                .with_contact(turns(Contact::obstacle(brick::X_MIN, obstacle.clone())));
            let mut simulation = Simulation::new(scene, tight()).expect("normals that do not turn");
            let result = simulation.step().expect("step");
            let turned = |w: &Warning| matches!(w, Warning::TurnedNormal { .. });
            assert!(!result.warnings().iter().any(turned), "{what}");
            let moment = result.reactions().contacts[0].moment;
            let moment = norm(&moment[axes.clone()]) / (10.0 * result.summary().normal_force);
            let products = result.report().counters.products;
            let what = format!("{what}, {angle}: {moment:.1e}, {products} products");
            assert!(result.report().status.converged() && products < 80, "{what}");
            assert!(moment < 1e-12, "{what}");
        }
    }
}

/// A sleeve holds a torque that its traction of 0.19637 gives. From 0.16 % above on it is not held; nearer by, what is
/// missing is less than what longer solves may find, and their limit was all that was told.
#[test]
fn what_may_slide_is_told_at_the_limit() {
    let turned = |traction: f64| {
        let around = move |x: [f64; 3], _: [f64; 3]| [-x[1], x[0], 0.0].map(|c| traction / 14.0 * c);
        let fit = Contact::between(brick::X_MAX, second(brick::X_MIN)).with_friction(Friction::coulomb(0.3));
        let scene = Scene::new(shaft([12, 12], 2), uniform(YOUNG, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_support(Support::components(second(brick::Z_MIN), [false, false, true]))
            .with_load(Load::new(LoadDensity::traction_field(second(brick::X_MAX), around)))
            .with_contact(fit.with_gap(-0.05));
        let settings = Settings::default().with_max_fallback_products(3000);
        let mut simulation = Simulation::new(scene, settings).expect("set-up");
        let result = simulation.step().expect("step");
        (result.failure(), result.reactions().loads.moment[2])
    };
    let (held, torque) = turned(0.196);
    assert!(held.is_none(), "{held:?}");
    let failure = turned(0.1966).0.expect("beyond friction");
    let slide = failure.slide.expect("a body");
    // 0.12 % of the torque at the radius of the contact
    assert!(failure.status == StepStatus::IterationLimit, "{failure}");
    assert!((1e-4..1e-2).contains(&(10.0 * slide.force / torque)), "{failure}");
    assert!(slide.body == 1 && slide.rotation[2].abs() > 0.99, "{failure}");
    assert!(
        failure.to_string().contains("may slide away along its rotation"),
        "{failure}"
    );
}

/// Where the other side ends, nodes of a closed side have the normal of all their facets, covered or not: with that of
/// covered ones 0.3 to 4.0 % of force times radius were left.
#[test]
fn normal_forces_of_linear_sides_have_no_moment_either() {
    for cells in [[18, 6], [12, 3], [24, 8], [30, 7], [48, 11]] {
        for angle in [0.1_f64, 0.7, 1.3] {
            let shoe = block([1.0; 3], [1, cells[1], 2]);
            let place = |[x, y, z]: [f64; 3]| {
                let (radius, angle) = (10.0 + 3.0 * x, 0.1 + 1.2 * y);
                [radius * angle.cos(), radius * angle.sin(), 8.0 * z]
            };
            let mesh = with_second(
                &ring([4.0, 10.0], [1, cells[0], 2], 0.0, 1),
                &shoe.map_points(place).expect("shoe"),
            );
            let way = [-0.05 * angle.cos(), -0.05 * angle.sin(), 0.0];
            let pushed = Support::fixed(second(brick::X_MAX)).with_motion(way, History::constant(1.0));
            for side in 0..2 {
                let contact = match side {
                    0 => Contact::between(second(brick::X_MIN), brick::X_MAX),
                    _ => Contact::between(brick::X_MAX, second(brick::X_MIN)),
                };
                let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
                    .with_support(Support::fixed(brick::X_MIN))
                    .with_support(pushed.clone())
                    .with_contact(contact.with_gap(0.0));
                let mut simulation = Simulation::new(scene, tight()).expect("set-up");
                let result = simulation.step().expect("step");
                let moment = result.reactions().contacts[0].moment[2] / (10.0 * result.summary().normal_force);
                assert!(result.report().status.converged(), "{cells:?}");
                assert!(moment.abs() < 1e-4, "{cells:?}, {angle}, {side}: {moment:.1e}");
            }
        }
    }
}

/// A shaft that is longer than the linear bore around it: beyond the rim it is as far from it as within, and presses
/// nothing.
#[test]
fn a_shaft_beyond_the_rim_of_its_bore_is_as_far_from_it() {
    let quarter = |radii: [f64; 2], cells: [usize; 3], ends: [f64; 2]| {
        let place = |[x, y, z]: [f64; 3]| {
            let (radius, angle) = (radii[0] + x * (radii[1] - radii[0]), 0.5 * std::f64::consts::PI * y);
            [
                radius * angle.cos(),
                radius * angle.sin(),
                ends[0] + z * (ends[1] - ends[0]),
            ]
        };
        block([1.0; 3], cells).map_points(place).expect("quarter")
    };
    for cells in [[12, 17], [17, 12], [12, 13]] {
        let shaft = quarter([4.0, 9.98], [1, cells[0], 5], [-1.3, 2.9]);
        let bore = quarter([10.0, 14.0], [1, cells[1], 2], [0.0, 1.7]);
        let mesh = with_second(&shaft, &bore);
        let scene = Scene::new(mesh.clone(), uniform(1e3, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_support(Support::fixed(second(brick::X_MAX)))
            .with_contact(Contact::between(brick::X_MAX, second(brick::X_MIN)));
        let mut beyond = 0;
        for point in &solve(scene, at(1e-8)).points {
            // at the planes of the cut normals are those of one facet
            if point.normal[..2].iter().all(|c| c.abs() > 0.2) {
                assert!((point.gap / 0.02 - 1.0).abs() < 0.01, "{cells:?} {point:?}");
                beyond += usize::from(!(-1e-9..1.7 + 1e-9).contains(&mesh.points()[point.node as usize][2]));
            }
        }
        // the coarser side has the points
        assert!(beyond > 0 || cells != [12, 17]);
    }
}
