//! Rows of linear equations: what they measure, which are needed, and that many are judged in little time.

use crate::common::{self, noise};
use signorini_fem_mesh::decomposition::Rigid;
use signorini_fem_mesh::vec3::{dot, norm};
use signorini_fem_mesh::{Decomposition, Hooke, Materials, brick};
use signorini_tfeti::internal::{MergedSupports, independent_equations};
use signorini_tfeti::{Motion, NodalEquation, NodeSupport, Tfeti, TfetiBuilder, TfetiError};
use std::time::Instant;

const X: [f64; 3] = [1.0, 0.0, 0.0];

fn alike(a: u32, b: u32, factor: f64) -> NodalEquation {
    NodalEquation {
        terms: vec![(a, X.map(|v| factor * v)), (b, X.map(|v| -factor * v))],
        ..NodalEquation::default()
    }
}

/// A brick on a moved support with a place.
fn system(equations: &[NodalEquation]) -> Result<(Tfeti, Decomposition), TfetiError> {
    let b = common::Brick::new(1, 2);
    let cut = b.decomposition.clone();
    let cut = cut
        .with_rigid(vec![Rigid::Places(vec![0, 1, 30])])
        .expect("nodes of the mesh");
    let materials = Materials::uniform(Hooke::isotropic(2e11, 0.3).expect("steel"));
    let moved = Motion::new(0, vec![[2.0, 3.0, 5.0]]);
    let supports = [NodeSupport::fixed(b.mesh.nodes_on(brick::X_MIN)).with_motion(moved)];
    let builder = TfetiBuilder::new(&b.mesh, &cut, &materials).with_supports(&supports);
    let tfeti = builder.with_equations(equations).build()?;
    Ok((tfeti, cut))
}

/// A row is the equation on means of copies, without what supports move, and of length one but for places.
#[test]
fn rows_measure_equations() {
    let b = common::Brick::new(1, 2);
    let held = b.mesh.nodes_on(brick::X_MIN)[3];
    let [first, second] = [8, b.mesh.nodes_on(brick::X_MAX)[2]];
    let place = b.decomposition.subdomains().len() as u32;
    let equation = NodalEquation {
        terms: vec![
            (first, [1.0, -2.0, 0.5]),
            (second, [0.0, 3.0, 1.0]),
            (held, [1.0, 1.0, 2.0]),
            (first, X),
        ],
        places: vec![(place, [0.0, 0.0, -4.0])],
        values: vec![(1, 7.0)],
    };
    let (tfeti, cut) = system(std::slice::from_ref(&equation)).expect("a system");
    let gluing = tfeti.gluing();
    let rows = gluing.ranges().equations.clone();
    let [own] = gluing.equations() else {
        panic!("{:?}", gluing.equations())
    };
    assert!(rows == (own.row..own.row + 1) && rows.start == gluing.ranges().tied.end && own.equation == 0);
    let at = |case: usize| {
        gluing
            .prescribed(case)
            .iter()
            .find(|p| p.0 as usize == own.row)
            .map(|p| p.1)
    };
    // one support moves the node along all of its coefficients
    let moved = dot([1.0, 1.0, 2.0], [2.0, 3.0, 5.0]);
    assert!((at(0).expect("moved") + own.scale * moved).abs() < 1e-12);
    assert!((at(1).expect("a value") - own.scale * 7.0).abs() < 1e-12);
    // displacements that are the same at all copies, and at all places
    let nodes = noise(3 * cut.nodes(), 4);
    let (mut u, shift) = (Vec::new(), [0.3, -0.2, 0.9]);
    for subdomain in cut.subdomains() {
        let of = |n: &u32| [0, 1, 2].map(|c| nodes[3 * *n as usize + c]);
        u.extend(
            subdomain
                .nodes
                .iter()
                .flat_map(|n| if subdomain.is_relative { shift } else { of(n) }),
        );
    }
    let mut out = vec![0.0; tfeti.dual_dim()];
    tfeti.rows_times(&u, &mut out);
    let at = |n: u32, v: [f64; 3]| (0..3).map(|c| v[c] * nodes[3 * n as usize + c]).sum::<f64>();
    let expected = at(first, [2.0, -2.0, 0.5]) + at(second, [0.0, 3.0, 1.0]) - 4.0 * shift[2];
    assert!((out[own.row] - own.scale * expected).abs() < 1e-12 * norm([4.0; 3]));
    assert!(gluing.length(own.row) == 1.0 && !gluing.ranges().equations.is_empty());
}

/// Those that follow from others, and from supports, are left out; what contradicts them, or does nearly, is refused
/// with them.
#[test]
fn what_follows_has_no_row() {
    let held = common::Brick::new(1, 2).mesh.nodes_on(brick::X_MIN);
    let circle = [
        alike(22, 23, 1.0),
        alike(23, 24, -3.0),
        alike(24, 22, 0.1),
        alike(held[0], held[1], 1.0),
    ];
    let (tfeti, _) = system(&circle).expect("a system");
    let found: Vec<usize> = tfeti.gluing().equations().iter().map(|e| e.equation).collect();
    assert_eq!(found, [0, 1]);
    let refused = |equations: &[NodalEquation]| system(equations).map(|_| ()).expect_err("refused");
    let mut wrong = circle.clone();
    wrong[2].values = vec![(2, 1e-3)];
    let found = refused(&wrong);
    assert!(
        matches!(&found, TfetiError::Equation { equation: 2, node: Some(22), others, .. } if *others == [0, 1]),
        "{found}"
    );
    let alone = NodalEquation {
        terms: vec![(held[0], X)],
        values: vec![(0, 2.0)],
        ..NodalEquation::default()
    };
    assert!(system(std::slice::from_ref(&alone)).is_ok());
    let other = NodalEquation {
        values: vec![(0, 2.001)],
        ..alone
    };
    assert!(matches!(refused(&[other]), TfetiError::Equation { node: None, .. }));
    let mut nearly = circle;
    nearly[2].terms[0].1[0] *= 1.0 + 1e-7;
    assert!(refused(&nearly).to_string().contains("more digits"));
    let unknown = NodalEquation {
        terms: vec![(9999, X)],
        ..NodalEquation::default()
    };
    assert!(matches!(
        refused(&[unknown]),
        TfetiError::UnknownNode { node: 9999, .. }
    ));
    let elastic = NodalEquation {
        places: vec![(0, X)],
        ..NodalEquation::default()
    };
    assert!(refused(&[elastic]).to_string().contains("no subdomain of places"));
}

/// Chains of thousands in any order, with as many means over all of them.
#[test]
fn many_are_judged_in_little_time() {
    let mesh = brick::Brick::new([1.0; 3], [24; 3]).build().expect("brick");
    let cut = Decomposition::whole(&mesh);
    let count = 12_000;
    for stride in [1, 7919] {
        let order = (0..count).map(|k| (k * stride) % count);
        let mut equations: Vec<_> = order.map(|k| alike(k as u32, k as u32 + 1, 1.0 + k as f64)).collect();
        equations.push(alike(count as u32, 0, 1.0));
        for part in 0..3 {
            let own = (0..count as u32).filter(|k| k % 3 == part);
            let terms = own.map(|k| (k, [0.0, 1.0, f64::from(part)])).collect();
            equations.push(NodalEquation {
                terms,
                ..NodalEquation::default()
            });
        }
        let started = Instant::now();
        let found = independent_equations(&equations, (&mesh, &cut), (&MergedSupports::default(), &[]), &[])
            .expect("no contradiction");
        println!("{stride}: {:?}", started.elapsed());
        assert_eq!(found.len(), count + 3);
        assert!(!found.contains(&count));
    }
}

/// A case is a number of one, not of bytes.
#[test]
fn equations_of_too_large_a_case_are_refused() {
    let of = |case| {
        let values = vec![(case, 1.0)];
        let equation = NodalEquation {
            values,
            ..alike(8, 9, 1.0)
        };
        system(&[equation]).err()
    };
    assert_eq!(of(3), None);
    let error = of(u32::MAX);
    assert!(
        matches!(error, Some(TfetiError::Equation { equation: 0, .. })),
        "{error:?}"
    );
}
