//! Conservation in every step: forces, moments, dissipation.

use crate::common::{
    benchmark, cross, methods, norm, ramp, run, small_benchmark, up_down_up, weakening,
};
use signorini_contact::{ContactState, Friction, Settings, Simulation};
use signorini_fem_mesh::{Decomposition, LoadDensity, TetMesh, assemble_load, brick};

/// Forces that the displacement of a level exerts on the nodes: K u, summed over the copies.
fn internal_forces(simulation: &Simulation, torn: &[f64]) -> Vec<[f64; 3]> {
    let mut sum = vec![[0.0; 3]; simulation.scene().mesh().points().len()];
    let mut force = vec![0.0; torn.len()];
    simulation.tfeti().stiffness_times(torn, &mut force);
    let subdomains = simulation.decomposition().subdomains();
    let nodes = subdomains.iter().flat_map(|s| &s.nodes);
    for (&node, f) in nodes.zip(force.chunks_exact(3)) {
        (0..3).for_each(|c| sum[node as usize][c] += f[c]);
    }
    sum
}

/// Nodal loads of the benchmark at time t.
fn loads(mesh: &TetMesh, t: f64) -> Vec<[f64; 3]> {
    let whole = Decomposition::whole(mesh);
    let mut sum = vec![[0.0; 3]; mesh.points().len()];
    for (tag, traction, factor) in [
        (brick::Z_MAX, [0.0, 0.0, -30e8], ramp().value(t)),
        (brick::X_MAX, [9e8, 0.0, -15e8], up_down_up().value(t)),
    ] {
        let local = assemble_load(mesh, &whole, &LoadDensity::traction(tag, traction));
        for (node, f) in local.expect("load")[0].chunks_exact(3).enumerate() {
            (0..3).for_each(|c| sum[node][c] += factor * f[c]);
        }
    }
    sum
}

/// Sum and moment about the origin.
fn resultants(points: &[[f64; 3]], forces: &[[f64; 3]]) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for (x, f) in points.iter().zip(forces) {
        let m = cross(*x, *f);
        for c in 0..3 {
            sum[c] += f[c];
            sum[3 + c] += m[c];
        }
    }
    sum
}

/// What K u leaves over is load, contact force or reaction of a support, node by node; and loads, contact forces and
/// reactions have neither resultant nor moment.
#[test]
fn forces_and_moments_are_in_balance() {
    for method in methods() {
        let scene = benchmark(up_down_up(), 10);
        let mesh = scene.mesh().clone();
        let fixed = mesh.nodes_on(brick::X_MIN);
        let (simulation, levels) = run(scene, Settings::default().with_method(method));
        for (k, level) in levels.iter().enumerate() {
            let load = loads(&mesh, level.time);
            let mut contact = vec![[0.0; 3]; mesh.points().len()];
            for p in &level.points {
                // outward normal (0, 0, -1)
                let f = p.friction_force;
                contact[p.node as usize] = [f[0], f[1], f[2] - p.normal_force];
            }
            let mut reaction = vec![[0.0; 3]; mesh.points().len()];
            let size = norm(&level.load);
            for (node, f) in internal_forces(&simulation, &level.torn).iter().enumerate() {
                let rest = [0, 1, 2].map(|c| f[c] - load[node][c] - contact[node][c]);
                if fixed.contains(&(node as u32)) {
                    reaction[node] = rest;
                } else {
                    assert!(
                        norm(&rest) <= 1e-6 * size,
                        "level {k}, node {node}: {rest:?}"
                    );
                }
            }
            let points = mesh.points();
            let [l, c, r] = [&load, &contact, &reaction].map(|f| resultants(points, f));
            let sum: Vec<f64> = (0..6).map(|i| l[i] + c[i] + r[i]).collect();
            // the longest arm is that of the opposite corner
            let good = norm(&sum[..3]) <= 1e-6 * size && norm(&sum[3..]) <= 3.3e-6 * size;
            assert!(good, "level {k}: {sum:?} of {size:e}");
            // the sums that the library reports are these
            for i in 0..3 {
                assert!((c[i] - level.summary.resultant[i]).abs() <= 1e-12 * size);
                assert!((l[i] - level.load[i]).abs() <= 1e-12 * size);
            }
        }
    }
}

/// Friction takes energy in every step, whatever the law and the formula.
#[test]
fn no_step_has_negative_dissipation() {
    let laws = [
        Friction::tresca(3e8),
        Friction::coulomb(0.05),
        Friction::coulomb(0.6),
        weakening(),
    ];
    for law in laws {
        for formula in [
            signorini_contact::DifferenceFormula::PAPER,
            signorini_contact::DifferenceFormula::BACKWARD_EULER,
        ] {
            let scene = small_benchmark(law.clone(), 20);
            let analysis = scene.analysis().clone().with_formula(formula);
            let (_, levels) = run(
                scene.with_analysis(analysis),
                Settings::default().with_tolerance(1e-8),
            );
            let total: f64 = levels.iter().map(|l| l.summary.dissipation).sum();
            assert!(total > 0.0, "{law:?}: nothing slides");
            for (k, level) in levels.iter().enumerate() {
                let s = &level.summary;
                assert!(
                    s.dissipation >= -1e-6 * total,
                    "{law:?}, level {k}: {:e}",
                    s.dissipation
                );
                for p in &level.points {
                    let work: f64 = (0..3).map(|c| p.friction_force[c] * p.difference[c]).sum();
                    assert!(work <= 1e-6 * total, "{law:?}, level {k}, node {}", p.node);
                    if p.state == ContactState::Open {
                        assert!(
                            matches!(law, Friction::Tresca(_)) || norm(&p.friction_force) == 0.0
                        );
                    }
                }
                if formula.is_one_step() {
                    assert!((s.dissipation - s.friction_work).abs() <= 1e-9 * total);
                }
            }
        }
    }
}
