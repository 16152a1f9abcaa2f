//! Seams: nodes that contacts, ties and bodies beside one another share.

use crate::common::*;

const LEFT: FacetTag = FacetTag(61);
const RIGHT: FacetTag = FacetTag(62);

/// A bar whose facets of a tag are two sides, which meet in the middle.
fn halves(tag: FacetTag) -> TetMesh {
    let bar = block([2.0, 1.0, 1.0], [4, 2, 2]);
    let facets = bar.facets().iter().map(|facet| {
        let middle = facet.nodes.iter().map(|n| bar.points()[*n as usize][0]).sum::<f64>() / 3.0;
        let side = if middle < 1.0 { LEFT } else { RIGHT };
        let tag = if facet.tag == tag { side } else { facet.tag };
        Facet { tag, ..*facet }
    });
    let facets = facets.collect();
    TetMesh::new(bar.points().to_vec(), bar.tets().to_vec(), facets).expect("halves")
}

/// Tied cubes side by side stand on a third body with all nodes of their joint: both of a pair lost their contact.
#[test]
fn tied_bodies_stand_on_a_third() {
    let (young, pressure) = (1e9, 1e6);
    let third = |tag: FacetTag| FacetTag(tag.0 + 200);
    let cube = block([1.0; 3], [2; 3]);
    let beside = cube.clone().map_points(|[x, y, z]| [x + 1.0, y, z]).expect("beside");
    let base = lifted(&block([2.0, 1.0, 1.0], [4, 2, 2]), -1.0).map_tags(third);
    let mesh = with_second(&cube, &beside).append(&base).expect("three bodies");
    let joint = [brick::X_MAX, second(brick::X_MIN)];
    let feet = [brick::Z_MIN, second(brick::Z_MIN)];
    for (from, first) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let scene = Scene::new(mesh.clone(), uniform(young, 0.0))
            .with_support(Support::fixed(third(brick::Z_MIN)))
            .with_support(Support::components(brick::X_MIN, [true, false, false]))
            .with_support(Support::components(brick::Y_MIN, [false, true, false]))
            .with_load(Load::pressure(brick::Z_MAX, pressure))
            .with_load(Load::pressure(second(brick::Z_MAX), pressure))
            .with_contact(Contact::tied(joint[from], joint[1 - from]))
            .with_contact(Contact::between(feet[first], third(brick::Z_MAX)))
            .with_contact(Contact::between(feet[1 - first], third(brick::Z_MAX)));
        let found = solve(scene, tight());
        let exact = mesh
            .points()
            .iter()
            .flat_map(|p| [0.0, 0.0, -(p[2] + 1.0) * pressure / young]);
        let exact: Vec<f64> = exact.collect();
        assert_close(&found.displacement, &exact, 1e-8, &format!("{from} {first}"));
        assert_eq!(found.summary.active, 15, "{from} {first}");
    }
}

/// A bar on another one, the sides between them in two halves.
fn bars(order: usize, contacts: impl IntoIterator<Item = Contact>) -> Scene {
    let mesh = with_second(&halves(brick::Z_MAX), &lifted(&halves(brick::Z_MIN), 1.0));
    let mesh = if order == 2 { mesh.raise_order().expect("order 2") } else { mesh };
    let scene = Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::traction(second(brick::Z_MAX), [8e4, 2e4, -1e6]).with_history(ramp()))
        .with_analysis(Analysis::quasistatic(1.0, 2));
    contacts.into_iter().fold(scene, Scene::with_contact)
}

fn whole(contact: Contact) -> Contact {
    contact.with_tag(second(RIGHT)).with_partner(RIGHT)
}

/// Contacts of two halves are that of the whole; their laws may differ. Their common nodes were refused.
#[test]
fn contacts_of_matching_halves_are_one() {
    let half = |side, friction| Contact::between(second(side), side).with_friction(Friction::coulomb(friction));
    let (_, one) = run(bars(1, [whole(half(LEFT, 0.3))]), tight());
    let (_, two) = run(bars(1, [half(LEFT, 0.3), half(RIGHT, 0.3)]), tight());
    for (a, b) in two.iter().zip(&one) {
        assert_close(&a.displacement, &b.displacement, 1e-7, "one law");
        let [one, two] = [a, b].map(|of| {
            let mut points = of.points.clone();
            points.sort_by_key(|p| p.node);
            forces(&points)
        });
        assert_close(&one, &two, 1e-5, "one law");
        assert_eq!(a.points.len(), 15);
        let area: f64 = a.points.iter().map(|p| p.area).sum();
        assert!((area - 2.0).abs() < 1e-12, "{area}");
    }
    let (_, rough) = run(bars(1, [half(LEFT, 0.05), half(RIGHT, 0.3)]), tight());
    assert!(rough[1].summary.slip > 0 && rough[1].summary.stick > 0);
}

/// So are ties.
#[test]
fn ties_of_matching_halves_are_one() {
    let half = |side| Contact::tied(second(side), side);
    for order in [1, 2] {
        let (_, one) = run(bars(order, [whole(half(LEFT))]), tight());
        let (_, two) = run(bars(order, [half(LEFT), half(RIGHT)]), tight());
        assert_close(&two[1].displacement, &one[1].displacement, 1e-7, "ties");
        // also where one ends
        let (_, ended) = run(bars(order, [half(LEFT).with_end(0.5), half(RIGHT)]), tight());
        let (_, alone) = run(bars(order, [half(RIGHT)]), tight());
        assert_close(&ended[1].displacement, &alone[1].displacement, 1e-6, "one tie");
    }
}

/// The seam of two patches of a floor that gives way keeps its elastic slip when the patch ends that has its nodes. It
/// was taken for lost.
#[test]
fn elastic_slip_stays_where_a_patch_ends() {
    let of = |swap: bool| {
        let patch = |tag| {
            let floor = Contact::rigid(tag).with_friction(Friction::coulomb(0.6));
            floor.with_tangential_compliance(2e-9)
        };
        let mut patches = [patch(LEFT).with_end(2.0), patch(RIGHT)];
        if swap {
            patches.reverse();
        }
        let press = Support::fixed(brick::Z_MAX).with_motion([2e-4, 0.0, -1e-3], ramp());
        let scene = Scene::new(halves(brick::Z_MIN), uniform(1e9, 0.3))
            .with_support(press)
            .with_analysis(Analysis::quasistatic(4.0, 4));
        run(patches.into_iter().fold(scene, Scene::with_contact), tight()).1
    };
    let (kept, known) = (of(false), of(true));
    for (k, (a, b)) in kept.iter().zip(&known).enumerate() {
        assert_close(&a.displacement, &b.displacement, 1e-7, &format!("step {k}"));
        let size = norm(&b.summary.friction_force);
        let off = norm(&[0, 1, 2].map(|c| a.summary.friction_force[c] - b.summary.friction_force[c]));
        assert!(size > 1e3 && off < 1e-5 * size, "step {k}: {off:e} {size:e}");
    }
}
