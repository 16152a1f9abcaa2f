//! Friction that differs by direction: ellipses in the place of discs.

use crate::common::*;
use std::f64::consts::FRAC_PI_4;

const YOUNG: f64 = 1000.0;
const PRESSURE: f64 = 10.0;
/// Along the axis and across it.
const COEFFICIENTS: [f64; 2] = [0.3, 0.6];

/// Published: pull in degrees to the axis, threshold over pressure, direction of slip in degrees.
const TABLE: [[f64; 3]; 3] = [
    [30.0, 0.332820, 8.2132],
    [45.0, 0.379473, 14.0362],
    [60.0, 0.453557, 23.4132],
];

/// Friction along a direction of the plane z = 0 that is turned by `turn` from x.
fn rough(contact: Contact, turn: f64) -> Contact {
    let [along, across] = COEFFICIENTS;
    // what the axis has along the normal does not count
    contact
        .with_friction(Friction::coulomb(along))
        .with_friction_axis([3.0 * turn.cos(), 3.0 * turn.sin(), 2.0], across / along)
}

/// Uniform shear `t` in the direction `angle` under uniform pressure.
fn sheared(floor: Contact, t: f64, angle: f64) -> Scene {
    let (ty, tx) = angle.sin_cos();
    let (tx, ty) = (t * tx, t * ty);
    Scene::new(block([1.0; 3], [2, 2, 2]), uniform(YOUNG, 0.0))
        .with_load(Load::traction(brick::Z_MAX, [tx, ty, -PRESSURE]))
        .with_load(Load::traction(brick::X_MAX, [0.0, 0.0, tx]))
        .with_load(Load::traction(brick::X_MIN, [0.0, 0.0, -tx]))
        .with_load(Load::traction(brick::Y_MAX, [0.0, 0.0, ty]))
        .with_load(Load::traction(brick::Y_MIN, [0.0, 0.0, -ty]))
        .with_contact(floor)
        .with_boxes([2, 1, 1])
}

/// Threshold over pressure, and direction of slip from the axis: normal to the ellipse.
fn closed_form(pull: f64) -> [f64; 2] {
    let [a, b] = COEFFICIENTS;
    let (y, x) = pull.sin_cos();
    [(x / a).hypot(y / b).recip(), (y / (b * b)).atan2(x / (a * a))]
}

/// The top is moved by what shears the block up to the threshold, and a little more in the direction of slip.
#[test]
fn thresholds_and_directions_of_slip_are_those_of_the_ellipse() {
    let shear = YOUNG / 2.0;
    for (k, [degrees, threshold, slip_degrees]) in TABLE.into_iter().enumerate() {
        let [found, along] = closed_form(degrees.to_radians());
        assert!((found - threshold).abs() < 1e-6 && (along.to_degrees() - slip_degrees).abs() < 1e-4);
        let turn = 0.4 * k as f64;
        let (pull, along, limit) = (degrees.to_radians() + turn, along + turn, found * PRESSURE);
        for method in methods() {
            let at = |t: f64, extra: f64| {
                let way = |from: f64, along: fn(f64) -> f64, to: f64| t / shear * along(from) + extra * along(to);
                let top = [
                    way(pull, f64::cos, along),
                    way(pull, f64::sin, along),
                    -PRESSURE / YOUNG,
                ];
                let scene = sheared(rough(Contact::rigid(brick::Z_MIN), turn), t, pull)
                    .with_support(Support::fixed(brick::Z_MAX).with_motion(top, History::constant(1.0)));
                solve(scene, at(1e-10).with_method(method.clone()))
            };
            let extra = 1e-4;
            let sliding = at(limit, extra);
            assert_eq!(count(&sliding.points, ContactState::Slip), 9, "{}", method.kind());
            for p in &sliding.points {
                let [fx, fy, _] = p.friction_force.map(|f| -f / p.area);
                let size = fx.hypot(fy) / PRESSURE;
                assert!((size - threshold).abs() < 1e-6, "{}, {degrees}: {size}", method.kind());
                assert!((fy.atan2(fx) - pull).abs() < 1e-6);
                let [x, y, _] = p.difference;
                assert!(
                    (y.atan2(x) - along).abs() < 1e-6,
                    "{}: {}",
                    method.kind(),
                    y.atan2(x) - turn
                );
                assert!((x.hypot(y) / extra - 1.0).abs() < 1e-5);
            }
            let sticking = at(limit * (1.0 - 1e-6), 0.0);
            let slip = sticking.points.iter().map(|p| norm(&p.difference)).fold(0.0, f64::max);
            assert!(slip < 1e-9 * limit / shear, "{slip:e}");
        }
        // driven by forces alone
        let pulled = |share: f64| sheared(rough(Contact::rigid(brick::Z_MIN), turn), share * limit, pull);
        solve(pulled(1.0 - 1e-4), Settings::default());
        let error = Simulation::new(pulled(1.01), Settings::default()).expect_err("held above the threshold");
        let ContactError::NotHeld {
            friction: Some(factor), ..
        } = error
        else {
            panic!("{error}");
        };
        assert!((1.005..1.01).contains(&factor), "{factor}");
    }
}

/// The law at each point: forces in the ellipse, slip along its normal.
fn assert_law(result: &Solved, axis: [f64; 3], bound: impl Fn(&PointState) -> [f64; 2]) -> usize {
    let largest = result.points.iter().map(|p| norm(&p.force())).fold(0.0, f64::max);
    let way = result.displacement.iter().map(|u| u.abs()).fold(0.0, f64::max);
    let mut slides = 0;
    for p in result.points.iter().filter(|p| p.state != ContactState::Open) {
        let along: f64 = (0..3).map(|c| axis[c] * p.normal[c]).sum();
        let first = [0, 1, 2].map(|c| axis[c] - along * p.normal[c]);
        let first = first.map(|c| c / norm(&first));
        let second = cross(p.normal, first);
        let part = |v: &[f64; 3], d: &[f64; 3]| -> f64 { (0..3).map(|c| v[c] * d[c]).sum() };
        let [r, s] = bound(p);
        let f = [first, second].map(|d| part(&p.friction_force, &d));
        let w = [first, second].map(|d| part(&p.difference, &d));
        let inside = (f[0] / r).hypot(f[1] / s);
        assert!((inside - 1.0) * r.min(s) < 1e-6 * largest, "{inside}");
        if p.state == ContactState::Slip {
            slides += 1;
            assert!((1.0 - inside) * r.max(s) < 1e-4 * largest, "{inside}");
            let normal = [-f[0] / (r * r), -f[1] / (s * s)];
            let off = (normal[0] * w[1] - normal[1] * w[0]) / norm(&normal);
            assert!(off.abs() < 1e-5 * way, "{off:e} of {way:e}");
        } else {
            assert!(norm(&p.difference) < 1e-6 * way);
        }
    }
    slides
}

fn pulled(contact: Contact, steps: usize) -> Scene {
    let pull = History::table(vec![(0.0, 0.0), (0.5, 1.0), (1.0, -0.5)]).expect("table");
    Scene::new(block([2.0, 1.0, 1.0], [6, 3, 3]), uniform(1e6, 0.3))
        .with_contact(contact)
        .with_support(
            Support::fixed(brick::Z_MAX).with_motion([0.0, 0.0, -1e-3], History::ramp(0.1, 1.0).expect("ramp")),
        )
        .with_load(Load::body([1e3, 1.5e3, 0.0]).with_history(pull))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, steps))
}

#[test]
fn points_that_stick_and_slide_obey_the_law_in_every_method() {
    let axis = [1.0, 0.5, 0.0];
    let laws: [(Friction, f64); 3] = [
        (Friction::coulomb(0.2), 0.0),
        (Friction::tresca(200.0), 200.0),
        (weakening(), 0.0),
    ];
    for method in methods() {
        for (law, stress) in &laws {
            let floor = Contact::rigid(brick::Z_MIN)
                .with_friction(law.clone())
                .with_friction_axis(axis, 2.5);
            let (_, results) = run(pulled(floor, 6), at(1e-9).with_method(method.clone()));
            let mut slides = 0;
            for result in &results {
                let bound = |p: &PointState| {
                    if *stress > 0.0 {
                        assert!((p.slip_bound / (stress * p.area) - 1.0).abs() < 1e-12);
                    } else if matches!(law, Friction::Coulomb(Coefficient::Constant(_))) {
                        assert!((p.slip_bound + 0.2 * p.normal_force).abs() < 1e-12 * p.slip_bound);
                    }
                    [p.slip_bound, 2.5 * p.slip_bound]
                };
                slides += assert_law(result, axis, bound);
            }
            let all: usize = results.iter().map(|r| r.summary.active).sum();
            assert!(slides > 0 && slides < all, "{law:?}: {slides} of {all}");
        }
    }
}

/// A circle is an ellipse; whatever the axis, results are those of isotropic friction.
#[test]
fn a_ratio_of_one_is_isotropic() {
    let floor = || Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.2));
    let (_, plain) = run(pulled(floor(), 4), at(1e-10));
    let (_, turned) = run(pulled(floor().with_friction_axis([1.0, -2.0, 0.3], 1.0), 4), at(1e-10));
    for (a, b) in plain.iter().zip(&turned) {
        assert_close(&a.displacement, &b.displacement, 1e-6, "displacement");
        assert_close(&forces(&a.points), &forces(&b.points), 1e-6, "forces");
    }
}

/// The second axis in the place of the first is the same ellipse.
#[test]
fn an_ellipse_has_two_axes() {
    let floor = |coefficient: f64, axis: [f64; 3], ratio: f64| {
        let floor = Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(coefficient));
        floor.with_friction_axis(axis, ratio)
    };
    let (_, one) = run(pulled(floor(0.1, [1.0, 0.5, 0.0], 3.0), 4), at(1e-10));
    let (_, other) = run(pulled(floor(0.3, [-0.5, 1.0, 0.0], 1.0 / 3.0), 4), at(1e-10));
    for (a, b) in one.iter().zip(&other) {
        assert_close(&a.displacement, &b.displacement, 1e-6, "displacement");
        assert_close(&forces(&a.points), &forces(&b.points), 1e-6, "forces");
        let [a, b] = [a, b].map(|r| r.summary.friction_work);
        assert!((a - b).abs() <= 1e-6 * a.abs().max(1e-9), "{a} {b}");
    }
    // nor does it take more to find
    let products = |floor: Contact| run(pulled(floor, 4), Settings::default()).0.counters().products;
    let one = products(floor(0.05, [1.0, 0.5, 0.0], 10.0));
    let other = products(floor(0.5, [-0.5, 1.0, 0.0], 0.1));
    println!("{one}, {other} products");
    assert!(other <= one + one / 4, "{one} {other}");
}

/// Where supports leave one direction of slip, friction along it is that of the ellipse's extent in this direction: the
/// rest of the force is the support's. An obstacle that moves keeps both rows, with the same result.
#[test]
fn one_direction_of_slip_meets_the_extent_of_the_ellipse() {
    let [a, b] = COEFFICIENTS;
    let extent = (a * FRAC_PI_4.cos()).hypot(b * FRAC_PI_4.sin());
    let across = [FRAC_PI_4.sin(), -FRAC_PI_4.cos(), 0.0];
    let along = [FRAC_PI_4.cos(), FRAC_PI_4.sin(), 0.0];
    let guided = |floor: Contact, by: f64| {
        let top = Support::fixed(brick::Z_MAX).with_motion([by * along[0], by * along[1], -1e-3], ramp());
        let guide = Support::partial(brick::Z_MIN, Directions::Vectors(vec![across]));
        let scene = Scene::new(block([1.0; 3], [2; 3]), uniform(1e6, 0.0))
            .with_contact(rough(floor, 0.0))
            .with_support(top)
            .with_support(guide)
            .with_boxes([2, 1, 1]);
        solve(scene, at(1e-10))
    };
    let still = guided(Contact::rigid(brick::Z_MIN), 0.1);
    let moved = guided(
        Contact::rigid(brick::Z_MIN).with_motion([-0.1 * along[0], -0.1 * along[1], 0.0], ramp()),
        0.0,
    );
    for result in [still, moved] {
        assert_eq!(result.summary.stick, 0);
        let force = result.summary.friction_force;
        let size = -(0..3).map(|c| force[c] * along[c]).sum::<f64>() / result.summary.normal_force;
        assert!((size / extent - 1.0).abs() < 1e-6, "{size} {extent}");
    }
}

/// Two bodies have the ellipse of a body on an obstacle that is not rigid.
#[test]
fn bodies_slide_along_the_normal_of_the_ellipse() {
    let lower = block([2.0, 1.0, 1.0], [6, 3, 3]);
    let mesh = with_second(&lower, &lifted(&lower, 1.0));
    let axis = [0.3, 1.0, 0.0];
    let contact = Contact::between(second(brick::Z_MIN), brick::Z_MAX)
        .with_friction(Friction::coulomb(0.2))
        .with_friction_axis(axis, 2.0);
    let scene = Scene::new(mesh, uniform(1e6, 0.3))
        .with_contact(contact)
        .with_support(Support::fixed(brick::Z_MIN))
        .with_support(Support::fixed(second(brick::Z_MAX)).with_motion([4e-3, 2e-3, -2e-3], ramp()))
        .with_boxes([2, 1, 2])
        .with_analysis(Analysis::quasistatic(1.0, 3));
    let (_, results) = run(scene, at(1e-9));
    let slides: usize = results
        .iter()
        .map(|r| assert_law(r, axis, |p| [-0.2 * p.normal_force, -0.4 * p.normal_force]))
        .sum();
    assert!(slides > 0);
}

/// The estimate knows ellipses: it is above the error, and not far.
#[test]
fn the_estimate_bounds_the_error() {
    let floor = Contact::rigid(brick::Z_MIN)
        .with_friction(Friction::coulomb(0.2))
        .with_friction_axis([1.0, 0.5, 0.0], 2.5);
    let scene = pulled(floor, 1);
    let reference = solve(scene.clone(), at(1e-11));
    assert!(reference.summary.slip > 20);
    for tolerance in [1e-1, 1e-2, 1e-4, 1e-6] {
        let mut simulation = Simulation::new(scene.clone(), at(tolerance)).expect("set-up");
        let result = step(&mut simulation);
        let gap = simulation.result().expect("a step").algebraic_error();
        let truth = energy_distance(&scene, &result.displacement, &reference.displacement) / gap.elastic.sqrt();
        let index = gap.relative() / truth;
        println!("{tolerance:e}: true {truth:.2e}, index {index:.2}");
        assert!(
            index > 0.95 && gap.relative() <= 4.0 * truth + 1e-10,
            "{tolerance:e}: {index}"
        );
    }
}

#[test]
fn ellipses_without_an_axis_are_refused() {
    let of = |axis: [f64; 3], ratio: f64| {
        let floor = Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.2));
        refused(&pulled(floor.with_friction_axis(axis, ratio), 1))
    };
    for ratio in [0.0, -1.0, 1e-4, 1e4, f64::NAN, f64::INFINITY] {
        let error = of([1.0, 0.0, 0.0], ratio);
        assert!(
            matches!(error, ContactError::ContactValue { name, .. } if name.contains("ratio")),
            "{error}"
        );
    }
    for axis in [[0.0; 3], [0.0, 0.0, 1.0], [f64::NAN, 0.0, 0.0]] {
        let error = of(axis, 2.0);
        assert!(
            matches!(
                error,
                ContactError::FrictionAxis {
                    contact: 0,
                    node: 0,
                    ..
                }
            ),
            "{error}"
        );
    }
}
