//! Projectors, orthonormal coarse rows, free motions and the spectrum on the kernel of `G`.

use crate::common::{Brick, column, distance, dot, noise, norm, steel};
use signorini_fem_mesh::{Decomposition, SurfaceFrame, TetMesh, brick};
use signorini_qp::{Equality, SymmetricOperator};
use signorini_tfeti::{
    CoarseFactor, ContactConstraint, Directions, NodeSupport, RowWeights, TangentialRows, TfetiBuilder,
};

#[test]
fn coarse_projectors_and_particular_solutions() {
    let b = Brick::new(2, 3);
    {
        let system = b.system();
        let coarse = system.coarse();
        let (dim, rows) = (coarse.dim(), coarse.rows());
        let mut s = coarse.scratch();
        let ranges = system.gluing().ranges().clone();
        let weights = |row: usize| {
            if ranges.contact().contains(&row) { 0.0 } else { 1.0 }
        };
        let weighted = coarse
            .factor_weighted(RowWeights::diagonal((0..dim).map(weights).collect()))
            .unwrap();
        for factor in [system.coarse_factor().unwrap(), &weighted] {
            assert!(factor.free_motions().is_empty());
            let x = noise(dim, 9);
            let e = noise(rows, 4);
            let mut g = vec![0.0; rows];
            // G P x = 0, P P = P, and the affine version reaches G x = e.
            let mut p = x.clone();
            factor.project(&mut p, None, &mut s);
            coarse.apply(&p, &mut g, &mut s);
            assert!(norm(&g) < 1e-11 * norm(&x));
            let mut pp = p.clone();
            factor.project(&mut pp, None, &mut s);
            assert!(distance(&pp, &p) < 1e-11 * norm(&p));
            let mut affine = x.clone();
            factor.project(&mut affine, Some(&e), &mut s);
            coarse.apply(&affine, &mut g, &mut s);
            assert!(distance(&g, &e) < 1e-10 * norm(&e));
            let mut particular = vec![0.0; dim];
            factor.particular(&e, &mut particular, &mut s);
            coarse.apply(&particular, &mut g, &mut s);
            assert!(distance(&g, &e) < 1e-10 * norm(&e));
            // The transposed projector is adjoint to the projector.
            let r = noise(dim, 11);
            let (mut t, mut alpha) = (r.clone(), vec![0.0; rows]);
            factor.project_transpose(&mut t, &mut alpha, &mut s);
            assert!((dot(&t, &x) - dot(&r, &p)).abs() < 1e-11 * norm(&r) * norm(&x));
            if factor.weights().is_some() {
                assert!(particular[ranges.contact()].iter().all(|v| *v == 0.0));
            } else {
                let mut q = r.clone();
                factor.project(&mut q, None, &mut s);
                assert!(distance(&q, &t) < 1e-11 * norm(&r), "P is symmetric");
            }
        }
        check_orthonormal(system.coarse_factor().unwrap());
    }
}

fn check_orthonormal(factor: &CoarseFactor) {
    let c = factor.orthonormal().unwrap();
    let mut s = c.scratch();
    let beta = noise(c.rows(), 21);
    let (mut x, mut back) = (vec![0.0; c.dim()], vec![0.0; c.rows()]);
    c.apply_transpose(&beta, &mut x, &mut s);
    c.apply(&x, &mut back, &mut s);
    assert!(distance(&beta, &back) < 1e-11 * norm(&beta), "C C^T = I");
    // C^T C = Q, G^T alpha = C^T beta, and C x = rhs(e) is G x = e.
    let y = noise(c.dim(), 22);
    c.apply(&y, &mut back, &mut s);
    c.apply_transpose(&back, &mut x, &mut s);
    let mut p = y.clone();
    factor.project(&mut p, None, &mut s);
    let q: Vec<f64> = y.iter().zip(&p).map(|(a, b)| a - b).collect();
    assert!(distance(&q, &x) < 1e-11 * norm(&y));
    let mut alpha = vec![0.0; c.rows()];
    c.amplitudes(&beta, &mut alpha, &mut s);
    let mut g = vec![0.0; c.dim()];
    factor.coarse().apply_transpose(&alpha, &mut g, &mut s);
    c.apply_transpose(&beta, &mut x, &mut s);
    assert!(distance(&g, &x) < 1e-11 * norm(&x));
    let (mut e, mut rhs) = (vec![0.0; c.rows()], vec![0.0; c.rows()]);
    factor.coarse().apply(&y, &mut e, &mut s);
    c.rhs(&e, &mut rhs, &mut s);
    c.apply(&y, &mut back, &mut s);
    assert!(distance(&rhs, &back) < 1e-11 * norm(&rhs));
}

#[test]
fn spectrum_on_the_kernel_of_g() {
    let b = Brick::new(1, 5);
    let system = b.system();
    let (f, factor) = (system.dual(), system.coarse_factor().unwrap());
    let (dim, mut fs, mut cs) = (f.dim(), f.scratch(), factor.scratch());
    let mut matrix = nalgebra::DMatrix::<f64>::zeros(dim, dim);
    for j in 0..dim {
        let (mut x, mut y) = (vec![0.0; dim], vec![0.0; dim]);
        x[j] = 1.0;
        factor.project(&mut x, None, &mut cs);
        f.apply(&x, &mut y, &mut fs);
        factor.project(&mut y, None, &mut cs);
        matrix.column_mut(j).copy_from_slice(&y);
    }
    let matrix = (&matrix + matrix.transpose()) * 0.5;
    let mut values: Vec<f64> = nalgebra::SymmetricEigen::new(matrix)
        .eigenvalues
        .iter()
        .copied()
        .collect();
    values.sort_by(f64::total_cmp);
    let rows = factor.coarse().rows();
    let largest = values[dim - 1];
    assert!(values[rows - 1].abs() < 1e-12 * largest, "six zeros a subdomain");
    let smallest = values[rows] / largest;
    assert!((0.015..0.03).contains(&smallest), "smallest / largest = {smallest}");
}

#[test]
fn free_motions_are_found_and_long_bodies_raise_no_alarm() {
    let b = Brick::new(1, 3);
    let free = |supports: &[NodeSupport], friction: Option<bool>, only_interface: bool| {
        let contact = b.contact(friction.unwrap_or(false));
        let mut builder = TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials).with_supports(supports);
        if friction.is_some() {
            builder = builder.with_contact(&contact);
        }
        let system = builder.build().unwrap();
        if !only_interface {
            return system.coarse_factor().unwrap().free_motions().len();
        }
        let ranges = system.gluing().ranges();
        let weights = (0..ranges.total())
            .map(|r| f64::from(u8::from(!ranges.contact().contains(&r))))
            .collect();
        let factor = system.coarse().factor_weighted(RowWeights::diagonal(weights)).unwrap();
        // Consistent right-hand sides are solved in spite of the free motions.
        let coarse = factor.coarse();
        let (mut s, mut x, mut e) = (coarse.scratch(), noise(coarse.dim(), 8), vec![0.0; coarse.rows()]);
        x[ranges.contact()].fill(0.0);
        coarse.apply(&x, &mut e, &mut s);
        let mut again = e.clone();
        factor.particular(&e, &mut x, &mut s);
        coarse.apply(&x, &mut again, &mut s);
        assert!(distance(&e, &again) < 1e-9 * norm(&e));
        assert!(factor.free_motions().len() < 6 || factor.orthonormal().is_none());
        factor.free_motions().len()
    };
    assert_eq!(free(&b.supports(), None, false), 0);
    assert_eq!(free(&[], None, false), 6);
    assert_eq!(free(&[], Some(false), false), 3);
    assert_eq!(free(&[], Some(true), false), 0);
    assert_eq!(free(&[], Some(true), true), 6);
    let line = NodeSupport::partial(vec![b.fixed[0]], Directions::All);
    assert_eq!(free(&[line], Some(true), true), 3);
    // A beam 200 times as long as thick in 200 subdomains.
    let mesh = brick::Brick::new([200.0, 1.0, 1.0], [400, 2, 2]).build().unwrap();
    let decomposition = Decomposition::boxes(&mesh, [200, 1, 1]).unwrap();
    let supports = [NodeSupport::fixed(mesh.nodes_on(brick::X_MIN))];
    let system = TfetiBuilder::new(&mesh, &decomposition, &b.materials)
        .with_supports(&supports)
        .build()
        .unwrap();
    assert!(system.coarse_factor().unwrap().free_motions().is_empty());
    assert!(system.coarse_factor().unwrap().orthonormal().is_some());
}

/// Products with `G` against its columns, for globs of one to many nodes and of two to many subdomains.
#[test]
fn products_go_through_globs_as_through_rows() {
    let mut single = Brick::of(1, 2, 0.1);
    let parts: Vec<u32> = (0..single.mesh.tets().len() as u32).collect();
    single.decomposition = Decomposition::from_parts(&single.mesh, &parts).unwrap();
    let most = (0..single.mesh.points().len())
        .map(|node| single.decomposition.copies(node).len())
        .max();
    assert!(most > Some(8), "{most:?} subdomains share a node");
    for b in [Brick::new(2, 3), Brick::of(2, 2, 0.1), single] {
        {
            let system = b.system();
            let coarse = system.coarse();
            let mut s = coarse.scratch();
            let (x, y) = (noise(coarse.dim(), 3), noise(coarse.rows(), 5));
            let (mut gx, mut gy) = (vec![0.0; y.len()], vec![0.0; x.len()]);
            coarse.apply(&x, &mut gx, &mut s);
            coarse.apply_transpose(&y, &mut gy, &mut s);
            let (mut rx, mut ry) = (vec![0.0; y.len()], vec![0.0; x.len()]);
            for row in 0..x.len() {
                for (subdomain, modes) in column(&system, row) {
                    for (k, mode) in modes.iter().enumerate() {
                        rx[6 * subdomain + k] += mode * x[row];
                        ry[row] += mode * y[6 * subdomain + k];
                    }
                }
            }
            assert!(distance(&gx, &rx) < 1e-13 * norm(&rx));
            assert!(distance(&gy, &ry) < 1e-13 * norm(&ry));
        }
    }
}

/// Loose blocks in a row on a floor, which each may touch, as the next one: judged and held one by one, or together.
#[test]
fn many_loose_bodies_are_held_one_by_one() {
    const COUNT: usize = 300;
    let one = brick::Brick::new([1.0; 3], [1, 1, 1]).build().unwrap();
    let nodes = one.points().len() as u32;
    let (mut points, mut tets, mut parts, mut contact) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let frame = |normal| SurfaceFrame::from_normal(normal).unwrap();
    let right = one.nodes_on(brick::X_MAX);
    let left = right.iter().map(|n| {
        let [_, y, z] = one.points()[*n as usize];
        one.points().iter().position(|p| *p == [0.0, y, z]).unwrap() as u32
    });
    let pairs: Vec<(u32, u32)> = right.iter().copied().zip(left).collect();
    for k in 0..COUNT as u32 {
        points.extend(one.points().iter().map(|[x, y, z]| [x + f64::from(k), *y, *z]));
        tets.extend(one.tets().iter().map(|tet| tet.map(|n| n + k * nodes)));
        parts.extend(one.tets().iter().map(|_| k));
        let floor = one.nodes_on(brick::Z_MIN).into_iter();
        contact.extend(floor.map(|n| ContactConstraint::new(n + k * nodes, frame([0.0, 0.0, -1.0]))));
        let next = |(a, b): &(u32, u32)| {
            let partner = Some(b + (k + 1) * nodes);
            ContactConstraint::new(a + k * nodes, frame([1.0, 0.0, 0.0])).with_partner(partner)
        };
        contact.extend(pairs.iter().filter(|_| k + 1 < COUNT as u32).map(next));
    }
    let contact: Vec<_> = contact.into_iter().map(|c| c.with_friction(true)).collect();
    let mesh = TetMesh::new(points, tets, Vec::new()).unwrap();
    let decomposition = Decomposition::from_parts(&mesh, &parts).unwrap();
    let materials = steel();
    let builder = TfetiBuilder::new(&mesh, &decomposition, &materials);
    let system = builder.with_contact(&contact).build().unwrap();
    let coarse = system.coarse();
    let rows = system.gluing().ranges().contact().end;
    let mut weights = vec![1.0; coarse.dim()];
    assert!(
        coarse.free_motions(None).unwrap().is_empty(),
        "friction holds all together"
    );
    // every tenth block may slide across the row
    for rows in system.gluing().contact() {
        let slides = system.gluing().row(rows.row).iter().any(|entry| entry.0 % 10 == 4);
        if let (TangentialRows::Disc { row, .. }, true) = (rows.tangential, slides) {
            weights[row..row + 2].fill(0.0);
        }
    }
    let sliding = coarse
        .free_motions(Some(&RowWeights::diagonal(weights.clone())))
        .unwrap();
    assert_eq!(sliding.len(), COUNT / 10);
    let mut moved = vec![0.0; coarse.dim()];
    for motion in &sliding {
        coarse.apply_transpose(&motion.amplitudes, &mut moved, &mut coarse.scratch());
        let held = moved.iter().zip(&weights).map(|(moved, weight)| moved * weight);
        assert!(held.fold(0.0, |most: f64, moved| most.max(moved.abs())) < 1e-9);
        assert!(norm(&moved) > 0.1);
    }
    weights[..rows].fill(0.0);
    let factor = coarse.factor_weighted(RowWeights::diagonal(weights)).unwrap();
    assert_eq!(factor.free_motions().len(), 6 * COUNT);
    assert!(factor.free_motions().iter().all(|motion| motion.bodies.len() == 1));
    // nothing acts, so that nothing is what is in balance
    let mut x = vec![0.0; coarse.dim()];
    factor.particular(&vec![0.0; coarse.rows()], &mut x, &mut coarse.scratch());
    assert!(x.iter().all(|x| *x == 0.0));
}
