//! Loads of the volume.

use signorini_contact::Scene;
use signorini_fem_mesh::{Brick, Decomposition, LoadDensity, TetMesh, assemble_load};

use crate::write::{STEEL, mesh, read};

const SPIN: &str = "CENTRIF, 4.E6, 0.25, -0.5, 9., 0., 0., -2.";

fn bar(order: usize) -> TetMesh {
    let bar = Brick::new([3.0, 1.0, 0.5], [6, 2, 1]).build().expect("a bar");
    match order {
        2 => bar.raise_order().expect("quadratic"),
        _ => bar,
    }
}

fn scene(bar: &TetMesh, sets: &str, loads: &str) -> Scene {
    let step = format!("*BOUNDARY\nN1, 1, 3\n*STEP\n*STATIC\n*DLOAD\n{loads}*END STEP\n");
    let deck = format!("{}{STEEL}{sets}{step}", mesh(bar));
    read(&deck).expect("deck").scene().expect("scene")
}

/// On a part of the elements the forces at nodes are those of the field that the whole mesh has, element by element.
#[test]
fn centrifugal_forces_of_parts_add_up_to_those_of_the_whole() {
    for order in [1, 2] {
        let bar = bar(order);
        let whole = scene(&bar, "", &format!("ALL, {SPIN}\n"));
        let half = bar.tets().len() / 2;
        let sets = format!(
            "*ELSET, ELSET=A, GENERATE\n1, {half}\n*ELSET, ELSET=B, GENERATE\n{}, {}\n",
            half + 1,
            bar.tets().len()
        );
        let parts = scene(&bar, &sets, &format!("A, {SPIN}\nB, {SPIN}\n"));
        let forces = |scene: &Scene| {
            let mut sum = vec![0.0; 3 * bar.points().len()];
            for load in scene.loads() {
                match load.density() {
                    Some(LoadDensity::NodalForces(forces)) => {
                        for (node, force) in forces {
                            (0..3).for_each(|c| sum[3 * *node as usize + c] += force[c]);
                        }
                    }
                    Some(density @ LoadDensity::BodyField(_)) => {
                        let one = Decomposition::boxes(&bar, [1, 1, 1]).expect("one subdomain");
                        let vectors = assemble_load(&bar, &one, density).expect("load");
                        sum.iter_mut().zip(&vectors[0]).for_each(|(s, v)| *s += v);
                    }
                    other => panic!("{other:?}"),
                }
            }
            sum
        };
        let (whole, parts) = (forces(&whole), forces(&parts));
        let scale = whole.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        assert!(whole.iter().zip(&parts).all(|(a, b)| (a - b).abs() < 1e-12 * scale));
        // density, square of the angular velocity, volume, and the distance of the centre from the axis
        let along: f64 = parts.iter().step_by(3).sum();
        let exact = 7.8e-9 * 4e6 * 1.5 * (1.5 - 0.25);
        assert!((along - exact).abs() < 1e-12 * exact, "{along} {exact}");
    }
}

/// The same line as the axis in another step, by another point and the other way round, is the same load.
#[test]
fn an_axis_is_a_line() {
    let bar = bar(1);
    let next = |spin: &str| {
        let more = format!("ALL, {SPIN}\n*END STEP\n*STEP\n*STATIC\n*DLOAD\nALL, {spin}\n");
        scene(&bar, "", &more).loads().to_vec()
    };
    let loads = next("CENTRIF, 1.E6, 0.25, -0.5, -3., 0., 0., 1.");
    assert_eq!(loads.len(), 1);
    let [one, two] = [1.0, 2.0].map(|t| loads[0].history().value(t));
    assert!((two / one - 0.25).abs() < 1e-15, "{one} {two}");
}
