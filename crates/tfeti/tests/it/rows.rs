//! Counts, independence and coefficients of the rows of `B`.

use crate::common::{Brick, gluing, gram, is_orthonormal, rigid, smallest_eigenvalue};
use signorini_fem_mesh::{Decomposition, Hooke, Materials, SurfaceFrame, brick};
use signorini_tfeti::{
    ContactConstraint, Directions, Motion, NodeSupport, Side, TangentialRows, TfetiBuilder, TfetiError,
};

#[test]
fn counts_of_the_papers_table() {
    for (n, rows) in [(1, 612), (2, 5685), (3, 20136), (4, 48879), (5, 96828)] {
        let b = Brick::new(n, 5);
        assert_eq!(b.decomposition.torn_dofs(), [1944, 15552, 52488, 124416, 243000][n - 1]);
        {
            let g = gluing(&b, &b.supports(), &b.contact(true)).unwrap();
            assert_eq!(g.rows_as_paper(), rows);
            assert_eq!(g.ranges().total(), rows - 3 * (5 * n + 1));
            // contact rows of the fixed edge are left out
            assert!(
                g.contact()
                    .iter()
                    .all(|c| b.fixed.binary_search(&g.node(c.row).unwrap()).is_err())
            );
        }
    }
}

#[test]
fn rows_are_orthonormal() {
    let b = Brick::new(1, 2);
    let supports = [
        NodeSupport::fixed(b.fixed.clone()),
        NodeSupport::partial(
            b.mesh.nodes_on(brick::Y_MIN),
            Directions::Components([false, true, false]),
        ),
        NodeSupport::partial(
            vec![b.mesh.nodes_on(brick::X_MAX)[0]],
            Directions::Vectors(vec![[1.0, 2.0, 0.0]]),
        ),
    ];
    let g = gluing(&b, &supports, &b.contact(true)).unwrap();
    assert!(is_orthonormal(&g));
    for (i, row) in gram(&g).iter().enumerate() {
        for (j, v) in row.iter().enumerate() {
            assert!((v - f64::from(u8::from(i == j))).abs() < 1e-13, "rows {i} {j}: {v}");
        }
    }
}

#[test]
fn without_friction_there_are_no_tangential_rows() {
    let b = Brick::new(1, 2);
    let g = gluing(&b, &b.supports(), &b.contact(false)).unwrap();
    assert!(g.ranges().tangential().is_empty());
    assert_eq!(g.ranges().normal.len(), b.bottom.len() - 3);
    assert!(g.contact().iter().all(|c| c.tangential == TangentialRows::None));
}

#[test]
fn pairs_of_nodes_act_on_the_relative_displacement() {
    let b = Brick::new(1, 2);
    // Take two nodes of one body as the pair; the rows do not know the difference.
    let (a, o) = (b.bottom[b.bottom.len() - 1], b.mesh.nodes_on(brick::Z_MAX)[4]);
    let point = ContactConstraint::new(a, b.frames[0])
        .with_partner(Some(o))
        .with_friction(true);
    let contact = [point];
    let g = gluing(&b, &[], &contact).unwrap();
    assert!(is_orthonormal(&g));
    let (ka, ko) = (
        b.decomposition.copies(a as usize).len() as f64,
        b.decomposition.copies(o as usize).len() as f64,
    );
    let info = &g.contact()[0];
    assert!((info.scale - (1.0 / ka + 1.0 / ko).sqrt().recip()).abs() < 1e-14);
    let displacement = |s: usize, dof: usize| {
        let node = b.decomposition.subdomains()[s].nodes[dof / 3];
        if node == a { [1.0, 2.0, 3.0][dof % 3] } else { [-4.0, 0.5, 1.0][dof % 3] }
    };
    let action: f64 = g
        .row(info.row)
        .iter()
        .map(|&(s, dof, v)| v * displacement(s, dof))
        .sum();
    assert!((action / info.scale - -(3.0 - 1.0)).abs() < 1e-13);
    // With the partner fixed the pair is a point against an obstacle.
    let supports = [NodeSupport::fixed(vec![o])];
    let g = gluing(&b, &supports, &contact).unwrap();
    assert!(smallest_eigenvalue(&gram(&g)) > 1e-3);
    let info = &g.contact()[0];
    assert!(matches!(info.tangential, TangentialRows::Disc { .. }));
    let action: f64 = g
        .row(info.row)
        .iter()
        .map(|&(_, dof, v)| v * [1.0, 2.0, 3.0][dof % 3])
        .sum();
    assert!((action / info.scale + 3.0).abs() < 1e-13);
}

/// A node may have several partners, and meet obstacles besides; the same pair along the same normal is one too many,
/// from whichever side it is seen.
#[test]
fn nodes_of_pairs_may_have_other_points() {
    let b = Brick::new(1, 2);
    let (a, frame) = (b.bottom[1], b.frames[0]);
    let [o, q] = [1, 4].map(|k| b.mesh.nodes_on(brick::Z_MAX)[k]);
    let reversed = SurfaceFrame::from_normal(frame.normal.map(|c| -c)).unwrap();
    let sideways = SurfaceFrame::from_normal([1.0, 0.0, 0.0]).unwrap();
    let pair = |node: u32, frame, partner: Option<u32>| ContactConstraint::new(node, frame).with_partner(partner);
    let make = |points: Vec<ContactConstraint>| gluing(&b, &[], &points);
    let first = || pair(a, frame, Some(o));
    for second in [
        pair(a, frame, Some(q)),
        pair(a, sideways, Some(o)),
        pair(a, frame, None),
        pair(q, frame, Some(o)),
        pair(o, frame, Some(a)),
    ] {
        let g = make(vec![first(), second.clone()]).unwrap();
        assert_eq!(g.ranges().normal.len(), 2, "{second:?}");
        assert!(smallest_eigenvalue(&gram(&g)) > 1e-6 || second.side == o.into());
        let sides = std::iter::once(&second.side).chain(&second.partner);
        for node in sides.flat_map(Side::nodes).map(|n| n.0).chain([a, o]) {
            assert!(g.is_dependent(node), "{second:?}: {node}");
        }
    }
    let alone = make(vec![first()]).unwrap();
    assert!(is_orthonormal(&alone) && alone.dependent_nodes().is_empty());
    for second in [first(), pair(o, reversed, Some(a)), pair(q, frame, Some(q))] {
        let error = make(vec![first(), second.clone()]).unwrap_err();
        assert!(
            matches!(error, TfetiError::ContactNodeTwice { .. }),
            "{second:?}: {error}"
        );
    }
}

#[test]
fn bad_input_is_named() {
    let b = Brick::new(1, 2);
    let many = b.mesh.points().len() as u32;
    let err = |supports: &[NodeSupport], contact: &[ContactConstraint]| gluing(&b, supports, contact).unwrap_err();
    assert!(
        matches!(err(&[NodeSupport::fixed(vec![many])], &[]), TfetiError::UnknownNode { node, .. } if node == many)
    );
    assert!(matches!(
        err(&[NodeSupport::fixed(vec![])], &[]),
        TfetiError::EmptySupport { what: "nodes", .. }
    ));
    let none = NodeSupport::partial(vec![0], Directions::Components([false; 3]));
    assert!(matches!(
        err(&[none], &[]),
        TfetiError::EmptySupport { what: "directions", .. }
    ));
    for direction in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]] {
        let support = NodeSupport::partial(vec![0], Directions::Vectors(vec![direction]));
        assert!(matches!(
            err(&[support], &[]),
            TfetiError::BadDirection {
                support: 0,
                node: None,
                direction: 0
            }
        ));
    }
    let motion = |values| Motion::new(0, values);
    let support = NodeSupport::fixed(vec![0, 1]).with_motion(motion(vec![[0.0; 3]; 3]));
    assert!(matches!(
        err(&[support], &[]),
        TfetiError::MotionLength { found: 3, nodes: 2, .. }
    ));
    let support = NodeSupport::fixed(vec![0, 1]).with_motion(motion(vec![[0.0; 3], [f64::NAN; 3]]));
    assert!(matches!(err(&[support], &[]), TfetiError::BadMotion { node: 1, .. }));
    let mut contact = b.contact(true);
    contact[3].side = contact[2].side.clone();
    assert!(matches!(err(&[], &contact), TfetiError::ContactNodeTwice { .. }));
    let mut contact = b.contact(true);
    contact[1].partner = Some(Side::node(many + 5));
    assert!(matches!(err(&[], &contact), TfetiError::UnknownNode { .. }));
    let mut contact = b.contact(true);
    contact[1].frame.normal = [0.0, 0.1, -1.0];
    assert!(matches!(err(&[], &contact), TfetiError::BadFrame { point: 1, .. }));
}

#[test]
fn a_whole_body_has_no_interface_rows() {
    let b = Brick::new(1, 2);
    let whole = Decomposition::whole(&b.mesh);
    let frame: SurfaceFrame = b.frames[0];
    let contact = rigid(&b.bottom, &vec![frame; b.bottom.len()], true);
    let supports = b.supports();
    let builder = TfetiBuilder::new(&b.mesh, &whole, &b.materials).with_supports(&supports);
    let system = builder.with_contact(&contact).build().unwrap();
    let g = system.gluing();
    assert!(g.ranges().interface.is_empty());
    assert!(g.contact().iter().all(|c| (c.scale - 1.0).abs() < 1e-15));
    let down = |row: &[(usize, usize, f64)]| matches!(row, [(0, dof, v)] if dof % 3 == 2 && *v == -1.0);
    assert!(g.contact().iter().all(|c| down(&g.row(c.row))));
}

/// Between a stiff and a soft subdomain a contact row follows the stiff one, and gluing errors of the soft one stay out
/// of it. Physical forces and gaps go with the sum of the coefficients.
#[test]
fn contact_rows_follow_the_stiff_copy() {
    let mut b = Brick::new(1, 2);
    let ratio = 1e4;
    let regions = (0..b.mesh.tets().len())
        .map(|t| u32::from(b.mesh.tet_points(t).iter().all(|p| p[0] >= 1.0 && p[0] <= 2.0)))
        .collect();
    b.mesh = b.mesh.with_regions(regions).unwrap();
    let hooke = |young| Hooke::isotropic(young, 0.3).unwrap();
    let materials = Materials::new(vec![(0, hooke(1.0)), (1, hooke(1.0 / ratio))]).unwrap();
    let (supports, contact) = (b.supports(), b.contact(true));
    let system = TfetiBuilder::new(&b.mesh, &b.decomposition, &materials)
        .with_supports(&supports)
        .with_contact(&contact)
        .build()
        .unwrap();
    let g = system.gluing();
    assert!(!is_orthonormal(g));
    for (i, row) in gram(g).iter().enumerate() {
        assert!((row[i] - 1.0).abs() < 1e-13);
    }
    let mut shared = 0;
    for info in g.contact() {
        let row = g.row(info.row);
        let sum: f64 = row.iter().map(|e| -e.2).sum();
        assert!((sum - info.scale).abs() < 1e-13);
        if row.len() == 2 {
            shared += 1;
            let soft = row.iter().position(|e| e.0 == 1).unwrap();
            let found = row[1 - soft].2 / row[soft].2;
            assert!(found > 0.1 * ratio && found < 10.0 * ratio, "{found}");
        }
    }
    assert_eq!(shared, 6);
    let mut torn = vec![0.0; system.torn_dim()];
    torn[system.torn_range(0)].fill(1.0);
    let mean = system.nodal_mean(&torn);
    for node in b.mesh.nodes_on(brick::Z_MIN) {
        let x = b.mesh.points()[node as usize][0];
        if x == 1.0 {
            assert!((mean[3 * node as usize] - 1.0).abs() < 10.0 / ratio);
        }
    }
}
