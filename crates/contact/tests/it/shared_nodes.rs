//! Nodes that two contact surfaces share: the nearer obstacle acts, with its own law, whichever was named first.

use crate::common;
use crate::common::{block, solve, tight, uniform};
use signorini_contact::{Contact, Friction, Scene, Support};
use signorini_fem_mesh::{FacetTag, History, TetMesh, brick};

const FAR: FacetTag = FacetTag(77);

/// A brick whose lower side has another tag beyond x = 1.
fn mesh() -> TetMesh {
    let mesh = block([2.0, 1.0, 1.0], [4, 2, 2]);
    let points = mesh.points().to_vec();
    let facets = mesh.facets().iter().map(|f| {
        let mut facet = *f;
        let x = f.nodes.iter().map(|n| points[*n as usize][0]).sum::<f64>() / 3.0;
        if f.tag == brick::Z_MIN && x > 1.0 {
            facet.tag = FAR;
        }
        facet
    });
    let facets = facets.collect();
    TetMesh::new(points.clone(), mesh.tets().to_vec(), facets).expect("mesh")
}

#[test]
fn the_nearer_obstacle_acts_at_nodes_that_two_contacts_share() {
    let press = 1e-3;
    let (near, far) = (0.0, 0.4 * press);
    let mesh = mesh();
    let border: Vec<u32> = (0..)
        .zip(mesh.points())
        .filter(|(_, x)| x[0] == 1.0 && x[2] == 0.0)
        .map(|(n, _)| n)
        .collect();
    assert_eq!(border.len(), 3);
    let part = |tag, gap, mu| {
        Contact::rigid(tag)
            .with_gap(gap)
            .with_friction(Friction::coulomb(mu))
    };
    let (first, second) = (part(brick::Z_MIN, near, 0.4), part(FAR, far, 0.1));
    for contacts in [[first.clone(), second.clone()], [second, first]] {
        let nearer = contacts.iter().position(|c| c.tags() == [brick::Z_MIN]);
        let scene = Scene::new(mesh.clone(), uniform(1e6, 0.3)).with_support(
            Support::fixed(brick::Z_MAX).with_motion([1e-2, 0.0, -press], History::constant(1.0)),
        );
        let scene = contacts.into_iter().fold(scene, Scene::with_contact);
        let level = solve(scene, tight());
        for &node in &border {
            // no deeper than the nearer obstacle lets it
            let down = -level.displacement[3 * node as usize + 2];
            assert!(down <= near + 1e-9 * press, "node {node}: {down:e}");
            let pressed = level
                .points
                .iter()
                .filter(|p| p.node == node && p.normal_force < -1e-3);
            let pressed: Vec<_> = pressed.collect();
            assert_eq!(pressed.len(), 1, "{pressed:?}");
            let (point, force) = (pressed[0], -pressed[0].normal_force);
            assert_eq!(Some(point.surface), nearer);
            assert!((point.slip_bound - 0.4 * force).abs() <= 1e-9 * force);
            let friction = common::norm(&point.friction_force);
            assert!((friction - 0.4 * force).abs() <= 1e-6 * force, "{point:?}");
        }
        // beyond the border the other part counts
        let beyond = level.points.iter().filter(|p| Some(p.surface) != nearer);
        assert!(beyond.clone().count() >= 6);
        for point in beyond {
            assert!((point.slip_bound + 0.1 * point.normal_force).abs() < 1e-9);
        }
    }
}
