//! Contact pairs that are found by the distance of bodies.

use crate::common::*;

fn tagged(mesh: TetMesh, of: impl Fn([f64; 3]) -> Option<u32>) -> TetMesh {
    mesh.tag_boundary(|_, normal| of(normal).map(FacetTag))
}

fn body(lengths: [f64; 3], cells: [usize; 3], origin: [f64; 3]) -> TetMesh {
    let mesh = Brick::new(lengths, cells).with_origin(origin).build().expect("brick");
    tagged(mesh, |_| None)
}

fn joined(bodies: &[TetMesh]) -> TetMesh {
    let mut out = bodies[0].clone();
    for body in &bodies[1..] {
        out = out.append(body).expect("bodies");
    }
    out
}

/// The area that each side of a pair has.
fn areas(mesh: &TetMesh, pair: &ContactPair) -> [f64; 2] {
    [0, 1].map(|side: usize| Surface::new(mesh, &pair.tags[side]).expect("side").total_area())
}

/// Two blocks on a plate whose cells are as wide as both, in no line with them: a facet of the plate faces both.
#[test]
fn a_facet_may_face_two_bodies() {
    let plate = body([2.0, 1.0, 0.5], [1, 1, 1], [0.0; 3]);
    let plate = tagged(plate, |normal| (normal[2] < -0.5).then_some(1));
    let one = |x: f64, gap: f64| {
        let block = body([0.5, 0.8, 0.5], [2, 3, 2], [x, 0.1, 0.5 + gap]);
        tagged(block, |normal| (normal[2] > 0.5).then_some(2))
    };
    let mesh = joined(&[plate, one(0.3, 0.0), one(1.1, 1e-3)]);
    let (mesh, pairs) = ContactPair::find(mesh, 1e-2).expect("reach");
    assert_eq!(pairs.len(), 2);
    for (pair, (body, gap)) in pairs.iter().zip([(1, 0.0), (2, 1e-3)]) {
        assert_eq!(pair.bodies, [0, body]);
        assert!(pair.gaps.iter().all(|g| (g - gap).abs() < 1e-12), "{pair:?}");
        assert!((areas(&mesh, pair)[1] - 0.4).abs() < 1e-12);
    }
    assert!(pairs[0].tags[0].iter().any(|tag| pairs[1].tags[0].contains(tag)));
    // supports and loads are where they were
    assert!((Surface::new(&mesh, &[FacetTag(2)]).expect("top").total_area() - 0.8).abs() < 1e-12);

    let contacts = pairs
        .iter()
        .map(|pair| pair.contact().with_friction(Friction::coulomb(0.5)));
    let scene = Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::fixed(FacetTag(1)))
        .with_support(Support::fixed(FacetTag(2)).with_motion([1e-3, 0.0, -2e-3], ramp()));
    let scene = contacts.fold(scene, Scene::with_contact);
    let (simulation, _) = run(scene, tight());
    let reactions = simulation.result().expect("a step").reactions();
    let [first, second] = [0, 1].map(|k| reactions.contacts[k].force[2].abs());
    assert!(first > 1.5 * second && second > 0.0, "{first} and {second}");
}

/// A cube in a corner touches both walls, each in a pair of its own: their sides meet at a crease.
#[test]
fn sides_that_meet_at_a_crease_are_apart() {
    let corner = body([3.0, 1.0, 2.0], [6, 2, 4], [0.0; 3]);
    let cells: Vec<bool> = (0..corner.tets().len())
        .map(|tet| {
            let middle = corner
                .tet_points(tet)
                .iter()
                .fold([0.0; 2], |sum, p| [sum[0] + 0.25 * p[0], sum[1] + 0.25 * p[2]]);
            middle[0] < 1.0 || middle[1] < 1.0
        })
        .collect();
    let tets: Vec<[u32; 4]> = corner
        .tets()
        .iter()
        .zip(&cells)
        .filter(|(_, keep)| **keep)
        .map(|(tet, _)| *tet)
        .collect();
    let (mut points, mut tets) = (corner.points().to_vec(), tets);
    signorini_fem_mesh::mesh::drop_unused_nodes(&mut points, &mut tets, &mut []);
    let corner = TetMesh::new(points, tets, Vec::new()).expect("an angle");
    let cube = body([0.8, 0.8, 0.7], [3; 3], [1.0, 0.1, 1.0]);
    let (mesh, pairs) = ContactPair::find(joined(&[corner, cube]), 1e-3).expect("reach");
    assert_eq!(pairs.len(), 2, "{pairs:?}");
    let mut sizes: Vec<f64> = pairs.iter().map(|pair| areas(&mesh, pair)[1]).collect();
    sizes.sort_by(f64::total_cmp);
    assert!(
        (sizes[0] - 0.56).abs() < 1e-12 && (sizes[1] - 0.64).abs() < 1e-12,
        "{sizes:?}"
    );
}

/// What lies behind a body, or behind its own far side, is hidden, however thin that is.
#[test]
fn thin_sheets_see_their_neighbours_only() {
    let sheet = |k: usize| body([1.0, 1.0, 0.01], [3 + k, 4, 1], [0.0, 0.0, 0.011 * k as f64]);
    let (mesh, pairs) = ContactPair::find(joined(&[sheet(0), sheet(1), sheet(2)]), 0.1).expect("reach");
    let bodies: Vec<[u32; 2]> = pairs.iter().map(|pair| pair.bodies).collect();
    assert_eq!(bodies, [[0, 1], [1, 2]]);
    for pair in &pairs {
        assert!(pair.gaps.iter().all(|gap| (gap - 1e-3).abs() < 1e-12));
        assert!(areas(&mesh, pair).iter().all(|area| (area - 1.0).abs() < 1e-12));
    }
    // in each other
    let (_, pairs) =
        ContactPair::find(joined(&[sheet(0), body([1.0; 3], [2; 3], [0.0, 0.0, 0.009])]), 0.1).expect("reach");
    assert_eq!(pairs.len(), 1);
    assert!(pairs[0].gaps.iter().all(|gap| (gap + 1e-3).abs() < 1e-12), "{pairs:?}");
}

/// A pin in a hole, in segments of other sizes: one pair all around, with the clearance and the sag of facets.
#[test]
fn a_pin_faces_its_hole_all_around() {
    let round = |inner: f64, outer: f64, around: usize| {
        let turn = |[r, a, z]: [f64; 3]| {
            let (sin, cos) = (0.5 * std::f64::consts::PI * a).sin_cos();
            [
                (inner + (outer - inner) * r) * cos,
                (inner + (outer - inner) * r) * sin,
                z,
            ]
        };
        let straight = body([1.0, 1.0, 0.5], [2, around, 2], [0.0; 3]);
        straight.map_points(turn).expect("quarter of a ring")
    };
    let mesh = joined(&[round(1.002, 1.5, 13), round(0.5, 1.0, 9)]);
    let (mesh, pairs) = ContactPair::find(mesh, 0.02).expect("reach");
    assert_eq!(pairs.len(), 1);
    let exact = 0.25 * std::f64::consts::PI;
    assert!(
        areas(&mesh, &pairs[0])
            .iter()
            .all(|area| (area / exact - 1.0).abs() < 5e-3)
    );
    assert!(pairs[0].gaps[0] > 0.0 && pairs[0].gaps[1] < 7e-3, "{:?}", pairs[0].gaps);
    let none = ContactPair::find(mesh.tag_boundary(|_, _| None), 1e-4).expect("reach");
    assert!(none.1.is_empty() && none.0.facets().is_empty());
}

#[test]
fn a_reach_is_a_length() {
    for reach in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = ContactPair::find(body([1.0; 3], [1; 3], [0.0; 3]), reach).expect_err("no length");
        assert!(matches!(error, ContactError::Setting { name: "reach", .. }));
    }
}

/// A bulge on a plate of other cells touches it and is nowhere inside; weights of means, in part negative, make it
/// 0.013.
#[test]
fn an_overlap_is_no_deeper_than_its_facets() {
    let plate = body([3.0, 1.2, 0.3], [6, 3, 1], [-1.5, -0.1, -0.3]);
    let plate = tagged(plate, |normal| (normal[2] < -0.5).then_some(1));
    let bulge = body([2.0, 1.0, 0.5], [6, 3, 1], [-1.0, 0.0, 0.0]);
    let bulge = bulge.map_points(|[x, y, z]| [x, y, z + 0.3 * x * x]).expect("bulge");
    let (mesh, pairs) = ContactPair::find(joined(&[plate, bulge]), 0.5).expect("reach");
    assert_eq!(pairs.len(), 1);
    assert!(pairs[0].gaps[0] >= 0.0, "{:?}", pairs[0].gaps);
    let scene = Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::fixed(FacetTag(1)))
        .with_load(Load::body([0.0, 0.0, -1e3]))
        .with_contact(pairs[0].contact().with_friction(Friction::coulomb(0.5)));
    let plan = Plan::new(&scene, &Settings::default()).expect("plan");
    let inside = |w: &Warning| matches!(w, Warning::FacetedOverlap { .. });
    assert!(!plan.warnings().iter().any(inside), "{:?}", plan.warnings());
}

/// Bricks have tags everywhere: nothing is left that could be in a pair.
#[test]
fn bodies_with_tags_everywhere_are_refused() {
    let brick = |z: f64| {
        let brick = Brick::new([1.0; 3], [2; 3]).with_origin([0.0, 0.0, z]);
        brick.build().expect("brick")
    };
    let bare = |mesh: TetMesh| tagged(mesh, |_| None);
    for mesh in [
        joined(&[brick(0.0), brick(1.0)]),
        joined(&[brick(0.0), bare(brick(1.0)), brick(2.0)]),
    ] {
        let bodies = mesh.components().iter().max().map_or(0, |last| *last as usize + 1);
        let error = ContactPair::find(mesh, 1e-2).expect_err("tags");
        assert!(
            matches!(error, ContactError::TaggedSides { bodies: found } if found == bodies),
            "{error}"
        );
        let text = error.to_string();
        assert!(
            text.contains("without_tags") && text.contains("Contact::between"),
            "{text}"
        );
    }
    // tags of whole surfaces are taken off, others stay
    let mesh = joined(&[brick(0.0), brick(1.0).map_tags(|tag| FacetTag(tag.0 + 10))]);
    let sides = [brick::Z_MAX, FacetTag(brick::Z_MIN.0 + 10)];
    let (mesh, pairs) = ContactPair::find(mesh.without_tags(&sides), 1e-2).expect("pairs");
    assert_eq!((pairs.len(), areas(&mesh, &pairs[0])), (1, [1.0; 2]));
    assert_eq!(Surface::new(&mesh, &[brick::Z_MIN]).expect("bottom").total_area(), 1.0);
    // others may be told, and one body has none
    let mesh = joined(&[bare(brick(0.0)), brick(1.0), bare(brick(2.0))]);
    assert_eq!(ContactPair::find(mesh, 1e-2).expect("reach").1, []);
    assert_eq!(ContactPair::find(brick(0.0), 1e-2).expect("reach").1, []);
    let mesh = joined(&[bare(brick(0.0)), bare(brick(1.0))]);
    assert_eq!(ContactPair::find(mesh, 1e-2).expect("reach").1.len(), 1);
}
