//! Sides of several nodes: rows are the weighted mean of the jump, whatever the nodes, copies and supports.

use crate::common::{Brick, column, distance, dot, gluing, is_orthonormal, noise, norm, product};
use signorini_fem_mesh::{SurfaceFrame, brick};
use signorini_qp::EqualityProjector;
use signorini_tfeti::internal::{ActiveSetFactor, MergedSupports, held_ties, prescribed_points};
use signorini_tfeti::{
    ActiveSetProjector, ContactConstraint, Directions, Motion, NodeSupport, Side, TangentialRows, Tfeti, TfetiError,
};

const WEIGHTS: [f64; 3] = [0.2, 0.3, 0.5];
const DUAL: [f64; 4] = [0.7, -0.25, 0.65, -0.1];

fn frame() -> SurfaceFrame {
    SurfaceFrame::from_normal([0.6, 0.0, -0.8]).unwrap()
}

/// Nodes of the bottom of which some are shared by two and four subdomains.
fn own(b: &Brick) -> [u32; 3] {
    let most = |n: &&u32| b.decomposition.copies(**n as usize).len();
    let mut nodes: Vec<&u32> = b.bottom.iter().filter(|n| !b.fixed.contains(n)).collect();
    nodes.sort_by_key(most);
    let [first, middle, last] = [0, nodes.len() - 3, nodes.len() - 1].map(|k| *nodes[k]);
    assert_eq!(b.decomposition.copies(last as usize).len(), 4);
    [first, middle, last]
}

fn side(nodes: &[u32], weights: &[f64]) -> Side {
    Side::new(nodes.iter().copied().zip(weights.iter().copied()).collect())
}

/// Three nodes against four with dual weights, and the same three against a rigid wall.
fn contact(b: &Brick) -> Vec<ContactConstraint> {
    let partner = &b.mesh.nodes_on(brick::Z_MAX)[5..9];
    let own = side(&own(b), &WEIGHTS);
    let against = ContactConstraint::new(own.clone(), frame()).with_friction(true);
    [against.clone().with_partner(Some(side(partner, &DUAL))), against]
        .into_iter()
        .collect()
}

fn system(b: &Brick, supports: &[NodeSupport]) -> Tfeti {
    let contact = contact(b);
    b.builder(supports).with_contact(&contact).build().unwrap()
}

/// The weighted mean of the jump of a torn displacement, by copies that count alike.
fn jump(b: &Brick, system: &Tfeti, point: &ContactConstraint, u: &[f64]) -> [f64; 3] {
    let mean = |side: &Side| {
        let mut sum = [0.0; 3];
        for &(node, weight) in side.nodes() {
            let copies = b.decomposition.copies(node as usize);
            for copy in copies {
                let first = system.torn_range(copy.subdomain as usize).start + 3 * copy.local as usize;
                (0..3).for_each(|c| sum[c] += weight * u[first + c] / copies.len() as f64);
            }
        }
        sum
    };
    let other = point.partner.as_ref().map_or([0.0; 3], mean);
    let own = mean(&point.side);
    [0, 1, 2].map(|c| own[c] - other[c])
}

#[test]
fn rows_are_the_weighted_mean_of_the_jump() {
    let b = Brick::new(2, 3);
    let (system, contact) = (system(&b, &b.supports()), contact(&b));
    let u = noise(system.torn_dim(), 4);
    let mut rows = vec![0.0; system.dual_dim()];
    system.rows_times(&u, &mut rows);
    assert_eq!(system.gluing().contact().len(), 2);
    for info in system.gluing().contact() {
        let point = &contact[info.point];
        let jump = jump(&b, &system, point, &u);
        let close = |row: usize, scale: f64, direction: &[f64; 3]| {
            let length: f64 = system.gluing().row(row).iter().map(|e| e.2 * e.2).sum();
            (rows[row] / scale - dot(&jump, direction)).abs() < 1e-14 && (length - 1.0).abs() < 1e-14
        };
        assert!(close(info.row, info.scale, &point.frame.normal));
        let TangentialRows::Disc { row, scale } = info.tangential else {
            panic!("friction in both directions");
        };
        assert!(close(row, scale, &point.frame.tangents[0]));
        assert!(close(row + 1, scale, &point.frame.tangents[1]));
    }
    // B and its transpose are adjoint
    let (x, mut f) = (noise(rows.len(), 5), vec![0.0; u.len()]);
    system.add_rows_transposed(&x, &mut f);
    assert!((dot(&x, &rows) - dot(&f, &u)).abs() < 1e-12 * norm(&x) * norm(&rows));
    // a rigid translation does nothing to two sides, and its part along the normal to one
    let [pair, wall] = [0, 1].map(|k| &system.gluing().contact()[k]);
    assert!(system.gluing().direction(pair.row).iter().all(|v| v.abs() < 1e-15));
    let direction = system.gluing().direction(wall.row).map(|v| v / wall.scale);
    assert!(distance(&direction, &frame().normal) < 1e-15);
}

/// The tables of `F`, of `G` and of the split factor take rows on many copies as any others.
#[test]
fn operators_agree_with_the_rows() {
    let b = Brick::new(2, 3);
    let system = system(&b, &b.supports());
    let x = noise(system.dual_dim(), 1);
    let (mut f, mut u) = (vec![0.0; system.torn_dim()], vec![0.0; system.torn_dim()]);
    system.add_rows_transposed(&x, &mut f);
    system.generalised_inverse(&f, &mut u);
    let mut y = vec![0.0; x.len()];
    system.rows_times(&u, &mut y);
    assert!(distance(&y, &product(&system, &x)) < 1e-12 * norm(&y));
    let (coarse, mut s) = (system.coarse(), system.coarse().scratch());
    let (mut g, mut expected) = (vec![0.0; coarse.rows()], vec![0.0; coarse.rows()]);
    coarse.apply(&x, &mut g, &mut s);
    for (row, value) in x.iter().enumerate() {
        for (s, modes) in column(&system, row) {
            (0..6).for_each(|k| expected[6 * s + k] += value * modes[k]);
        }
    }
    assert!(distance(&g, &expected) < 1e-13 * norm(&g));
    let contact = system.gluing().ranges().contact().end;
    let projected = [ActiveSetFactor::Split, ActiveSetFactor::Sparse].map(|kind| {
        let mut space = ActiveSetProjector::with_factor(coarse, contact, None, kind).unwrap();
        let mut weights = vec![1.0; x.len()];
        weights[1] = 0.0;
        space.set_weights(&weights).unwrap();
        let mut p = x.clone();
        space.project(&mut p);
        p
    });
    assert!(distance(&projected[0], &projected[1]) < 1e-12 * norm(&x));
    assert!(system.lumped().is_ok() && system.dirichlet().is_ok());
}

/// A direction that is supported at all nodes is prescribed; otherwise the row stays and knows what supports do to it.
#[test]
fn supports_at_some_nodes_leave_the_row() {
    let b = Brick::new(2, 3);
    let (own, contact) = (own(&b), contact(&b));
    let partner = b.mesh.nodes_on(brick::Z_MAX)[5..9].to_vec();
    let motion = |case, z| Motion::new(case, vec![[0.0, 0.0, z]]);
    let held = |nodes: &[u32], case, z| {
        let z_only = Directions::Components([false, false, true]);
        NodeSupport::partial(nodes.to_vec(), z_only).with_motion(motion(case, z))
    };
    let some = [held(&own[..2], 0, 2e-3), held(&partner[1..], 1, -1e-3)];
    let system = system(&b, &some);
    let g = system.gluing();
    assert_eq!(g.contact().len(), 2);
    let mut u = noise(system.torn_dim(), 3);
    for (nodes, z) in [(&own[..2], 2e-3), (&partner[1..], -1e-3)] {
        for copy in nodes.iter().flat_map(|n| b.decomposition.copies(*n as usize)) {
            let start = system.torn_range(copy.subdomain as usize).start;
            u[start + 3 * copy.local as usize + 2] = z;
        }
    }
    let (mut rows, offsets) = (
        vec![0.0; system.dual_dim()],
        system.prescribed_offsets(Vec::new(), &[(0, 1.0), (1, 1.0)]),
    );
    system.rows_times(&u, &mut rows);
    for info in g.contact() {
        let point = &contact[info.point];
        let found = (rows[info.row] - offsets[info.row]) / info.scale;
        let expected = dot(&jump(&b, &system, point, &u), &point.frame.normal);
        assert!((found - expected).abs() < 1e-14, "{found} {expected}");
    }
    // both sides held in all directions: the weighted mean of what supports prescribe
    let all = [(&own[..], 0, 2e-3), (&partner[..], 1, -1e-3)]
        .map(|(nodes, case, z)| NodeSupport::fixed(nodes.to_vec()).with_motion(motion(case, z)));
    let all = MergedSupports::new(&all, b.mesh.points().len()).unwrap();
    let points = prescribed_points(&contact, &all).unwrap();
    assert_eq!(
        points.iter().map(|p| (p.point, p.node)).collect::<Vec<_>>(),
        [(0, own[0]), (1, own[0])]
    );
    let [(0, a), (1, c)] = points[0].normal[..] else {
        panic!("{points:?}");
    };
    assert!(
        (a + 0.8 * 2e-3).abs() < 1e-16 && (c - 0.8 * -1e-3).abs() < 1e-16,
        "{a} {c}"
    );
}

/// Where supports hold a part of both sides, so that no row says how these move, all of a side moves with that.
#[test]
fn what_supports_hold_of_a_side_takes_the_rest_with_it() {
    let b = Brick::new(1, 2);
    let [down, turn] = [[0.0, 0.0, -1.0], [0.2, -0.1, 0.3]];
    let partner = side(&[2, 3], &[0.4, 0.6]).with_turn(vec![[turn; 3]; 2]);
    let point = ContactConstraint::new(side(&[0, 1], &[0.7, 0.3]), SurfaceFrame::from_normal(down).unwrap());
    let point = point.with_partner(Some(partner));
    let moved = |node: u32, case, by: f64| {
        let held = NodeSupport::partial(vec![node], Directions::Components([false, false, true]));
        held.with_motion(Motion::new(case, vec![[0.0, 0.0, by]]))
    };
    let merged = |supports: &[NodeSupport]| MergedSupports::new(supports, b.mesh.points().len()).unwrap();
    let supports = merged(&[moved(0, 0, 2e-3), moved(2, 1, 5e-4)]);
    let held = prescribed_points(std::slice::from_ref(&point), &supports).unwrap();
    let [(0, own), (1, other)] = held[0].normal[..] else {
        panic!("{held:?}");
    };
    assert!((own + 2e-3).abs() < 1e-16 && (other - 5e-4).abs() < 1e-16, "{held:?}");
    // so of a tie, but where nodes of a side do not move alike
    let tied = [ContactConstraint { tied: true, ..point }];
    let along = |supports: &MergedSupports| {
        let held = held_ties(&tied, supports);
        let [held] = &held[..] else {
            panic!("{held:?}");
        };
        assert!(
            (held.direction[2].abs() - 1.0).abs() < 1e-12 && held.point == 0,
            "{held:?}"
        );
        let values = held.values.clone();
        values.map(|values| values.iter().map(|v| v.1 * held.direction[2]).collect::<Vec<_>>())
    };
    let [own, other] = along(&supports).unwrap()[..] else {
        panic!("two cases");
    };
    assert!(
        (own - 2e-3).abs() < 1e-16 && (other + 5e-4).abs() < 1e-16,
        "{own} {other}"
    );
    let three = ContactConstraint {
        side: side(&[0, 1, 4], &[0.4, 0.3, 0.3]),
        ..tied[0].clone()
    };
    let unlike = merged(&[moved(0, 0, 2e-3), moved(1, 0, 1e-3), moved(2, 1, 5e-4)]);
    assert_eq!(held_ties(&[three], &unlike)[0].values, None);
}

/// Matrices of a side are in its rows beside the mean, whatever supports hold.
#[test]
fn a_side_that_turns_adds_its_matrices() {
    let b = Brick::new(1, 2);
    let (own, top) = (b.bottom[7], b.mesh.nodes_on(brick::Z_MAX));
    let turn = |s: f64| [[0.1 * s, 0.0, -0.3], [0.2, s, 0.0], [0.0, -0.4 * s, 0.5]];
    let partner = side(&top[..2], &[0.75, 0.25]).with_turn(vec![turn(1.0), turn(-2.0)]);
    let point = ContactConstraint::new(side(&[own], &[1.0]), frame());
    let point = point.with_partner(Some(partner)).with_friction(true);
    let held = NodeSupport::fixed(vec![top[1]]);
    for supports in [vec![], vec![held]] {
        let g = gluing(&b, &supports, std::slice::from_ref(&point)).unwrap();
        let info = &g.contact()[0];
        let direction = point.frame.normal;
        for (node, weight, turn) in [
            (own, 1.0, None),
            (top[0], -0.75, Some(turn(1.0))),
            (top[1], -0.25, Some(turn(-2.0))),
        ] {
            let mut found = [0.0; 3];
            for (subdomain, dof, value) in g.row(info.row) {
                if b.decomposition.subdomains()[subdomain].nodes[dof / 3] == node {
                    found[dof % 3] += value / info.scale;
                }
            }
            let mut expected = direction.map(|d| weight * d);
            if let Some(turn) = turn {
                (0..3).for_each(|c| expected[c] -= (0..3).map(|r| turn[r][c] * direction[r]).sum::<f64>());
            }
            if node == top[1] && !supports.is_empty() {
                expected = [0.0; 3];
            }
            assert!(distance(&found, &expected) < 1e-14, "{node}: {found:?} {expected:?}");
        }
    }
}

#[test]
fn a_list_of_one_node_is_the_node() {
    let b = Brick::new(1, 2);
    let (node, other) = (b.bottom[7], b.mesh.nodes_on(brick::Z_MAX)[4]);
    let entries = |own: Side, partner: Side| {
        let point = ContactConstraint::new(own, frame()).with_partner(Some(partner));
        let g = gluing(&b, &[], &[point]).unwrap();
        (g.row(0), g.contact().to_vec(), is_orthonormal(&g))
    };
    let list = entries(side(&[node], &[1.0]), side(&[other], &[1.0]));
    assert_eq!(entries(node.into(), other.into()), list);
}

#[test]
fn bad_sides_are_named() {
    let b = Brick::new(1, 2);
    let make = |points: Vec<ContactConstraint>| gluing(&b, &[], &points).unwrap_err();
    let point = |nodes: &[u32], weights: &[f64]| ContactConstraint::new(side(nodes, weights), frame());
    for (nodes, weights) in [
        (&[][..], &[][..]),
        (&[3, 4], &[0.5, 0.6]),
        (&[3, 4], &[1.0, 0.0]),
        (&[3, 4], &[f64::NAN, 1.0]),
        (&[3, 3], &[0.5, 0.5]),
    ] {
        let error = make(vec![point(&[1], &[1.0]), point(nodes, weights)]);
        assert!(matches!(error, TfetiError::BadSide { point: 1, .. }), "{error}");
    }
    let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for turn in [vec![unit], vec![unit, [[f64::NAN; 3]; 3]]] {
        let turning = side(&[3, 4], &[0.5, 0.5]).with_turn(turn);
        let error = make(vec![point(&[1], &[1.0]).with_partner(Some(turning))]);
        assert!(matches!(error, TfetiError::BadSide { point: 0, .. }), "{error}");
    }
    let error = make(vec![point(&[3, 1 << 20], &[0.5, 0.5])]);
    assert!(matches!(error, TfetiError::UnknownNode { .. }), "{error}");
    let twice = point(&[3, 4], &[0.5, 0.5]);
    for points in [
        vec![twice.clone(), twice.clone()],
        vec![twice.with_partner(Some(side(&[4, 5], &[0.5, 0.5])))],
    ] {
        let error = make(points);
        assert!(matches!(error, TfetiError::ContactNodeTwice { .. }), "{error}");
    }
}
