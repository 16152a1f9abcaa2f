//! Ways to be wrong: each gives a typed error that names the place.

use approx::assert_abs_diff_eq;
use signorini_fem_mesh::brick::{Brick, BrickError, Z_MIN};
use signorini_fem_mesh::decomposition::{Rigid, split_disconnected};
use signorini_fem_mesh::fields::{FieldError, nodal_average, strains, stresses};
use signorini_fem_mesh::mesh::{drop_unused_nodes, orient_tets};
use signorini_fem_mesh::recovery::discretisation_error;
use signorini_fem_mesh::{
    Decomposition, DecompositionError, Facet, FacetTag, History, HistoryError, Hooke, HookeError, LoadDensity,
    LoadError, MaterialError, Materials, MeshError, Surface, SurfaceError, TetMesh, assemble_load, assemble_stiffness,
};

const UNIT: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn mesh_error(points: &[[f64; 3]], tets: &[[u32; 4]], facets: &[[u32; 3]]) -> MeshError {
    let facets = facets
        .iter()
        .map(|&nodes| Facet {
            nodes,
            tag: FacetTag(1),
        })
        .collect();
    TetMesh::new(points.to_vec(), tets.to_vec(), facets).unwrap_err()
}

fn with(extra: &[[f64; 3]]) -> Vec<[f64; 3]> {
    [&UNIT[..], extra].concat()
}

/// Two unit cubes of five tetrahedra side by side.
fn brick() -> TetMesh {
    Brick::new([2.0, 1.0, 1.0], [2, 1, 1]).build().unwrap()
}

#[test]
fn meshes() {
    let t = [[0, 1, 2, 3]];
    assert_eq!(mesh_error(&[], &[], &[]), MeshError::Empty { what: "nodes" });
    assert_eq!(mesh_error(&UNIT, &[], &[]), MeshError::Empty { what: "tetrahedra" });
    let mut points = UNIT;
    points[2][1] = f64::NAN;
    assert!(matches!(
        mesh_error(&points, &t, &[]),
        MeshError::NotFinite { node: 2, .. }
    ));
    let error = mesh_error(&UNIT, &[[0, 1, 2, 4]], &[]);
    assert_eq!(
        error,
        MeshError::NodeOutOfRange {
            tet: 0,
            node: 4,
            nodes: 4
        }
    );
    let error = mesh_error(&UNIT, &[[0, 1, 2, 1]], &[]);
    assert_eq!(error, MeshError::RepeatedNode { tet: 0, node: 1 });
    let mut points = UNIT;
    points[3] = [0.3, 0.3, 1e-13];
    assert!(matches!(
        mesh_error(&points, &t, &[]),
        MeshError::DegenerateTet { tet: 0, .. }
    ));
    points[3] = points[0];
    assert!(matches!(
        mesh_error(&points, &t, &[]),
        MeshError::DegenerateTet { tet: 0, .. }
    ));
    let error = mesh_error(&UNIT, &[[0, 1, 3, 2]], &[]);
    assert!(matches!(error, MeshError::InvertedTet { tet: 0, .. }));
    assert!(error.to_string().contains("swap its nodes 3 and 2"), "{error}");
    let error = mesh_error(&with(&[[5.0; 3]]), &t, &[]);
    assert_eq!(error, MeshError::DanglingNode { node: 4, count: 1 });
    let error = mesh_error(&UNIT, &[t[0], t[0]], &[]);
    assert!(matches!(
        error,
        MeshError::OverlappingTets {
            first: 0,
            second: 1,
            ..
        }
    ));
    // Two more tetrahedra behind the face x + y + z = 1.
    let points = with(&[[1.0; 3], [2.0; 3]]);
    let tets = [t[0], [4, 3, 2, 1], [5, 3, 2, 1]];
    assert!(matches!(
        mesh_error(&points, &tets, &[]),
        MeshError::FaceShared { count: 3, .. }
    ));
}

#[test]
fn coinciding_nodes_of_one_body_but_not_of_two() {
    // Three tetrahedra around an edge; the last one uses a copy of node 3, so that the body is
    // cut open there.
    let points = with(&[[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]);
    let error = mesh_error(&points, &[[0, 1, 2, 3], [0, 2, 4, 3], [0, 4, 5, 6]], &[]);
    assert_eq!(
        error,
        MeshError::CoincidentNodes {
            first: 3,
            second: 6,
            distance: 0.0
        }
    );
    let mut near = points;
    near[6][2] += 1e-14;
    let error = mesh_error(&near, &[[0, 1, 2, 3], [0, 2, 4, 3], [0, 4, 5, 6]], &[]);
    assert!(matches!(
        error,
        MeshError::CoincidentNodes {
            first: 3,
            second: 6,
            ..
        }
    ));
    let twice = [UNIT, UNIT].concat();
    let two = TetMesh::new(twice, vec![[0, 1, 2, 3], [4, 5, 6, 7]], vec![]).unwrap();
    assert_eq!(two.components(), [0, 1]);
}

#[test]
fn facets() {
    let points = with(&[[1.0; 3]]);
    let tets = [[0, 1, 2, 3], [4, 3, 2, 1]];
    let error = |facets: &[[u32; 3]]| mesh_error(&points, &tets, facets);
    assert_eq!(
        error(&[[0, 1, 9]]),
        MeshError::FacetNodeOutOfRange {
            facet: 0,
            node: 9,
            nodes: 5
        }
    );
    assert_eq!(
        error(&[[0, 1, 4]]),
        MeshError::FacetUnknown {
            facet: 0,
            nodes: [0, 1, 4]
        }
    );
    assert_eq!(
        error(&[[0, 1, 1]]),
        MeshError::FacetUnknown {
            facet: 0,
            nodes: [0, 1, 1]
        }
    );
    let inside = MeshError::FacetInside {
        facet: 1,
        nodes: [1, 2, 3],
        first: 0,
        second: 1,
    };
    assert_eq!(error(&[[0, 1, 2], [1, 2, 3]]), inside);
    let twice = error(&[[0, 1, 2], [0, 1, 3], [2, 0, 1]]);
    assert_eq!(
        twice,
        MeshError::FacetRepeated {
            first: 0,
            second: 2,
            nodes: [2, 0, 1]
        }
    );
    let regions = brick().with_regions(vec![0; 3]).unwrap_err();
    assert_eq!(regions, MeshError::RegionCount { given: 3, tets: 10 });
    let reflected = brick().map_points(|[x, y, z]| [-x, y, z]).unwrap_err();
    assert!(matches!(reflected, MeshError::InvertedTet { tet: 0, .. }));
}

#[test]
fn repairs() {
    let mut points = with(&[[5.0; 3]]);
    points.swap(0, 4);
    let mut tets = vec![[4, 1, 3, 2]];
    let mut facets = vec![Facet {
        nodes: [4, 1, 2],
        tag: FacetTag(7),
    }];
    assert_eq!(orient_tets(&points, &mut tets), 1);
    assert_eq!(drop_unused_nodes(&mut points, &mut tets, &mut facets), [1, 2, 3, 4]);
    let mesh = TetMesh::new(points, tets, facets).unwrap();
    assert_abs_diff_eq!(mesh.volume(0), 1.0 / 6.0, epsilon = 1e-15);
}

#[test]
fn bricks() {
    let field = |brick: Brick| match brick.build().unwrap_err() {
        BrickError::OutOfRange { field, axis, .. } => (field, axis),
        other => panic!("{other}"),
    };
    let good = || Brick::new([1.0; 3], [1; 3]);
    assert_eq!(field(Brick::new([1.0, 0.0, 1.0], [1; 3])), ("lengths", "y"));
    assert_eq!(field(Brick::new([1.0; 3], [1, 1, 0])), ("cells", "z"));
    assert_eq!(field(good().with_origin([f64::NAN, 0.0, 0.0])), ("origin", "x"));
    assert_eq!(field(good().graded([1.0, -1.0, 1.0])), ("grading", "y"));
    assert_eq!(field(good().perturbed(0.2, 1)), ("perturbation", "all axes"));
    for cells in [[usize::MAX; 3], [1 << 20, 1 << 20, 1]] {
        let error = Brick::new([1.0; 3], cells).build().unwrap_err();
        assert!(matches!(error, BrickError::Mesh(MeshError::TooLarge { .. })));
    }
    // So far from the origin that the cells drown in rounding.
    let far = good().with_origin([1e20; 3]).build().unwrap_err();
    assert!(matches!(far, BrickError::Mesh(_)));
}

#[test]
fn materials() {
    assert_eq!(Hooke::isotropic(0.0, 0.3), Err(HookeError::Young(0.0)));
    assert!(matches!(Hooke::isotropic(f64::NAN, 0.3), Err(HookeError::Young(_))));
    assert_eq!(Hooke::isotropic(1.0, 0.5), Err(HookeError::Poisson(0.5)));
    assert_eq!(Hooke::isotropic(1.0, -1.0), Err(HookeError::Poisson(-1.0)));
    assert!(matches!(Hooke::isotropic(1.0, f64::NAN), Err(HookeError::Poisson(_))));
    for ratio in [0.5 - 1e-14, 0.5 - 1e-13, -1.0 + 1e-14] {
        for young in [1e-300, 1.0, 1e300] {
            let error = Hooke::isotropic(young, ratio).unwrap_err();
            assert_eq!(error, HookeError::Poisson(ratio));
        }
    }
    for ratio in [0.5 - 1e-11, -1.0 + 1e-11] {
        assert!(Hooke::isotropic(1.0, ratio).is_ok());
    }
    let good = Hooke::isotropic(1.0, 0.3).unwrap();
    let changed = |i: usize, j: usize, value: f64| {
        let mut c = *good.voigt();
        c[i][j] = value;
        Hooke::from_voigt(&c).unwrap_err()
    };
    assert!(matches!(
        changed(0, 0, f64::INFINITY),
        HookeError::NotFinite { row: 0, .. }
    ));
    assert!(matches!(
        changed(0, 1, 0.1),
        HookeError::NotSymmetric {
            left: [1, 1, 0, 0],
            right: [0, 0, 1, 1],
            ..
        }
    ));
    assert!(matches!(changed(4, 4, 0.0), HookeError::NotElliptic { .. }));
    assert!(matches!(changed(4, 4, -1.0), HookeError::NotElliptic { .. }));
    assert!(matches!(
        Hooke::from_voigt(&[[0.0; 6]; 6]),
        Err(HookeError::NotElliptic { .. })
    ));

    let table = vec![(3, good), (1, good), (3, good)];
    assert_eq!(Materials::new(table), Err(MaterialError::Repeated { region: 3 }));
    let some = Materials::new(vec![(3, good), (1, good)]).unwrap();
    assert_eq!(
        some.get(2),
        Err(MaterialError::Unknown {
            region: 2,
            known: vec![1, 3]
        })
    );
    assert!(some.get(3).is_ok());
}

#[test]
fn assembly_and_fields() {
    let mesh = brick();
    let law = Hooke::isotropic(1.0, 0.3).unwrap();
    let error = assemble_stiffness(&mesh.points()[..5], mesh.tets(), |_| &law).unwrap_err();
    assert!(matches!(error, MeshError::NodeOutOfRange { nodes: 5, .. }));
    let small = Brick::new([1.0; 3], [1; 3]).build().unwrap();
    let rest = vec![0.0; 3 * mesh.points().len()];
    let estimate = discretisation_error(&mesh, &law.into(), &rest).unwrap();
    assert!(matches!(
        estimate.stress_errors(&small, &law.into()),
        Err(FieldError::Length { what: "table of tetrahedra", given, expected })
            if (given, expected) == (mesh.tets().len(), small.tets().len())
    ));
    let elsewhere = Materials::new(vec![(9, law)]).unwrap();

    assert!(matches!(
        strains(&mesh, &[0.0; 5]),
        Err(FieldError::Length { given: 5, .. })
    ));
    let mut u = vec![0.0; 3 * mesh.points().len()];
    assert!(matches!(stresses(&mesh, &elsewhere, &u), Err(FieldError::Material(_))));
    u[7] = f64::NAN;
    assert!(matches!(strains(&mesh, &u), Err(FieldError::NotFinite { node: 2, .. })));
    assert!(matches!(
        nodal_average(&mesh, &[[0.0]]),
        Err(FieldError::Length { given: 1, .. })
    ));
}

#[test]
fn decompositions() {
    let mesh = brick();
    let boxes = |b| Decomposition::boxes(&mesh, b).unwrap_err();
    assert!(matches!(
        boxes([1, 0, 1]),
        DecompositionError::NoBoxes { axis: "y", .. }
    ));
    let parts = |p: &[u32]| Decomposition::from_parts(&mesh, p).unwrap_err();
    assert_eq!(parts(&[0; 9]), DecompositionError::PartCount { given: 9, tets: 10 });
    let gap = [0, 0, 0, 0, 0, 2, 2, 2, 2, 2];
    assert_eq!(parts(&gap), DecompositionError::EmptyPart { part: 1, parts: 3 });
    let huge = [0, 0, 0, 0, 0, 0, 0, 0, 0, u32::MAX];
    assert!(matches!(parts(&huge), DecompositionError::EmptyPart { part: 1, .. }));
    let rigid = |nodes: Vec<u32>| Decomposition::whole(&mesh).with_rigid(vec![Rigid::Nodes(nodes)]);
    let nodes = mesh.points().len();
    let error = rigid(vec![0, nodes as u32]).unwrap_err();
    assert!(matches!(error, DecompositionError::RigidNode { node, nodes: n } if n == nodes && node as usize == n));
    let whole = Decomposition::whole(&mesh);
    let with = rigid(vec![3, 1, 3]).unwrap();
    let [elastic, rigid] = with.subdomains() else { panic!() };
    assert!(elastic == &whole.subdomains()[0] && rigid.is_rigid() && rigid.nodes == [1, 3]);
    assert!(with.copies(3).len() == 2 && with.copies(2).len() == 1 && with.parts() == whole.parts());
    assert_eq!(with.torn_dofs(), whole.torn_dofs() + 6);
    // The four corners of a cube touch only along edges.
    let corners = [1, 1, 1, 1, 0, 0, 0, 0, 0, 0];
    let error = parts(&corners);
    assert!(
        matches!(error, DecompositionError::DisconnectedPart { part: 0, pieces: 2, .. })
            || matches!(error, DecompositionError::DisconnectedPart { part: 1, .. }),
        "{error}"
    );
    let split = split_disconnected(&mesh, &corners).unwrap();
    assert!(Decomposition::from_parts(&mesh, &split).is_ok());
    assert!(split_disconnected(&mesh, &[0]).is_err());
}

#[test]
fn surfaces() {
    let mesh = brick();
    let error = |tags: &[FacetTag]| Surface::new(&mesh, tags).unwrap_err();
    assert_eq!(error(&[]), SurfaceError::NoTags);
    assert!(matches!(error(&[FacetTag(99)]), SurfaceError::UnknownTag { .. }));
    assert_eq!(
        error(&[FacetTag(99)]).to_string(),
        "no facet has tag 99; the mesh has the tags 1, 2, 3, 4, 5, 6"
    );
    assert_eq!(error(&[Z_MIN, Z_MIN]), SurfaceError::RepeatedTag { tag: Z_MIN });
    // Two tetrahedra that meet tip to tip: the normals around the common node cancel.
    let points = with(&[[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);
    let tips = TetMesh::new(points, vec![[0, 1, 2, 3], [0, 4, 6, 5]], vec![]).unwrap();
    let tips = tips.tag_boundary(|_, _| Some(FacetTag(1)));
    let error = Surface::new(&tips, &[FacetTag(1)]).unwrap_err();
    assert_eq!(error, SurfaceError::NoNormal { node: 0 });
}

#[test]
fn loads() {
    let mesh = brick();
    let parts = Decomposition::whole(&mesh);
    let error = |load: LoadDensity| assemble_load(&mesh, &parts, &load).unwrap_err();
    let nan = [0.0, f64::NAN, 0.0];
    assert!(matches!(error(LoadDensity::Body(nan)), LoadError::NotFinite { .. }));
    assert!(matches!(
        error(LoadDensity::Traction(Z_MIN, nan)),
        LoadError::NotFinite { .. }
    ));
    assert!(matches!(
        error(LoadDensity::Pressure(Z_MIN, f64::INFINITY)),
        LoadError::NotFinite { .. }
    ));
    let pole = LoadDensity::body_field(|[x, _, _]| [if x > 1.9 { f64::NAN } else { 0.0 }; 3]);
    assert!(matches!(error(pole), LoadError::NotFinite { place, .. } if place[0] > 1.9));
    assert!(matches!(
        error(LoadDensity::Force(Z_MIN, nan)),
        LoadError::NotFinite { .. }
    ));
    assert!(matches!(
        error(LoadDensity::Moment(Z_MIN, nan)),
        LoadError::NotFinite { .. }
    ));
    for missing in [
        LoadDensity::Traction(FacetTag(77), [1.0; 3]),
        LoadDensity::Force(FacetTag(77), [1.0; 3]),
        LoadDensity::Moment(FacetTag(77), [1.0; 3]),
    ] {
        assert!(matches!(
            error(missing),
            LoadError::UnknownTag { tag: FacetTag(77), .. }
        ));
    }
    let bare = TetMesh::new(mesh.points().to_vec(), mesh.tets().to_vec(), vec![]).unwrap();
    for (mesh, tags) in [(&mesh, "the tags 1, 2, 3, 4, 5, 6"), (&bare, "no tags")] {
        let load = LoadDensity::Pressure(FacetTag(77), 1.0);
        assert_eq!(
            assemble_load(mesh, &parts, &load).unwrap_err().to_string(),
            format!("a load is given on tag 77, but no facet has it; the mesh has {tags}")
        );
    }
    let nowhere = LoadDensity::NodalForces(vec![(99, [1.0; 3])]);
    assert_eq!(error(nowhere), LoadError::UnknownNode { node: 99, nodes: 12 });
    let other = Brick::new([1.0; 3], [1; 3]).build().unwrap();
    let foreign = assemble_load(&other, &parts, &LoadDensity::Body([1.0; 3])).unwrap_err();
    assert_eq!(
        foreign,
        LoadError::ForeignDecomposition {
            decomposed: 10,
            meshed: 5
        }
    );
}

#[test]
fn histories() {
    let error = |points: &[(f64, f64)]| History::table(points.to_vec()).unwrap_err();
    assert_eq!(error(&[]), HistoryError::Empty);
    assert!(matches!(
        error(&[(0.0, f64::NAN)]),
        HistoryError::NotFinite { index: 0, .. }
    ));
    assert!(matches!(
        error(&[(0.0, 0.0), (0.0, 1.0)]),
        HistoryError::NotIncreasing { index: 1, .. }
    ));
    assert!(matches!(
        error(&[(0.0, 0.0), (1.0, 1.0), (0.5, 1.0)]),
        HistoryError::NotIncreasing { index: 2, .. }
    ));
    assert!(matches!(
        History::ramp(0.0, 1.0),
        Err(HistoryError::NotIncreasing { .. })
    ));
    assert!(matches!(
        History::ramp(-1.0, 1.0),
        Err(HistoryError::NotIncreasing { .. })
    ));
}
