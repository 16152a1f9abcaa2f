//! The number of subdomains changes nothing: direct solve, 1, 3 and 24 subdomains.

use crate::common::*;
use signorini_fem_mesh::assemble_stiffness;

const BOXES: [[usize; 3]; 3] = [[1, 1, 1], [3, 1, 1], [6, 2, 2]];

fn meshes() -> [TetMesh; 2] {
    let shape = Brick::new([3.0, 1.0, 1.0], [12, 4, 4]);
    [
        shape.build().expect("brick"),
        shape.perturbed(0.15, 5).build().expect("brick"),
    ]
}

/// Displacements of the loaded brick by a dense Cholesky factor of the supported stiffness matrix.
fn direct(mesh: &TetMesh) -> Vec<f64> {
    let hooke = Hooke::isotropic(211.9e9, 0.277).expect("Hooke");
    let whole = Decomposition::whole(mesh);
    let mut force = vec![0.0; 3 * mesh.points().len()];
    for (tag, traction) in [(brick::Z_MAX, [0.0, 0.0, -30e8]), (brick::X_MAX, [9e8, 0.0, -15e8])] {
        let local = assemble_load(mesh, &whole, &LoadDensity::Traction(tag, traction));
        for (f, l) in force.iter_mut().zip(&local.expect("load")[0]) {
            *f += l;
        }
    }
    let fixed = mesh.nodes_on(brick::X_MIN);
    let free: Vec<usize> = (0..force.len())
        .filter(|i| !fixed.contains(&((i / 3) as u32)))
        .collect();
    let mut place = vec![usize::MAX; force.len()];
    for (k, &i) in free.iter().enumerate() {
        place[i] = k;
    }
    let mut matrix = vec![vec![0.0; free.len()]; free.len()];
    for (&value, (i, j)) in assemble_stiffness(mesh.points(), mesh.tets(), |_| &hooke)
        .expect("stiffness")
        .iter()
    {
        if place[i] != usize::MAX && place[j] != usize::MAX {
            matrix[place[i]][place[j]] += value;
        }
    }
    let right: Vec<f64> = free.iter().map(|&i| force[i]).collect();
    let x = cholesky_solve(matrix, &right);
    let mut u = vec![0.0; force.len()];
    for (&i, v) in free.iter().zip(x) {
        u[i] = v;
    }
    u
}

#[test]
fn without_contact_any_decomposition_equals_the_direct_solution() {
    for (k, mesh) in meshes().into_iter().enumerate() {
        let exact = direct(&mesh);
        for boxes in BOXES {
            for preconditioner in [Preconditioner::Lumped, Preconditioner::Dirichlet] {
                let scene = loaded_brick(mesh.clone(), ramp()).with_boxes(boxes);
                // the tolerance is that of the certificate here
                let settings = at(1e-8).with_tolerance(1e-10);
                let result = solve(scene, settings.with_preconditioner(preconditioner));
                let what = format!("mesh {k}, {boxes:?}, {preconditioner:?}");
                assert_close(&result.displacement, &exact, 1e-9, &what);
            }
        }
    }
}

fn compare(scene: &Scene, what: &str) {
    let mut first: Option<Vec<(Vec<f64>, Vec<f64>)>> = None;
    for boxes in BOXES {
        let (_, results) = run(scene.clone().with_boxes(boxes), at(1e-8));
        let last = results.last().expect("steps");
        assert!(last.summary.active > 0, "{what}: nothing touches");
        let found: Vec<_> = results
            .iter()
            .map(|l| (l.displacement.clone(), forces(&l.points)))
            .collect();
        let Some(reference) = &first else {
            first = Some(found);
            continue;
        };
        for (k, (a, b)) in found.iter().zip(reference).enumerate() {
            assert_close(&a.0, &b.0, 1e-7, &format!("{what}, {boxes:?}, step {k}: u"));
            assert_close(&a.1, &b.1, 1e-7, &format!("{what}, {boxes:?}, step {k}: forces"));
        }
    }
}

#[test]
fn with_contact_and_friction_1_3_and_24_subdomains_agree() {
    for (k, mesh) in meshes().into_iter().enumerate() {
        for friction in [
            Friction::None,
            Friction::tresca(2e8),
            Friction::coulomb(0.3),
            weakening(),
        ] {
            let what = format!("mesh {k}, {friction:?}");
            let scene = loaded_brick(mesh.clone(), up_down_up())
                .with_contact(foundation(friction))
                .with_analysis(paper_steps(1.0, 5));
            compare(&scene, &what);
        }
    }
}

/// The regions of a heterogeneous body do not follow the subdomains.
#[test]
fn two_materials_agree() {
    let mesh = block([3.0, 1.0, 1.0], [12, 4, 4]);
    let regions = (0..mesh.tets().len())
        .map(|t| u32::from(mesh.tet_points(t).iter().all(|p| p[2] > 0.49)))
        .collect();
    let soft = Hooke::isotropic(100e9, 0.3).expect("Hooke");
    let hard = Hooke::isotropic(300e9, 0.2).expect("Hooke");
    let materials = Materials::new(vec![(0, soft), (1, hard)]).expect("materials");
    assert_ne!(format!("{materials:?}"), format!("{:?}", steel()));
    let mesh = mesh.with_regions(regions).expect("regions");
    let scene = Scene::new(mesh, materials)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [1e8, 0.0, -30e8]))
        .with_contact(foundation(Friction::coulomb(0.3)));
    compare(&scene, "two materials");
}
