//! Contact of quadratic tetrahedra.

use crate::common::*;

/// The brick at half load on a floor with coefficient 0.2, one static step, on `k` cells a metre.
fn half_loaded(mesh: TetMesh) -> Scene {
    let half = History::constant(0.5);
    let q = 1e8;
    Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30.0 * q]).with_history(half.clone()))
        .with_load(Load::traction(brick::X_MAX, [9.0 * q, 0.0, -15.0 * q]).with_history(half))
        .with_contact(foundation(Friction::coulomb(0.2)))
}

/// Normal and friction force of the floor on the brick, N.
fn floor_forces(result: &Solved) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for point in &result.points {
        let force = point.force();
        sum[0] += force[2];
        sum[1] += force[0];
    }
    sum
}

#[test]
fn trial() {
    let k: usize = std::env::var("K").unwrap().parse().unwrap();
    let b: usize = std::env::var("B").unwrap().parse().unwrap();
    let order: usize = std::env::var("ORDER").unwrap().parse().unwrap();
    let mut mesh = block([3.0, 1.0, 1.0], [3 * k, k, k]);
    let parts = Decomposition::boxes(&mesh, [3 * b, b, b]).unwrap().parts().to_vec();
    let g: f64 = std::env::var("G").map_or(1.0, |g| g.parse().unwrap());
    if g != 1.0 {
        let f = |s: f64| {
            if s < 0.5 {
                0.5 * (2.0 * s).powf(g)
            } else {
                1.0 - 0.5 * (2.0 * (1.0 - s)).powf(g)
            }
        };
        mesh = mesh.map_points(|[x, y, z]| [3.0 * f(x / 3.0), f(y), f(z)]).unwrap();
    }
    if order == 2 {
        mesh = mesh.raise_order().unwrap();
    }
    let scene = half_loaded(mesh).with_parts(parts);
    let mut simulation = Simulation::new(scene, tight()).expect("set-up");
    let start = std::time::Instant::now();
    let result = step(&mut simulation);
    let [n, t] = floor_forces(&result);
    println!(
        "nodes {} products {} normal {:.4e} {:+.3} % friction {:.4e} {:+.2} % {:?}",
        result.displacement.len() / 3,
        result.report.counters.products,
        n,
        100.0 * (n / 2.6228e9 - 1.0),
        t,
        100.0 * (t / -8.38e7 - 1.0),
        start.elapsed()
    );
    println!(
        "{:?} {:?}",
        result.report.status,
        result.certificate.parts().map(|(n, v)| (n, v.relative()))
    );
}

#[test]
fn trial_linear() {
    let k: usize = std::env::var("K").unwrap().parse().unwrap();
    let b: usize = std::env::var("B").unwrap().parse().unwrap();
    let order: usize = std::env::var("ORDER").unwrap().parse().unwrap();
    let mut mesh = block([3.0, 1.0, 1.0], [3 * k, k, k]);
    let parts = Decomposition::boxes(&mesh, [3 * b, b, b]).unwrap().parts().to_vec();
    let g: f64 = std::env::var("G").map_or(1.0, |g| g.parse().unwrap());
    if g != 1.0 {
        let f = |s: f64| {
            if s < 0.5 {
                0.5 * (2.0 * s).powf(g)
            } else {
                1.0 - 0.5 * (2.0 * (1.0 - s)).powf(g)
            }
        };
        mesh = mesh.map_points(|[x, y, z]| [3.0 * f(x / 3.0), f(y), f(z)]).unwrap();
    }
    if order == 2 {
        mesh = mesh.raise_order().unwrap();
    }
    let q = 1e8;
    let scene = Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30.0 * q]))
        .with_load(Load::traction(brick::X_MAX, [9.0 * q, 0.0, -15.0 * q]))
        .with_parts(parts);
    for scene in [scene.clone(), scene.with_contact(foundation(Friction::None))] {
        let mut simulation = Simulation::new(scene, tight()).expect("set-up");
        let result = step(&mut simulation);
        println!(
            "products {} {:?}",
            result.report.counters.products, result.report.counters
        );
    }
}
