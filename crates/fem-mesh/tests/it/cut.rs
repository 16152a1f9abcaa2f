//! Meshes that are cut open.

use signorini_fem_mesh::brick::{X_MAX, Z_MIN};
use signorini_fem_mesh::mesh::drop_unused_nodes;
use signorini_fem_mesh::vec3::{add, area_vector, centroid, norm};
use signorini_fem_mesh::{Brick, Decomposition, FacetTag, MeshError, TetMesh};

const TAGS: [FacetTag; 2] = [FacetTag(31), FacetTag(32)];

fn bar(order: usize) -> TetMesh {
    let mesh = Brick::new([2.0, 1.0, 1.0], [6, 3, 3])
        .perturbed(0.1, 5)
        .build()
        .expect("brick");
    if order == 2 {
        mesh.raise_order().expect("order 2")
    } else {
        mesh
    }
}

fn middle(mesh: &TetMesh, tet: usize) -> [f64; 3] {
    centroid(&mesh.tet_points(tet))
}

/// Facets of both sides lie on each other, the mesh falls into two bodies, and everything else stays.
#[test]
fn both_sides_match() {
    for order in [1, 2] {
        let whole = bar(order);
        let (cut, copied) = whole.cut(|tet| Some(middle(&whole, tet)[0] < 0.9), TAGS).expect("cut");
        assert_eq!(cut.points().len(), whole.points().len() + copied.len());
        for (k, &node) in copied.iter().enumerate() {
            assert_eq!(cut.points()[whole.points().len() + k], cut.points()[node as usize]);
        }
        let [first, second] = TAGS.map(|tag| cut.nodes_on(tag));
        assert_eq!(first, copied);
        assert_eq!(second.len(), copied.len());
        assert!(second.iter().all(|n| *n as usize >= whole.points().len()));
        let bodies = cut.components();
        assert!(
            bodies
                .iter()
                .enumerate()
                .all(|(t, b)| (*b == 0) == (middle(&whole, t)[0] < 0.9) || *b == 1)
        );
        assert_eq!(bodies.iter().max(), Some(&1));
        for tag in [X_MAX, Z_MIN] {
            assert_eq!(
                cut.facets().iter().filter(|f| f.tag == tag).count(),
                whole.facets().iter().filter(|f| f.tag == tag).count()
            );
        }
        assert_eq!(
            (cut.total_volume(), cut.tets().len()),
            (whole.total_volume(), whole.tets().len())
        );
        // the boundary of each body is closed, and what is known of it is as of a mesh that is made anew
        let sum = cut.boundary_facets().iter().fold([0.0; 3], |sum, facet| {
            add(sum, area_vector(&facet.nodes.map(|n| cut.points()[n as usize])))
        });
        assert!(norm(sum) < 1e-12);
        let tets = cut.tets().to_vec();
        let again = match order {
            1 => TetMesh::new(cut.points().to_vec(), tets, cut.facets().to_vec()),
            _ => {
                let quadratic = tets.iter().zip(cut.mids());
                let quadratic = quadratic.map(|(t, m)| std::array::from_fn(|k| if k < 4 { t[k] } else { m[k - 4] }));
                TetMesh::quadratic(cut.points().to_vec(), quadratic.collect(), cut.facets().to_vec())
            }
        };
        assert_eq!(again.expect("a mesh"), cut);
        assert_eq!(Decomposition::whole(&cut).subdomains().len(), 2);
    }
}

/// A ring that is cut once stays one body, and nodes on both sides differ.
#[test]
fn a_ring_opens() {
    let (mut points, mut tets) = {
        let plate = Brick::new([3.0, 3.0, 1.0], [3, 3, 1]).build().expect("brick");
        (plate.points().to_vec(), plate.tets().to_vec())
    };
    let outer = |t: &[u32; 4]| {
        let [x, y, _] = centroid(&t.map(|n| points[n as usize]));
        (x - 1.5).abs() > 0.5 || (y - 1.5).abs() > 0.5
    };
    tets.retain(outer);
    drop_unused_nodes(&mut points, &mut tets, &mut []);
    let ring = TetMesh::new(points, tets, Vec::new()).expect("ring");
    let side = |tet: usize| {
        let [x, y, _] = middle(&ring, tet);
        (y < 1.0).then_some(x < 1.0)
    };
    let (open, copied) = ring.cut(side, TAGS).expect("cut");
    assert_eq!(copied.len(), 4);
    assert_eq!(open.components().iter().max(), Some(&0));
    let facets = |tag| open.facets().iter().filter(move |f| f.tag == tag).count();
    assert_eq!((facets(TAGS[0]), facets(TAGS[1])), (2, 2));
}

/// Cuts may cross one another.
#[test]
fn cuts_cross() {
    let whole = bar(1);
    let (once, first) = whole.cut(|tet| Some(middle(&whole, tet)[0] < 0.9), TAGS).expect("cut");
    let others = [FacetTag(33), FacetTag(34)];
    let (twice, second) = once.cut(|tet| Some(middle(&once, tet)[1] < 0.5), others).expect("cut");
    assert_eq!(twice.components().iter().max(), Some(&3));
    assert!(!first.is_empty() && !second.is_empty());
    assert!((twice.total_volume() - 2.0).abs() < 1e-12);
}

#[test]
fn cuts_that_are_none_are_refused() {
    let whole = bar(1);
    assert_eq!(whole.cut(|_| Some(true), TAGS), Err(MeshError::NoCut));
    assert_eq!(whole.cut(|_| None, TAGS), Err(MeshError::NoCut));
    // through a half only
    let half = |tet: usize| {
        let [x, y, _] = middle(&whole, tet);
        (y < 0.5).then_some(x < 0.9)
    };
    let error = whole.cut(half, TAGS).expect_err("ends inside");
    assert!(matches!(error, MeshError::CutEnds { .. }), "{error}");
}
