//! Work memory carries nothing from one product to the next.

use crate::common::{Brick, build, noise};
use signorini_qp::internal::LineWeight;
use signorini_qp::{Equality, SymmetricOperator};
use signorini_tfeti::RowWeights;
use signorini_tfeti::internal::InverseKind;

#[test]
fn scratch_is_reused() {
    let b = Brick::new(1, 3);
    for kind in [InverseKind::Dense, InverseKind::Sparse] {
        let system = build(&b, kind, true);
        let f = system.dual();
        let (x, mut s) = (noise(f.dim(), 1), f.scratch());
        let (mut y, mut z) = (vec![0.0; f.dim()], vec![0.0; f.dim()]);
        f.apply(&x, &mut y, &mut s);
        f.apply(&noise(f.dim(), 2), &mut z, &mut s);
        f.apply(&x, &mut z, &mut s);
        assert_eq!(y, z);
        let c = system.coarse_factor().unwrap().orthonormal().unwrap();
        let (mut cs, mut a, mut again) = (c.scratch(), vec![0.0; c.rows()], vec![0.0; c.rows()]);
        c.apply(&x, &mut a, &mut cs);
        c.apply_transpose(&a, &mut z, &mut cs);
        c.apply(&x, &mut again, &mut cs);
        assert_eq!(a, again);
    }
}

#[test]
fn line_weights_act_like_a_rotated_diagonal() {
    let b = Brick::new(1, 3);
    let system = b.system();
    let (coarse, ranges) = (system.coarse(), system.gluing().ranges().clone());
    let diagonal: Vec<f64> = (0..coarse.dim())
        .map(|r| f64::from(u8::from(!ranges.contact().contains(&r))))
        .collect();
    // Directions along the axes are the same as a diagonal with one of the two rows.
    let (row, other) = (ranges.discs.start, ranges.discs.start + 4);
    let mut lines = RowWeights::diagonal(diagonal.clone());
    lines.lines = vec![
        LineWeight {
            row,
            direction: [1.0, 0.0],
            weight: 0.7,
        },
        LineWeight {
            row: other,
            direction: [0.0, -1.0],
            weight: 0.3,
        },
    ];
    let mut plain = diagonal;
    plain[row] = 0.7;
    plain[other + 1] = 0.3;
    let factors = [lines, RowWeights::diagonal(plain)].map(|w| coarse.factor_weighted(w).unwrap());
    let results = factors.map(|factor| {
        let (mut x, mut s) = (noise(coarse.dim(), 6), coarse.scratch());
        factor.project(&mut x, None, &mut s);
        x
    });
    assert!(crate::common::distance(&results[0], &results[1]) < 1e-11 * crate::common::norm(&results[0]));
    let mut crossed = RowWeights::diagonal(vec![1.0; coarse.dim()]);
    crossed.lines = vec![LineWeight {
        row: ranges.normal.start,
        direction: [1.0, 0.0],
        weight: 1.0,
    }];
    assert!(coarse.factor_weighted(crossed).is_err());
}
