//! Contacts that a scene names apart stay apart.

mod common;

use common::{block, uniform};
use signorini_contact::{
    Contact, Friction, Load, Method, Scene, Screening, Settings, Simulation, Support,
};
use signorini_fem_mesh::{FacetTag, brick};

fn leaning(degrees: f64, gaps: [f64; 2], friction: f64) -> Scene {
    let slope = degrees.to_radians();
    let lean = 1.0 / slope.tan();
    let mesh = block([1.0; 3], [4, 4, 4])
        .map_points(|[x, y, z]| [x * (1.0 + lean * z), y, z])
        .expect("mesh");
    let side = |tag, gap| {
        Contact::rigid(tag)
            .with_gap(gap)
            .with_friction(Friction::coulomb(friction))
    };
    Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::body([-1e7, 0.0, -4e7]))
        .with_contact(side(brick::Z_MIN, gaps[0]))
        .with_contact(side(brick::X_MAX, gaps[1]))
}

/// flat bottom with a kink of `angle` radians at x = 1
fn kinked(angle: f64, gaps: [f64; 2], friction: f64, along: f64) -> Scene {
    let mesh = block([2.0, 1.0, 1.0], [8, 4, 4]);
    let tag = FacetTag(77);
    let points = mesh.points().to_vec();
    let facets = mesh
        .facets()
        .iter()
        .map(|f| {
            let mut f = *f;
            let x = f.nodes.iter().map(|n| points[*n as usize][0]).sum::<f64>() / 3.0;
            if f.tag == brick::Z_MIN && x > 1.0 {
                f.tag = tag;
            }
            f
        })
        .collect();
    let mesh = signorini_fem_mesh::TetMesh::new(points, mesh.tets().to_vec(), facets)
        .expect("mesh")
        .map_points(|[x, y, z]| [x, y, z + (1.0 - z) * angle.tan() * (x - 1.0).max(0.0)])
        .expect("mesh");
    let side = |tag, gap| {
        Contact::rigid(tag)
            .with_gap(gap)
            .with_friction(Friction::coulomb(friction))
    };
    Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::Z_MAX).moved([along, 0.0, -1e-3], common::ramp()))
        .with_contact(side(brick::Z_MIN, gaps[0]))
        .with_contact(side(tag, gaps[1]))
}

#[test]
fn experiment() {
    for degrees in [50.0, 65.0] {
        let mut s =
            Simulation::new(leaning(degrees, [0.0, 2e-3], 0.0), Settings::default()).unwrap();
        let f = s.step().unwrap();
        println!(
            "{degrees} {:?} {:.1e} gap {:.1e} rows {}",
            f.report().status,
            f.certificate().largest(),
            f.certificate().gap.relative(),
            f.points().len()
        );
    }
    for k in 1..=14 {
        let angle = if k == 14 {
            0.0
        } else {
            10f64.powf(-0.5 * f64::from(k))
        };
        for mu in [0.0, 0.3] {
            for along in [2e-3, -2e-3] {
                for (name, settings) in [
                    ("def", Settings::default()),
                    ("1e-9", Settings::default().with_tolerance(1e-9)),
                    ("paper", Settings::default().with_method(Method::paper())),
                    ("one", Settings::default().with_method(Method::one_loop())),
                    ("scr", Settings::default().with_screening(Screening::on())),
                ] {
                    for boxes in [[1, 1, 1], [2, 1, 1], [4, 2, 2]] {
                        let scene = kinked(angle, [0.0, 0.0], mu, along).with_boxes(boxes);
                        let mut s = match Simulation::new(scene, settings.clone()) {
                            Ok(s) => s,
                            Err(e) => {
                                println!("{angle:.1e} {mu} {name} refused {e}");
                                continue;
                            }
                        };
                        let f = s.step().unwrap();
                        let n = f.points().len();
                        let total: f64 = f.points().iter().map(|p| -p.normal_force).sum();
                        println!(
                            "{angle:.1e} mu {mu} along {along:.0e} {name:5} {boxes:?} points {n} {:?} {:.1e} gap {:.1e} products {} fallback {} sum {total:.6e} {:.6e}",
                            f.report().status,
                            f.certificate().largest(),
                            f.certificate().gap.relative(),
                            f.report().counters.products,
                            f.report().fallback,
                            f.summary().friction_force[0]
                        );
                    }
                }
            }
        }
    }
}
