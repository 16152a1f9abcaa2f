//! Functions that are given as distances to an obstacle, and are others.

use crate::common::*;

fn pressed(contact: Contact) -> Scene {
    Scene::new(block([1.0; 3], [4, 4, 2]), uniform(1e6, 0.3))
        .with_contact(contact)
        .with_support(Support::fixed(brick::Z_MIN))
}

/// Multiples and squares of a distance, distances in mm and of the wrong sign have other gaps.
#[test]
fn functions_that_are_no_distances_are_refused_with_their_place() {
    let arm = |x: [f64; 3]| norm(&[x[0] - 0.5, x[1] - 0.5, x[2] - 3.0]);
    let outward = move |x: [f64; 3]| [x[0] - 0.5, x[1] - 0.5, x[2] - 3.0].map(|c| c / arm(x));
    let ball = move |x: [f64; 3]| arm(x) - 1.0;
    let contact = |f: fn(f64) -> f64| {
        let shape = Obstacle::from_distance(move |x| f(ball(x)), outward);
        Contact::obstacle(brick::Z_MAX, shape)
    };
    let faces: [fn(Contact) -> Contact; 3] = [|c| c, |c| c.with_normal([0.0, 0.0, 1.0]), |c| c.with_body_normals()];
    for (f, is) in [
        ((|d| 2.0 * d) as fn(f64) -> f64, 2.0),
        (|d| 1e3 * d, 1e3),
        (|d| 0.5 * d, 0.5),
        (|d| -d, -1.0),
        (|d| d.powi(2), 2.0),
    ] {
        for face in faces {
            let error = refused(&pressed(face(contact(f))));
            let ContactError::ObstacleDistance {
                contact: 0,
                node,
                position,
                slope,
            } = error
            else {
                panic!("{error}");
            };
            // of the square it is twice the distance, which is 1 at least
            assert!((slope / is - 1.0).abs() < 0.2, "{slope}");
            assert_eq!(error.parts(), [Part::Contact(0), Part::Node(node)]);
            let text = error.to_string();
            assert!(position[2] == 1.0 && text.contains("changes by") && text.contains("give the distance in m"));
        }
        // the gap is another one
        let given = pressed(contact(f).with_gap(0.1));
        assert!(Plan::new(&given, &Settings::default()).is_ok());
    }
    // nearly one; of a function over the length of its gradient, far from the ball; with errors of an iteration
    let newton = move |x: [f64; 3]| (arm(x).powi(2) - 1.0) / (2.0 * arm(x));
    let noise = move |x: [f64; 3]| ball(x) + 1e-6 * (1e7 * (x[0] + 2.0 * x[1] + 3.0 * x[2])).sin();
    let small = move |x: [f64; 3]| (arm(x) - 0.1) * (arm(x) + 0.1) / (2.0 * arm(x));
    for face in faces {
        for shape in [
            Obstacle::from_distance(newton, outward),
            Obstacle::from_distance(noise, outward),
            Obstacle::from_distance(small, outward),
        ] {
            let given = pressed(face(Contact::obstacle(brick::Z_MAX, shape)));
            assert!(Plan::new(&given, &Settings::default()).is_ok());
        }
        let near = pressed(face(contact(|d| d * (1.0 + 0.03 * d))));
        assert!(Plan::new(&near, &Settings::default()).is_ok());
    }
}

/// Inclined sides of two bodies, of the same cells or others, are as far from each other along a fixed direction as one
/// was moved along it; what moves back by as much touches.
#[test]
fn gaps_along_a_fixed_direction_are_those_along_it() {
    for (slope, order) in [(0.0, 1), (0.6, 1), (1.5, 1), (0.6, 2)] {
        for cells in [[3, 3], [3, 4], [4, 3], [2, 5]] {
            let wedge = |cells: usize, up: f64| {
                let straight = block([1.0; 3], [cells; 3]);
                let straight = if order == 2 { straight.raise_order().expect("order 2") } else { straight };
                let place = |[x, y, z]: [f64; 3]| [x, y, z + up + slope * x];
                straight.map_points(place).expect("inclined")
            };
            let mesh = with_second(&wedge(cells[0], 0.0), &wedge(cells[1], 1.02));
            let contact = Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_normal([0.0, 0.0, -1.0]);
            let gaps = |down: f64| {
                let moved = Support::fixed(second(brick::Z_MAX)).with_motion([0.0, 0.0, -down], ramp());
                let scene = Scene::new(mesh.clone(), uniform(1e9, 0.3))
                    .with_support(Support::fixed(brick::Z_MIN))
                    .with_support(moved)
                    .with_support(Support::fixed(second(brick::Z_MIN)).with_motion([0.0, 0.0, -down], ramp()))
                    .with_contact(contact.clone());
                let points = solve(scene, at(1e-8)).points;
                points.iter().map(|p| p.gap).collect::<Vec<_>>()
            };
            let gaps = gaps(0.01);
            assert!(!gaps.is_empty());
            for gap in gaps {
                assert!((gap - 0.01).abs() < 1e-9, "{slope} {order} {cells:?}: {gap}");
            }
        }
    }
}
