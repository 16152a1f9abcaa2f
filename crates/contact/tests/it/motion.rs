//! Turning, shifting and renumbering a scene turns, shifts and renumbers its results.

use crate::common;
use crate::common::{assert_close, block, cross, rotation, run, turn, up_down_up, weakening};
use proptest::prelude::*;
use signorini_contact::{Contact, Friction, Load, Place, Scene, Settings, Support};
use signorini_fem_mesh::{Facet, LoadDensity, TetMesh, brick};

type Rotation = [[f64; 3]; 3];

const IDENTITY: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn accurate() -> Settings {
    Settings::default().with_tolerance(1e-8)
}

/// The small benchmark with a side load, turned by `r` and shifted, with its parts given by element.
fn scene(mesh: TetMesh, parts: Vec<u32>, r: &Rotation, shift: [f64; 3], law: Friction) -> Scene {
    let moved = mesh
        .map_points(|p| {
            let q = turn(r, p);
            [q[0] + shift[0], q[1] + shift[1], q[2] + shift[2]]
        })
        .expect("mesh");
    let traction = |tag, v| Load::new(LoadDensity::traction(tag, turn(r, v)));
    Scene::new(moved, common::steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(traction(brick::Z_MAX, [0.0, 4e8, -30e8]).with_history(common::ramp()))
        .with_load(traction(brick::X_MAX, [9e8, 3e8, -15e8]).with_history(up_down_up()))
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(0.1)
                .with_friction(law),
        )
        .with_parts(parts)
        .with_analysis(common::paper_steps(1.0, 4))
}

fn brick_mesh() -> TetMesh {
    block([3.0, 1.0, 1.0], [6, 2, 2])
}

/// Three parts along x, by element.
fn three_parts(mesh: &TetMesh) -> Vec<u32> {
    let centre = |t: usize| mesh.tet_points(t).iter().map(|p| p[0]).sum::<f64>() / 4.0;
    (0..mesh.tets().len())
        .map(|t| centre(t).floor() as u32)
        .collect()
}

/// Everything of all levels that has a direction, turned back by the inverse of `r`, by mesh node.
fn turned_back(levels: &[common::Solved], r: &Rotation, nodes: usize) -> Vec<f64> {
    let mut inverse = IDENTITY;
    for (i, row) in inverse.iter_mut().enumerate() {
        *row = [r[0][i], r[1][i], r[2][i]];
    }
    let mut out = Vec::new();
    for level in levels {
        for u in level.displacement.chunks_exact(3) {
            // displacements of 0.1 m beside forces of 1e8 N
            out.extend(turn(&inverse, [u[0], u[1], u[2]]).map(|v| 1e9 * v));
        }
        let mut forces = vec![0.0; 4 * nodes];
        for p in &level.points {
            let f = turn(&inverse, p.friction_force);
            forces[4 * p.node as usize..][..4].copy_from_slice(&[p.normal_force, f[0], f[1], f[2]]);
        }
        out.extend(forces);
        out.extend(turn(&inverse, level.summary.resultant));
    }
    out
}

fn results(mesh: &TetMesh, r: &Rotation, shift: [f64; 3], law: &Friction) -> Vec<f64> {
    let parts = three_parts(mesh);
    let scene = scene(mesh.clone(), parts, r, shift, law.clone());
    let (_, levels) = run(scene, accurate());
    assert!(levels.iter().any(|l| l.summary.slip > 0));
    turned_back(&levels, r, mesh.points().len())
}

#[test]
fn quarter_turns_and_general_rotations() {
    let mesh = brick_mesh();
    for law in [Friction::tresca(3e8), Friction::coulomb(0.4), weakening()] {
        let reference = results(&mesh, &IDENTITY, [0.0; 3], &law);
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
            let found = results(&mesh, &r, [0.3, -2.0, 5.0], &law);
            assert_close(
                &found,
                &reference,
                1e-6,
                &format!("{law:?}, {axis:?}, {angle}"),
            );
        }
    }
}

/// A shuffled list of 0..n that depends on the seed.
fn shuffled(n: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    let mut state = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    for i in (1..n).rev() {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        order.swap(i, (state >> 33) as usize % (i + 1));
    }
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
        let scene = scene(
            mesh.clone(),
            three_parts(mesh),
            &IDENTITY,
            [0.0; 3],
            law.clone(),
        );
        run(scene, accurate()).1
    };
    let reference = solve(&mesh);
    let (other, places) = renumbered(&mesh, seed);
    for (k, (a, b)) in solve(&other).iter().zip(&reference).enumerate() {
        let u: Vec<f64> = places
            .iter()
            .flat_map(|&p| a.displacement[3 * p..3 * p + 3].to_vec())
            .collect();
        assert_close(&u, &b.displacement, 1e-7, &format!("{law:?}, level {k}"));
        let mut forces = Vec::new();
        let mut expected = Vec::new();
        for p in &b.points {
            let new = places[p.node as usize] as u32;
            let q = a
                .points
                .iter()
                .find(|q| q.node == new)
                .expect("contact node");
            forces.push(q.normal_force);
            forces.extend(q.friction_force);
            expected.push(p.normal_force);
            expected.extend(p.friction_force);
        }
        assert_close(&forces, &expected, 1e-6, &format!("{law:?}, level {k}"));
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
        let parts = three_parts(&mesh)
            .iter()
            .map(|&p| names[p as usize])
            .collect();
        let scene = scene(
            mesh.clone(),
            parts,
            &IDENTITY,
            [0.0; 3],
            Friction::coulomb(0.3),
        );
        let (_, levels) = run(scene, accurate());
        turned_back(&levels, &IDENTITY, mesh.points().len())
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
        let mut scene = common::small_benchmark(Friction::coulomb(0.3), 3);
        let base = Scene::new(mesh.clone(), common::steel())
            .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]))
            .with_contact(scene.contact().expect("contact").clone())
            .with_boxes([3, 1, 1]);
        scene = supports.into_iter().fold(base, Scene::with_support);
        run(scene, accurate()).1.remove(0).displacement
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
        let reference = results(&mesh, &IDENTITY, [0.0; 3], &law);
        let found = results(&mesh, &rotation(axis, angle), [1.0, 2.0, 3.0], &law);
        assert_close(&found, &reference, 1e-6, "rotation");
    }

    #[test]
    fn any_numbering(seed in 0..u64::MAX / 2, coefficient in 0.05..0.6f64) {
        check_renumbering(seed, &Friction::coulomb(coefficient));
    }
}
