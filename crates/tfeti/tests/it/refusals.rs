//! Arguments that do not fit are refused by errors.

use crate::common::{Brick, gluing};
use signorini_qp::internal::LineWeight;
use signorini_qp::{EqualityProjector, QpError};
use signorini_tfeti::internal::{ActiveSetFactor, MergedSupports};
use signorini_tfeti::{
    ActiveSetProjector, CommunicationError, Communicator, Directions, Motion, NodalSpring, NodeSupport, RowWeights,
    TfetiError,
};
use std::ops::Range;
use std::sync::Arc;

#[test]
fn projectors_check_their_arguments() {
    let system = Brick::new(1, 2).system();
    let (coarse, dim) = (system.coarse(), system.dual_dim());
    let contact = system.gluing().ranges().contact().end;
    for kind in [ActiveSetFactor::Auto, ActiveSetFactor::Sparse, ActiveSetFactor::Split] {
        let new = |rows, metric| ActiveSetProjector::with_factor(coarse, rows, metric, kind);
        for rows in [contact + 1, dim + 1, usize::MAX] {
            let error = new(rows, None).unwrap_err();
            assert!(matches!(error, TfetiError::Setting { .. }), "{error}");
        }
        for length in [0, contact, dim - 1, dim + 1] {
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
        assert_eq!(space.set_weights_and_lines(&w, &[line(disc, [0.6, 0.8])]), Ok(true));
    }
}

#[test]
fn line_directions_are_unit_vectors() {
    let system = Brick::new(1, 2).system();
    let factor = |direction| {
        let mut weights = RowWeights::diagonal(vec![1.0; system.dual_dim()]);
        let row = system.gluing().ranges().discs.start;
        let weight = 1.0;
        weights.lines.push(LineWeight { row, direction, weight });
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
fn cases_beyond_the_supports_are_refused() {
    let b = Brick::new(1, 2);
    let of_case = |case| {
        let values = vec![[0.0; 3]];
        let support = NodeSupport::fixed(b.fixed.clone()).with_motion(Motion::new(case, values));
        gluing(&b, &[support], &[])
    };
    assert!(of_case(0).is_ok());
    for case in [1, u32::MAX] {
        let error = of_case(case).unwrap_err();
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

/// A direction of one node among many is named by the node, one of all by its place.
#[test]
fn bad_directions_are_named_by_their_nodes() {
    let of = |directions| MergedSupports::new(&[NodeSupport::partial((10..30).collect(), directions)], 100);
    let mut lists = vec![vec![[0.0, 0.0, 1.0]]; 20];
    for bad in [[0.0; 3], [f64::NAN, 0.0, 1.0]] {
        lists[7] = vec![bad];
        let error = of(Directions::EachNode(lists.clone())).unwrap_err();
        assert!(error.to_string().contains("node 17"), "{error}");
        let error = of(Directions::Vectors(vec![[1.0, 0.0, 0.0], bad])).unwrap_err();
        assert!(error.to_string().contains("support 0: direction 1"), "{error}");
    }
}

#[test]
fn springs_have_unit_directions() {
    let b = Brick::new(1, 2);
    let resting = |direction, stiffness, rest| {
        let springs = [NodalSpring {
            node: 0,
            direction,
            stiffness,
            rest,
        }];
        let supports = b.supports();
        b.builder(&supports).with_springs(&springs).build()
    };
    let of = |direction, stiffness| resting(direction, stiffness, Vec::new());
    assert!(of([0.6, 0.0, -0.8], 1e9).is_ok());
    for direction in [
        [0.0; 3],
        [2.0, 0.0, 0.0],
        [f64::NAN, 0.0, 1.0],
        [f64::INFINITY, 0.0, 0.0],
    ] {
        let error = of(direction, 1e9).err();
        assert!(matches!(error, Some(TfetiError::Spring { node: 0, .. })), "{error:?}");
    }
    for rest in [(7, 1e-3), (u32::MAX, 0.0)] {
        let error = resting([0.6, 0.0, -0.8], 1e9, vec![rest]).err();
        assert!(
            matches!(error, Some(TfetiError::SpringRest { node: 0, .. })),
            "{error:?}"
        );
    }
}

/// A communicator that a user wrote.
#[derive(Debug)]
struct Ranks(usize, usize);

impl Communicator for Ranks {
    fn rank(&self) -> usize {
        self.0
    }

    fn size(&self) -> usize {
        self.1
    }

    fn gather_while(
        &self,
        _: &mut [f64],
        _: &[Range<usize>],
        work: &mut dyn FnMut(),
    ) -> Result<(), CommunicationError> {
        work();
        Ok(())
    }
}

#[test]
fn a_communicator_is_a_rank_of_some() {
    let brick = Brick::new(1, 2);
    let supports = brick.supports();
    for (rank, size) in [(0, 0), (2, 2)] {
        let communicator: Arc<dyn Communicator> = Arc::new(Ranks(rank, size));
        let error = brick.builder(&supports).with_communicator(&communicator).build();
        let expected = CommunicationError::NoRank { rank, size };
        assert!(matches!(error, Err(TfetiError::Communication(e)) if e == expected));
    }
}
