//! Obstacles of any shape, at rest, displaced and turned.

use crate::common::*;

/// A quarter of a block, [0, w]^2 x [-w, 0], whose cells become smaller towards the corner at the origin.
fn graded(width: f64, cells: usize) -> TetMesh {
    let finer = |x: f64| width * (x / width).powf(2.2);
    block([width; 3], [cells; 3])
        .map_points(|[x, y, z]| [finer(x), finer(y), -finer(width - z)])
        .expect("graded")
}

fn ball(radius: f64, approach: f64) -> Obstacle {
    Obstacle::sphere([0.0, 0.0, radius - approach], radius)
}

/// A rigid ball on a half-space: R 100, E 1000, nu 0.3, approach 0.01; by Hertz the force is 14.6520 and the radius of
/// the contact 1. At its far sides the quarter block is held where the half-space has moved under that force
/// (Boussinesq). Returns the relative error of the force.
fn hertz(cells: usize) -> f64 {
    let (young, poisson, width, exact) = (1000.0, 0.3, 8.0, 14.6520);
    let mesh = graded(width, cells);
    let far = |x: [f64; 3]| x.iter().any(|c| c.abs() > 0.999 * width);
    let shear = young / (2.0 * (1.0 + poisson));
    let nodes = 0..mesh.points().len() as u32;
    let nodes: Vec<u32> = nodes.filter(|&n| far(mesh.points()[n as usize])).collect();
    let values = nodes.iter().map(|&n| {
        let [x, y, z] = mesh.points()[n as usize];
        let (rho, depth) = (norm(&[x, y, z]), -z);
        let factor = exact / (4.0 * std::f64::consts::PI * shear);
        let out = depth / rho.powi(3) - (1.0 - 2.0 * poisson) / (rho * (rho + depth));
        let down = 2.0 * (1.0 - poisson) / rho + depth * depth / rho.powi(3);
        [factor * x * out, factor * y * out, -factor * down]
    });
    let values: Vec<[f64; 3]> = values.collect();
    let scene = Scene::new(mesh, uniform(young, poisson))
        .with_contact(Contact::obstacle(brick::Z_MAX, ball(100.0, 0.01)))
        .with_support(Support::fixed(nodes).with_motions(values, History::constant(1.0)))
        .with_support(Support::components(brick::X_MIN, [true, false, false]))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]));
    4.0 * solve(scene, at(1e-8)).summary.normal_force / exact - 1.0
}

/// Linear tetrahedra are too stiff by a part that falls with the size of cells.
#[test]
fn a_rigid_ball_presses_as_hertz_says() {
    let [coarse, fine] = [8, 16].map(hertz);
    println!("force of the ball: errors {coarse} and {fine}");
    assert!(fine > 0.0 && fine < 0.45 * coarse && fine < 0.14, "{coarse} {fine}");
}

/// `cargo test --release -p signorini-contact --test it -- --ignored finer_ball --nocapture` shows the errors.
#[test]
#[ignore = "half a minute"]
fn a_finer_ball_presses_as_hertz_says() {
    let [coarse, middle, fine] = [24, 32, 40].map(hertz);
    println!("force of the ball: errors {coarse}, {middle} and {fine}");
    assert!(fine > 0.0 && fine < 0.038 && fine < 0.5 * coarse);
}

/// A rigid cylinder along a slab in plane strain: a^2 = 4 P R / (pi E*), p0 = 2 P / (pi a) with the force P a length.
#[test]
fn a_rigid_cylinder_presses_as_hertz_says() {
    let (young, poisson, radius) = (1000.0, 0.3, 100.0);
    let error = |cells: usize| {
        let finer = |x: f64| x.signum() * 10.0 * (x.abs() / 10.0).powf(2.2);
        let depth = 0.2;
        let mesh = block([20.0, depth, 10.0], [2 * cells, 1, cells]);
        let mesh = mesh
            .map_points(|[x, y, z]| [finer(x - 10.0), y, finer(z - 10.0)])
            .expect("slab");
        let drum = Obstacle::cylinder([0.0, 0.0, radius - 0.02], [0.0, 2.0, 0.0], radius);
        let scene = Scene::new(mesh, uniform(young, poisson))
            .with_contact(Contact::obstacle(brick::Z_MAX, drum))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_support(Support::components(brick::Y_MIN, [false, true, false]))
            .with_support(Support::components(brick::Y_MAX, [false, true, false]));
        let result = solve(scene, at(1e-8));
        let force = result.summary.normal_force / depth;
        let modulus = young / (1.0 - poisson * poisson);
        let width = (4.0 * force * radius / (std::f64::consts::PI * modulus)).sqrt();
        let highest = 2.0 * force / (std::f64::consts::PI * width);
        // pressure of the two nodes in the middle
        let middle = result.points.iter().filter(|p| p.normal_force < 0.0);
        let [sum, area] = middle.fold([0.0; 2], |[sum, area], p| match p.gap.abs() < 1e-6 {
            true if norm(&p.normal[..1]) < 1e-9 => [sum - p.normal_force, area + p.area],
            _ => [sum, area],
        });
        sum / area / highest - 1.0
    };
    let [coarse, fine] = [10, 20].map(error);
    println!("pressure of the cylinder: errors {coarse} and {fine}");
    assert!(coarse.abs() < 0.05 && fine.abs() < 0.01, "{coarse} {fine}");
}

/// Triangles of a ball: an octahedron whose triangles are cut in four, again and again.
fn triangulated(centre: [f64; 3], radius: f64, cuts: usize) -> Obstacle {
    let mut points: Vec<[f64; 3]> = Vec::new();
    for (axis, sign) in (0..6).map(|k| (k / 2, 1.0 - 2.0 * f64::from(k as u32 % 2))) {
        points.push([0, 1, 2].map(|c| if c == axis { sign } else { 0.0 }));
    }
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for k in 0..8_u32 {
        let [i, j, l] = [k & 1, 2 + (k >> 1 & 1), 4 + (k >> 2)];
        // an odd number of negative corners turns it round
        triangles.push(if k.count_ones() % 2 == 0 { [i, j, l] } else { [i, l, j] });
    }
    for _ in 0..cuts {
        let mut middles = std::collections::BTreeMap::new();
        let mut next = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |p: u32, q: u32| {
                *middles.entry([p.min(q), p.max(q)]).or_insert_with(|| {
                    let sum = [0, 1, 2].map(|i| points[p as usize][i] + points[q as usize][i]);
                    points.push(sum.map(|x| x / norm(&sum)));
                    points.len() as u32 - 1
                })
            };
            let [d, e, f] = [middle(a, b), middle(b, c), middle(c, a)];
            next.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
        }
        triangles = next;
    }
    let places: Vec<[f64; 3]> = points
        .iter()
        .map(|p| [0, 1, 2].map(|c| centre[c] + radius * p[c]))
        .collect();
    Obstacle::surface(&places, &triangles).expect("surface")
}

/// A block [0, 1]^3, held below.
fn held(contact: Contact, steps: usize) -> Scene {
    Scene::new(block([1.0; 3], [6, 6, 3]), uniform(1e6, 0.3))
        .with_contact(contact)
        .with_support(Support::fixed(brick::Z_MIN))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, steps))
}

#[test]
fn a_ball_of_triangles_presses_like_the_ball() {
    let (centre, radius) = ([0.5, 0.5, 1.98], 1.0);
    let press = |shape: Obstacle| solve(held(Contact::obstacle(brick::Z_MAX, shape), 1), at(1e-9));
    let exact = press(Obstacle::sphere(centre, radius));
    let [coarse, fine] = [4, 6].map(|cuts| {
        let found = press(triangulated(centre, radius, cuts));
        (found.summary.normal_force / exact.summary.normal_force - 1.0).abs()
    });
    println!("ball of triangles: differences {coarse} and {fine}");
    assert!(coarse < 0.05 && fine < 0.2 * coarse, "{coarse} {fine}");
}

/// The same numbers, however the plane is told.
#[test]
fn a_half_space_is_an_obstacle_to_the_last_bit() {
    let (point, outward) = ([0.0, 0.0, -5e-4], [2e-4, -1e-4, 1.0]);
    let law = || Friction::coulomb(0.3);
    let scene = |contact: Contact| {
        let contact = contact.with_friction(law());
        clamped()
            .with_contact(contact)
            .with_analysis(Analysis::quasistatic(1.0, 3))
    };
    let plane = scene(Contact::half_space(brick::Z_MIN, point, outward));
    let shape = Obstacle::half_space(point, outward);
    let functions = {
        let of = shape.clone();
        let other = shape.clone();
        Obstacle::from_distance(move |x| of.distance(x).0, move |x| other.distance(x).1)
    };
    let (expected, state) = fingerprint(plane, at(1e-8));
    for shape in [shape, functions] {
        let (found, own) = fingerprint(scene(Contact::obstacle(brick::Z_MIN, shape)), at(1e-8));
        assert!(found == expected && own == state);
    }
}

/// A prism on its edge in a groove of a right angle, one obstacle or two: each side carries the weight over root two.
#[test]
fn a_groove_is_two_half_spaces() {
    let tilt = |v: [f64; 3]| turn(&rotation([0.0, -1.0, 0.0], std::f64::consts::FRAC_PI_4), v);
    let sides = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(|n| Obstacle::half_space([0.0; 3], tilt(n)));
    let nearer = {
        let sides = sides.clone();
        move |x: [f64; 3]| {
            let [a, b] = [&sides[0], &sides[1]].map(|side| side.distance(x));
            if a.0 < b.0 { a } else { b }
        }
    };
    let distance = nearer.clone();
    let groove = Obstacle::from_distance(move |x| distance(x).0, move |x| nearer(x).1);
    let [left, right] = sides;
    let one = vec![Contact::obstacle(brick::X_MIN, groove).with_tag(brick::Z_MIN)];
    let two = vec![
        Contact::obstacle(brick::X_MIN, left),
        Contact::obstacle(brick::Z_MIN, right),
    ];
    for contacts in [one, two] {
        let prism = block([1.0; 3], [3, 2, 3]).map_points(tilt).expect("prism");
        let mut scene = Scene::new(prism, uniform(1e6, 0.3))
            .with_load(Load::body([0.0, 0.0, -1.0]))
            .with_support(Support::components(brick::Y_MIN, [false, true, false]));
        for contact in contacts {
            scene = scene.with_contact(contact);
        }
        let result = solve(scene, at(1e-9));
        let side = |sign: f64| -> f64 {
            let own = result.points.iter().filter(|p| sign * p.normal[0] > 0.0);
            own.map(|p| -p.normal_force).sum()
        };
        for force in [side(1.0), side(-1.0)] {
            assert!((force - 0.5_f64.sqrt()).abs() < 1e-6, "{force}");
        }
    }
}

/// A pad that is pressed by its top on a disc.
fn pad(disc: Contact, steps: usize) -> Scene {
    let mesh = block([1.0, 1.0, 0.5], [4, 4, 2]);
    let mesh = mesh.map_points(|[x, y, z]| [x + 2.0, y - 0.5, z]).expect("pad");
    Scene::new(mesh, uniform(1e6, 0.3))
        .with_contact(disc.with_friction(Friction::coulomb(0.4)))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, steps))
}

fn pressed_top() -> Support {
    Support::fixed(brick::Z_MAX).with_motion([0.0, 0.0, -1e-3], History::ramp(0.1, 1.0).expect("ramp"))
}

/// Moment of the friction forces about the vertical axis through a point, and that of full slip: mu N r.
fn moments(mesh: &TetMesh, result: &Solved, [x, y]: [f64; 2], coefficient: f64) -> [f64; 2] {
    let mut out = [0.0; 2];
    for p in &result.points {
        let at = mesh.points()[p.node as usize];
        let arm = [at[0] - x, at[1] - y];
        out[0] += arm[0] * p.friction_force[1] - arm[1] * p.friction_force[0];
        out[1] -= coefficient * p.normal_force * norm(&arm);
    }
    out
}

#[test]
fn a_disc_that_turns_drags_a_pad_by_the_moment_of_its_friction() {
    for (sense, gap) in [(1.0, None), (-1.0, Some(0.0))] {
        let disc = match gap {
            None => Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0]),
            Some(gap) => Contact::rigid(brick::Z_MIN).with_gap(gap),
        };
        // a full turn
        let angle = History::ramp(1.0, sense * std::f64::consts::TAU).expect("ramp");
        let scene = pad(disc.with_rotation([0.0; 3], [0.0, 0.0, 2.0], angle), 20).with_support(pressed_top());
        let mesh = scene.mesh().clone();
        let (_, results) = run(scene, at(1e-9));
        let last = &results[19];
        let [moment, full] = moments(&mesh, last, [0.0; 2], 0.4);
        assert!((sense * moment / full - 1.0).abs() < 1e-6, "{moment} {full}");
        assert_eq!(last.summary.stick, 0);
        // mean radius of the pad
        let mean = full / (0.4 * last.summary.normal_force);
        assert!((mean - 2.5).abs() < 0.1, "{mean}");
        // all that the disc does is lost; nothing moves any more
        let [work, lost] = [last.summary.obstacle_work, last.summary.friction_work];
        let turned = std::f64::consts::TAU / 20.0;
        assert!((work / lost - 1.0).abs() < 1e-6 && (lost / (full * turned) - 1.0).abs() < 1e-6);
    }
}

/// A disc that turns under a pad is a pad that turns on a disc: small turns are rigid motions without strain.
#[test]
fn a_disc_turned_under_a_pad_is_a_pad_turned_on_a_disc() {
    let angle = 2e-4;
    let course = History::table(vec![(0.0, 0.0), (0.5, 1.0), (1.0, -0.5)]).expect("table");
    let (point, course_of) = ([2.2, 0.1, 7.0], course.clone());
    let disc = || Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0]);
    let angles = History::function(move |t| angle * course_of.value(t));
    let load = || Load::traction(brick::Z_MAX, [0.0, 0.0, -1e3]);
    let turning = pad(disc().with_rotation(point, [0.0, 0.0, 1.0], angles), 8)
        .with_load(load())
        .with_support(Support::components(brick::Z_MAX, [true, true, false]));
    let mesh = turning.mesh().clone();
    let way = |x: [f64; 3]| [-angle * (x[1] - point[1]), angle * (x[0] - point[0]), 0.0];
    let ways: Vec<[f64; 3]> = mesh
        .nodes_on(brick::Z_MAX)
        .iter()
        .map(|&n| way(mesh.points()[n as usize]))
        .collect();
    let back = ways.iter().map(|w| w.map(|c| -c)).collect();
    let turned = pad(disc(), 8)
        .with_load(load())
        .with_support(Support::components(brick::Z_MAX, [true, true, false]).with_motions(back, course.clone()));
    for method in methods() {
        let settings = at(1e-9).with_method(method.clone());
        let (_, a) = run(turning.clone(), settings.clone());
        let (_, b) = run(turned.clone(), settings);
        for (a, b) in a.iter().zip(&b) {
            let factor = course.value(a.time);
            let seen: Vec<f64> = (0..mesh.points().len())
                .flat_map(|n| {
                    let way = way(mesh.points()[n]);
                    [0, 1, 2].map(|c| b.displacement[3 * n + c] + factor * way[c])
                })
                .collect();
            assert_close(
                &a.displacement,
                &seen,
                1e-5,
                &format!("{} at {}", method.kind(), a.time),
            );
            assert_close(&forces(&a.points), &forces(&b.points), 1e-5, "forces");
        }
        assert!(a.iter().any(|r| r.summary.slip > 0) && a.iter().any(|r| r.summary.stick > 0));
    }
}

/// A ball that is pressed in and turns about its vertical axis stays where it is; a restart goes on with the same bits.
#[test]
fn a_ball_that_spins_keeps_its_gap() {
    let spin = History::table(vec![(0.0, 0.0), (0.2, 0.0), (1.0, 3.0)]).expect("table");
    let down = [0.0, 0.0, -0.02];
    let contact = Contact::obstacle(brick::Z_MAX, Obstacle::sphere([0.5, 0.5, 2.0], 1.0))
        .with_friction(Friction::coulomb(0.2))
        .with_motion(down, History::ramp(0.2, 1.0).expect("ramp"))
        .with_rotation([0.5, 0.5, 0.0], [0.0, 0.0, 1.0], spin);
    let scene = held(contact, 10);
    let (_, results) = run(scene.clone(), at(1e-9));
    let mesh = scene.mesh().clone();
    let last = &results[9];
    let [moment, full] = moments(&mesh, last, [0.5; 2], 0.2);
    // the node on the axis does not slide
    assert!((moment / full - 1.0).abs() < 1e-6, "{moment} {full}");
    let still = Contact::obstacle(brick::Z_MAX, Obstacle::sphere([0.5, 0.5, 1.98], 1.0));
    let still = solve(held(still, 1), at(1e-9));
    let [a, b] = [last, &still].map(|r| r.summary.normal_force);
    assert!((a / b - 1.0).abs() < 0.02, "{a} {b}");
    let mut half = Simulation::new(scene.clone(), at(1e-9)).expect("set-up");
    (0..5).for_each(|_| drop(step(&mut half)));
    let state = half.state().clone();
    let mut simulation = Simulation::new(scene, at(1e-9)).expect("set-up");
    simulation.resume(state).expect("resumed");
    let rest = rest(&mut simulation);
    for (a, b) in results[5..].iter().zip(&rest) {
        assert!(bits(a) == bits(b));
    }
}

/// Along the body's own flat side a ball may be dragged however far: the gap is measured along the normals.
#[test]
fn a_ball_dragged_along_a_plane_is_a_ball_that_stands_there() {
    let ball = |x: f64| Obstacle::sphere([x, 0.5, 2.98], 2.0);
    let stands = Contact::obstacle(brick::Z_MAX, ball(0.3));
    let dragged = stands.clone().with_motion([0.4, 0.0, 0.0], ramp());
    let (_, results) = run(held(dragged.clone().with_body_normals(), 2), at(1e-9));
    for result in &results {
        let there = Contact::obstacle(brick::Z_MAX, ball(0.3 + 0.4 * result.time)).with_body_normals();
        let there = solve(held(there, 1), at(1e-9));
        assert_close(&result.displacement, &there.displacement, 1e-7, "displacement");
    }
    let error = refused(&held(dragged, 2));
    assert!(matches!(error, ContactError::TurnedNormal { time: 1.0, .. }), "{error}");
    // a small way: normals of the start, gaps of the place
    let [large, small] = [0.02, 0.01].map(|way| {
        let near = stands.clone().with_motion([way, 0.0, 0.0], ramp());
        let near = solve(held(near, 1), at(1e-9));
        let there = solve(held(Contact::obstacle(brick::Z_MAX, ball(0.3 + way)), 1), at(1e-9));
        distance(&near.displacement, &there.displacement)
    });
    assert!(large < 0.06 && small < 0.6 * large, "{large} {small}");
}

#[test]
fn displacements_that_turn_the_normal_are_warned_of() {
    let warnings = |radius: f64| {
        let ball = Contact::obstacle(brick::Z_MAX, Obstacle::sphere([0.5, 0.5, 0.98 + radius], radius));
        let aside = Support::fixed(brick::Z_MIN).with_motion([0.05, 0.0, 0.0], ramp());
        let scene = Scene::new(block([1.0; 3], [6, 6, 3]), uniform(1e6, 0.3))
            .with_contact(ball)
            .with_support(aside);
        let mut simulation = Simulation::new(scene, at(1e-8)).expect("set-up");
        simulation.step().expect("step").warnings()
    };
    let turned = |w: &Warning| matches!(w, Warning::TurnedNormal { .. });
    assert!(!warnings(5.0).iter().any(turned));
    let found = warnings(0.3);
    let Some(
        warning @ Warning::TurnedNormal {
            step: 0,
            contact: 0,
            turn,
            ..
        },
    ) = found.iter().find(|w| turned(w))
    else {
        panic!("{found:?}");
    };
    // 0.05 m along a circle of 0.3 m
    assert!(
        (turn - 9.5).abs() < 1.5 && warning.to_string().contains("radius of curvature"),
        "{warning}"
    );
}

#[test]
fn obstacles_that_are_none_are_refused_with_their_place() {
    let of = |shape: Obstacle| refused(&held(Contact::obstacle(brick::Z_MAX, shape), 1));
    let at_node = |gradient: [f64; 3]| of(Obstacle::from_distance(|x| x[2] - 1.0, move |_| gradient));
    let up = |x: [f64; 3]| 1.0 - x[2];
    for gradient in [[0.0; 3], [0.0, 0.0, -2.0], [f64::NAN, 0.0, 0.0], [0.0, 0.0, -0.99]] {
        let error = at_node(gradient);
        assert!(
            matches!(
                error,
                ContactError::ObstacleGradient {
                    contact: 0,
                    node: 147,
                    ..
                }
            ),
            "{error}"
        );
    }
    // the middle of a ball
    let error = of(Obstacle::sphere([0.0, 0.0, 1.0], 0.5));
    assert!(matches!(error, ContactError::ObstacleGradient { .. }), "{error}");
    let error = of(Obstacle::from_distance(|_| f64::NAN, |_| [0.0, 0.0, -1.0]));
    assert!(matches!(error, ContactError::Gap { .. }), "{error}");
    // above the block the ground would have to be upside down
    let error = of(Obstacle::from_distance(up, |_| [0.0, 0.0, 1.0]));
    assert!(matches!(error, ContactError::ObstacleSide { .. }), "{error}");
    for shape in [
        Obstacle::sphere([0.5, 0.5, 2.0], 0.0),
        Obstacle::sphere([0.5, 0.5, 2.0], f64::NAN),
        Obstacle::cylinder([0.5, 0.5, 2.0], [0.0; 3], 1.0),
        Obstacle::half_space([0.0; 3], [0.0; 3]),
    ] {
        let error = of(shape);
        assert!(matches!(error, ContactError::ContactValue { .. }), "{error}");
    }
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]];
    for (triangles, facet) in [(vec![], 0), (vec![[0, 1, 2], [0, 1, 3]], 1), (vec![[0, 1, 9]], 0)] {
        let error = Obstacle::surface(&corners, &triangles).expect_err("refused");
        assert!(
            matches!(error, ContactError::ObstacleFacet { facet: k, .. } if k == facet),
            "{error}"
        );
    }
    // a plane that tilts
    let floor = Contact::half_space(brick::Z_MAX, [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
    let tilt = |angle: f64| {
        floor
            .clone()
            .with_rotation([0.0; 3], [1.0, 0.0, 0.0], History::constant(angle))
    };
    let error = refused(&held(tilt(0.2), 1));
    assert!(matches!(error, ContactError::MovedField { contact: 0, .. }), "{error}");
    solve(held(tilt(0.002), 1), at(1e-8));
    let error = refused(&held(floor.with_rotation([0.0; 3], [0.0; 3], ramp()), 1));
    assert!(matches!(error, ContactError::ContactValue { .. }), "{error}");
}
