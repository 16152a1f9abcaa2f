//! Rigid motions that come close to a place without overlap.

use super::friction_cone::{Generators, WrenchCone};
use crate::tolerances::{NULL_RANK, ROUNDING, WEAKLY_PLACED};
use nalgebra::{DMatrix, DVector};
use signorini_qp::vector;

/// Steps out of overlaps: the first is exact to a hundred-thousandth.
const STEPS: usize = 3;

/// The `w` that minimises `|T w - t|` subject to `N w <= n`, of pairs `[T, N]` and `[t, n]`; `None` if there is none.
pub(crate) fn nearest(columns: &[DMatrix<f64>; 2], wanted: &[DVector<f64>; 2]) -> Option<DVector<f64>> {
    let ([near, room], [target, gap]) = (columns, wanted);
    // as many rows as columns: with fewer, motions that no target determines would be left out
    let rows = near.nrows().max(near.ncols());
    let near = near.clone().resize_vertically(rows, 0.0);
    let target = &target.clone().resize_vertically(rows, 0.0);
    let svd = near.svd(true, true);
    let largest = svd.singular_values.max();
    let mut way = svd.solve(target, NULL_RANK * largest).ok()?;
    // steps of length one in what targets determine; what they do not moves as if they determined little of it
    let mut steps = svd.v_t.as_ref()?.transpose();
    let lengths = steps.column_iter_mut().zip(&svd.singular_values);
    lengths.for_each(|(mut step, s)| step /= s.max(WEAKLY_PLACED * largest));
    let opened = -(room * &steps);
    let rounding = ROUNDING * target.amax().max(gap.amax());
    for _ in 0..STEPS {
        // what rounding leaves of room without play, between a floor and a ceiling, is none: it may be overlapped by that
        let over = (room * &way - gap).add_scalar(-rounding);
        let most = over.max();
        if most <= 0.0 {
            break;
        }
        // the shortest step over linear inequalities from non-negative least squares (Lawson and Hanson, chapter 23)
        let generators = opened.row_iter().zip(&over).map(|(opened, over)| {
            let normal: Vec<f64> = opened.iter().copied().chain([over / most]).collect();
            let length = vector::norm(&normal);
            Generators::pressure(normal.iter().map(|v| v / length).collect())
        });
        let dim = opened.ncols();
        let cone = WrenchCone::new(generators.collect());
        let last: Vec<f64> = (0..=dim).map(|k| f64::from(u8::from(k == dim))).collect();
        let apart = cone.separates(&last)?;
        let step = DVector::from_column_slice(&apart[..dim]);
        way -= &steps * step * (most / apart[dim]);
    }
    Some(way)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_place_in_a_polygon() {
        let near = DMatrix::identity(2, 2);
        let room = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 0.0, 1.0, -1.0, -1.0]);
        let gap = DVector::from_vec(vec![0.3, 2.0, 1e3]);
        let at = |x: f64, y: f64| {
            nearest(
                &[near.clone(), room.clone()],
                &[DVector::from_vec(vec![x, y]), gap.clone()],
            )
        };
        for ([x, y], place) in [
            ([0.1, 0.2], [0.1, 0.2]),
            ([1.0, 1.0], [0.3, 1.0]),
            ([7.0, 9.0], [0.3, 2.0]),
            ([-600.0, -500.0], [-550.0, -450.0]),
        ] {
            let found = at(x, y).expect("a place");
            assert!(
                (found - DVector::from_column_slice(&place)).norm() < 1e-9 * x.hypot(y),
                "{x} {y}"
            );
        }
        // what no target determines moves, too
        let [one, both] = [&[1.0, 0.0][..], &[0.0, -1.0]].map(|row| DMatrix::from_row_slice(1, 2, row));
        let wanted = [DVector::from_vec(vec![3.0]), DVector::from_vec(vec![-0.5])];
        let found = nearest(&[one, both], &wanted).expect("a place");
        assert!((found - DVector::from_vec(vec![3.0, 0.5])).norm() < 1e-9);
        // between two walls without play, which rounding has moved into each other
        let walls = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, -1.0]);
        let wanted = [vec![8e-3, 1e-12], vec![0.0, -1e-15]].map(DVector::from_vec);
        let found = nearest(&[near.clone(), walls], &wanted).expect("a place");
        assert!((found - DVector::from_vec(vec![8e-3, 0.0])).norm() < 1e-13);
        let none = DVector::from_vec(vec![-1.0, -1.0, 1.0]);
        assert!(nearest(&[near.clone(), room.clone()], &[DVector::zeros(2), none]).is_none());
    }
}
