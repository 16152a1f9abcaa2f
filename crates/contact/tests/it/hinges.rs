//! Bodies that share an edge or a node only: they turn about it until supports or contact stop them.

use crate::common;
use crate::common::{block, methods, run, uniform};
use signorini_contact::{Contact, ContactError, Load, Scene, Settings, Simulation, Support};
use signorini_fem_mesh::{FacetTag, LoadDensity, TetMesh, brick};

/// Tags of the second body are those of the brick plus this.
const SECOND: u32 = 100;

fn tag(of: FacetTag) -> FacetTag {
    FacetTag(of.0 + SECOND)
}

/// A cube of side one and a block of length two beside it that share the nodes at one place.
fn joined(offset: [f64; 3]) -> TetMesh {
    let first = block([1.0; 3], [2, 2, 2]);
    let second = block([2.0, 1.0, 1.0], [4, 2, 2]);
    let mut points = first.points().to_vec();
    let number: Vec<u32> = second
        .points()
        .iter()
        .map(|p| {
            let p: [f64; 3] = std::array::from_fn(|c| p[c] + offset[c]);
            let same = |q: &[f64; 3]| (0..3).all(|c| (p[c] - q[c]).abs() < 1e-12);
            points.iter().position(same).unwrap_or_else(|| {
                points.push(p);
                points.len() - 1
            }) as u32
        })
        .collect();
    let renumber = |n: u32| number[n as usize];
    let mut tets = first.tets().to_vec();
    tets.extend(second.tets().iter().map(|t| t.map(renumber)));
    let mut facets = first.facets().to_vec();
    facets.extend(second.facets().iter().map(|f| {
        let mut f = *f;
        f.nodes = f.nodes.map(renumber);
        f.tag = tag(f.tag);
        f
    }));
    TetMesh::new(points, tets, facets).expect("mesh")
}

/// The second body lies on the upper edge of the first at x = 1, z = 1.
fn lever() -> Scene {
    Scene::new(joined([1.0, 0.0, 1.0]), uniform(1e6, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(tag(brick::Z_MAX), 500.0))
}

fn settings() -> Settings {
    Settings::default().with_tolerance(1e-9)
}

#[test]
fn a_hinge_that_nothing_stops_is_named() {
    for boxes in [[1, 1, 1], [3, 1, 2]] {
        match Simulation::new(lever().with_boxes(boxes), settings()) {
            Err(ContactError::NotHeld { mode, force, .. }) => {
                assert!(mode.contains("rotation"), "{mode}");
                assert!(force > 0.0);
            }
            Err(error) => panic!("{boxes:?}: {error}"),
            Ok(_) => panic!("{boxes:?}: accepted"),
        }
    }
}

/// A lever on a floor: the moment about the hinge is that of the load, W times 1.
#[test]
fn a_lever_rests_on_a_floor() {
    let weight = 500.0 * 2.0;
    let mut reference: Option<Vec<f64>> = None;
    for boxes in [[1, 1, 1], [2, 1, 2], [3, 2, 2]] {
        for method in methods() {
            let scene = lever()
                .with_contact(Contact::rigid(tag(brick::Z_MIN)))
                .with_boxes(boxes);
            let place = scene.mesh().points().to_vec();
            let (_, levels) = run(scene, settings().with_method(method.clone()));
            let moment: f64 = levels[0]
                .points
                .iter()
                .map(|p| -p.normal_force * (place[p.node as usize][0] - 1.0))
                .sum();
            let what = format!("{boxes:?} {}", method.name());
            assert!((moment / weight - 1.0).abs() < 1e-6, "{what}: {moment}");
            let u = &levels[0].displacement;
            let first = reference.get_or_insert_with(|| u.clone());
            common::assert_close(u, first, 1e-5, &what);
        }
    }
}

/// A ball joint: one node shared; the other end is held along two directions.
#[test]
fn a_ball_joint_carries_its_share() {
    let corner = joined([1.0, 1.0, 1.0]);
    let scene = Scene::new(corner, uniform(1e6, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::new(LoadDensity::pressure(tag(brick::Z_MAX), 500.0)));
    let refused = Simulation::new(scene.clone(), settings());
    assert!(matches!(refused, Err(ContactError::NotHeld { .. })));
    let held = scene
        .with_support(Support::components(tag(brick::X_MAX), [false, true, true]))
        .with_boxes([2, 1, 2]);
    let (_, levels) = run(held, settings());
    assert!(common::norm(&levels[0].displacement) > 0.0);
}
