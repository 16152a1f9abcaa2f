//! Obstacles of any shape, at rest, displaced and turned.

use crate::common::*;

/// A block [-w, w] x [-w, w] x [-h, 0] whose cells become smaller towards the middle of its top.
fn graded(half: f64, height: f64, cells: usize) -> TetMesh {
    let finer = |x: f64| x.signum() * half * (x.abs() / half).powf(2.2);
    block([2.0 * half, 2.0 * half, height], [2 * cells, 2 * cells, cells])
        .map_points(|[x, y, z]| {
            let down = height - z;
            [finer(x - half), finer(y - half), -height * (down / height).powf(2.2)]
        })
        .expect("graded")
}

fn ball(radius: f64, approach: f64) -> Obstacle {
    Obstacle::sphere([0.0, 0.0, radius - approach], radius)
}

/// A rigid ball on a half-space: R 100, E 1000, nu 0.3, approach 0.01; by Hertz the force is 14.6520 and the radius of
/// the contact 1. The block is held at its far sides where the half-space has moved by the point force (Boussinesq).
fn hertz(cells: usize) -> (f64, f64) {
    let (young, poisson, radius, approach) = (1000.0, 0.3, 100.0, 0.01);
    let exact = 14.6520;
    let mesh = graded(8.0, 8.0, cells);
    let far = |x: [f64; 3]| x[2] < -7.99 || x[0].abs() > 7.99 || x[1].abs() > 7.99;
    let shear = young / (2.0 * (1.0 + poisson));
    let nodes: Vec<u32> = (0..mesh.points().len() as u32)
        .filter(|&n| far(mesh.points()[n as usize]))
        .collect();
    let values = nodes.iter().map(|&n| {
        let [x, y, z] = mesh.points()[n as usize];
        let (rho, depth) = (norm(&[x, y, z]), -z);
        let factor = exact / (4.0 * std::f64::consts::PI * shear);
        let out = depth / rho.powi(3) - (1.0 - 2.0 * poisson) / (rho * (rho + depth));
        let down = 2.0 * (1.0 - poisson) / rho + depth * depth / rho.powi(3);
        [factor * x * out, factor * y * out, -factor * down]
    });
    let values: Vec<[f64; 3]> = values.collect();
    let top = brick::Z_MAX;
    let scene = Scene::new(mesh, uniform(young, poisson))
        .with_contact(Contact::obstacle(top, ball(radius, approach)))
        .with_support(Support::fixed(nodes).with_displacements(values, History::constant(1.0)));
    let result = solve(scene, at(1e-8));
    let touching = result.points.iter().filter(|p| p.state != ContactState::Open);
    let area: f64 = touching.map(|p| p.area).sum();
    (
        result.summary.normal_force / exact - 1.0,
        (area / std::f64::consts::PI).sqrt(),
    )
}

#[test]
fn a_rigid_ball_presses_as_hertz_says() {
    let [coarse, fine] = [8, 14].map(hertz);
    println!("{coarse:?} {fine:?}");
}
