//! Contact pressure and friction stress as fields: constants, forces, the noise of unequal triangles, creases.

use crate::common::*;

/// A block with nodes moved within the planes of its sides, so that the triangles below are unequal.
fn uneven(lengths: [f64; 3], cells: [usize; 3]) -> TetMesh {
    Brick::new(lengths, cells).perturbed(0.15, 7).build().expect("brick")
}

fn last(scene: Scene) -> std::sync::Arc<StepResult> {
    let mut simulation = Simulation::new(scene, tight()).expect("set-up");
    let result = simulation.step().expect("step");
    assert!(result.certificate().largest() < 1e-6);
    result
}

/// Pressure times area, summed.
fn force(result: &StepResult, surface: usize) -> f64 {
    let pressure = result.contact_pressure(surface).expect("a surface");
    let areas = result.surfaces()[surface].areas();
    pressure.iter().zip(areas).map(|(p, a)| p * a).sum()
}

/// A state of constant stress is exact on any mesh of linear tetrahedra, and so is its pressure.
#[test]
fn a_constant_pressure_stays() {
    let scene = Scene::new(uneven([1.0, 2.0, 1.0], [4, 8, 4]), uniform(2e11, 0.3))
        .with_support(Support::components(brick::X_MIN, [true, false, false]))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_load(Load::pressure(brick::Z_MAX, 5e6))
        .with_contact(Contact::rigid(brick::Z_MIN));
    let result = last(scene);
    for pressure in result.contact_pressure(0).expect("the floor") {
        assert!((pressure - 5e6).abs() < 1e-6 * 5e6, "{pressure}");
    }
    assert!((force(&result, 0) - 1e7).abs() < 1e-6 * 1e7);
    assert!(
        result
            .friction_stress(0)
            .expect("the floor")
            .iter()
            .all(|f| *f == [0.0; 3])
    );
}

/// Averages keep the sums, and friction follows the pressure where everything slides.
#[test]
fn forces_stay_and_friction_follows() {
    let ramp = ramp();
    let scene = Scene::new(uneven([1.0; 3], [5; 3]), uniform(2e11, 0.3))
        .with_support(Support::components(brick::Z_MAX, [true, true, true]).with_motion([1e-3, 0.0, -1e-4], ramp))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.1)))
        .with_analysis(Analysis::quasistatic(1.0, 1).with_formula(DifferenceFormula::BACKWARD_EULER));
    let result = last(scene);
    let sum = result.summary();
    assert!(sum.slip == 36 && sum.stick == 0, "{sum:?}");
    assert!((force(&result, 0) - sum.normal_force).abs() < 1e-12 * sum.normal_force);
    let friction = result.friction_stress(0).expect("the floor");
    let areas = result.surfaces()[0].areas();
    for c in 0..3 {
        let total: f64 = friction.iter().zip(areas).map(|(f, a)| f[c] * a).sum();
        assert!((total - sum.friction_force[c]).abs() < 1e-12 * sum.friction_norm);
    }
    let pressure = result.contact_pressure(0).expect("the floor");
    for (f, p) in friction.iter().zip(&pressure) {
        // directions differ from node to node, so that means are shorter, but never longer
        let length = (f[0] * f[0] + f[1] * f[1]).sqrt();
        assert!(length <= 0.1 * p * (1.0 + 1e-6) && length > 0.09 * p, "{length} {p}");
    }
}

/// A paraboloid pressed into a block: within 0.8 of the radius `p²` is linear in `r²` (Hertz).
#[test]
fn the_noise_of_unequal_triangles_goes() {
    let mesh = uneven([2.0, 2.0, 1.0], [20, 20, 6]);
    let middle = |p: [f64; 3]| ((p[0] - 1.0).powi(2) + (p[1] - 1.0).powi(2)).sqrt();
    let scene = Scene::new(mesh, uniform(1.0, 0.3))
        .with_support(Support::fixed(brick::Z_MAX).with_motion([0.0, 0.0, -0.1], ramp()))
        .with_contact(Contact::rigid(brick::Z_MIN).with_gap_field(move |p| 0.2 * middle(p).powi(2)));
    let result = last(scene);
    let surface = &result.surfaces()[0];
    let points = result.points_at_nodes(0).expect("the surface");
    let rough: Vec<f64> = points
        .iter()
        .map(|p| p.map_or(0.0, |p| -p.normal_force / p.area))
        .collect();
    let smooth = result.contact_pressure(0).expect("the surface");
    assert!((force(&result, 0) - result.summary().normal_force).abs() < 1e-12 * result.summary().normal_force);
    let radius: Vec<f64> = surface
        .nodes()
        .iter()
        .map(|&n| middle(result.scene().mesh().points()[n as usize]))
        .collect();
    let touched: f64 = rough
        .iter()
        .zip(surface.areas())
        .filter(|(p, _)| **p > 0.0)
        .map(|(_, a)| a)
        .sum();
    let inside: Vec<usize> = (0..radius.len())
        .filter(|k| radius[*k] < 0.8 * (touched / std::f64::consts::PI).sqrt())
        .collect();
    assert!(inside.len() > 60, "{}", inside.len());
    let noise = |p: &[f64]| {
        // least squares for p² = a + b r²
        let n = inside.len() as f64;
        let sum = |f: &dyn Fn(usize) -> f64| inside.iter().map(|&k| f(k)).sum::<f64>() / n;
        let (x, y) = (|k: usize| radius[k].powi(2), |k: usize| p[k].powi(2));
        let (mx, my) = (sum(&x), sum(&y));
        let b = sum(&|k| (x(k) - mx) * (y(k) - my)) / sum(&|k| (x(k) - mx).powi(2));
        let fit = |k: usize| (my + b * (x(k) - mx)).max(0.0).sqrt();
        sum(&|k| (p[k] - fit(k)).powi(2)).sqrt() / (my - b * mx).sqrt()
    };
    let (before, after) = (noise(&rough), noise(&smooth));
    // 0.105 and 0.014
    assert!(before > 0.03 && after < 0.2 * before, "{before} {after}");
}

/// Nothing is averaged around an edge: a block that stands on a floor does not press on the wall beside it.
#[test]
fn pressure_stays_on_its_side_of_a_crease() {
    let scene = Scene::new(uneven([1.0; 3], [4; 3]), uniform(2e11, 0.0))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_support(Support::components(brick::X_MIN, [true, false, false]))
        .with_load(Load::pressure(brick::Z_MAX, 5e6))
        .with_contact(Contact::rigid(brick::Z_MIN).with_tag(brick::X_MAX));
    let result = last(scene);
    let surface = &result.surfaces()[0];
    let pressure = result.contact_pressure(0).expect("the surface");
    for (&node, p) in surface.nodes().iter().zip(&pressure) {
        let floor = result.scene().mesh().points()[node as usize][2] == 0.0;
        let expected = if floor { 5e6 } else { 0.0 };
        assert!((p - expected).abs() < 1e-5 * 5e6, "node {node}: {p}");
    }
}
