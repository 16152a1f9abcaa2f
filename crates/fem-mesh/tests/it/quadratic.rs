//! Meshes of order 2: tables, elements, loads, means, checks.

use crate::norms::{energy_of_error, l2_error};
use signorini_fem_mesh::brick::{Brick, SIDES, X_MIN, Z_MAX, Z_MIN};
use signorini_fem_mesh::fields::{nodal_stresses, strain_energy, strains, stresses};
use signorini_fem_mesh::mesh::{drop_unused_nodes, merge_nodes, orient_tets};
use signorini_fem_mesh::{
    Decomposition, Eigenstrain, FacetTag, Hooke, LoadDensity, Materials, MeshError, Surface, TetMesh,
    assemble_eigenstrain, assemble_load, assemble_stiffness,
};

/// A perturbed block, straight.
fn block() -> TetMesh {
    let mesh = Brick::new([2.0, 1.0, 1.0], [4, 2, 2])
        .perturbed(0.15, 7)
        .build()
        .unwrap();
    mesh.raise_order().unwrap()
}

/// The same bent, so that most edges are curved.
fn bent() -> TetMesh {
    let bend = |[x, y, z]: [f64; 3]| [x + 0.1 * z * z, y + 0.05 * (2.0 * x).sin(), z + 0.1 * x * y];
    block().map_points(bend).unwrap()
}

fn steel() -> Materials {
    Materials::uniform(Hooke::isotropic(10.0, 0.3).unwrap())
}

fn nodal(mesh: &TetMesh, u: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    mesh.points().iter().flat_map(|&p| u(p)).collect()
}

/// `u . K v`
fn form(mesh: &TetMesh, u: &[f64], v: &[f64]) -> f64 {
    let law = Hooke::isotropic(10.0, 0.3).unwrap();
    let k = assemble_stiffness(mesh.points(), &mesh.quadratic_tets(), |_| &law).unwrap();
    let product = |(value, (row, column)): (&f64, (usize, usize))| u[row] * value * v[column];
    k.iter().map(product).sum()
}

fn close(a: f64, b: f64, size: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * size.abs(), "{a:e} {b:e}");
}

#[test]
fn every_edge_gets_one_node() {
    let linear = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).build().unwrap();
    let mesh = linear.raise_order().unwrap();
    assert_eq!((linear.order(), mesh.order(), linear.mids().len()), (1, 2, 0));
    assert_eq!(mesh.raise_order().unwrap(), mesh);
    // Euler: nodes - edges + faces - tetrahedra = 1
    let faces = (4 * mesh.tets().len() + mesh.boundary_facets().len()) / 2;
    let corners = linear.points().len();
    assert_eq!(corners + faces - 1, mesh.points().len() - corners + mesh.tets().len());
    for (tet, mids) in mesh.tets().iter().zip(mesh.mids()) {
        for (k, (a, b)) in [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)].into_iter().enumerate() {
            let [p, q, m] = [tet[a], tet[b], mids[k]].map(|n| mesh.points()[n as usize]);
            (0..3).for_each(|c| assert!((p[c] + q[c] - 2.0 * m[c]).abs() < 1e-14));
        }
    }
    close(mesh.total_volume(), 2.0, 2.0, 1e-13);
    // 5 x 5 corners and mid-nodes of the grid, and one on each of 4 diagonals
    assert_eq!(mesh.nodes_on(X_MIN).len(), 25);
    assert!(
        mesh.nodes_on(X_MIN)
            .iter()
            .all(|&n| mesh.points()[n as usize][0] == 0.0)
    );
    for facet in 0..mesh.facets().len() {
        let (corners, mids) = (mesh.facet_points(facet), mesh.facet_mids(facet).unwrap());
        for k in 0..3 {
            let middle = mesh.points()[mids[k] as usize];
            (0..3).for_each(|c| assert!((corners[k][c] + corners[(k + 1) % 3][c] - 2.0 * middle[c]).abs() < 1e-14));
        }
    }
    assert_eq!([linear.facet_mids(0), mesh.facet_mids(usize::MAX)], [None; 2]);
    let again = TetMesh::quadratic(mesh.points().to_vec(), mesh.quadratic_tets(), mesh.facets().to_vec());
    assert_eq!(again.unwrap(), mesh);
}

#[test]
fn subdomains_have_mid_nodes_and_translates_the_same_tables() {
    let mesh = Brick::new([2.0, 1.0, 1.0], [4, 2, 2])
        .build()
        .unwrap()
        .raise_order()
        .unwrap();
    let parts = Decomposition::boxes(&mesh, [2, 1, 1]).unwrap();
    let [a, b] = parts.subdomains() else {
        panic!("two boxes")
    };
    assert_eq!((a.tets.clone(), a.mids.clone()), (b.tets.clone(), b.mids.clone()));
    assert_eq!(
        a.nodes.len(),
        a.quadratic_tets().iter().flatten().max().unwrap().to_owned() as usize + 1
    );
    for (local, &element) in a.quadratic_tets().iter().zip(&a.elements) {
        let global = mesh.quadratic_tets()[element as usize];
        assert_eq!(local.map(|n| a.nodes[n as usize]), global);
    }
    // copies: all nodes at x = 1
    let shared = (0..mesh.points().len()).filter(|&n| parts.copies(n).len() == 2);
    assert_eq!(shared.count(), 25);
}

#[test]
fn stiffness_is_exact_for_quadratic_displacements_on_straight_edges() {
    let mesh = block();
    let u = nodal(&mesh, |[x, y, z]| [x * x + y * z, x * y - z * z, z * x + 0.5 * y * y]);
    let v = nodal(&mesh, |[x, y, z]| [y * y, x * z + x * x, x * y]);
    // by quadrature of degree 5 of the exact strains: energies of the difference from nothing
    let zero = vec![0.0; u.len()];
    let gradient_u = |[x, y, z]: [f64; 3]| [[2.0 * x, z, y], [y, x, -2.0 * z], [z, y, x]];
    let gradient_v = |[x, y, z]: [f64; 3]| [[0.0, 2.0 * y, 0.0], [z + 2.0 * x, 0.0, x], [y, x, 0.0]];
    let of_u = energy_of_error(&mesh, &steel(), &zero, gradient_u).unwrap();
    let of_v = energy_of_error(&mesh, &steel(), &zero, gradient_v).unwrap();
    close(0.5 * form(&mesh, &u, &u), of_u, of_u, 1e-12);
    close(0.5 * form(&mesh, &v, &v), of_v, of_v, 1e-12);
    close(strain_energy(&mesh, &steel(), &u).unwrap(), of_u, of_u, 1e-12);
    assert!(energy_of_error(&mesh, &steel(), &u, gradient_u).unwrap() < 1e-24 * of_u);
    assert!(l2_error(&mesh, &v, |[x, y, z]| [y * y, x * z + x * x, x * y]).unwrap() < 1e-13);
    // a linear strain has its mean at the centroid, and is the same from all tetrahedra around a node
    let centre = mesh
        .tet_points(3)
        .iter()
        .fold([0.0; 3], |s, p| [0, 1, 2].map(|c| s[c] + p[c] / 4.0));
    close(strains(&mesh, &u).unwrap()[3][0], 2.0 * centre[0], 1.0, 1e-12);
    let nodal = nodal_stresses(&mesh, &steel(), &u).unwrap();
    let law = Hooke::isotropic(10.0, 0.3).unwrap();
    for (&[x, y, z], stress) in mesh.points().iter().zip(nodal) {
        let exact = law.stress(&[2.0 * x, x, x, y - 2.0 * z, y + z, z + y]);
        (0..6).for_each(|i| close(stress[i], exact[i], 40.0, 1e-12));
    }
    let linear = Brick::new([1.0; 3], [2; 3]).build().unwrap();
    let u: Vec<f64> = linear
        .points()
        .iter()
        .flat_map(|p| [p[0] * p[1], 0.0, p[2] * p[2]])
        .collect();
    let averages = signorini_fem_mesh::fields::nodal_average(&linear, &stresses(&linear, &steel(), &u).unwrap());
    assert_eq!(nodal_stresses(&linear, &steel(), &u).unwrap(), averages.unwrap());
}

#[test]
fn curved_elements_know_rigid_and_linear_displacements() {
    let mesh = bent();
    assert!(mesh.total_volume() > 1.9 && mesh != block());
    for (rigid, size) in [
        (nodal(&mesh, |_| [1.0, 2.0, 3.0]), 1.0),
        (nodal(&mesh, |[x, y, z]| [z - y, x - z, y - x]), 1.0),
    ] {
        assert!(form(&mesh, &rigid, &rigid).abs() < 1e-12 * size);
    }
    let u = nodal(&mesh, |[x, y, z]| [x + 2.0 * y, 0.5 * z - y, x - z]);
    for strain in strains(&mesh, &u).unwrap() {
        let exact = [1.0, -1.0, -1.0, 0.5, 1.0, 2.0];
        (0..6).for_each(|i| close(strain[i], exact[i], 1.0, 1e-11));
    }
    let energy = Hooke::isotropic(10.0, 0.3)
        .unwrap()
        .energy_density(&[1.0, -1.0, -1.0, 0.5, 1.0, 2.0]);
    let volume = mesh.total_volume();
    let found = strain_energy(&mesh, &steel(), &u).unwrap();
    close(found, 0.5 * form(&mesh, &u, &u), found, 1e-12);
    // four points for volumes of degree three: not to the last digit
    close(found, energy * volume, found, 1e-4);
}

/// Nearly incompressible: energy and stiffness agree, uniform strains are exact, and a bending that keeps the volume
/// only in the mean costs no volume energy.
#[test]
fn volume_strains_are_means_near_incompressibility() {
    let law = Hooke::isotropic(10.0, 0.4999).unwrap();
    assert!(law.is_nearly_incompressible() && (law.poisson().unwrap() - 0.4999).abs() < 1e-12);
    assert_eq!(
        law.compressible()
            .and_then(|l| l.poisson())
            .map(|p| (p - 0.4).abs() < 1e-12),
        Some(true)
    );
    assert!(!Hooke::isotropic(10.0, 0.4).unwrap().is_nearly_incompressible());
    let mut skew = *law.voigt();
    skew[3][3] *= 1.1;
    assert_eq!(Hooke::from_voigt(&skew).unwrap().poisson(), None);
    let materials = Materials::uniform(law);
    for mesh in [block(), bent()] {
        let u = nodal(&mesh, |[x, y, z]| [x * x - y, 0.3 * z * z + x, y * z + x * z]);
        let k = assemble_stiffness(mesh.points(), &mesh.quadratic_tets(), |_| &law).unwrap();
        let product = |(value, (row, column)): (&f64, (usize, usize))| u[row] * value * u[column];
        let energy = strain_energy(&mesh, &materials, &u).unwrap();
        close(energy, 0.5 * k.iter().map(product).sum::<f64>(), energy, 1e-12);
        let linear = nodal(&mesh, |[x, y, z]| [x + y, y - z, z]);
        for stress in stresses(&mesh, &materials, &linear).unwrap() {
            let exact = law.stress(&[1.0, 1.0, 1.0, -1.0, 0.0, 1.0]);
            (0..6).for_each(|i| close(stress[i], exact[i], exact[0], 1e-10));
        }
    }
    // div u = 2 (x - centre) in each tetrahedron alone
    let mesh = TetMesh::new(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        vec![[0, 1, 2, 3]],
        Vec::new(),
    );
    let mesh = mesh.unwrap().raise_order().unwrap();
    let u = nodal(&mesh, |[x, _, _]| [x * x - 0.5 * x, 0.0, 0.0]);
    let shear = 2.0 * 10.0 / (2.0 * 1.4999);
    let energy = strain_energy(&mesh, &materials, &u).unwrap();
    // 1/2 2 mu (2/3) e_xx^2, and (2 x - 1/2)^2 has the integral 1/40
    close(energy, 0.5 * shear * 2.0 / 3.0 / 40.0, energy, 1e-10);
}

#[test]
fn loads_do_the_work_of_quadratic_displacements() {
    let mesh = block();
    let parts = Decomposition::whole(&mesh);
    let work = |load: LoadDensity, u: &dyn Fn([f64; 3]) -> f64| -> [f64; 3] {
        let force = &assemble_load(&mesh, &parts, &load).unwrap()[0];
        let mut sum = [0.0; 3];
        for (f, &p) in force.chunks_exact(3).zip(mesh.points()) {
            (0..3).for_each(|c| sum[c] += f[c] * u(p));
        }
        sum
    };
    // over [0, 2] x [0, 1]^2: of 1, x y, z z
    for (u, volume, top) in [
        (&(|_: [f64; 3]| 1.0) as &dyn Fn([f64; 3]) -> f64, 2.0, 2.0),
        (&|p: [f64; 3]| p[0] * p[1], 1.0, 1.0),
        (&|p: [f64; 3]| p[0] * p[0], 8.0 / 3.0, 8.0 / 3.0),
    ] {
        let body = work(LoadDensity::Body([1.0, 2.0, 3.0]), u);
        (0..3).for_each(|c| close(body[c], (c + 1) as f64 * volume, 8.0, 1e-13));
        let traction = work(LoadDensity::Traction(Z_MAX, [1.0, 2.0, 3.0]), u);
        (0..3).for_each(|c| close(traction[c], (c + 1) as f64 * top, 8.0, 1e-13));
        close(work(LoadDensity::Pressure(Z_MAX, 3.0), u)[2], -3.0 * top, 8.0, 1e-13);
        close(
            work(LoadDensity::Force(Z_MAX, [0.0, 0.0, 5.0]), u)[2],
            2.5 * top,
            8.0,
            1e-13,
        );
        close(
            work(LoadDensity::body_field(|p| [p[2], 0.0, 0.0]), u)[0],
            0.5 * volume,
            8.0,
            1e-13,
        );
        let along = LoadDensity::traction_field(Z_MAX, |p, n| [p[1] * p[1], 0.0, n[2]]);
        close(work(along, u)[2], top, 8.0, 1e-13);
    }
    // constant: nothing at corners
    let force = &assemble_load(&mesh, &parts, &LoadDensity::Pressure(Z_MAX, 1.0)).unwrap()[0];
    let corners: std::collections::BTreeSet<u32> = mesh.tets().iter().flatten().copied().collect();
    assert!(corners.iter().all(|&n| force[3 * n as usize + 2].abs() < 1e-16));
}

#[test]
fn pressure_on_a_closed_curved_surface_has_no_sum() {
    let mesh = bent();
    let parts = Decomposition::boxes(&mesh, [2, 1, 1]).unwrap();
    let (mut sum, mut moment) = ([0.0; 3], 0.0);
    for tag in SIDES.into_iter().flatten() {
        for (part, forces) in parts
            .subdomains()
            .iter()
            .zip(assemble_load(&mesh, &parts, &LoadDensity::Pressure(tag, 1.0)).unwrap())
        {
            for (f, p) in forces.chunks_exact(3).zip(part.points(&mesh)) {
                (0..3).for_each(|c| sum[c] += f[c]);
                moment += f[0] * p[1] - f[1] * p[0];
            }
        }
    }
    assert!(
        sum.iter().all(|s| s.abs() < 1e-13) && moment.abs() < 1e-13,
        "{sum:?} {moment}"
    );
    let force = assemble_load(&mesh, &parts, &LoadDensity::Force(Z_MIN, [4.0, 0.0, 0.0])).unwrap();
    close(force.iter().flatten().sum(), 4.0, 4.0, 1e-13);
}

/// Area A, half the sum of hat and dual function: the node itself A/12, other corners -A/24, mid-nodes beside it A/6,
/// the one opposite nothing; sum A/3. On curved facets the dual function is found anew: the mean of a hat function is
/// half of its mean with the hat function of the node, and half of its value there.
#[test]
fn means_have_the_weights_of_hat_and_dual_functions() {
    let mesh = block();
    let surface = Surface::new(&mesh, &[Z_MIN]).unwrap();
    let linear = Brick::new([2.0, 1.0, 1.0], [4, 2, 2])
        .perturbed(0.15, 7)
        .build()
        .unwrap();
    let straight = Surface::new(&linear, &[Z_MIN]).unwrap();
    assert_eq!(
        (surface.nodes(), surface.triangles()),
        (straight.nodes(), straight.triangles())
    );
    for (a, b) in surface.areas().iter().zip(straight.areas()) {
        close(*a, *b, 1.0, 1e-15);
    }
    let all = || 0..surface.triangles().len();
    for local in 0..surface.nodes().len() {
        let mean = surface.mean(local, all());
        assert_eq!(straight.mean(local, all()), [(surface.nodes()[local], 1.0)]);
        assert_eq!(mean[0].0, surface.nodes()[local]);
        let mut expected = std::collections::BTreeMap::new();
        for (&facet, triangle) in surface.facets().iter().zip(surface.triangles()) {
            let Some(own) = triangle.iter().position(|&n| n as usize == local) else {
                continue;
            };
            let area = 3.0
                * surface
                    .corner(&mesh, all().find(|&t| surface.facets()[t] == facet).unwrap(), own)
                    .0;
            let nodes = mesh.facets()[facet as usize].nodes;
            let mids = mesh.facet_mids(facet as usize).unwrap();
            for k in 0..3 {
                let corner = if k == own { area / 12.0 } else { -area / 24.0 };
                *expected.entry(nodes[k]).or_insert(0.0) += corner / surface.areas()[local];
                if k != (own + 1) % 3 {
                    *expected.entry(mids[k]).or_insert(0.0) += area / 6.0 / surface.areas()[local];
                }
            }
        }
        assert_eq!(mean.len(), expected.len());
        mean.iter().for_each(|(n, w)| close(*w, expected[n], 1.0, 1e-14));
    }
    let bent = bent();
    let surface = Surface::new(&bent, &[Z_MIN]).unwrap();
    for (t, triangle) in surface.triangles().iter().enumerate() {
        let facet = surface.facets()[t] as usize;
        let (nodes, mids) = (bent.facets()[facet].nodes, bent.facet_mids(facet).unwrap());
        let areas = [0, 1, 2].map(|corner| surface.corner(&bent, t, corner).0);
        for own in 0..3 {
            let mean = surface.mean(triangle[own] as usize, std::iter::once(t));
            let at = |node: u32| mean.iter().filter(|m| m.0 == node).map(|m| m.1).sum::<f64>();
            // of the hat function of each corner: one there, a half at the mid-nodes beside it
            let hat = |k: usize| at(nodes[k]) + 0.5 * (at(mids[k]) + at(mids[(k + 2) % 3]));
            let other = [hat((own + 1) % 3), hat((own + 2) % 3)];
            close(hat(own) + other[0] + other[1], 1.0, 1.0, 1e-14);
            // symmetric: int l_i l_j is the same from either side
            let there = surface.mean(triangle[(own + 1) % 3] as usize, std::iter::once(t));
            let from = |node: u32| there.iter().filter(|m| m.0 == node).map(|m| m.1).sum::<f64>();
            let back = from(nodes[own]) + 0.5 * (from(mids[own]) + from(mids[(own + 2) % 3]));
            close(areas[own] * other[0], areas[(own + 1) % 3] * back, areas[own], 1e-14);
        }
    }
    let force = assemble_load(&bent, &Decomposition::whole(&bent), &LoadDensity::Pressure(Z_MIN, 1.0)).unwrap();
    // hats sum to one: so do integrals of normals
    let sum = (0..surface.triangles().len()).flat_map(|t| (0..3).map(move |k| (t, k)));
    let normal: f64 = sum.map(|(t, k)| surface.corner(&bent, t, k).1[2]).sum();
    let total: f64 = force[0].chunks_exact(3).map(|f| f[2]).sum();
    close(-normal, total, total, 1e-13);
}

#[test]
fn meshes_are_joined_moved_and_repaired_with_their_mid_nodes() {
    let mesh = block();
    let other = mesh
        .map_points(|[x, y, z]| [x, y, z + 1.0])
        .unwrap()
        .map_tags(|t| FacetTag(t.0 + 10));
    let both = mesh.append(&other).unwrap();
    assert_eq!(both.mids().len(), both.tets().len());
    let nodes = mesh.points().len() as u32;
    assert_eq!(both.mids()[mesh.tets().len()], mesh.mids()[0].map(|n| n + nodes));
    let linear = Brick::new([1.0; 3], [1; 3]).build().unwrap();
    assert_eq!(
        mesh.append(&linear).unwrap_err(),
        MeshError::MixedOrder { first: 2, second: 1 }
    );
    // one body of two
    let cube = linear.raise_order().unwrap();
    let far = cube.map_points(|[x, y, z]| [1.0 - x, y, z + 1.0]);
    assert!(matches!(far, Err(MeshError::InvertedTet { .. })));
    let above = cube.map_points(|[x, y, z]| [1.0 - y, x, z + 1.0]).unwrap();
    let both = cube.append(&above).unwrap();
    let (mut points, mut tets) = (both.points().to_vec(), both.quadratic_tets());
    assert_eq!(merge_nodes(&points, &mut tets, &mut [], 1e-9), 9);
    drop_unused_nodes(&mut points, &mut tets, &mut []);
    // the same in a mirror, repaired
    let mut mirrored: Vec<_> = points.iter().map(|[x, y, z]| [-x, *y, *z]).collect();
    assert_eq!(orient_tets(&mirrored, &mut tets.clone()), 10);
    let one = TetMesh::quadratic(points, tets.clone(), Vec::new()).unwrap();
    assert!(!one.components().contains(&1));
    orient_tets(&mirrored, &mut tets);
    assert!(TetMesh::quadratic(mirrored.clone(), tets.clone(), Vec::new()).is_ok());
    mirrored.push([0.5; 3]);
    assert!(matches!(
        TetMesh::quadratic(mirrored, tets, Vec::new()),
        Err(MeshError::DanglingNode { .. })
    ));
}

/// A change of points and tetrahedra.
type Change<'a> = &'a dyn Fn(&mut Vec<[f64; 3]>, &mut Vec<[u32; 10]>);

#[test]
fn faults_of_mid_nodes_name_the_element() {
    let mesh = Brick::new([1.0; 3], [1; 3]).build().unwrap().raise_order().unwrap();
    let build = |change: Change<'_>| {
        let (mut points, mut tets) = (mesh.points().to_vec(), mesh.quadratic_tets());
        change(&mut points, &mut tets);
        TetMesh::quadratic(points, tets, Vec::new()).unwrap_err()
    };
    let tet = mesh.quadratic_tets()[2];
    let error = build(&|_, tets| tets[2].swap(8, 9));
    assert!(
        matches!(error, MeshError::MidNodesOfEdge { .. } | MeshError::MidNodeTwice { .. }),
        "{error}"
    );
    let error = build(&|_, tets| tets[2][5] = tets[2][0]);
    assert_eq!(error, MeshError::MidNodeCorner { tet: 2, node: tet[0] });
    let error = build(&|_, tets| tets[2][5] = 999);
    assert!(matches!(error, MeshError::NodeOutOfRange { tet: 2, node: 999, .. }));
    let error = build(&|points, _| points[tet[4] as usize] = [0.1, 0.45, 0.7]);
    assert!(
        matches!(error, MeshError::MidNodeOff { node, .. } if node == tet[4]),
        "{error}"
    );
    // one tetrahedron that is bent into itself, with no mid-node far off
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.2]];
    let mut points = points.to_vec();
    for (a, b) in [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)] {
        let [p, q]: [[f64; 3]; 2] = [points[a], points[b]];
        points.push([0, 1, 2].map(|c| 0.5 * (p[c] + q[c])));
    }
    points[4][2] = 0.2;
    let error = TetMesh::quadratic(points, vec![std::array::from_fn(|k| k as u32)], Vec::new()).unwrap_err();
    assert!(
        matches!(error, MeshError::CurvedInside { tet: 0, least, .. } if least < 0.0),
        "{error}"
    );
}

/// A fold between the nodes of an edge is seen.
#[test]
fn a_fold_within_an_edge_is_a_fault() {
    let mut points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    points.extend([[0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.0]]);
    points.extend([[0.0, -0.15, 0.7], [0.5, 0.0, 0.5], [-0.15, 0.3, 0.3]]);
    let error = TetMesh::quadratic(points, vec![[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]], Vec::new()).unwrap_err();
    assert!(
        matches!(error, MeshError::CurvedInside { least, .. } if least < -0.05),
        "{error}"
    );
}

/// Forces of an eigenstrain are the slope of the energy with it: `E(u) = u K u / 2 - f u + E(0)`, straight or curved,
/// nearly incompressible or not.
#[test]
fn eigenstrains_load_by_the_slope_of_the_energy() {
    let linear = Brick::new([2.0, 1.0, 1.0], [4, 2, 2])
        .perturbed(0.1, 3)
        .build()
        .unwrap();
    for mesh in [linear, block(), bent()] {
        for poisson in [0.3, 0.4999] {
            let law = Hooke::isotropic(10.0, poisson).unwrap();
            let factors = mesh.points().iter().map(|[x, y, z]| 1.0 + x * y - z).collect();
            let free = Eigenstrain::new([3.0, 1.0, -1.0, 0.5, 0.2, 0.1]).with_factors(factors);
            let materials = Materials::uniform(law);
            let force = assemble_eigenstrain(&mesh, &Decomposition::whole(&mesh), &materials, &free).unwrap();
            let with = materials.clone().with_eigenstrain(2.0, free);
            let u = nodal(&mesh, |[x, y, z]| [x * x - y, 0.3 * z * z + x, y * z + x * z]);
            let zero = vec![0.0; u.len()];
            let work: f64 = force[0].iter().zip(&u).map(|(f, u)| f * u).sum();
            let energy = |m: &Materials, u: &[f64]| strain_energy(&mesh, m, u).unwrap();
            let change = energy(&with, &u) - energy(&with, &zero);
            close(change, energy(&materials, &u) - 2.0 * work, energy(&with, &u), 1e-12);
        }
    }
}

/// Stress at the nodes is that of the strain that is not free.
#[test]
fn nodal_stresses_know_of_eigenstrains() {
    let law = Hooke::isotropic(10.0, 0.3).unwrap();
    let linear = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).build().unwrap();
    for mesh in [linear, block()] {
        let free = [3.0, 1.0, -1.0, 0.5, 0.2, 0.1];
        let materials = Materials::uniform(law).with_eigenstrain(0.5, Eigenstrain::new(free));
        let u = nodal(&mesh, |[x, y, z]| [x, y, z]);
        let exact = law.stress(&[1.0 - 1.5, 1.0 - 0.5, 1.0 + 0.5, -0.25, -0.1, -0.05]);
        for stress in nodal_stresses(&mesh, &materials, &u).unwrap() {
            (0..6).for_each(|i| close(stress[i], exact[i], 10.0, 1e-12));
        }
    }
}
