//! Obstacles that end at an edge, and what lies over it.

use crate::common::*;

/// A table that ends at x: a box of triangles, or an open sheet.
fn table(end: f64, is_box: bool) -> Obstacle {
    let whole = block([end + 1.0, 3.0, 1.0], [1; 3]).map_points(|[x, y, z]| [x - 1.0, y - 1.0, z - 1.0]);
    let whole = whole.expect("box");
    let mut facets = whole.facets().to_vec();
    facets.retain(|facet| is_box || facet.tag == brick::Z_MAX);
    let triangles: Vec<[u32; 3]> = facets.iter().map(|facet| facet.nodes).collect();
    Obstacle::surface(whole.points(), &triangles).expect("a table")
}

/// A block [0, 2] x [0, 1] x [0, 0.5] with node rows at 1 and 1.2, whose end is moved along the table.
fn over_the_edge(contact: Contact, way: f64) -> Scene {
    Scene::new(block([2.0, 1.0, 0.5], [10, 3, 3]), uniform(1e6, 0.3))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e3]))
        .with_support(Support::components(brick::X_MIN, [true, false, false]).with_motion([way, 0.0, 0.0], ramp()))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_contact(contact)
}

/// Nodes on the edge are met along the normal of the side that lies on the table, those beside it are free: they slide
/// over the edge.
#[test]
fn a_block_over_the_edge_of_a_table_is_held_by_what_is_below() {
    for end in [1.0, 1.03, 1.1999, 1.2 - 1e-12] {
        for way in [0.0, -0.01] {
            let gap = move |x: [f64; 3]| if x[0] > end + 1e-9 { 1.0 } else { 0.0 };
            let floor = Contact::rigid(brick::Z_MIN).with_gap_field(gap);
            let expected = solve(over_the_edge(floor, way), at(1e-8));
            for is_box in [true, false] {
                let contact = Contact::obstacle(brick::Z_MIN, table(end, is_box));
                let found = solve(over_the_edge(contact, way), at(1e-8));
                assert_close(
                    &found.displacement,
                    &expected.displacement,
                    1e-6,
                    &format!("{end} {way} {is_box}"),
                );
            }
        }
    }
}

/// What is beside a table may not come over it: the table has no say there.
#[test]
fn what_comes_over_the_edge_of_a_table_is_refused_or_warned_of() {
    let contact = Contact::obstacle(brick::Z_MIN, table(1.03, true));
    let error = refused(&over_the_edge(
        contact.clone().with_motion([0.2, 0.0, 0.0], ramp()),
        0.0,
    ));
    assert!(matches!(error, ContactError::TurnedNormal { .. }), "{error}");
    let warnings = |way: f64| {
        let mut simulation = Simulation::new(over_the_edge(contact.clone(), way), at(1e-8)).expect("set-up");
        simulation.step().expect("step").warnings()
    };
    let turned = |w: &Warning| matches!(w, Warning::TurnedNormal { .. });
    assert!(!warnings(-0.1).iter().any(turned));
    assert!(warnings(-0.2).iter().any(turned));
}
