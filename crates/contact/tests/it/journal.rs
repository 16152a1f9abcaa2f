//! Journals and press fits on uneven linear facets.

use crate::common::*;
use crate::curved_sides::closed;
use signorini_fem_mesh::vec3::add;
use std::f64::consts::TAU;

/// A unit cube of cells that are cut alike into six tetrahedra, so that all its diagonals run one way.
fn cut_alike(cells: [usize; 3]) -> TetMesh {
    let points = block([1.0; 3], cells).points().to_vec();
    let node = |at: [usize; 3]| {
        let place = [0, 1, 2].map(|c| at[c] as f64 / cells[c] as f64);
        let near = |x: &[f64; 3]| (0..3).all(|c| (x[c] - place[c]).abs() < 1e-9);
        points.iter().position(near).expect("a node") as u32
    };
    let (mut tets, mut facets) = (Vec::new(), Vec::new());
    for cell in
        (0..cells.iter().product()).map(|k: usize| [k % cells[0], k / cells[0] % cells[1], k / cells[0] / cells[1]])
    {
        for axes in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]] {
            let mut at = cell;
            let mut tet = vec![node(at)];
            for axis in axes {
                at[axis] += 1;
                tet.push(node(at));
            }
            let odd = [[1, 0, 2], [0, 2, 1], [2, 1, 0]].contains(&axes);
            let corners = if odd { [0, 2, 1, 3] } else { [0, 1, 2, 3] };
            tets.push(corners.map(|k| tet[k]));
        }
    }
    for tet in &tets {
        for face in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
            let nodes = face.map(|k| tet[k]);
            for (axis, end, tag) in [
                (0, 0.0, brick::X_MIN),
                (0, 1.0, brick::X_MAX),
                (1, 0.0, brick::Y_MIN),
                (1, 1.0, brick::Y_MAX),
                (2, 0.0, brick::Z_MIN),
                (2, 1.0, brick::Z_MAX),
            ] {
                if nodes.iter().all(|&n| (points[n as usize][axis] - end).abs() < 1e-9) {
                    facets.push(Facet { nodes, tag });
                }
            }
        }
    }
    TetMesh::new(points, tets, facets).expect("cube")
}

/// A shaft that lies in its sleeve and turns is held by the torque of friction on a cylinder. Normals of nodes that were
/// means by areas tilted at the rims, and the torque was up to 8 % too large.
#[test]
fn a_turning_shaft_is_held_by_the_torque_of_friction() {
    let coefficient = 0.1;
    for (cells, swap) in [([24, 24], false), ([36, 48], false), ([48, 36], true)] {
        for turn in [1.0, -1.0] {
            let mesh = with_second(
                &closed(cut_alike([1, cells[0], 2]), [4.0, 10.0], 0.0, 1),
                &closed(cut_alike([1, cells[1], 3]), [10.0, 14.0], 0.1, 1),
            );
            let held = mesh.nodes_on(brick::X_MIN);
            let turned = |n: &u32| {
                add(
                    cross([0.0, 0.0, 2e-2 * turn], mesh.points()[*n as usize]),
                    [0.0, -0.06, 0.0],
                )
            };
            let motions = held.iter().map(turned).collect();
            let (inner, outer) = (brick::X_MAX, second(brick::X_MIN));
            let [first, other] = if swap { [outer, inner] } else { [inner, outer] };
            let fit = Contact::between(first, other).with_gap(0.02);
            let scene = Scene::new(mesh, uniform(1e3, 0.3))
                .with_support(Support::fixed(second(brick::X_MAX)))
                .with_support(Support::fixed(held).with_motions(motions, History::constant(1.0)))
                .with_contact(fit.with_friction(Friction::coulomb(coefficient)));
            let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
            let result = simulation.step().expect("step");
            let torque = result.reactions().contacts[0].moment[2].abs();
            let pressed: f64 = result.points().iter().map(|p| p.normal_force.abs()).sum();
            let ratio = torque / (10.0 * coefficient * pressed);
            assert!((ratio - 1.0).abs() < 2e-4, "{cells:?}, {turn}: {ratio}");
        }
    }
}

/// A ring whose nodes are moved along its curved sides by up to so much of a cell, at random.
fn uneven(radii: [f64; 2], cells: [usize; 3], phase: f64, amount: f64) -> TetMesh {
    let moved = |[x, y, z]: [f64; 3]| {
        let (radius, angle) = (x.hypot(y), y.atan2(x));
        let random = |k: f64| (((angle * 917.3 + z * 331.7 + k) * 12.9898).sin() * 43758.5453) % 1.0;
        let turned = angle + amount * random(0.0) * TAU / cells[1] as f64;
        let at_rim = !(1e-9..8.0 - 1e-9).contains(&z);
        let lifted = if at_rim { z } else { z + amount * random(3.0) * 8.0 / cells[2] as f64 };
        [radius * turned.cos(), radius * turned.sin(), lifted]
    };
    closed(cut_alike(cells), radii, phase, 1)
        .map_points(moved)
        .expect("ring")
}

/// Uneven facets know the curve between them: an interference of a seventeenth of their distance from it presses everywhere,
/// where points had pressed between not at all and 4.5 times the mean.
#[test]
fn uneven_facets_of_a_press_fit_press_everywhere() {
    let mesh = with_second(
        &uneven([4.0, 10.005], [2, 24, 2], 0.0, 0.3),
        &uneven([10.0, 14.0], [2, 36, 3], 0.1, 0.3),
    );
    let fit = Contact::between(brick::X_MAX, second(brick::X_MIN)).with_measured_overlaps();
    let scene = Scene::new(mesh, uniform(1e3, 0.3))
        .with_support(Support::fixed(second(brick::X_MAX)))
        .with_support(Support::components(brick::Z_MIN, [false, false, true]))
        .with_contact(fit.with_friction(Friction::coulomb(0.2)));
    let result = solve(scene, Settings::default());
    let pressures: Vec<f64> = result.points.iter().map(|p| -p.normal_force / p.area).collect();
    let mean = pressures.iter().sum::<f64>() / pressures.len() as f64;
    let (least, most) = (
        pressures.iter().copied().fold(f64::MAX, f64::min),
        pressures.iter().copied().fold(0.0, f64::max),
    );
    assert!(
        least > 0.5 * mean && most < 1.5 * mean,
        "{least} to {most} about {mean}"
    );
}
