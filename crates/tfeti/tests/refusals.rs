//! Arguments that do not fit are refused by errors.

mod common;

use common::{Brick, build};
use signorini_fem_mesh::Decomposition;
use signorini_qp::{EqualityProjector, QpError};
use signorini_tfeti::{
    ActiveSetFactor, ActiveSetProjector, CopyStiffness, Gluing, InverseKind, LineWeight, Motion,
    NodeSupport, RowScaling, RowWeights, Sharing, Tfeti, TfetiBuilder, TfetiError,
};

fn system(b: &Brick) -> Tfeti {
    let (rule, sharing) = (RowScaling::Orthonormal, Sharing::Translates);
    build(b, InverseKind::Auto, sharing, rule)
}

#[test]
fn face_spaces_check_their_arguments() {
    let system = system(&Brick::new(1, 2));
    let (coarse, dim) = (system.coarse(), system.dual_dim());
    let contact = system.gluing().ranges().contact().end;
    for kind in [
        ActiveSetFactor::Auto,
        ActiveSetFactor::Sparse,
        ActiveSetFactor::Split,
    ] {
        let new = |rows, metric| ActiveSetProjector::with_factor(coarse, rows, metric, kind);
        for rows in [contact + 1, dim + 1, usize::MAX] {
            let error = new(rows, None).unwrap_err();
            assert!(matches!(error, TfetiError::Setting { .. }), "{error}");
        }
        for length in [0, dim - 1, dim + 1] {
            let error = new(contact, Some(vec![1.0; length])).unwrap_err();
            assert!(matches!(error, TfetiError::Length { .. }), "{error}");
        }
        let mut metric = vec![1.0; dim];
        metric[0] = -1.0;
        let error = new(contact, Some(metric)).unwrap_err();
        assert!(matches!(error, TfetiError::Setting { .. }), "{error}");
        let mut space = new(contact, Some(vec![1.0; dim])).unwrap();
        for length in [0, dim - 1, dim + 1] {
            let error = space.set_weights(&vec![1.0; length]).unwrap_err();
            assert!(matches!(error, QpError::Length { .. }), "{error}");
        }
        let line = |row, direction| LineWeight {
            row,
            direction,
            weight: 1.0,
        };
        let disc = system.gluing().ranges().discs.start;
        let mut w = vec![1.0; dim];
        w[disc..disc + 2].fill(0.0);
        for line in [line(dim, [1.0, 0.0]), line(disc, [1.0, 1.0])] {
            assert!(space.set_weights_and_lines(&w, &[line]).is_err());
        }
        assert_eq!(
            space.set_weights_and_lines(&w, &[line(disc, [0.6, 0.8])]),
            Ok(true)
        );
    }
}

#[test]
fn line_directions_are_unit_vectors() {
    let system = system(&Brick::new(1, 2));
    let factor = |direction| {
        let mut weights = RowWeights::diagonal(vec![1.0; system.dual_dim()]);
        let row = system.gluing().ranges().discs.start;
        let weight = 1.0;
        weights.lines.push(LineWeight {
            row,
            direction,
            weight,
        });
        system.coarse().factor_weighted(weights)
    };
    assert!(factor([0.6, -0.8]).is_ok());
    let huge = [f64::INFINITY, 0.0];
    for direction in [[0.0; 2], [1.0, 1e-4], [f64::NAN, 1.0], huge] {
        let error = factor(direction).unwrap_err();
        assert!(matches!(error, TfetiError::Setting { .. }), "{error}");
    }
}

#[test]
fn a_system_of_other_subdomains_is_not_reused() {
    let mut b = Brick::new(1, 2);
    let first = system(&b);
    // The same number of subdomains and torn nodes, in another order.
    let part = |t| {
        let x = b.mesh.tet_points(t).iter().map(|p| p[0]).sum::<f64>() / 4.0;
        u32::from(x > 0.5) + u32::from(x > 2.0)
    };
    let parts: Vec<u32> = (0..b.mesh.tets().len()).map(part).collect();
    b.decomposition = Decomposition::from_parts(&b.mesh, &parts).unwrap();
    assert_eq!(b.decomposition.torn_dofs(), first.torn_dim());
    let error = TfetiBuilder::new(&b.mesh, &b.decomposition, &b.materials)
        .with_reuse(&first)
        .build()
        .unwrap_err();
    assert!(
        matches!(
            error,
            TfetiError::DecompositionMismatch {
                what: "nodes in a subdomain",
                found: 18,
                expected: 27
            }
        ),
        "{error}"
    );
}

#[test]
fn cases_beyond_the_supports_are_refused() {
    let b = Brick::new(1, 2);
    let gluing = |case| {
        let values = vec![[0.0; 3]];
        let support = NodeSupport::fixed(b.fixed.clone()).with_motion(Motion { case, values });
        let (nodes, rule) = (b.mesh.points().len(), RowScaling::Orthonormal);
        let stiffness = CopyStiffness::default();
        Gluing::new(&b.decomposition, nodes, &[support], None, rule, &stiffness)
    };
    assert_eq!(gluing(0).unwrap().prescribed_cases(), 1);
    for case in [1, u32::MAX] {
        let error = gluing(case).unwrap_err();
        assert!(
            matches!(
                error,
                TfetiError::CaseNumber {
                    support: 0,
                    supports: 1,
                    ..
                }
            ),
            "{error}"
        );
    }
}

#[test]
fn gluing_checks_what_belongs_to_the_decomposition() {
    let b = Brick::new(1, 2);
    let stiffness = system(&b).all_copy_stiffness();
    let gluing = |decomposition: &Decomposition, nodes, stiffness: &CopyStiffness| {
        let (supports, contact) = (b.supports(), b.contact(true));
        let rule = RowScaling::Orthonormal;
        Gluing::new(
            decomposition,
            nodes,
            &supports,
            Some(&contact),
            rule,
            stiffness,
        )
    };
    let nodes = b.mesh.points().len();
    assert!(gluing(&b.decomposition, nodes, &stiffness).is_ok());
    for wrong in [0, nodes - 1, nodes + 1] {
        let error = gluing(&b.decomposition, wrong, &stiffness).unwrap_err();
        assert!(
            matches!(
                error,
                TfetiError::DecompositionMismatch { what: "nodes", .. }
            ),
            "{error}"
        );
    }
    for other in [
        Decomposition::whole(&b.mesh),
        Decomposition::boxes(&b.mesh, [6, 1, 1]).unwrap(),
    ] {
        let error = gluing(&other, nodes, &stiffness).unwrap_err();
        assert!(
            matches!(error, TfetiError::ForeignStiffness { subdomain: 0, .. }),
            "{error}"
        );
    }
}
