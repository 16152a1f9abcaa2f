//! Effectivity of the estimated discretisation error: estimated over true error in the energy norm.

use crate::norms::energy_of_error;
use approx::assert_abs_diff_eq;
use signorini_fem_mesh::fields::energy_of_difference;
use signorini_fem_mesh::recovery::{StrainRecovery, discretisation_error};
use signorini_fem_mesh::{Brick, Hooke, LoadDensity, Materials, TetMesh};

/// u = s(x) (1, -1, 0.5) with s = sin x sin y sin z, interpolated at the nodes. The energy error of the
/// interpolant is of the order of the finite element solution's.
fn smooth(p: [f64; 3]) -> [f64; 3] {
    let s: f64 = p.iter().map(|x| (2.0 * x).sin()).product();
    [s, -s, 0.5 * s]
}

fn gradient(p: [f64; 3]) -> [[f64; 3]; 3] {
    let g: [f64; 3] = std::array::from_fn(|d| {
        let term = |k: usize| {
            if k == d { 2.0 * (2.0 * p[k]).cos() } else { (2.0 * p[k]).sin() }
        };
        (0..3).map(term).product()
    });
    [g, g.map(|v| -v), g.map(|v| 0.5 * v)]
}

fn material() -> Materials {
    Materials::uniform(Hooke::isotropic(1000.0, 0.3).expect("Hooke"))
}

/// The finite element solution with prescribed boundary values and the body force of `smooth`, by
/// plain conjugate gradients of the test's own.
fn solve(mesh: &TetMesh) -> Vec<f64> {
    let hooke = Hooke::isotropic(1000.0, 0.3).expect("Hooke");
    let k = match mesh.order() {
        1 => signorini_fem_mesh::assemble_stiffness(mesh.points(), mesh.tets(), |_| &hooke),
        _ => signorini_fem_mesh::assemble_stiffness(mesh.points(), &mesh.quadratic_tets(), |_| &hooke),
    };
    let k = k.expect("stiffness");
    let whole = signorini_fem_mesh::Decomposition::whole(mesh);
    let (shear, lame) = (1000.0 / 2.6, 300.0 / (1.3 * 0.4));
    // f = -(mu lap u + (lambda + mu) grad div u), lap s = -12 s
    let load = LoadDensity::body_field(move |p| {
        let a = [1.0, -1.0, 0.5];
        let (s, c) = (p.map(|x| (2.0 * x).sin()), p.map(|x| (2.0 * x).cos()));
        let second = |i: usize, j: usize| {
            if i == j { -4.0 * s[0] * s[1] * s[2] } else { 4.0 * c[i] * c[j] * s[3 - i - j] }
        };
        std::array::from_fn(|i| {
            let div: f64 = (0..3).map(|j| a[j] * second(i, j)).sum();
            12.0 * shear * a[i] * s[0] * s[1] * s[2] - (lame + shear) * div
        })
    });
    let f = signorini_fem_mesh::assemble_load(mesh, &whole, &load)
        .expect("load")
        .concat();
    let fixed: Vec<bool> = mesh
        .points()
        .iter()
        .flat_map(|p| [p.iter().any(|x| *x < 1e-9 || *x > 1.0 - 1e-9); 3])
        .collect();
    let mut u: Vec<f64> = mesh.points().iter().flat_map(|p| smooth(*p)).collect();
    let times = |x: &[f64]| {
        let mut y = vec![0.0; x.len()];
        for (value, (row, column)) in k.iter() {
            y[row] += value * x[column];
        }
        y
    };
    let mask = |v: &mut Vec<f64>| {
        v.iter_mut().zip(&fixed).for_each(|(v, fixed)| {
            if *fixed {
                *v = 0.0
            }
        })
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut r: Vec<f64> = times(&u).iter().zip(&f).map(|(k, f)| f - k).collect();
    mask(&mut r);
    let mut p = r.clone();
    let mut rho = dot(&r, &r);
    let start = rho;
    while rho > 1e-20 * start {
        let mut ap = times(&p);
        mask(&mut ap);
        let step = rho / dot(&p, &ap);
        for i in 0..u.len() {
            u[i] += step * p[i];
            r[i] -= step * ap[i];
        }
        let next = dot(&r, &r);
        for i in 0..p.len() {
            p[i] = r[i] + next / rho * p[i];
        }
        rho = next;
    }
    u
}

#[test]
fn the_index_of_a_manufactured_solution_is_near_one_and_errors_fall_with_h() {
    let mut last = f64::INFINITY;
    for cells in [4, 8, 12] {
        let mesh = Brick::new([1.0; 3], [cells; 3])
            .perturbed(0.1, 7)
            .build()
            .expect("brick");
        let u = solve(&mesh);
        let truth = energy_of_error(&mesh, &material(), &u, gradient).expect("error");
        let estimate = discretisation_error(&mesh, &material(), &u).expect("estimate");
        let index = (estimate.energy / truth).sqrt();
        println!(
            "cells {cells}: true {:.4e}, index {index:.4}",
            (truth / estimate.elastic_energy).sqrt()
        );
        let band = if cells == 4 { 0.3 } else { 0.15 };
        assert!((index - 1.0).abs() < band, "{cells}: {index}");
        assert!(truth < last);
        last = truth;
        let sum: f64 = estimate.energies.iter().sum();
        assert_abs_diff_eq!(sum, estimate.energy, epsilon = 1e-12 * sum);
    }
}

/// The same of order 2, with straight and with curved edges: errors fall with the square of h.
#[test]
fn the_index_of_quadratic_elements_is_near_one() {
    // the boundary, on which values are given, stays
    let bend = |[x, y, z]: [f64; 3]| {
        let bubble = 10.0 * x * (1.0 - x) * y * (1.0 - y) * z * (1.0 - z);
        [x + bubble * z, y - bubble, z + bubble * x]
    };
    for curved in [false, true] {
        let mut last = f64::INFINITY;
        for cells in [3, 6] {
            let mesh = Brick::new([1.0; 3], [cells; 3])
                .perturbed(0.1, 7)
                .build()
                .expect("brick");
            let mut mesh = mesh.raise_order().expect("quadratic");
            if curved {
                mesh = mesh.map_points(bend).expect("bent");
            }
            let u = solve(&mesh);
            let truth = energy_of_error(&mesh, &material(), &u, gradient).expect("error");
            let estimate = discretisation_error(&mesh, &material(), &u).expect("estimate");
            let index = (estimate.energy / truth).sqrt();
            println!(
                "curved {curved}, {cells}: index {index:.3}, relative {:.4}",
                estimate.relative()
            );
            assert!((0.8..1.3).contains(&index), "{index}");
            assert!(truth.sqrt() < last / 3.0, "{truth}");
            last = truth.sqrt();
        }
    }
}

/// However flat the cells are, and however they lie.
#[test]
fn the_index_of_flat_quadratic_elements_is_near_one() {
    let turned = |[x, y, z]: [f64; 3]| {
        [
            0.8 * x - 0.48 * y - 0.36 * z,
            0.6 * x + 0.64 * y + 0.48 * z,
            0.8 * z - 0.6 * y,
        ]
    };
    for flat in [1.0, 0.1, 0.01] {
        let mesh = Brick::new([1.8, 1.8, 1.2 * flat], [6, 6, 4]).build().expect("brick");
        let mesh = mesh.raise_order().expect("quadratic");
        let oblique = mesh.map_points(turned).expect("turned");
        for (mesh, along) in [(mesh, [1.0, 0.0, 0.0]), (oblique, [0.8, 0.6, 0.0])] {
            let place = |p: &[f64; 3]| (0..3).map(|d| along[d] * p[d]).sum::<f64>();
            let gradient = |p| along.map(|a: f64| along.map(|b| a * b * place(&p).cos()));
            let u: Vec<f64> = (mesh.points().iter())
                .flat_map(|p| along.map(|a| a * place(p).sin()))
                .collect();
            let truth = energy_of_error(&mesh, &material(), &u, gradient).expect("error");
            let estimate = discretisation_error(&mesh, &material(), &u).expect("estimate");
            let index = (estimate.energy / truth).sqrt();
            assert!((0.7..1.3).contains(&index), "cells flat by {flat}, {along:?}: {index}");
        }
    }
}

/// Also where a patch has few tetrahedra, as in a body of one element over its thickness.
#[test]
fn a_quadratic_displacement_has_no_error() {
    for (cells, size) in [([4, 3, 3], 1.0), ([6, 1, 1], 1.0), ([1, 1, 1], 1.0)] {
        let mesh = Brick::new([2.0, 1.0, size], cells)
            .build()
            .expect("brick")
            .raise_order()
            .expect("quadratic");
        let u: Vec<f64> = mesh
            .points()
            .iter()
            .flat_map(|[x, y, z]| [x * x - y * z, x * y + z, z * z - x * x])
            .collect();
        let estimate = discretisation_error(&mesh, &material(), &u).expect("estimate");
        assert!(estimate.relative() < 1e-6, "{cells:?}: {}", estimate.relative());
        let energy = signorini_fem_mesh::fields::strain_energy(&mesh, &material(), &u).expect("energy");
        assert!((estimate.elastic_energy - energy).abs() < 1e-12 * energy);
        let stresses = estimate.stress_errors(&mesh, &material()).expect("errors");
        assert_eq!(stresses.len(), mesh.tets().len());
    }
}

#[test]
fn a_linear_displacement_has_no_error_and_regions_are_kept_apart() {
    let mesh = Brick::new([2.0, 1.0, 1.0], [6, 3, 3]).build().expect("brick");
    let regions: Vec<u32> = (0..mesh.tets().len())
        .map(|t| u32::from(mesh.tet_points(t).iter().map(|p| p[0]).sum::<f64>() > 4.0))
        .collect();
    let mesh = mesh.with_regions(regions).expect("regions");
    let stiff = Hooke::isotropic(1e6, 0.3).expect("Hooke");
    let soft = Hooke::isotropic(1e3, 0.3).expect("Hooke");
    let materials = Materials::new(vec![(0, soft), (1, stiff)]).expect("materials");
    // two different uniform strains meet at x = 1: continuous, with a jump of the gradient
    let u: Vec<f64> = mesh
        .points()
        .iter()
        .flat_map(|p| [if p[0] > 1.0 { 1.0 + 1e-3 * (p[0] - 1.0) } else { p[0] }, 0.0, 0.0])
        .collect();
    let estimate = discretisation_error(&mesh, &materials, &u).expect("estimate");
    assert!(estimate.relative() < 1e-7, "{}", estimate.relative());
    let rest = discretisation_error(&mesh, &materials, &vec![0.0; u.len()]).expect("estimate");
    assert_eq!(rest.relative(), 0.0);
    assert!(discretisation_error(&mesh, &materials, &u[1..]).is_err());
}

#[test]
fn two_meshes_of_the_same_linear_field_do_not_differ() {
    let field = |p: [f64; 3]| [2.0 * p[0] + p[1], p[2] - p[0], 0.3 * p[1]];
    let make = |cells: [usize; 3], seed: u64| {
        let mesh = Brick::new([3.0, 1.0, 1.0], cells)
            .perturbed(0.1, seed)
            .build()
            .expect("brick");
        let u: Vec<f64> = mesh.points().iter().flat_map(|p| field(*p)).collect();
        (mesh, u)
    };
    let ((a, u), (b, v)) = (make([9, 3, 3], 1), make([6, 2, 2], 2));
    let zero = energy_of_difference(&a, &material(), &u, &b, &v).expect("difference");
    let all = energy_of_difference(&a, &material(), &u, &b, &vec![0.0; v.len()]).expect("energy");
    let own = signorini_fem_mesh::fields::strain_energy(&a, &material(), &u).expect("energy");
    assert!(zero < 1e-20 * own && (all - own).abs() < 1e-9 * own);
}

/// In a curved mesh, too, a point has the strain of the place where it is.
#[test]
fn a_curved_mesh_does_not_differ_from_itself() {
    let bulge = |[x, y, z]: [f64; 3]| [x, y, z * (1.0 + 0.4 * (1.0 - (2.0 * x - 1.0).powi(2)))];
    let mesh = Brick::new([1.0; 3], [2; 3]).build().expect("brick");
    let mesh = mesh
        .raise_order()
        .expect("quadratic")
        .map_points(bulge)
        .expect("curved");
    let field = |p: &[f64; 3]| [p[0] * p[1], p[2] * p[2] - p[0], 0.3 * p[1] * p[2]];
    let u: Vec<f64> = mesh.points().iter().flat_map(field).collect();
    let own = signorini_fem_mesh::fields::strain_energy(&mesh, &material(), &u).expect("energy");
    let zero = energy_of_difference(&mesh, &material(), &u, &mesh, &u).expect("difference");
    assert!(zero < 1e-20 * own, "{zero:e} {own:e}");
}

/// Of nearly incompressible quadratic elements strains are those of the solver.
#[test]
fn the_difference_to_zero_is_the_strain_energy() {
    let mesh = Brick::new([1.0; 3], [2; 3]).build().expect("brick");
    let mesh = mesh.raise_order().expect("quadratic");
    let field = |p: &[f64; 3]| [p[0] * p[1], p[2] * p[2], p[0] * p[0]];
    let u: Vec<f64> = mesh.points().iter().flat_map(field).collect();
    for poisson in [0.3, 0.45, 0.499] {
        let law = Materials::uniform(Hooke::isotropic(1e3, poisson).expect("Hooke"));
        let own = signorini_fem_mesh::fields::strain_energy(&mesh, &law, &u).expect("energy");
        let all = energy_of_difference(&mesh, &law, &u, &mesh, &vec![0.0; u.len()]).expect("energy");
        assert!((all - own).abs() < 1e-12 * own, "{poisson}: {all} {own}");
    }
}

/// Along all edges wanted lengths grow by at most half the distance; the error that they predict is the target; where
/// the error is, tetrahedra are smaller.
#[test]
fn wanted_sizes_have_the_target_and_grow_slowly() {
    let mesh = Brick::new([1.0; 3], [8; 3]).perturbed(0.1, 3).build().expect("mesh");
    // strain that changes ever faster along x
    let u: Vec<f64> = (mesh.points().iter()).flat_map(|p| [p[0].powi(3), 0.0, 0.0]).collect();
    let error = discretisation_error(&mesh, &material(), &u).expect("estimate");
    let edge = |tet: usize| (72.0_f64.sqrt() * mesh.volume(tet)).cbrt();
    for factor in [0.4, 0.7, 1.0, 1.3] {
        let target = factor * error.relative();
        let sizes = error.wanted_sizes(&mesh, target).expect("sizes");
        let mean = |tet: usize| mesh.tets()[tet].iter().map(|n| sizes[*n as usize].ln()).sum::<f64>() / 4.0;
        let part = |(tet, e): (usize, &f64)| e * (mean(tet).exp() / edge(tet)).powi(2);
        let predicted: f64 = error.energies.iter().enumerate().map(part).sum();
        let predicted = (predicted / error.elastic_energy).sqrt();
        assert!((predicted / target - 1.0).abs() < 0.1, "{factor}: {predicted} {target}");
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        for tet in mesh.tets() {
            for (a, b) in
                [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(a, b)| (tet[a] as usize, tet[b] as usize))
            {
                let [x, y] = [a, b].map(|n| mesh.points()[n]);
                let way = (0..3).map(|c| (x[c] - y[c]).powi(2)).sum::<f64>().sqrt();
                assert!((sizes[a] - sizes[b]).abs() <= 0.5 * way * (1.0 + 1e-12));
            }
            let middle = tet.iter().map(|n| mesh.points()[*n as usize][0]).sum::<f64>() / 4.0;
            let size = tet.iter().map(|n| sizes[*n as usize]).sum::<f64>() / 4.0;
            low = if middle < 0.2 { low.min(size) } else { low };
            high = if middle > 0.8 { high.max(size) } else { high };
        }
        assert!(high < low, "{factor}: {high} where the error is, {low} elsewhere");
    }
    // limits: four times smaller, twice larger
    for (target, most) in [(1e-9, 0.25), (1e9, 2.0)] {
        let sizes = error.wanted_sizes(&mesh, target).expect("sizes");
        let edges = || (0..mesh.tets().len()).map(edge);
        let (least, largest) = (edges().fold(f64::MAX, f64::min), edges().fold(0.0, f64::max));
        assert!(
            sizes
                .iter()
                .all(|s| *s >= 0.999 * most * least && *s <= 1.001 * most * largest)
        );
    }
}

#[test]
fn a_target_is_positive_and_the_mesh_its_own() {
    let mesh = Brick::new([1.0; 3], [2; 3]).build().expect("mesh");
    let still = vec![0.0; 3 * mesh.points().len()];
    let error = discretisation_error(&mesh, &material(), &still).expect("estimate");
    // nothing strained: as large as may be
    let sizes = error.wanted_sizes(&mesh, 0.1).expect("sizes");
    assert!(sizes.iter().all(|s| s.is_finite() && *s > 0.5));
    for value in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let message = error.wanted_sizes(&mesh, value).expect_err("target").to_string();
        assert!(message.contains("must be positive"), "{message}");
    }
    let other = Brick::new([1.0; 3], [3; 3]).build().expect("mesh");
    let message = error.wanted_sizes(&other, 0.1).expect_err("mesh").to_string();
    assert!(message.contains("table of tetrahedra"), "{message}");
}

/// Mid-nodes have the mean of the ends of their edges, so that sizes grow as slowly along halves of edges.
#[test]
fn wanted_sizes_at_mid_nodes_grow_slowly() {
    let mesh = Brick::new([1.0; 3], [4; 3]).build().expect("mesh");
    let mesh = mesh.raise_order().expect("order 2");
    let bent = |p: &[f64; 3]| [if p[0] < 0.3 { p[0].powi(5) } else { 0.0 }, 0.0, 0.0];
    let u: Vec<f64> = mesh.points().iter().flat_map(bent).collect();
    let error = discretisation_error(&mesh, &material(), &u).expect("estimate");
    let sizes = error.wanted_sizes(&mesh, 0.3 * error.relative()).expect("sizes");
    let edges = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];
    for (tet, mids) in mesh.tets().iter().zip(mesh.mids()) {
        for (mid, ends) in mids.iter().zip(edges) {
            for end in ends.map(|k| tet[k] as usize) {
                let [x, y] = [end, *mid as usize].map(|n| mesh.points()[n]);
                let way = (0..3).map(|c| (x[c] - y[c]).powi(2)).sum::<f64>().sqrt();
                let growth = (sizes[end] - sizes[*mid as usize]).abs();
                assert!(growth <= 0.5 * way * (1.0 + 1e-12), "{growth} over {way}");
            }
        }
    }
}

/// A recovery is for meshes of its order: of the other one it looked for what is not there, and panicked.
#[test]
fn a_recovery_refuses_a_mesh_of_the_other_order() {
    let linear = Brick::new([1.0; 3], [2; 3]).build().expect("mesh");
    let quadratic = linear.raise_order().expect("order 2");
    for (own, other) in [(&linear, &quadratic), (&quadratic, &linear)] {
        let still = vec![0.0; 3 * other.points().len()];
        let error = StrainRecovery::new(own).error(other, &material(), &still);
        let message = error.expect_err("the order").to_string();
        assert!(message.contains("table of nodes"), "{message}");
    }
}
