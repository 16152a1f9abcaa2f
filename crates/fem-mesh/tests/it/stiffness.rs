//! The element, the assembly and Hooke's law.

use approx::assert_abs_diff_eq;
use nalgebra::SMatrix;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use signorini_fem_mesh::decomposition::Subdomain;
use signorini_fem_mesh::fields::{strain_energy, stresses};
use signorini_fem_mesh::{Brick, Decomposition, Hooke, Materials, TetMesh, assemble_stiffness};
use sprs::{CsMat, TriMat};

/// A law without any symmetry beyond (2.8).
fn general_law() -> Hooke {
    let mut c = *Hooke::isotropic(100.0, 0.25).unwrap().voigt();
    for i in 0..6 {
        for j in 0..i {
            let extra = ((3 * i + 5 * j) % 7) as f64 - 3.0;
            c[i][j] += extra;
            c[j][i] += extra;
        }
    }
    Hooke::from_voigt(&c).unwrap()
}

fn brick() -> TetMesh {
    Brick::new([3.0, 1.0, 2.0], [4, 3, 3])
        .perturbed(0.15, 5)
        .build()
        .unwrap()
}

fn stiffness(mesh: &TetMesh, law: &Hooke) -> CsMat<f64> {
    assemble_stiffness(mesh.points(), mesh.tets(), |_| law).unwrap()
}

/// The stiffness of one tetrahedron.
fn element_stiffness(points: &[[f64; 3]; 4], law: &Hooke) -> SMatrix<f64, 12, 12> {
    let k = assemble_stiffness(points, &[[0, 1, 2, 3]], |_| law).unwrap();
    SMatrix::from_fn(|row, column| k.get(row, column).copied().unwrap_or(0.0))
}

fn times(k: &CsMat<f64>, u: &[f64]) -> Vec<f64> {
    let mut f = vec![0.0; u.len()];
    for (column, vector) in k.outer_iterator().enumerate() {
        vector.iter().for_each(|(row, value)| f[row] += value * u[column]);
    }
    f
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Nodal values of the affine displacement u = h x.
fn affine(mesh: &TetMesh, h: &[[f64; 3]; 3]) -> Vec<f64> {
    let row = |p: &[f64; 3], i: usize| (0..3).map(|j| h[i][j] * p[j]).sum::<f64>();
    mesh.points()
        .iter()
        .flat_map(|p| [row(p, 0), row(p, 1), row(p, 2)])
        .collect()
}

#[test]
fn isotropic_law_is_that_of_the_textbook() {
    let law = Hooke::isotropic(200.0, 0.3).unwrap();
    let uniaxial = law.stress(&[1e-3, -0.3e-3, -0.3e-3, 0.0, 0.0, 0.0]);
    assert!((uniaxial[0] - 0.2).abs() < 1e-14 && largest(&uniaxial[1..]) < 1e-14);
    let shear = law.stress(&[0.0, 0.0, 0.0, 1e-3, 0.0, 0.0]);
    assert_abs_diff_eq!(shear[3], 0.2 / 2.6, epsilon = 1e-14);
    // the largest eigenvalue is 3 K
    assert_abs_diff_eq!(law.bound(), 200.0 / 0.4, epsilon = 1e-10);
    assert_abs_diff_eq!(
        law.energy_density(&[1.0, -0.3, -0.3, 0.0, 0.0, 0.0]),
        100.0,
        epsilon = 1e-11
    );
}

#[test]
fn assembly_is_the_sum_of_elements() {
    let (mesh, law) = (brick(), general_law());
    let k = stiffness(&mesh, &law);
    let size = 3 * mesh.points().len();
    let mut triplets = TriMat::new((size, size));
    for (t, tet) in mesh.tets().iter().enumerate() {
        let element = element_stiffness(&mesh.tet_points(t), &law);
        for a in 0..12 {
            for b in 0..12 {
                let dof = |a: usize| 3 * tet[a / 3] as usize + a % 3;
                triplets.add_triplet(dof(a), dof(b), element[(a, b)]);
            }
        }
    }
    let expected: CsMat<f64> = triplets.to_csc();
    assert_eq!((k.indptr(), k.indices()), (expected.indptr(), expected.indices()));
    let scale = largest(expected.data());
    let difference: Vec<f64> = k.data().iter().zip(expected.data()).map(|(a, b)| a - b).collect();
    assert!(largest(&difference) < 1e-14 * scale);
}

#[test]
fn symmetric_bit_for_bit_and_free_of_thread_count() {
    let (mesh, law) = (brick(), general_law());
    let k = stiffness(&mesh, &law);
    let transposed = k.transpose_view().to_csc();
    assert_eq!(k.data(), transposed.data());
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| stiffness(&mesh, &law)), k);
    }
    let element = element_stiffness(&mesh.tet_points(3), &law);
    assert_eq!(element, element.transpose());
}

#[test]
fn rigid_motions_need_no_force() {
    let (mesh, law) = (brick(), general_law());
    let k = stiffness(&mesh, &law);
    let scale = largest(k.data());
    let spin = |a: [f64; 3]| [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]];
    for d in 0..3 {
        let mut axis = [0.0; 3];
        axis[d] = 1.0;
        let shift: Vec<f64> = mesh.points().iter().flat_map(|_| axis).collect();
        assert!(largest(&times(&k, &shift)) < 1e-13 * scale);
        assert!(largest(&times(&k, &affine(&mesh, &spin(axis)))) < 1e-13 * scale);
    }
}

#[test]
fn linear_patch() {
    let (mesh, law) = (brick(), general_law());
    let h = [[1e-3, 2e-3, -1e-3], [4e-3, -2e-3, 3e-3], [0.0, 1e-3, 5e-3]];
    let u = affine(&mesh, &h);
    let strain = [
        h[0][0],
        h[1][1],
        h[2][2],
        h[1][2] + h[2][1],
        h[0][2] + h[2][0],
        h[0][1] + h[1][0],
    ];
    let s = law.stress(&strain);
    let materials = Materials::from(law);
    for stress in stresses(&mesh, &materials, &u).unwrap() {
        (0..6).for_each(|i| assert!((stress[i] - s[i]).abs() < 1e-12 * largest(&s)));
    }
    let expected = law.energy_density(&strain) * mesh.total_volume();
    let energy = strain_energy(&mesh, &materials, &u).unwrap();
    assert_abs_diff_eq!(energy / expected, 1.0, epsilon = 1e-12);
    // K u: the tractions sigma n, a third of each triangle's force to its nodes, nothing inside.
    let f = times(&stiffness(&mesh, &law), &u);
    assert!((f.iter().zip(&u).map(|(f, u)| f * u).sum::<f64>() / (2.0 * expected) - 1.0).abs() < 1e-12);
    let sigma = [[s[0], s[5], s[4]], [s[5], s[1], s[3]], [s[4], s[3], s[2]]];
    let mut rest = f;
    for facet in 0..mesh.facets().len() {
        let [p, q, r] = mesh.facet_points(facet);
        let (a, b) = ([0, 1, 2].map(|i| q[i] - p[i]), [0, 1, 2].map(|i| r[i] - p[i]));
        let n = [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ];
        for node in mesh.facets()[facet].nodes {
            for i in 0..3 {
                let traction: f64 = (0..3).map(|j| sigma[i][j] * n[j]).sum();
                rest[3 * node as usize + i] -= traction / 6.0;
            }
        }
    }
    assert!(largest(&rest) < 1e-12 * largest(&s));
}

#[test]
fn subdomains_add_up_to_the_whole() {
    let mesh = brick();
    let regions = mesh.tets().iter().map(|t| t[0] % 2).collect();
    let mesh = mesh.with_regions(regions).unwrap();
    let laws = vec![(0, general_law()), (1, Hooke::isotropic(5.0, 0.1).unwrap())];
    let materials = Materials::new(laws).unwrap();
    let whole = Decomposition::whole(&mesh);
    let laws = materials.of_tets(mesh.regions()).unwrap();
    let stiffness = |subdomain: &Subdomain| {
        let law = |tet: usize| laws[subdomain.elements[tet] as usize];
        assemble_stiffness(&subdomain.points(&mesh), &subdomain.tets, law).unwrap()
    };
    let k = stiffness(&whole.subdomains()[0]);
    let parts = Decomposition::boxes(&mesh, [2, 1, 3]).unwrap();
    let mut sum = TriMat::new(k.shape());
    for subdomain in parts.subdomains() {
        let local = stiffness(subdomain);
        for (&value, (row, column)) in &local {
            let dof = |d: usize| 3 * subdomain.nodes[d / 3] as usize + d % 3;
            sum.add_triplet(dof(row), dof(column), value);
        }
    }
    let sum: CsMat<f64> = sum.to_csc();
    let scale = largest(k.data());
    let difference: Vec<f64> = k.data().iter().zip(sum.data()).map(|(a, b)| a - b).collect();
    assert_eq!(k.indices(), sum.indices());
    assert!(largest(&difference) < 1e-14 * scale);
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        rng_seed: RngSeed::Fixed(2),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// With a general elliptic law (a random square plus the identity) the element has six zero
    /// eigenvalues and six positive ones.
    #[test]
    fn element_has_six_rigid_motions(
        entries in prop::array::uniform32(-1.0f64..1.0),
        shift in prop::array::uniform12(-0.2f64..0.2),
    ) {
        let a = |i: usize, j: usize| entries[(6 * i + j) % 32];
        let mut c = [[0.0; 6]; 6];
        for i in 0..6 {
            for j in 0..6 {
                c[i][j] = (0..6).map(|k| a(i, k) * a(j, k)).sum::<f64>() + f64::from(i == j);
            }
        }
        let law = Hooke::from_voigt(&c).unwrap();
        let mut points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for n in 0..12 {
            points[n / 3][n % 3] += shift[n];
        }
        let k = element_stiffness(&points, &law);
        let mut eigenvalues: Vec<f64> = k.symmetric_eigenvalues().iter().copied().collect();
        eigenvalues.sort_by(f64::total_cmp);
        prop_assert!(eigenvalues[5].abs() < 1e-12 * eigenvalues[11]);
        prop_assert!(eigenvalues[0] > -1e-12 * eigenvalues[11]);
        prop_assert!(eigenvalues[6] > 1e-6 * eigenvalues[11]);
    }
}
