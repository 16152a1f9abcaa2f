//! Turning, shifting, renumbering and other units change the numbers of a result and nothing else.

use crate::common::*;
use proptest::prelude::*;
use rand::seq::SliceRandom;

type Rotation = [[f64; 3]; 3];

const IDENTITY: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The small benchmark with a side load, turned by `r` and shifted, with its parts given by element.
fn scene(mesh: TetMesh, parts: Vec<u32>, r: &Rotation, shift: [f64; 3], law: Friction) -> Scene {
    let moved = mesh
        .map_points(|p| {
            let q = turn(r, p);
            [q[0] + shift[0], q[1] + shift[1], q[2] + shift[2]]
        })
        .expect("mesh");
    let traction = |tag, v| Load::new(LoadDensity::Traction(tag, turn(r, v)));
    Scene::new(moved, steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(traction(brick::Z_MAX, [0.0, 4e8, -30e8]).with_history(ramp()))
        .with_load(traction(brick::X_MAX, [9e8, 3e8, -15e8]).with_history(up_down_up()))
        .with_contact(Contact::rigid(brick::Z_MIN).with_gap(0.1).with_friction(law))
        .with_parts_as_given(parts)
        .with_analysis(paper_steps(1.0, 4))
}

fn brick_mesh() -> TetMesh {
    block([3.0, 1.0, 1.0], [6, 2, 2])
}

/// Three parts along x, by element.
fn three_parts(mesh: &TetMesh) -> Vec<u32> {
    let centre = |t: usize| mesh.tet_points(t).iter().map(|p| p[0]).sum::<f64>() / 4.0;
    (0..mesh.tets().len()).map(|t| centre(t).floor() as u32).collect()
}

/// Everything of all steps that has a direction, turned back by the inverse of `r`, by mesh node.
fn turned_back(results: &[Solved], r: &Rotation, nodes: usize) -> Vec<f64> {
    let mut inverse = IDENTITY;
    for (i, row) in inverse.iter_mut().enumerate() {
        *row = [r[0][i], r[1][i], r[2][i]];
    }
    let mut out = Vec::new();
    for result in results {
        for u in result.displacement.chunks_exact(3) {
            // displacements of 0.1 m beside forces of 1e8 N
            out.extend(turn(&inverse, [u[0], u[1], u[2]]).map(|v| 1e9 * v));
        }
        let mut forces = vec![0.0; 4 * nodes];
        for p in &result.points {
            let f = turn(&inverse, p.friction_force);
            forces[4 * p.node as usize..][..4].copy_from_slice(&[p.normal_force, f[0], f[1], f[2]]);
        }
        out.extend(forces);
        out.extend(turn(&inverse, result.summary.resultant));
    }
    out
}

fn solved(mesh: &TetMesh, r: &Rotation, shift: [f64; 3], law: &Friction) -> Vec<f64> {
    let parts = three_parts(mesh);
    let scene = scene(mesh.clone(), parts, r, shift, law.clone());
    let (_, results) = run(scene, at(1e-8));
    assert!(results.iter().any(|l| l.summary.slip > 0));
    turned_back(&results, r, mesh.points().len())
}

#[test]
fn quarter_turns_and_general_rotations() {
    let mesh = brick_mesh();
    for law in [Friction::tresca(3e8), Friction::coulomb(0.4), weakening()] {
        let reference = solved(&mesh, &IDENTITY, [0.0; 3], &law);
        let quarter = std::f64::consts::FRAC_PI_2;
        for (axis, angle) in [
            ([0.0, 0.0, 1.0], quarter),
            ([1.0, 0.0, 0.0], quarter),
            ([0.0, 1.0, 0.0], 2.0 * quarter),
            ([1.0, 2.0, -0.5], 0.83),
            ([-1.0, 0.3, 0.9], 2.6),
        ] {
            let r = rotation(axis, angle);
            let right_handed = cross(turn(&r, [1.0, 0.0, 0.0]), turn(&r, [0.0, 1.0, 0.0]));
            assert_close(&right_handed, &turn(&r, [0.0, 0.0, 1.0]), 1e-14, "rotation");
            let found = solved(&mesh, &r, [0.3, -2.0, 5.0], &law);
            assert_close(&found, &reference, 1e-6, &format!("{law:?}, {axis:?}, {angle}"));
        }
    }
}

/// A shuffled list of 0..n that depends on the seed.
fn shuffled(n: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    order.shuffle(&mut random(seed));
    order
}

/// The mesh with nodes, elements and facets in another order; `places[old] = new` for nodes.
fn renumbered(mesh: &TetMesh, seed: u64) -> (TetMesh, Vec<usize>) {
    let order = shuffled(mesh.points().len(), seed);
    let mut places = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        places[old] = new;
    }
    let points = order.iter().map(|&old| mesh.points()[old]).collect();
    let new = |n: u32| places[n as usize] as u32;
    let tets = shuffled(mesh.tets().len(), seed + 1)
        .into_iter()
        .map(|t| {
            let [a, b, c, d] = mesh.tets()[t].map(new);
            // an even permutation keeps the orientation
            [b, c, a, d]
        })
        .collect();
    let facets = shuffled(mesh.facets().len(), seed + 2)
        .into_iter()
        .map(|f| {
            let facet = mesh.facets()[f];
            let [a, b, c] = facet.nodes.map(new);
            Facet {
                nodes: [b, c, a],
                tag: facet.tag,
            }
        })
        .collect();
    (TetMesh::new(points, tets, facets).expect("mesh"), places)
}

fn check_renumbering(seed: u64, law: &Friction) {
    let mesh = brick_mesh();
    let solve = |mesh: &TetMesh| {
        let scene = scene(mesh.clone(), three_parts(mesh), &IDENTITY, [0.0; 3], law.clone());
        run(scene, at(1e-8)).1
    };
    let reference = solve(&mesh);
    let (other, places) = renumbered(&mesh, seed);
    for (k, (a, b)) in solve(&other).iter().zip(&reference).enumerate() {
        let u: Vec<f64> = places
            .iter()
            .flat_map(|&p| a.displacement[3 * p..3 * p + 3].to_vec())
            .collect();
        assert_close(&u, &b.displacement, 1e-7, &format!("{law:?}, step {k}"));
        let mut forces = Vec::new();
        let mut expected = Vec::new();
        for p in &b.points {
            let new = places[p.node as usize] as u32;
            let q = a.points.iter().find(|q| q.node == new).expect("contact node");
            forces.push(q.normal_force);
            forces.extend(q.friction_force);
            expected.push(p.normal_force);
            expected.extend(p.friction_force);
        }
        assert_close(&forces, &expected, 1e-6, &format!("{law:?}, step {k}"));
    }
}

#[test]
fn renumbering_nodes_elements_and_facets() {
    for seed in 0..3 {
        for law in [Friction::None, Friction::coulomb(0.3), weakening()] {
            check_renumbering(seed, &law);
        }
    }
}

/// The numbers of the parts are names only.
#[test]
fn renumbering_subdomains() {
    let mesh = brick_mesh();
    let solve = |names: [u32; 3]| {
        let parts = three_parts(&mesh).iter().map(|&p| names[p as usize]).collect();
        let scene = scene(mesh.clone(), parts, &IDENTITY, [0.0; 3], Friction::coulomb(0.3));
        let (_, results) = run(scene, at(1e-8));
        turned_back(&results, &IDENTITY, mesh.points().len())
    };
    let reference = solve([0, 1, 2]);
    for names in [[2, 1, 0], [1, 2, 0]] {
        assert_close(&solve(names), &reference, 1e-6, &format!("{names:?}"));
    }
}

/// A support given by a tag, by its nodes, and in pieces.
#[test]
fn supports_may_be_given_in_any_way() {
    let mesh = brick_mesh();
    let nodes = mesh.nodes_on(brick::X_MIN);
    let solve = |supports: Vec<Support>| {
        let mut scene = small_benchmark(Friction::coulomb(0.3), 3);
        let base = Scene::new(mesh.clone(), steel())
            .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]))
            .with_contact(scene.contacts()[0].clone())
            .with_boxes([3, 1, 1]);
        scene = supports.into_iter().fold(base, Scene::with_support);
        run(scene, at(1e-8)).1.remove(0).displacement
    };
    let reference = solve(vec![Support::fixed(brick::X_MIN)]);
    let reversed: Vec<u32> = nodes.iter().rev().copied().collect();
    for supports in [
        vec![Support::fixed(Place::Nodes(reversed))],
        vec![
            Support::components(brick::X_MIN, [true, false, false]),
            Support::components(brick::X_MIN, [false, true, true]),
        ],
        vec![Support::fixed(brick::X_MIN), Support::fixed(nodes)],
    ] {
        assert_close(&solve(supports), &reference, 1e-7, "displacement");
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 8,
        rng_seed: proptest::test_runner::RngSeed::Fixed(11),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_rotation(axis in prop::array::uniform3(0.1..1.0f64), angle in -3.1..3.1f64, coefficient in 0.05..0.6f64) {
        let mesh = brick_mesh();
        let law = Friction::coulomb(coefficient);
        let reference = solved(&mesh, &IDENTITY, [0.0; 3], &law);
        let found = solved(&mesh, &rotation(axis, angle), [1.0, 2.0, 3.0], &law);
        assert_close(&found, &reference, 1e-6, "rotation");
    }

    #[test]
    fn any_numbering(seed in 0..u64::MAX / 2, coefficient in 0.05..0.6f64) {
        check_renumbering(seed, &Friction::coulomb(coefficient));
    }
}

/// The small benchmark in units in which a metre is `length` and a newton `force` times one; seconds are `time`.
fn scene_in_units(law: usize, length: f64, force: f64, time: f64) -> Scene {
    let stress = force / (length * length);
    let friction = match law {
        0 => Friction::None,
        1 => Friction::tresca(3e8 * stress),
        2 => Friction::coulomb(0.3),
        _ => Friction::Coulomb(Coefficient::Exponential {
            fixed: 0.3,
            kinetic: 0.1,
            decay: 0.05 * length / time,
        }),
    };
    let history = |table: fn() -> History| {
        let table = table();
        History::function(move |t| table.value(t / time))
    };
    let q = 1e8 * stress;
    Scene::new(
        block([3.0 * length, length, length], [6, 2, 2]),
        uniform(211.9e9 * stress, 0.277),
    )
    .with_support(Support::fixed(brick::X_MIN))
    .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30.0 * q]).with_history(history(ramp)))
    .with_load(Load::traction(brick::X_MAX, [9.0 * q, 0.0, -15.0 * q]).with_history(history(up_down_up)))
    .with_load(Load::body([0.0, 1e7 * force / length.powi(3), 0.0]))
    .with_contact(
        Contact::rigid(brick::Z_MIN)
            .with_gap(0.1 * length)
            .with_friction(friction),
    )
    .with_boxes([3, 1, 1])
    .with_analysis(paper_steps(time, 5))
}

/// Compares a scene in other units with the original; returns the products of both.
fn compare_units(law: usize, settings: &Settings, length: f64, force: f64, time: f64) -> [usize; 2] {
    let (a, reference) = run(scene_in_units(law, 1.0, 1.0, 1.0), settings.clone());
    let (b, results) = run(scene_in_units(law, length, force, time), settings.clone());
    for (k, (x, y)) in results.iter().zip(&reference).enumerate() {
        let what = format!("law {law}, {length:e} m, {force:e} N, {time:e} s, step {k}");
        let u: Vec<f64> = x.displacement.iter().map(|v| v / length).collect();
        let f: Vec<f64> = forces(&x.points).iter().map(|v| v / force).collect();
        assert_close(&u, &y.displacement, 1e-7, &what);
        assert_close(&f, &forces(&y.points), 1e-7, &what);
        assert_eq!(x.summary.active, y.summary.active, "{what}");
        let rate = x.summary.max_slip_rate * time / length;
        assert!(
            (rate - y.summary.max_slip_rate).abs() <= 1e-6 * rate.max(1e-3),
            "{what}"
        );
        let work = x.summary.dissipation / (force * length);
        assert!(
            (work - y.summary.dissipation).abs() <= 1e-6 * work.abs().max(1e3),
            "{what}"
        );
    }
    assert!(reference.iter().any(|l| l.summary.active > 0));
    [a.counters().products, b.counters().products]
}

#[test]
fn stiffness_and_lengths_scale() {
    let accurate = at(1e-8);
    for law in 0..4 {
        for method in methods() {
            let settings = accurate.clone().with_method(method);
            for (length, force) in [(1.0, 1e9), (1.0, 1e-9), (1e-3, 1e-6 * 1e9), (1e3, 1.0), (1e-3, 1.0)] {
                let [a, b] = compare_units(law, &settings, length, force, 1.0);
                // the same iterations up to rounding
                assert!(a.abs_diff(b) <= 5 + a / 10, "{a} and {b} products");
            }
        }
        let settings = accurate.clone().with_preconditioner(Preconditioner::Dirichlet);
        compare_units(law, &settings, 1e-3, 1e3, 1e3);
    }
}

/// Powers of two are exact: not one product may differ, nor one bit of the mantissas.
#[test]
fn powers_of_two_change_no_bit() {
    for method in methods() {
        let settings = by(method.clone());
        let (length, force) = (2.0_f64.powi(-10), 2.0_f64.powi(30));
        let (_, reference) = run(scene_in_units(2, 1.0, 1.0, 1.0), settings.clone());
        let (_, results) = run(scene_in_units(2, length, force, 1.0), settings);
        for (x, y) in results.iter().zip(&reference) {
            assert_eq!(x.report.counters, y.report.counters, "{}", method.kind());
            for (a, b) in x.torn.iter().zip(&y.torn) {
                assert_eq!(a / length, *b, "{}", method.kind());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 12,
        rng_seed: proptest::test_runner::RngSeed::Fixed(20),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_units(law in 0..4usize, length in -4.0..4.0f64, force in -9.0..9.0f64, time in -3.0..6.0f64) {
        let settings = by(Method::default()).with_tolerance(1e-8);
        compare_units(law, &settings, 10f64.powf(length), 10f64.powf(force), 10f64.powf(time));
    }
}

/// Two sectors of rings, one around the other, guided at their ends and below: supports and contact share nodes.
#[test]
fn rows_that_share_nodes_are_scaled_under_any_numbers() {
    let mut all = Vec::new();
    for seed in 0..30 {
        let sector = |radius: f64| {
            let flat = block([0.4, 1.0, 0.5], [1, 5, 1]);
            let bend = |[x, y, z]: [f64; 3]| [(radius + x) * (1.3 * y).cos(), (radius + x) * (1.3 * y).sin(), z];
            flat.map_points(bend).expect("a sector")
        };
        let (mesh, _) = renumbered(&with_second(&sector(0.6), &sector(1.0)), seed);
        let mut scene = Scene::new(mesh, uniform(1e3, 0.3));
        for tag in [|tag| tag, second] {
            let along = |end| Support::components(tag(end), [false, true, false]).with_axis([0.0; 3], [0.0, 0.0, 1.0]);
            scene = scene
                .with_support(along(brick::Y_MIN))
                .with_support(along(brick::Y_MAX))
                .with_support(Support::components(tag(brick::Z_MIN), [false, false, true]));
        }
        let scene = scene
            .with_contact(Contact::between(brick::X_MAX, second(brick::X_MIN)).with_friction(Friction::coulomb(0.3)))
            .with_load(Load::pressure(brick::X_MIN, 0.5));
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let result = simulation.step().expect("a step");
        assert!(result.report().status.converged(), "{seed}: {}", result.report().status);
        all.push(result.points().iter().map(|p| p.normal_force).sum::<f64>());
    }
    assert!(all.iter().all(|force| (force / all[0] - 1.0).abs() < 1e-5), "{all:?}");
}

/// What rounding leaves between a body and a tilted floor on which it lies is no gap: without loads nothing moves.
#[test]
fn a_body_at_rest_on_a_tilted_floor_stays() {
    for (k, friction) in (0..24).flat_map(|k| [(k, 0.0), (k, 0.3)]) {
        let ((s, c), (s2, c2)) = ((0.13 * f64::from(k)).sin_cos(), (0.06 * f64::from(k)).sin_cos());
        let turn = |[x, y, z]: [f64; 3]| {
            let [x, y, z] = [x, c * y - s * z, s * y + c * z];
            [c2 * x - s2 * y, s2 * x + c2 * y, z]
        };
        let mesh = block([1.0, 1.0, 0.5], [3, 3, 1]).map_points(turn).expect("a mesh");
        let along = |tag, way| Support::partial(tag, Directions::Vectors(vec![turn(way)]));
        let later = History::table(vec![(0.0, 0.0), (0.5, 0.0), (1.0, 1.0)]).expect("a table");
        let floor = Contact::half_space(brick::Z_MIN, [0.0; 3], turn([0.0, 0.0, 1.0]));
        let ball = Obstacle::sphere(turn([0.5, 0.5, 3.6]), 3.0);
        let scene = Scene::new(mesh, uniform(1e3, 0.3))
            .with_support(along(brick::X_MIN, [1.0, 0.0, 0.0]))
            .with_support(along(brick::Y_MIN, [0.0, 1.0, 0.0]))
            .with_contact(match friction {
                0.0 => floor,
                _ => floor.with_friction(Friction::coulomb(friction)),
            })
            .with_contact(Contact::obstacle(brick::Z_MAX, ball).with_motion(turn([0.0, 0.0, -0.05]), later))
            .with_analysis(Analysis::quasistatic(1.0, 2));
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let result = simulation.step().expect("a step");
        assert!(
            result.report().status.converged(),
            "{k} {friction}: {}",
            result.report().status
        );
        let largest = result
            .displacement()
            .iter()
            .flatten()
            .fold(0.0, |most: f64, u| most.max(u.abs()));
        assert!(largest < 1e-12, "{k} {friction}: {largest:e}");
    }
}
