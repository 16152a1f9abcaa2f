//! Contact between elastic bodies with matching meshes.

use crate::common::*;

/// The image of a mesh in the plane z = 0.
fn mirrored(mesh: &TetMesh) -> TetMesh {
    let points = mesh.points().iter().map(|[x, y, z]| [*x, *y, -z]);
    let tets = mesh.tets().iter().map(|[a, b, c, d]| [*b, *a, *c, *d]);
    TetMesh::new(points.collect(), tets.collect(), mesh.facets().to_vec()).expect("mirrored")
}

/// A cube that bulges downwards, its lowest point at z = 0.
fn bulging() -> TetMesh {
    block([1.0; 3], [4; 3])
        .map_points(|[x, y, z]| {
            let depth = (x - 0.5).powi(2) + 0.5 * (y - 0.5).powi(2) + 0.1 * x;
            [x, y, z + 0.1 * (1.0 - z) * (depth - 0.0475)]
        })
        .expect("bulging")
}

/// Two bodies that are mirror images touch as each of them touches a plane without friction, whatever the friction
/// between them.
#[test]
fn a_body_and_its_image_touch_like_a_body_and_a_plane() {
    let one = bulging();
    let pressed = |scene: Scene, tag: FacetTag, sign: f64| {
        scene
            .with_support(Support::fixed(tag).with_motion([0.0, 0.0, -0.02 * sign], ramp()))
            .with_analysis(paper_steps(1.0, 3))
    };
    let plane = Contact::rigid(brick::Z_MIN)
        .with_normal([0.0, 0.0, -1.0])
        .with_gap_field(|x| x[2]);
    let alone = Scene::new(one.clone(), uniform(1e9, 0.3)).with_contact(plane);
    let alone = pressed(alone, brick::Z_MAX, 1.0).with_boxes([2, 1, 1]);
    let (_, reference) = run(alone, tight());
    let open = reference[2].points.iter().filter(|p| p.gap > 1e-4).count();
    assert!(open > 5 && open < 20, "{open} open points");
    let both = with_second(&one, &mirrored(&one));
    for friction in [Friction::None, Friction::coulomb(0.5)] {
        for method in methods() {
            let what = format!("{} {friction:?}", method.kind());
            let contact = Contact::between(brick::Z_MIN, second(brick::Z_MIN))
                .with_normal([0.0, 0.0, -1.0])
                .with_friction(friction.clone());
            let scene = Scene::new(both.clone(), uniform(1e9, 0.3)).with_contact(contact);
            let scene = pressed(scene, brick::Z_MAX, 1.0);
            let scene = pressed(scene, second(brick::Z_MAX), -1.0).with_boxes([2, 1, 2]);
            let (simulation, results) = run(scene, tight().with_method(method));
            assert!(simulation.plan().effects.partners && simulation.plan().effects.gap);
            for (a, b) in results.iter().zip(&reference) {
                let half = b.displacement.len();
                let [upper, lower] = [&a.displacement[..half], &a.displacement[half..]];
                assert_close(upper, &b.displacement, 1e-6, &what);
                let image: Vec<f64> = lower.chunks(3).flat_map(|u| [u[0], u[1], -u[2]]).collect();
                assert_close(&image, &b.displacement, 1e-6, &what);
                let normal = |points: &[PointState]| -> Vec<f64> { points.iter().map(|p| p.normal_force).collect() };
                assert_close(&normal(&a.points), &normal(&b.points), 1e-6, &what);
            }
        }
    }
}

/// Two cubes, the second on the first. Planes of symmetry hold them sideways.
fn column(cells: [usize; 3]) -> TetMesh {
    let lower = block([1.0; 3], cells);
    let upper = lifted(&lower, 1.0);
    with_second(&lower, &upper)
}

fn joint() -> Contact {
    Contact::between(second(brick::Z_MIN), brick::Z_MAX)
}

/// A column of two blocks under pressure is one of uniaxial stress.
#[test]
fn pressure_passes_from_body_to_body() {
    let (young, poisson, pressure) = (2e9, 0.3, 1e6);
    let mesh = column([3, 2, 2]);
    for (boxes, friction) in [
        ([1, 1, 2], Friction::None),
        ([2, 2, 4], Friction::None),
        ([2, 1, 2], Friction::coulomb(0.3)),
        ([2, 1, 2], Friction::tresca(1e3)),
    ] {
        for method in methods() {
            let what = format!("{boxes:?} {} {friction:?}", method.kind());
            let mut scene = Scene::new(mesh.clone(), uniform(young, poisson))
                .with_support(Support::components(brick::Z_MIN, [false, false, true]))
                .with_load(Load::pressure(second(brick::Z_MAX), pressure))
                .with_contact(joint().with_friction(friction.clone()))
                .with_boxes(boxes);
            for tag in [brick::X_MIN, second(brick::X_MIN)] {
                scene = scene.with_support(Support::components(tag, [true, false, false]));
            }
            for tag in [brick::Y_MIN, second(brick::Y_MIN)] {
                scene = scene.with_support(Support::components(tag, [false, true, false]));
            }
            let (simulation, results) = run(scene, tight().with_method(method));
            let effects = simulation.plan().effects;
            assert!(effects.partners && !effects.gap, "{what}");
            let strain = pressure / young;
            let exact: Vec<f64> = mesh
                .points()
                .iter()
                .flat_map(|[x, y, z]| [poisson * strain * x, poisson * strain * y, -strain * z])
                .collect();
            assert_close(&results[0].displacement, &exact, 1e-7, &what);
            for point in &results[0].points {
                let found = -point.normal_force / point.area;
                assert!((found / pressure - 1.0).abs() < 1e-6, "{what}: {found:e}");
                assert!(point.partner.is_some(), "{what}");
            }
            let gluing = simulation.tfeti().gluing();
            // boxes that cut cells leave tips: copies differ, and count by stiffness
            assert_eq!(orthonormal(gluing), boxes == [1, 1, 2], "{what}");
        }
    }
}

/// A clamped beam above a plate: with a plate much stiffer than the beam the floor is rigid, histories of sliding
/// included.
pub(crate) fn beam(plate: Option<f64>) -> Scene {
    let contact = match plate {
        Some(_) => Contact::between(brick::Z_MIN, second(brick::Z_MAX)),
        None => Contact::rigid(brick::Z_MIN).with_gap(0.1),
    };
    beam_with(plate, contact)
}

fn beam_with(plate: Option<f64>, contact: Contact) -> Scene {
    let contact = contact.with_friction(weakening());
    let beam = block([3.0, 1.0, 1.0], [6, 2, 2]);
    let loads = |scene: Scene| {
        let q = 1e8;
        scene
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30.0 * q]).with_history(ramp()))
            .with_load(Load::traction(brick::X_MAX, [9.0 * q, 0.0, -15.0 * q]).with_history(up_down_up()))
            .with_analysis(paper_steps(1.0, 6))
    };
    let Some(young) = plate else {
        let scene = Scene::new(beam, steel()).with_contact(contact);
        return loads(scene).with_boxes([3, 1, 1]);
    };
    let below = lifted(&block([3.0, 1.0, 1.0], [6, 2, 2]), -1.1);
    let mesh = with_second(&beam, &below);
    let regions = mesh.components();
    let steel = Hooke::isotropic(211.9e9, 0.277).expect("steel");
    let stiff = Hooke::isotropic(young, 0.277).expect("stiff");
    let materials = Materials::new(vec![(0, steel), (1, stiff)]).expect("materials");
    let scene = Scene::new(mesh.with_regions(regions).expect("regions"), materials)
        .with_support(Support::fixed(second(brick::Z_MIN)))
        .with_contact(contact);
    loads(scene).with_boxes([3, 1, 2])
}

#[test]
fn a_stiff_plate_is_a_rigid_floor() {
    let (_, reference) = run(beam(None), tight());
    let mut last = f64::INFINITY;
    for stiffness in [1e3, 1e6] {
        let settings = at(1e-8);
        let (_, results) = run(beam(Some(211.9e9 * stiffness)), settings);
        let off = |a: &Solved, b: &Solved| {
            let beam = b.displacement.len();
            distance(&a.displacement[..beam], &b.displacement)
        };
        let worst = results.iter().zip(&reference).map(|(a, b)| off(a, b));
        let worst = worst.fold(0.0, f64::max);
        assert!(worst < 30.0 / stiffness, "{stiffness:e}: {worst:e}");
        assert!(worst < last);
        last = worst;
        for result in &results {
            assert!(!result.report.fallback);
        }
    }
}

#[test]
fn results_do_not_depend_on_the_partition_nor_on_which_side_comes_first() {
    let plate = 4e11;
    let (_, reference) = run(beam(Some(plate)), tight());
    for boxes in [[1, 1, 2], [3, 2, 2], [2, 1, 4]] {
        let (_, results) = run(beam(Some(plate)).with_boxes(boxes), tight());
        for (a, b) in results.iter().zip(&reference) {
            assert_close(&a.displacement, &b.displacement, 1e-6, "cut");
            assert_close(&forces(&a.points), &forces(&b.points), 1e-6, "cut");
        }
    }
    let swapped = Contact::between(second(brick::Z_MAX), brick::Z_MIN);
    let (_, results) = run(beam_with(Some(plate), swapped), tight());
    for (a, b) in results.iter().zip(&reference) {
        assert_close(&a.displacement, &b.displacement, 1e-6, "swapped");
    }
}

/// A block on a block, pushed: friction takes the push up to the coefficient, and no scene is solved beyond.
#[test]
fn friction_between_bodies_holds_up_to_its_coefficient() {
    let scene = |push: f64| {
        Scene::new(column([2, 2, 2]), uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_load(Load::pressure(second(brick::Z_MAX), 1e6))
            .with_load(Load::body([0.0, push * 1e6, 0.0]))
            .with_contact(joint().with_friction(Friction::coulomb(0.3)))
            .with_boxes([1, 1, 2])
    };
    for method in methods() {
        let result = solve(scene(0.2), by(method));
        let force = result.summary.resultant;
        // on the upper body: it carries its pressure and its push
        for (found, exact) in force.iter().zip([0.0, -0.2e6, 1e6]) {
            assert!((found - exact).abs() < 10.0, "{force:?}");
        }
    }
    match Simulation::new(scene(0.31), Settings::default()) {
        Err(ContactError::NotHeld { body, node, mode, .. }) => {
            // nodes of the upper block come after the 27 of the lower
            assert!(body == 1 && node >= 27, "{body} {node}");
            assert!(mode.contains("translation"), "{mode}");
        }
        other => panic!("{other:?}"),
    }
}

/// A plate is pulled along under a block that is pressed on it: all of the surface slides.
#[test]
fn a_body_drags_the_other_one() {
    let scene = Scene::new(column([2, 2, 2]), uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::Z_MIN).with_motion([0.02, 0.0, 0.0], ramp()))
        .with_support(Support::fixed(second(brick::Z_MAX)).with_motion([0.0, 0.0, -1e-3], ramp()))
        .with_contact(joint().with_friction(Friction::coulomb(0.25)))
        .with_analysis(paper_steps(1.0, 4))
        .with_boxes([1, 1, 2]);
    let mut simulation = Simulation::new(scene, tight()).expect("set-up");
    while !simulation.is_finished() {
        let frame = simulation.step().expect("step");
        assert!(frame.certificate().largest() < 1e-6);
        let reactions = frame.reactions();
        let whole = norm(&reactions.of_supports().force).max(frame.summary().normal_force);
        let rest = reactions.imbalance();
        assert!(norm(&rest.force) < 1e-7 * whole && norm(&rest.moment) < 1e-7 * whole);
        assert_eq!(norm(&reactions.contact.force), 0.0, "forces between bodies cancel");
    }
    let frame = simulation.result().expect("a step");
    let sum = frame.summary();
    assert_eq!(sum.slip, sum.active);
    // every point slides along x, but for what bulging adds
    assert!((sum.friction_force[0] / sum.normal_force - 0.25).abs() < 0.01);
    assert!(sum.friction_work > 0.0);
    let [lower, upper] = [0, 1].map(|k| frame.reactions().supports[k].resultant.force);
    assert!((lower[0] + upper[0]).abs() < 1e-6 * upper[2].abs());
    assert!((lower[0] / sum.friction_force[0] - 1.0).abs() < 1e-6);
}

/// Bodies that are pulled apart feel nothing of each other.
#[test]
fn bodies_come_apart() {
    let scene = Scene::new(column([2, 2, 2]), uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::Z_MIN))
        .with_support(Support::fixed(second(brick::Z_MAX)).with_motion([0.0, 0.0, 0.01], ramp()))
        .with_contact(joint())
        .with_boxes([1, 1, 2]);
    let result = solve(scene, Settings::default());
    assert_eq!(result.summary.active, 0);
    assert!(result.report.counters.products <= 2);
    for point in &result.points {
        assert!((point.gap - 0.01).abs() < 1e-9, "{}", point.gap);
    }
}

#[test]
fn what_cannot_be_paired_is_refused() {
    let fails = |mesh: TetMesh, contact: Contact| {
        let scene = Scene::new(mesh, uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_contact(contact);
        Simulation::new(scene, Settings::default()).expect_err("refused")
    };
    // sides that do not face each other
    let error = fails(column([2; 3]), Contact::between(second(brick::Z_MIN), brick::X_MIN));
    assert!(
        matches!(error, ContactError::NoPartner { contact: 0, distance } if distance == 0.0),
        "{error}"
    );
    assert!(
        error.to_string().contains("name sides that look at each other"),
        "{error}"
    );
    // a tag on both sides
    let error = fails(column([2; 3]), joint().with_partner(second(brick::Z_MIN)));
    assert!(
        matches!(error, ContactError::SameSide { contact: 0, tag } if tag == second(brick::Z_MIN).0),
        "{error}"
    );
    // the same sides twice, told the other way round or tied, unless one ends before the other starts
    let scene = |again: Contact, ends: Option<f64>| {
        let first = match ends {
            Some(time) => joint().with_end(time),
            None => joint(),
        };
        Scene::new(column([2; 3]), uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_contact(first)
            .with_contact(again)
            .with_analysis(Analysis::quasistatic(1.0, 2))
    };
    let turned = || Contact::between(second(brick::Z_MIN), brick::Z_MAX);
    for again in [joint(), turned(), Contact::tied(brick::Z_MAX, second(brick::Z_MIN))] {
        let error = refused(&scene(again, None));
        let ContactError::SamePair {
            first: 0, second: 1, ..
        } = error
        else {
            panic!("{error}");
        };
    }
    let staged = scene(turned().with_start(0.5), Some(0.5));
    assert!(!matches!(
        Simulation::new(staged, Settings::default()),
        Err(ContactError::SamePair { .. })
    ));
    // sides that look away from each other
    for outer in [Contact::between, Contact::tied] {
        let error = fails(column([2; 3]), outer(second(brick::Z_MAX), brick::Z_MIN));
        assert!(
            matches!(error, ContactError::Overlap { contact: 0, depth, .. } if (depth - 2.0).abs() < 1e-9),
            "{error}"
        );
        // a gap is no remedy for a tie
        let remedy = "where Contact::between is to press them apart, tell how far by with_gap";
        assert!(error.to_string().contains(remedy), "{error}");
    }
    let error = fails(column([2; 3]), joint().with_motion([1.0, 0.0, 0.0], ramp()));
    assert!(matches!(error, ContactError::MovedPartner { contact: 0 }), "{error}");
    // bodies that lie behind each other, unless that is what is meant
    let behind = Contact::between(brick::Z_MIN, second(brick::Z_MAX));
    let error = fails(column([2; 3]), behind.clone());
    assert!(
        matches!(error, ContactError::Overlap { depth, .. } if (depth - 2.0).abs() < 1e-12),
        "{error}"
    );
    let scene = Scene::new(column([2; 3]), uniform(1e9, 0.3)).with_contact(behind.with_gap(-1e-3));
    assert!(Simulation::new(scene, Settings::default()).is_ok());
    let error = fails(column([2; 3]), joint().with_partner(FacetTag(999)));
    assert!(error.to_string().contains("999"), "{error}");
}

/// Facets so slender that neighbours are closer to a normal than is allowed for partners; a gap that a rigid contact
/// has not told.
#[test]
fn partners_are_the_nearest_nodes() {
    let lower = block([1.0, 100.0, 1.0], [40, 2, 1]);
    let upper = lifted(&lower, 1.5);
    let rigid = Contact::rigid(second(brick::Z_MIN)).with_partner(brick::Z_MAX);
    for contact in [joint(), rigid] {
        let scene = Scene::new(with_second(&lower, &upper), uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_support(Support::fixed(second(brick::Z_MAX)))
            .with_contact(contact);
        let simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        for point in simulation.constrained_points() {
            let places = simulation.scene().mesh().points();
            let partner = point.partner().expect("a partner");
            let [a, b] = [point.node(), partner].map(|node| places[node as usize]);
            assert_eq!([a[0], a[1]], [b[0], b[1]]);
            assert!((point.gap() - 0.5).abs() < 1e-12, "{}", point.gap());
        }
    }
}

/// Two blocks side by side under a third, in a corner of two walls with friction: nodes where three bodies or two
/// bodies and a wall meet have several points.
fn wall(friction: &Friction) -> Scene {
    let left = block([1.0; 3], [2; 3]);
    let right = left.map_points(|[x, y, z]| [x + 1.0, y, z]).expect("moved");
    let above = lifted(&block([2.0, 1.0, 1.0], [4, 2, 2]), 1.0);
    let third = |tag: FacetTag| second(second(tag));
    let mesh = with_second(&left, &right)
        .append(&above.map_tags(third))
        .expect("three bodies");
    let rough = |contact: Contact| contact.with_friction(friction.clone());
    Scene::new(mesh, uniform(1e9, 0.3))
        .with_contact(rough(Contact::rigid(brick::Z_MIN).with_tag(second(brick::Z_MIN))))
        .with_contact(rough(Contact::rigid(brick::X_MIN).with_tag(third(brick::X_MIN))))
        .with_contact(rough(Contact::between(brick::X_MAX, second(brick::X_MIN))))
        .with_contact(rough(
            Contact::between(brick::Z_MAX, third(brick::Z_MIN)).with_tag(second(brick::Z_MAX)),
        ))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_support(Support::components(second(brick::Y_MIN), [false, true, false]))
        .with_support(Support::components(third(brick::Y_MIN), [false, true, false]))
        .with_load(Load::pressure(third(brick::Z_MAX), 1e6))
        .with_load(Load::pressure(second(brick::X_MAX), 4e5))
        .with_load(Load::pressure(third(brick::X_MAX), 4e5))
}

/// Without friction three blocks are pressed like one of twice the height: uniform stress in two directions.
#[test]
fn nodes_may_meet_several_bodies_and_walls() {
    let (young, poisson) = (1e9, 0.3);
    for boxes in [[2, 1, 2], [4, 1, 4]] {
        for method in methods() {
            let what = format!("{boxes:?} {}", method.kind());
            let scene = wall(&Friction::None).with_boxes(boxes);
            let mesh = scene.mesh().clone();
            let result = solve(scene, tight().with_method(method));
            let [x, z] = [-4e5, -1e6].map(|stress| stress / young);
            let strain = [x - poisson * z, -poisson * (x + z), z - poisson * x];
            let exact: Vec<f64> = mesh
                .points()
                .iter()
                .flat_map(|p| [0, 1, 2].map(|c| strain[c] * p[c]))
                .collect();
            assert_close(&result.displacement, &exact, 1e-6, &what);
        }
    }
}

#[test]
fn rough_bodies_and_walls_do_not_depend_on_the_cut() {
    let friction = Friction::tresca(2e4);
    let reference = solve(wall(&friction), tight());
    for boxes in [[2, 1, 2], [4, 2, 4]] {
        let result = solve(wall(&friction).with_boxes(boxes), tight());
        assert_close(&result.displacement, &reference.displacement, 1e-5, "cut");
        assert!(!result.report.fallback);
    }
    let result = solve(wall(&Friction::coulomb(0.3)), Settings::default());
    assert!(!result.report.fallback);
}

/// Gaps up to a length are closed, overlaps too; others stay, for matching and for other meshes.
#[test]
fn small_gaps_are_closed() {
    let other = block([1.0; 3], [3; 3]).map_points(|[x, y, z]| [x, y, z - 1.0 - 0.005 * x]);
    let swapped = |tag| match tag {
        brick::Z_MIN => brick::Z_MAX,
        brick::Z_MAX => brick::Z_MIN,
        tag => tag,
    };
    for lower in [mirrored(&bulging()), other.expect("tilted").map_tags(swapped)] {
        let points = |lower: &TetMesh, contact: Contact| {
            let scene = Scene::new(with_second(&bulging(), lower), uniform(1e9, 0.3))
                .with_contact(contact.with_normal([0.0, 0.0, -1.0]))
                .with_support(Support::fixed(brick::Z_MAX))
                .with_support(Support::fixed(second(brick::Z_MAX)));
            run(scene, tight()).1.remove(0).points
        };
        let between = || Contact::between(brick::Z_MIN, second(brick::Z_MIN));
        let (open, closed) = (
            points(&lower, between()),
            points(&lower, between().with_closed_gaps(0.01)),
        );
        assert_eq!(open.len(), closed.len());
        let near = open.iter().filter(|p| p.gap <= 0.01).count();
        assert!(near > 0 && near < open.len());
        for (a, b) in open.iter().zip(&closed) {
            let exact = if a.gap <= 0.01 { 0.0 } else { a.gap };
            assert!(a.node == b.node && (b.gap - exact).abs() < 1e-9, "{a:?} {b:?}");
        }
        let lifted = lower.map_points(|[x, y, z]| [x, y, z + 0.005]).expect("lifted");
        let pressed = |contact| {
            points(&lifted, contact)
                .iter()
                .filter(|p| p.normal_force != 0.0)
                .count()
        };
        assert!(pressed(between()) > 0);
        assert_eq!(pressed(between().with_closed_gaps(0.0)), 0);
    }
}

/// Only measured gaps can be closed, by a length.
#[test]
fn closed_gaps_are_checked() {
    let both = with_second(&bulging(), &mirrored(&bulging()));
    let between = Contact::between(brick::Z_MIN, second(brick::Z_MIN));
    for contact in [
        between.clone().with_closed_gaps(-1.0),
        between.clone().with_closed_gaps(f64::NAN),
        between.with_gap(0.1).with_closed_gaps(1.0),
        Contact::rigid(brick::Z_MIN).with_closed_gaps(1.0),
    ] {
        let scene = Scene::new(both.clone(), uniform(1e9, 0.3)).with_contact(contact);
        let error = Simulation::new(scene, Settings::default())
            .map(|_| ())
            .expect_err("refused")
            .to_string();
        assert!(error.contains("reach of closed gaps"), "{error}");
    }
}
