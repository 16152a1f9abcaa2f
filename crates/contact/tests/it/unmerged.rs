//! Bodies whose nodes coincide where nothing acts between them are told, once, and no others are.

use crate::common::*;

/// The warning of it.
fn unmerged(scene: &Scene) -> Option<Warning> {
    let plan = Plan::new(scene, &Settings::default()).expect("plan");
    let such = |w: &&Warning| matches!(w, Warning::Unmerged { .. });
    plan.warnings().iter().find(such).cloned()
}

/// A block on another one, both held at their far sides, with as many cells along the common side.
fn blocks(order: usize, cells: usize, lift: f64) -> Scene {
    let mesh = with_second(&block([1.0; 3], [2; 3]), &lifted(&block([1.0; 3], [cells; 3]), lift));
    let mesh = match order {
        1 => mesh,
        _ => mesh.raise_order().expect("quadratic"),
    };
    Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::Z_MIN))
        .with_support(Support::fixed(second(brick::Z_MAX)))
        .with_load(Load::pressure(second(brick::X_MIN), 1e5))
}

const LOWER: FacetTag = brick::Z_MAX;

fn upper() -> FacetTag {
    second(brick::Z_MIN)
}

#[test]
fn bodies_that_pass_through_each_other_are_told() {
    for order in [1, 2] {
        let scene = blocks(order, 2, 1.0);
        let warning = unmerged(&scene).expect("a warning");
        let Warning::Unmerged {
            node,
            partner,
            place,
            nodes: 9,
        } = warning
        else {
            panic!("{warning}");
        };
        let points = scene.mesh().points();
        assert!(place[2] == 1.0 && [node, partner].iter().all(|n| points[*n as usize] == place));
        assert!(scene.mesh().nodes_on(LOWER).contains(&node) && scene.mesh().nodes_on(upper()).contains(&partner));
        assert_eq!(warning.parts(), [Part::Node(node), Part::Node(partner)]);
        let text = warning.to_string();
        assert!(
            ["merge_nodes", "Contact::tied", "Contact::between"]
                .iter()
                .all(|way| text.contains(way)),
            "{text}"
        );
    }
    // an obstacle elsewhere, and supports along a common edge, are nothing between them
    let sides = [brick::X_MIN, second(brick::X_MIN)].map(|tag| Support::components(tag, [true, false, false]));
    let scene = sides.into_iter().fold(blocks(1, 2, 1.0), Scene::with_support);
    let scene = scene.with_contact(Contact::rigid(brick::X_MAX).with_gap(0.1));
    // but the three nodes on X_MIN that both bodies have held, and the three on X_MAX that may touch
    assert_eq!(unmerged(&scene), None);
    let scene = blocks(1, 2, 1.0).with_contact(Contact::rigid(brick::X_MAX).with_gap(0.1));
    assert!(matches!(unmerged(&scene), Some(Warning::Unmerged { nodes: 6, .. })));
}

#[test]
fn bodies_with_something_between_them_are_not_told() {
    let scene = || blocks(1, 2, 1.0);
    let (lower, higher) = (scene().mesh().nodes_on(LOWER), scene().mesh().nodes_on(upper()));
    let all: Vec<u32> = lower.iter().chain(&higher).copied().collect();
    let equal = |scene: Scene, (a, b): (&u32, &u32)| {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let terms = axes.map(|e| Equation::new([(*a, e), (*b, e.map(|c| -c))]));
        terms.into_iter().fold(scene, Scene::with_equation)
    };
    for (k, scene) in [
        scene().with_contact(Contact::between(upper(), LOWER)),
        scene().with_contact(Contact::tied(LOWER, upper())),
        // at a later step
        scene()
            .with_contact(Contact::between(upper(), LOWER).with_start(1.0))
            .with_analysis(Analysis::quasistatic(2.0, 2)),
        lower.iter().zip(&higher).fold(scene(), equal),
        // by a point each that both bodies have an equation with
        lower
            .iter()
            .zip(&higher)
            .enumerate()
            .fold(scene(), |scene, (k, (a, b))| {
                let along = |node| Equation::new([(node, [0.0, 0.0, 1.0])]).with_point(k, [0.0, 0.0, -1.0]);
                let place = scene.mesh().points()[*a as usize];
                let scene = scene.with_coupling(Coupling::point(place));
                scene.with_equation(along(*a)).with_equation(along(*b))
            }),
        scene().with_coupling(Coupling::rigid(all.clone(), [0.5, 0.5, 1.0])),
        scene().with_support(Support::components(all, [false, false, true])),
        // they rest on a thin plate, from both sides
        scene()
            .with_contact(Contact::rigid(LOWER))
            .with_contact(Contact::rigid(upper())),
        // meshes that do not match, and bodies apart
        blocks(1, 3, 1.0),
        blocks(1, 2, 1.5),
    ]
    .iter()
    .enumerate()
    {
        assert_eq!(unmerged(scene), None, "{k}");
    }
    // bodies that have an edge in common, and no facet
    let beside = block([1.0; 3], [2; 3]).map_points(|[x, y, z]| [x + 1.0, y, z + 1.0]);
    let mesh = with_second(&block([1.0; 3], [2; 3]), &beside.expect("moved"));
    let scene = Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::Z_MIN))
        .with_support(Support::fixed(second(brick::Z_MAX)));
    assert_eq!(unmerged(&scene), None);
}

/// Four blocks, as of a wall: those that meet along an edge only have no pair, and those side by side have.
#[test]
fn walls_are_told_of_the_pair_that_is_missing() {
    let at = |x: f64, z: f64, first: u32| {
        let moved = block([1.0; 3], [2; 3]).map_points(|[a, b, c]| [a + x, b, c + z]);
        moved.expect("moved").map_tags(|tag| FacetTag(tag.0 + first))
    };
    let rest = [at(1.0, 0.0, 10), at(0.0, 1.0, 20), at(1.0, 1.0, 30)];
    let mesh = rest
        .iter()
        .fold(at(0.0, 0.0, 0), |all, one| all.append(one).expect("bodies"));
    let tag = |tag: FacetTag, first: u32| FacetTag(tag.0 + first);
    let scene = Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::Z_MIN))
        .with_support(Support::fixed(tag(brick::Z_MIN, 10)))
        .with_load(Load::pressure(tag(brick::Z_MAX, 20), 1e5));
    let pairs = [
        (brick::X_MAX, tag(brick::X_MIN, 10)),
        (tag(brick::X_MAX, 20), tag(brick::X_MIN, 30)),
        (brick::Z_MAX, tag(brick::Z_MIN, 20)),
        (tag(brick::Z_MAX, 10), tag(brick::Z_MIN, 30)),
    ];
    let add = |scene: Scene, (a, b): &(FacetTag, FacetTag)| scene.with_contact(Contact::between(*a, *b));
    assert_eq!(unmerged(&pairs.iter().fold(scene.clone(), add)), None);
    // the last pair is forgotten: three of its nodes are in others
    let warning = unmerged(&pairs[..3].iter().fold(scene, add));
    assert!(
        matches!(warning, Some(Warning::Unmerged { nodes: 6, .. })),
        "{warning:?}"
    );
}
