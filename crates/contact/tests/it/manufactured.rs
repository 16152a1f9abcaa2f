//! A manufactured elasticity solution: orders of convergence through the whole library, without contact.

use crate::common::*;
use signorini_fem_mesh::fields::integrate;
use std::f64::consts::PI;

const YOUNG: f64 = 1.0;
const POISSON: f64 = 0.3;

/// u = (sin pi x cos y, x y z, cos(pi y) exp(z) / 4).
fn exact([x, y, z]: [f64; 3]) -> [f64; 3] {
    [(PI * x).sin() * y.cos(), x * y * z, (PI * y).cos() * z.exp() / 4.0]
}

fn gradient([x, y, z]: [f64; 3]) -> [[f64; 3]; 3] {
    [
        [PI * (PI * x).cos() * y.cos(), -(PI * x).sin() * y.sin(), 0.0],
        [y * z, x * z, x * y],
        [
            0.0,
            -PI * (PI * y).sin() * z.exp() / 4.0,
            (PI * y).cos() * z.exp() / 4.0,
        ],
    ]
}

/// -div sigma = -(lambda + mu) grad div u - mu lap u.
fn force([x, y, z]: [f64; 3]) -> [f64; 3] {
    let lambda = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    let mu = YOUNG / (2.0 * (1.0 + POISSON));
    let (sx, cx) = (PI * x).sin_cos();
    let (sy, cy) = (PI * y).sin_cos();
    // div u = pi cos(pi x) cos y + x z + cos(pi y) e^z / 4
    let grad_div = [
        -PI * PI * sx * y.cos() + z,
        -PI * cx * y.sin() - PI * sy * z.exp() / 4.0,
        x + cy * z.exp() / 4.0,
    ];
    let laplace = [
        -(PI * PI + 1.0) * sx * y.cos(),
        0.0,
        (1.0 - PI * PI) * cy * z.exp() / 4.0,
    ];
    [0, 1, 2].map(|i| -(lambda + mu) * grad_div[i] - mu * laplace[i])
}

/// The derivatives above are typed by hand: differences of `exact` and `gradient` must agree with them.
#[test]
fn the_manufactured_fields_belong_together() {
    let h = 1e-5;
    let lambda = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    let mu = YOUNG / (2.0 * (1.0 + POISSON));
    let stress = |x| {
        let g = gradient(x);
        let trace = g[0][0] + g[1][1] + g[2][2];
        let mut s = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                s[i][j] = mu * (g[i][j] + g[j][i]);
            }
            s[i][i] += lambda * trace;
        }
        s
    };
    for x in [[0.3, 0.2, 0.7], [0.9, 0.5, 0.1]] {
        let mut divergence = [0.0; 3];
        for j in 0..3 {
            let (mut a, mut b) = (x, x);
            a[j] += h;
            b[j] -= h;
            for i in 0..3 {
                let slope = (exact(a)[i] - exact(b)[i]) / (2.0 * h);
                assert!((slope - gradient(x)[i][j]).abs() < 1e-8);
                divergence[i] += (stress(a)[i][j] - stress(b)[i][j]) / (2.0 * h);
            }
        }
        for i in 0..3 {
            assert!((divergence[i] + force(x)[i]).abs() < 1e-8);
        }
    }
}

/// Nodes of the whole boundary with their exact displacements.
fn boundary(mesh: &TetMesh) -> (Vec<u32>, Vec<[f64; 3]>) {
    let mut nodes: Vec<u32> = brick::SIDES
        .iter()
        .flatten()
        .flat_map(|&tag| mesh.nodes_on(tag))
        .collect();
    nodes.sort_unstable();
    nodes.dedup();
    let values = nodes.iter().map(|&n| exact(mesh.points()[n as usize])).collect();
    (nodes, values)
}

/// H1 and L2 errors on a mesh.
fn errors(mesh: &TetMesh) -> (f64, f64) {
    let (nodes, values) = boundary(mesh);
    let scene = Scene::new(mesh.clone(), uniform(YOUNG, POISSON))
        .with_support(Support::fixed(Place::Nodes(nodes)).with_motions(values, History::constant(1.0)))
        .with_load(Load::new(LoadDensity::body_field(force)))
        .with_boxes([2, 2, 2]);
    let (_, results) = run(scene, tight());
    let u = &results[0].displacement;
    let square = |v: [f64; 3], e: [f64; 3]| v.iter().zip(e).map(|(v, e)| (v - e).powi(2)).sum::<f64>();
    let rows = |x, h: [[f64; 3]; 3]| h.into_iter().zip(gradient(x)).map(|(h, e)| square(h, e)).sum();
    let h1 = integrate(mesh, u, |x, _, h| rows(x, h)).expect("field");
    let l2 = integrate(mesh, u, |x, u, _| square(u, exact(x))).expect("field");
    (h1.sqrt(), l2.sqrt())
}

/// Orders from meshes with twice as many cells each.
fn assert_orders(errors: &[(f64, f64)], h1: std::ops::Range<f64>, l2: std::ops::Range<f64>) {
    for pair in errors.windows(2) {
        let orders = [pair[0].0 / pair[1].0, pair[0].1 / pair[1].1].map(f64::log2);
        println!("orders: H1 {:.3}, L2 {:.3}; {pair:?}", orders[0], orders[1]);
        assert!(h1.contains(&orders[0]), "H1 order {}", orders[0]);
        assert!(l2.contains(&orders[1]), "L2 order {}", orders[1]);
    }
}

#[test]
fn orders_of_convergence() {
    let errors: Vec<_> = [4, 8, 16].map(|cells| errors(&block([1.0; 3], [cells; 3]))).into();
    assert_orders(&errors, 0.9..1.15, 1.8..2.2);
}

#[test]
fn orders_of_quadratic_elements() {
    let mesh = |cells| block([1.0; 3], [cells; 3]).raise_order().expect("quadratic");
    assert_orders(&[2, 4, 8].map(|cells| errors(&mesh(cells))), 1.85..2.15, 2.8..3.3);
}

/// A sector of a hollow ball, its mid-nodes on spheres.
#[test]
fn orders_of_quadratic_elements_on_a_ball() {
    let ball = |[x, y, z]: [f64; 3]| {
        let (u, v) = (1.4 * (x - 0.5), 1.4 * (y - 0.5));
        let radius = 0.5 + 0.5 * z;
        let length = (1.0 + u * u + v * v).sqrt();
        [radius * u / length, radius * v / length, radius / length]
    };
    let mesh = |cells| {
        let straight = block([1.0; 3], [cells; 3]).raise_order().expect("quadratic");
        straight.map_points(ball).expect("ball")
    };
    assert_orders(&[4, 8].map(|cells| errors(&mesh(cells))), 1.85..2.2, 2.8..3.3);
}

/// All edges curved: bent by a smooth map.
#[test]
fn orders_of_curved_quadratic_elements() {
    let bend = |[x, y, z]: [f64; 3]| {
        [
            x + 0.15 * (2.0 * y).sin() * z,
            y + 0.1 * z * z,
            z + 0.1 * (3.0 * x).cos(),
        ]
    };
    let mesh = |cells| {
        let straight = block([1.0; 3], [cells; 3]).raise_order().expect("quadratic");
        straight.map_points(bend).expect("bent")
    };
    assert_orders(&[2, 4, 8].map(|cells| errors(&mesh(cells))), 1.8..2.2, 2.7..3.3);
}
