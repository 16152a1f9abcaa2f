//! The lumped and the Dirichlet preconditioner, and the inverse of a formed F.

use crate::common::{Brick, build, dot, noise, norm, steel};
use nalgebra::{DMatrix, DVector};
use signorini_fem_mesh::{Decomposition, Hooke, Materials, brick};
use signorini_qp::{DenseOperator, Status, SymmetricOperator};
use signorini_tfeti::internal::InverseKind;
use signorini_tfeti::{Directions, NodeSupport, Tfeti, TfetiBuilder};

/// Iterations of preconditioned projected conjugate gradients to a relative residual of 1e-8.
fn preconditioned_iterations<M: SymmetricOperator>(system: &Tfeti, preconditioner: Option<&M>) -> usize {
    let (f, factor) = (system.dual(), system.coarse_factor().unwrap());
    let (mut fs, mut cs) = (f.scratch(), factor.scratch());
    let dim = f.dim();
    let mut r = noise(dim, 17);
    let mut f_r = vec![0.0; dim];
    f.apply(&r, &mut f_r, &mut fs);
    std::mem::swap(&mut r, &mut f_r);
    factor.project(&mut r, None, &mut cs);
    let start = norm(&r);
    let mut ps = preconditioner.map(SymmetricOperator::scratch);
    let mut precondition = |r: &[f64], cs: &mut signorini_tfeti::internal::CoarseScratch| {
        let mut z = r.to_vec();
        if let (Some(m), Some(s)) = (preconditioner, ps.as_mut()) {
            m.apply(r, &mut z, s);
            factor.project(&mut z, None, cs);
        }
        z
    };
    let mut z = precondition(&r, &mut cs);
    let (mut p, mut rz) = (z.clone(), dot(&r, &z));
    let mut fp = vec![0.0; dim];
    for iteration in 1..500 {
        f.apply(&p, &mut fp, &mut fs);
        factor.project(&mut fp, None, &mut cs);
        let step = rz / dot(&p, &fp);
        (0..dim).for_each(|k| r[k] -= step * fp[k]);
        if norm(&r) < 1e-8 * start {
            return iteration;
        }
        z = precondition(&r, &mut cs);
        let new = dot(&r, &z);
        (0..dim).for_each(|k| p[k] = z[k] + new / rz * p[k]);
        rz = new;
    }
    500
}

/// With many subdomains that float, and on one that supports hold.
#[test]
fn a_formed_f_is_inverted_on_the_kernel_of_g() {
    for (n, cells) in [(2, 3), (1, 4)] {
        let system = Brick::new(n, cells).system();
        let inverse = system.explicit_inverse().unwrap();
        let (x, y) = (noise(inverse.dim(), 1), noise(inverse.dim(), 2));
        let (mut mx, mut my, mut s) = (vec![0.0; x.len()], vec![0.0; x.len()], inverse.scratch());
        inverse.apply(&x, &mut mx, &mut s);
        inverse.apply(&y, &mut my, &mut s);
        assert!((dot(&mx, &y) - dot(&my, &x)).abs() < 1e-11 * norm(&mx) * norm(&y));
        let iterations = preconditioned_iterations(&system, Some(&inverse));
        assert!(iterations <= 3, "{iterations}");
    }
}

/// Here a solve of the contact rows is one with their matrix, off by more or less.
#[test]
fn what_lacks_least_stays_where_later_solves_go_astray() {
    let system = Brick::new(2, 3).system();
    let inverse = system.explicit_inverse().unwrap();
    let (linear, e) = (noise(system.dual_dim(), 3), noise(system.coarse().rows(), 4));
    let (mut x, mut errors) = (vec![0.0; linear.len()], [1e-3, 1e-6, 0.5, 0.5, 0.5, 0.5].into_iter());
    let solve = |matrix: &DenseOperator, load: &[f64], x: &mut [f64]| {
        let n = matrix.dim();
        let matrix = DMatrix::from_column_slice(n, n, matrix.entries());
        let found = matrix.cholesky().unwrap().solve(&DVector::from_column_slice(load));
        let error = errors.next().unwrap();
        x.iter_mut()
            .zip(&found)
            .for_each(|(x, found)| *x = (1.0 + error) * found);
        Ok(Status::Converged)
    };
    let solved = inverse.through_contact(system.coarse(), (&linear, &e), &mut x, solve);
    let mut lacks = vec![0.0; e.len()];
    system.coarse().apply(&x, &mut lacks, &mut system.coarse().scratch());
    lacks.iter_mut().zip(&e).for_each(|(lacks, e)| *lacks -= e);
    let alpha = solved.unwrap().expect("a solution");
    // F x - linear + Gᵀ alpha = 0, but for that solve
    let dual = system.dual();
    let (mut left, mut turned) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    dual.apply(&x, &mut left, &mut dual.scratch());
    system.coarse().transpose_times(&alpha, &mut turned);
    let size = norm(&left) + norm(&turned);
    (left.iter_mut().zip(&turned).zip(&linear)).for_each(|((left, turned), linear)| *left += turned - linear);
    assert!(norm(&left) < 1e-4 * size, "{:e}", norm(&left) / size);
    assert!(norm(&lacks) < 1e-4 * norm(&x), "{:e}", norm(&lacks) / norm(&x));
    assert_eq!(errors.count(), 2);
}

#[test]
fn preconditioners_are_symmetric_and_help() {
    let b = Brick::new(2, 4);
    let counts = |system: &Tfeti| {
        let (lumped, dirichlet) = (system.lumped().unwrap(), system.dirichlet().unwrap());
        for m in [&lumped, &dirichlet] {
            let (x, y) = (noise(m.dim(), 1), noise(m.dim(), 2));
            let (mut mx, mut my, mut s) = (vec![0.0; m.dim()], vec![0.0; m.dim()], m.scratch());
            m.apply(&x, &mut mx, &mut s);
            m.apply(&y, &mut my, &mut s);
            assert!((dot(&mx, &y) - dot(&my, &x)).abs() < 1e-11 * norm(&mx) * norm(&y));
            assert!(dot(&mx, &x) > 0.0);
        }
        [None, Some(&lumped), Some(&dirichlet)].map(|m| preconditioned_iterations(system, m))
    };
    for sharing in [true, false] {
        let [none, lumped, dirichlet] = counts(&build(&b, InverseKind::Auto, sharing));
        assert!(dirichlet < lumped && lumped < none, "{none} {lumped} {dirichlet}");
        assert!(dirichlet < 25, "{none} {lumped} {dirichlet}");
    }
}

#[test]
fn stiffness_scaling_copes_with_several_materials() {
    let mut b = Brick::new(2, 4);
    let regions: Vec<u32> = b.decomposition.parts().iter().map(|p| p % 2).collect();
    b.mesh = b.mesh.clone().with_regions(regions).unwrap();
    let law = |young| Hooke::isotropic(young, 0.3).unwrap();
    b.materials = Materials::new(vec![(0, law(1e9)), (1, law(1e12))]).unwrap();
    let system = b.system();
    assert_eq!(system.classes().classes().len(), 2);
    let dirichlet = system.dirichlet().unwrap();
    let [with, without] = [Some(&dirichlet), None].map(|m| preconditioned_iterations(&system, m));
    assert!(3 * with < without, "{with} {without}");
}

/// A plate one cell thick between two planes: supports hold one direction of all nodes, and with the others eliminated
/// the preconditioner is the inverse. With the others held, as in a block that is not thin, a plate twice as long would
/// take about twice the iterations.
#[test]
fn a_thin_body_between_two_planes_is_no_dearer_where_it_is_long() {
    let iterations = |length: usize, planes: Directions| {
        let cells = [length, 4, 1];
        let mesh = brick::Brick::new(cells.map(|c| c as f64), cells).build().unwrap();
        let mut between = mesh.nodes_on(brick::Z_MIN);
        between.extend(mesh.nodes_on(brick::Z_MAX));
        let ends = mesh.nodes_on(brick::X_MIN);
        between.retain(|node| !ends.contains(node));
        let supports = [NodeSupport::fixed(ends), NodeSupport::partial(between, planes)];
        let (whole, materials) = (Decomposition::whole(&mesh), steel());
        let builder = TfetiBuilder::new(&mesh, &whole, &materials).with_supports(&supports);
        let system = builder.build().unwrap();
        preconditioned_iterations(&system, Some(&system.lumped().unwrap()))
    };
    let normal = Directions::Components([false, false, true]);
    let oblique = Directions::Vectors(vec![[0.0, 0.6, 0.8]]);
    for planes in [normal, oblique] {
        let [short, long] = [8, 32].map(|length| iterations(length, planes.clone()));
        assert!(short <= 4 && long <= 4, "{planes:?}: {short} {long}");
    }
}
