//! Estimates of the algebraic error where couplings hold parts of contact surfaces.

use crate::common::*;
use crate::couplings::{POINT, YOUNG, moved};

/// Two blocks on each other, meshed so finely along each edge, half of the top of the lower one in a coupling.
fn stacked(edges: [usize; 2], order: usize, contact: &dyn Fn(Contact) -> Contact) -> Scene {
    let lower = Brick::new([1.2, 1.2, 0.6], [edges[0], edges[0], 2])
        .build()
        .expect("brick");
    let upper = Brick::new([0.8, 0.8, 0.5], [edges[1], edges[1], 2])
        .build()
        .expect("brick");
    let upper = upper
        .map_points(|[x, y, z]| [x + 0.2, y + 0.2, z + 0.6])
        .expect("moved");
    let mut mesh = with_second(&lower, &upper);
    if order == 2 {
        mesh = mesh.raise_order().expect("order 2");
    }
    let half = |n: &u32| mesh.points()[*n as usize][0] > 0.55;
    let nodes: Vec<u32> = mesh.nodes_on(brick::Z_MAX).into_iter().filter(half).collect();
    let pressed = Support::fixed(second(brick::Z_MAX)).with_motion([1e-4, 0.0, -4e-4], moved());
    Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::Z_MIN))
        .with_contact(contact(Contact::between(brick::Z_MAX, second(brick::Z_MIN))))
        .with_coupling(Coupling::rigid(nodes, POINT))
        .with_support(pressed)
        .with_subdomains(4)
}

/// Points whose own node is in a coupling, and their number may be above that of the nodes of the other side: the
/// estimate is above the error, and not far.
#[test]
fn coupled_surfaces_have_sharp_estimates() {
    let laws: [&dyn Fn(Contact) -> Contact; 4] = [
        &|c| c,
        &|c| c.with_friction(Friction::coulomb(0.3)),
        &|c| c.with_friction(Friction::tresca(2e7)),
        &|_| Contact::tied(brick::Z_MAX, second(brick::Z_MIN)),
    ];
    for (order, edges) in [(1, [4, 3]), (1, [3, 5]), (1, [6, 3]), (2, [3, 2])] {
        // finer rigid sides have more rows than the others can meet one by one
        let count = if edges[0] > edges[1] { 3 } else { 4 };
        for (k, law) in laws.iter().enumerate().take(count) {
            let exact = solve(stacked(edges, order, law), at(1e-10));
            for tolerance in [1e-2, 1e-3, 1e-5] {
                let mut loose = Simulation::new(stacked(edges, order, law), at(tolerance)).expect("set-up");
                let rough = step(&mut loose);
                let error = loose.result().expect("a step").algebraic_error();
                let index =
                    error.energy.sqrt() / energy_distance(loose.scene(), &rough.displacement, &exact.displacement);
                println!("order {order}, {edges:?}, {k}, {tolerance:e}: {index:.2}");
                assert!(
                    (0.9..3.0).contains(&index),
                    "order {order}, {edges:?}, {k}, {tolerance:e}: {index}"
                );
            }
        }
    }
}
