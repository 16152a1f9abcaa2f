//! Obstacles whose gap depends on the place, and that move along the surface: the gap moves with them.

use crate::common::*;

const RADIUS: f64 = 2.0;
const DEPTH: f64 = 0.02;

/// A paraboloid under the plane z = 0 with its top at (x, 1), pressed in by `DEPTH`.
fn ball(x: f64) -> impl Fn([f64; 3]) -> f64 + Send + Sync + 'static {
    move |p| ((p[0] - x).powi(2) + (p[1] - 1.0).powi(2)) / (2.0 * RADIUS) - DEPTH
}

fn scene(contact: Contact, steps: usize) -> Scene {
    Scene::new(block([6.0, 2.0, 1.0], [24, 8, 4]), uniform(1e6, 0.3))
        .with_contact(contact)
        .with_support(Support::fixed(brick::Z_MAX))
        .with_boxes([6, 2, 1])
        .with_analysis(Analysis::quasistatic(1.0, steps))
}

/// The x coordinate of the centre of pressure.
fn centre(mesh: &TetMesh, result: &Solved) -> f64 {
    let moment = |p: &PointState| -p.normal_force * mesh.points()[p.node as usize][0];
    result.points.iter().map(moment).sum::<f64>() / result.summary.normal_force
}

/// Over ways of two cells, with which the mesh repeats itself, the pressure is the same one, further along.
#[test]
fn the_pressure_goes_with_a_ball_that_is_dragged() {
    for friction in [0.0, 0.3] {
        let contact = Contact::rigid(brick::Z_MIN)
            .with_gap_field(ball(2.0))
            .with_friction(Friction::coulomb(friction))
            .with_motion([2.0, 0.0, 0.0], ramp());
        let scene = scene(contact, 4);
        let mesh = scene.mesh().clone();
        let (_, results) = run(scene, at(1e-9));
        for result in &results {
            let at = 2.0 + 2.0 * result.time;
            let found = centre(&mesh, result);
            assert!((found - at).abs() < 0.02, "{friction}: {found}, not {at}");
            let first = results[0].summary.normal_force;
            let force = result.summary.normal_force / first;
            assert!((force - 1.0).abs() < 1e-3, "{friction}: {force}");
            assert_eq!(result.summary.slip > 0, friction > 0.0);
            // sliding as a whole
            let drag = result.summary.friction_force[0] / result.summary.normal_force;
            assert!((drag - friction).abs() < 0.02, "{friction}: {drag}");
        }
    }
}

/// Without friction each step is that of an obstacle that stands where the moving one is.
#[test]
fn a_step_is_that_of_an_obstacle_that_stands_there() {
    let way = [1.3, 0.2, -0.01];
    let contact = Contact::rigid(brick::Z_MIN);
    let moving = contact.clone().with_gap_field(ball(2.0)).with_motion(way, ramp());
    let (_, results) = run(scene(moving.clone(), 3), at(1e-9));
    for result in &results {
        let w = way.map(|c| result.time * c);
        let there = ball(2.0);
        let still = contact
            .clone()
            .with_gap_field(move |p| there([p[0] - w[0], p[1] - w[1], p[2]]) - w[2]);
        let (_, still) = run(scene(still, 1), at(1e-9));
        assert_close(&result.displacement, &still[0].displacement, 1e-7, "displacement");
        for (a, b) in result.points.iter().zip(&still[0].points) {
            assert!((a.gap - b.gap).abs() < 1e-9);
        }
    }
}

/// Planes move along themselves without effect, whatever the directions of plane, side and way.
#[test]
fn a_plane_is_where_its_point_has_moved() {
    let outward = [0.2, -0.1, 1.0];
    let point = [3.0, 1.0, -0.02];
    let way = [2.0, -0.7, -0.4];
    let arch = |mesh: TetMesh| {
        mesh.map_points(|[x, y, z]| [x, y, z + 0.05 * (x - 3.0).powi(2) * (1.0 - z)])
            .expect("mesh")
    };
    let solved = |point: [f64; 3], motion: Option<[f64; 3]>| {
        let mut contact = Contact::half_space(brick::Z_MIN, point, outward);
        if let Some(way) = motion {
            contact = contact.with_motion(way, ramp());
        }
        let scene = Scene::new(arch(block([6.0, 2.0, 1.0], [12, 4, 2])), uniform(1e6, 0.3))
            .with_contact(contact)
            .with_support(Support::fixed(brick::Z_MAX))
            .with_analysis(paper_steps(1.0, 1));
        run(scene, at(1e-9)).1.remove(0)
    };
    let moved = solved(point, Some(way));
    let there = solved([0, 1, 2].map(|c| point[c] + way[c]), None);
    assert!(there.summary.active > 3);
    assert_close(&moved.displacement, &there.displacement, 1e-8, "displacement");
}

/// What a wedge that is driven under the block does to it without friction is elastic energy, up to a part that falls
/// with the step.
#[test]
fn the_work_of_a_wedge_is_stored() {
    let miss = |steps: usize| {
        let contact = Contact::rigid(brick::Z_MIN)
            .with_gap_field(|p| 0.02 * p[0])
            .with_motion([2.0, 0.0, 0.0], ramp());
        let scene = scene(contact, steps);
        let (mesh, materials) = (scene.mesh().clone(), scene.materials().clone());
        let (_, results) = run(scene, at(1e-9));
        let last = &results[results.len() - 1].displacement;
        let stored = fields::strain_energy(&mesh, &materials, last).expect("energy");
        let work: f64 = results.iter().map(|l| l.summary.obstacle_work).sum();
        (work - stored) / stored
    };
    let (coarse, fine) = (miss(8), miss(32));
    assert!(
        coarse.abs() < 0.25 && fine.abs() < 0.3 * coarse.abs(),
        "{coarse} {fine}"
    );
}

#[test]
fn a_run_over_a_moving_ball_continues() {
    let make = || {
        let contact = Contact::rigid(brick::Z_MIN)
            .with_gap_field(ball(2.0))
            .with_friction(Friction::coulomb(0.3))
            .with_motion([1.0, 0.5, 0.0], ramp());
        Simulation::new(scene(contact, 4), Settings::default()).expect("set-up")
    };
    let (mut whole, mut first, mut second) = (make(), make(), make());
    first.step().expect("step");
    first.step().expect("step");
    second.resume(first.state().clone()).expect("resume");
    let (all, rest) = (rest(&mut whole), rest(&mut second));
    for (a, b) in all[2..].iter().zip(&rest) {
        assert_eq!(bits(a), bits(b));
        assert_eq!(a.summary.obstacle_work, b.summary.obstacle_work);
    }
}

/// A field that knows the surface only, or takes an obstacle into a node that a support holds.
#[test]
fn fields_are_asked_at_all_places_that_pass() {
    let known = |p: [f64; 3]| if p[0] < -1e-9 { f64::NAN } else { 0.1 };
    let contact = Contact::rigid(brick::Z_MIN).with_gap_field(known);
    let along = contact.clone().with_motion([0.5, 0.0, 0.0], ramp());
    match refused(&scene(along, 4)) {
        ContactError::Gap { contact, position, .. } => assert_eq!((contact, position[0]), (0, -0.125)),
        error => panic!("{error}"),
    }
    let away = contact.with_motion([0.0, 0.0, -0.5], ramp());
    Plan::new(&scene(away, 4), &Settings::default()).expect("the way is normal");
    let step = |p: [f64; 3]| if p[0] < -0.3 { -1e-3 } else { 1e-3 };
    let contact = Contact::rigid(brick::Z_MIN)
        .with_gap_field(step)
        .with_motion([0.5, 0.0, 0.0], ramp());
    let scene = scene(contact, 5).with_support(Support::fixed(brick::X_MIN));
    match refused(&scene) {
        ContactError::SupportInObstacle { time, gap, .. } => {
            assert_eq!((time, gap), (0.8, -1e-3));
        }
        error => panic!("{error}"),
    }
}

/// Two fields on one side with one motion: refused only where the nearer one changes.
#[test]
fn which_field_is_nearer_must_not_change() {
    let field = |slope: f64, way: f64| {
        Contact::rigid(brick::Z_MIN)
            .with_gap_field(move |p| 0.1 + slope * (p[0] - 7.0))
            .with_motion([way, 0.0, 0.0], ramp())
    };
    let both = |way: f64| scene(field(0.0, way), 4).with_contact(field(0.01, way));
    Plan::new(&both(2.0), &Settings::default()).expect("one stays nearer");
    // they cross at x = 7, and pass the end of the block on their way back
    match refused(&both(-2.0)) {
        ContactError::SharedNode { first, second, .. } => assert_eq!((first, second), (0, 1)),
        error => panic!("{error}"),
    }
}

/// Along a cylinder, and on short ways across it, but not far across it unless there is one direction.
#[test]
fn curved_sides_take_fields_along_short_ways() {
    let bent = block([2.0, 1.0, 0.5], [12, 4, 2])
        .map_points(|[x, y, z]| {
            let (radius, angle) = (2.0 - z, (x - 1.0) / 2.0);
            [radius * angle.sin(), y, -radius * angle.cos()]
        })
        .expect("bent");
    let scene = |contact: Contact| {
        Scene::new(bent.clone(), uniform(1e6, 0.3))
            .with_contact(contact)
            .with_support(Support::fixed(brick::Z_MAX))
            .with_analysis(paper_steps(1.0, 2))
    };
    let field = Contact::rigid(brick::Z_MIN).with_gap_field(|p| 0.01 + 0.01 * p[1].powi(2));
    let plan = |way: [f64; 3], contact: &Contact| {
        let moving = contact.clone().with_motion(way, ramp());
        Plan::new(&scene(moving), &Settings::default())
    };
    plan([0.0, 5.0, 0.0], &field).expect("along the axis");
    plan([0.15, 0.0, 0.0], &field).expect("short");
    plan([0.0, 0.0, 0.15], &field).expect("short");
    let down = field.clone().with_normal([0.0, 0.0, -1.0]);
    plan([0.5, 0.0, 0.0], &down).expect("one direction");
    let constant = Contact::rigid(brick::Z_MIN).with_gap(0.01);
    plan([0.5, 0.0, 0.0], &constant).expect("the same gap everywhere");
    let across = field.with_motion([0.5, 0.5, 0.0], History::constant(-1.0));
    match refused(&scene(across)) {
        ContactError::MovedField { contact, turn, .. } => {
            // 0.5 m on a circle of 2 m
            let expected = 0.25_f64.to_degrees();
            assert!(contact == 0 && (turn / expected - 1.0).abs() < 0.1, "{turn}");
        }
        error => panic!("{error}"),
    }
}

/// A gap that is the same everywhere only knows the way along the normal.
#[test]
fn a_constant_gap_has_nothing_to_bring() {
    let contact = |way: [f64; 3]| Contact::rigid(brick::Z_MIN).with_gap(0.01).with_motion(way, ramp());
    let loaded = |c| {
        let load = Load::traction(brick::X_MAX, [0.0, 0.0, -1e4]);
        scene(c, 2).with_load(load)
    };
    let (_, a) = run(loaded(contact([0.0, 0.0, 0.02])), at(1e-9));
    let (_, b) = run(loaded(contact([0.7, -0.3, 0.02])), at(1e-9));
    for (a, b) in a.iter().zip(&b) {
        assert_eq!(a.displacement, b.displacement);
    }
}

/// The distance from a shaft, given as a field, is that of the shaft along a bore of quadratic facets, too: that a mean
/// place is beside a curved side was taken for a jump of the gap, and where the shaft moved the force was 12 % off.
#[test]
fn a_field_around_quadratic_facets_does_not_jump() {
    let place = |[x, y, z]: [f64; 3]| {
        let (radius, angle) = (10.0 + 4.0 * x, 0.5 * std::f64::consts::PI * y);
        [radius * angle.cos(), radius * angle.sin(), z]
    };
    let bore = block([1.0; 3], [1, 4, 2])
        .raise_order()
        .and_then(|mesh| mesh.map_points(place));
    let scene = Scene::new(bore.expect("bore"), uniform(1e3, 0.3)).with_support(Support::fixed(brick::X_MAX));
    let shaft = || Contact::obstacle(brick::X_MIN, Obstacle::cylinder([0.0; 3], [0.0, 0.0, 1.0], 10.01));
    let field = || Contact::rigid(brick::X_MIN).with_gap_field(|[x, y, _]| x.hypot(y) - 10.01);
    for way in [[0.0; 3], [0.004, 0.003, 0.002]] {
        let [known, found] = [shaft(), field()].map(|contact| {
            let scene = scene.clone().with_contact(contact.with_motion(way, ramp()));
            solve(scene, Settings::default()).summary.normal_force
        });
        assert!((found / known - 1.0).abs() < 0.02, "{way:?}: {found}, {known}");
    }
}

/// A cone that turns about its axis, and a plane that moves along its normal, are the same ones: of quadratic facets
/// nodes that had no way along the surface had the mean gap of their point, not their own.
#[test]
fn a_field_that_moves_along_itself_stays_on_quadratic_facets() {
    let mesh = block([1.0; 3], [4, 4, 2]).raise_order().expect("order 2");
    let scene = Scene::new(mesh, uniform(1e3, 0.3)).with_support(Support::fixed(brick::Z_MAX));
    let apex = [0.5, 0.5, 0.0];
    let cone = Contact::rigid(brick::Z_MIN).with_gap_field(move |[x, y, _]| 0.1 * (x - 0.5).hypot(y - 0.5) - 0.01);
    let turn = History::ramp(0.3, 1.0).expect("ramp");
    let solved = |contact: Contact| solve(scene.clone().with_contact(contact), at(1e-9));
    let still = solved(cone.clone());
    let turned = solved(cone.with_rotation(apex, [0.0, 0.0, 1.0], turn));
    for (a, b) in still.points.iter().zip(&turned.points) {
        assert!((a.gap - b.gap).abs() < 1e-12, "{} {}", a.gap, b.gap);
    }
    let plane = |rise: f64| Contact::half_space(brick::Z_MIN, [0.5, 0.5, rise], [-0.3, 0.0, 1.0]);
    let there = solved(plane(1e-3 * 1.09));
    let moved = solved(plane(0.0).with_motion([-3e-4, 0.0, 1e-3], ramp()));
    assert!(there.summary.active > 3, "{}", there.summary.active);
    assert_close(&moved.displacement, &there.displacement, 1e-7, "along its normal");
}
