//! Two faces of one body: cracks, whose tips are nodes of both.

use crate::common::*;
use signorini_fem_mesh::vec3;
use std::collections::HashMap;

const LOW: FacetTag = FacetTag(50);
const UP: FacetTag = FacetTag(51);
const TIP: f64 = 0.6;

/// A block of 1.6 m x 0.9 m x 0.9 m, cut open at half its height beyond the tip, by so much a metre.
fn cracked(order: usize, opening: f64) -> TetMesh {
    let whole = block([1.6, 0.9, 0.9], [4, 1, 2]);
    let (mut points, mut facets) = (whole.points().to_vec(), whole.facets().to_vec());
    let in_plane = |node: u32| (whole.points()[node as usize][2] - 0.45).abs() < 1e-9;
    let mut twins = HashMap::new();
    for (node, &[x, y, z]) in (0..).zip(whole.points()) {
        if in_plane(node) && x > TIP {
            twins.insert(node, points.len() as u32);
            points.push([x, y, z + opening * (x - TIP)]);
        }
    }
    let twin = |node: u32| twins.get(&node).copied().unwrap_or(node);
    let mut tets = whole.tets().to_vec();
    for (k, tet) in tets.iter_mut().enumerate() {
        let above = vec3::centroid(&whole.tet_points(k))[2] > 0.45;
        for skip in 0..4 {
            let [a, b, c] = [1, 2, 3].map(|k| tet[(skip + k) % 4]);
            if [a, b, c].iter().all(|n| in_plane(*n)) && [a, b, c].iter().any(|n| twins.contains_key(n)) {
                let (nodes, tag) = if above {
                    ([a, b, c].map(twin), UP)
                } else {
                    ([a, b, c], LOW)
                };
                facets.push(Facet { nodes, tag });
            }
        }
        if above {
            *tet = tet.map(twin);
        }
    }
    for facet in &mut facets[..whole.facets().len()] {
        if facet.nodes.iter().map(|n| whole.points()[*n as usize][2]).sum::<f64>() > 1.35 {
            facet.nodes = facet.nodes.map(twin);
        }
    }
    let mesh = TetMesh::new(points, tets, facets).expect("cracked");
    if order == 2 {
        mesh.raise_order().expect("order 2")
    } else {
        mesh
    }
}

/// Uniform pressure passes, at the tip as elsewhere, whatever side has the points.
#[test]
fn pressure_passes_through_a_closed_crack() {
    let (young, pressure) = (1e9, 1e6);
    for order in [1, 2] {
        for [tag, partner] in [[LOW, UP], [UP, LOW]] {
            let scene = Scene::new(cracked(order, 1e-7), uniform(young, 0.0))
                .with_support(Support::components(brick::Z_MIN, [false, false, true]))
                .with_support(Support::components(brick::X_MIN, [true, false, false]))
                .with_support(Support::components(brick::Y_MIN, [false, true, false]))
                .with_load(Load::pressure(brick::Z_MAX, pressure))
                .with_contact(
                    Contact::between(tag, partner)
                        .with_gap(0.0)
                        .with_friction(Friction::coulomb(0.3)),
                );
            let result = solve(scene, at(1e-10));
            assert_certified(&result, "crack");
            assert_pressure(&result.points, pressure, 1e-5, &format!("order {order}"));
        }
    }
}

/// A curved crack whose tip had a condition made of what the opening leaves: it held the faces apart, by more than the
/// body moves.
#[test]
fn faces_of_a_curved_crack_change_places() {
    for (order, opening) in [(1, 1e-4), (1, 1e-3), (2, 1e-3)] {
        let mesh = cracked(order, opening).map_points(|[x, y, z]| {
            let [x, y] = [x - 0.8, y - 0.45];
            [x, y, z - 0.05 * (x * x - 0.7 * x * y - 0.5 * y * y)]
        });
        let mesh = mesh.expect("curved");
        let [one, other] = [[LOW, UP], [UP, LOW]].map(|[tag, partner]| {
            let scene = Scene::new(mesh.clone(), uniform(1e9, 0.15))
                .with_support(Support::fixed(brick::Z_MIN))
                .with_load(Load::traction(brick::Z_MAX, [-1.6e5, -2.1e5, -1.6e5]))
                .with_contact(Contact::between(tag, partner).with_friction(Friction::coulomb(0.1)));
            let mut simulation = Simulation::new(scene, tight()).expect("model");
            let result = simulation.step().expect("solved");
            assert!(result.report().status.converged() && result.summary().active > 0);
            result.displacement()
        });
        let apart = one.iter().zip(&other).map(|(a, b)| vec3::norm(vec3::sub(*a, *b)));
        let (apart, size) = (
            apart.fold(0.0, f64::max),
            one.iter().map(|u| vec3::norm(*u)).fold(0.0, f64::max),
        );
        println!("order {order}, opening {opening}: {apart:.1e} of {size:.1e}");
        // the faces are turned against each other by the opening
        assert!(
            apart < 3.0 * opening * size,
            "order {order}, opening {opening}: {apart:.1e} of {size:.1e}"
        );
    }
}
