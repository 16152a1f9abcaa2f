//! Wrong input is refused with an error that names it.

use signorini_qp::kprgp::KprgpWorkspace;
use signorini_qp::problem::Diagonal;
use signorini_qp::smalse::SmalseWorkspace;
use signorini_qp::{
    DenseEquality, DenseOperator, DenseProjector, Equality, EqualityProjector, KprgpSettings, MovingSet, ProductSet,
    QpError, QuadraticCost, Segment, SetError, SmalseSettings, Status, SymmetricOperator, kprgp, smalse,
};

use crate::common::{pair, run};

#[test]
fn wrong_input_of_kprgp_is_named() {
    let (a, free, s) = (pair(), ProductSet::free(2), KprgpSettings::default());
    assert!(matches!(
        run(&a, &[0.0], &free, &mut [0.0; 2], &s),
        Err(QpError::Length {
            found: 1,
            expected: 2,
            ..
        })
    ));
    assert!(matches!(
        run(&a, &[0.0; 2], &free, &mut [0.0; 3], &s),
        Err(QpError::Length { found: 3, .. })
    ));
    assert!(matches!(
        run(&a, &[0.0; 2], &ProductSet::free(3), &mut [0.0; 2], &s),
        Err(QpError::Length { what: "the set", .. })
    ));
    assert!(matches!(
        run(&a, &[f64::NAN, 0.0], &free, &mut [0.0; 2], &s),
        Err(QpError::Input { entry: 0, .. })
    ));
    for bad in [
        s.with_step_length(2.5),
        s.with_step_length(f64::NAN),
        s.with_proportioning(0.0),
        s.with_max_products(0),
    ] {
        assert!(matches!(
            run(&a, &[0.0; 2], &free, &mut [0.0; 2], &bad),
            Err(QpError::Setting { .. })
        ));
    }
    let mut work = KprgpWorkspace::new(&a);
    let wrong_norm = kprgp(
        &QuadraticCost::new(&a, &[0.0; 2], 0.0),
        &free,
        1e-6,
        &s,
        &mut [0.0; 2],
        &mut work,
    );
    assert!(matches!(wrong_norm, Err(QpError::Setting { name: "norm", .. })));
}

#[test]
fn wrong_input_of_smalse_is_named() {
    let a = DenseOperator::new(2, vec![1.0, 0.0, 0.0, 1.0]).expect("symmetric");
    let c = DenseEquality::orthonormal(1, 2, &[1.0, 1.0]).expect("row");
    let mut set = ProductSet::free(2);
    let mut work = SmalseWorkspace::new(&a, &c);
    let s = SmalseSettings::default();
    let mut go = |e: &[f64], beta: &mut [f64], s: &SmalseSettings| {
        let cost = QuadraticCost::new(&a, &[1.0; 2], 1.0).with_equality(&c, e);
        smalse(&cost, MovingSet::fixed(&mut set), &mut [0.0; 2], beta, s, &mut work).map(|r| r.status)
    };
    assert_eq!(go(&[1.0], &mut [0.0], &s), Ok(Status::Converged));
    assert!(matches!(
        go(&[], &mut [0.0], &s),
        Err(QpError::Length {
            what: "the right side e",
            ..
        })
    ));
    assert!(matches!(
        go(&[1.0], &mut [], &s),
        Err(QpError::Length {
            what: "the multiplier",
            ..
        })
    ));
    assert!(matches!(
        go(&[f64::INFINITY], &mut [0.0], &s),
        Err(QpError::Input { .. })
    ));
    for bad in [
        s.with_penalty(0.0),
        s.with_precision(-1.0),
        s.with_gradient_cap(f64::NAN),
        s.with_equality(0.0),
        s.with_max_outer(0),
        s.with_shrink(1.0),
    ] {
        assert!(
            matches!(go(&[1.0], &mut [0.0], &bad), Err(QpError::Setting { .. })),
            "{bad:?}"
        );
    }
}

#[test]
fn sizes_that_cannot_be_counted_are_refused() {
    assert!(DenseOperator::new(1 << 32, Vec::new()).is_err());
    assert!(DenseEquality::orthonormal(1 << 20, 0, &[]).is_err());
    let long = vec![Segment::Free(usize::MAX), Segment::Free(2)];
    assert!(ProductSet::new(long).is_err());
}

#[test]
fn wrong_sets_are_named() {
    let bounds = |l: f64, u: f64| ProductSet::new(vec![Segment::Free(1), Segment::bounds(vec![0.0, l], vec![1.0, u])]);
    for (l, u) in [
        (2.0, 1.0),
        (f64::NAN, 1.0),
        (0.0, f64::NAN),
        (f64::INFINITY, f64::INFINITY),
    ] {
        assert!(matches!(
            bounds(l, u),
            Err(SetError::Bounds {
                segment: 1,
                entry: 1,
                ..
            })
        ));
    }
    let uneven = ProductSet::new(vec![Segment::bounds(vec![0.0], vec![])]);
    assert!(matches!(
        uneven,
        Err(SetError::Lengths {
            segment: 0,
            lower: 1,
            upper: 0
        })
    ));
    for r in [-1.0, f64::NAN] {
        assert!(matches!(
            ProductSet::new(vec![Segment::discs(vec![1.0, r])]),
            Err(SetError::Radius {
                segment: 0,
                entry: 1,
                ..
            })
        ));
    }
}

#[test]
fn dependent_rows_are_named() {
    let g = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 3.0, -2.0, 0.0];
    assert!(matches!(
        DenseEquality::orthonormal(3, 3, &g),
        Err(QpError::DependentRow { row: 2, .. })
    ));
    assert!(matches!(
        DenseEquality::orthonormal(1, 2, &[0.0, 0.0]),
        Err(QpError::DependentRow { row: 0, .. })
    ));
}

#[test]
fn wrong_dimensions_and_weights_of_a_projector_are_named() {
    let new = |rows, dim| DenseProjector::new(rows, dim, vec![1.0; 2]).map(|_| ());
    assert!(matches!(new(1, 3), Err(QpError::Length { .. })));
    assert!(matches!(new(2, 1), Err(QpError::CoarseDeficient { .. })));
    for (rows, dim) in [(0, usize::MAX), (usize::MAX, 0)] {
        assert!(DenseProjector::new(rows, dim, Vec::new()).is_err(), "{rows} x {dim}");
    }
    let mut projector = DenseProjector::new(1, 2, vec![1.0; 2]).expect("one row");
    let error = projector.set_weights(&[5.0, -1.0]);
    assert!(matches!(error, Err(QpError::Setting { name: "weight", .. })));
}

/// A projector whose weights are refused stays what it was.
#[test]
fn refused_weights_leave_the_projector_as_it_was() {
    let g = vec![1.0, 2.0, 0.0, 1.0, 0.0, 3.0, 1.0, 0.5];
    let mut projector = DenseProjector::new(2, 4, g).expect("two rows");
    let projected = |projector: &mut DenseProjector| {
        let mut x = vec![1.0, -2.0, 3.0, 0.5];
        projector.project(&mut x);
        projector.project_transpose(&mut x);
        x
    };
    let weights = [1.0, 2.0, 0.0, 1.0];
    assert!(projector.set_weights(&weights).expect("weights"));
    let before = projected(&mut projector);
    for _ in 0..2 {
        let error = projector.set_weights(&[1.0, 0.0, 0.0, 0.0]);
        assert!(matches!(error, Err(QpError::CoarseDeficient { .. })), "{error:?}");
        assert_eq!(projected(&mut projector), before);
    }
    assert!(!projector.set_weights(&weights).expect("the same weights"));
    assert!(projector.set_weights(&[1.0; 4]).expect("weights"));
}

/// None leaves what is behind the product as it was.
#[test]
fn products_into_longer_vectors_panic() {
    let diagonal = Diagonal::new(vec![2.0; 2]).expect("a diagonal");
    let equality = DenseEquality::orthonormal(1, 2, &[3.0, 4.0]).expect("a row");
    let panics = |product: &dyn Fn(&mut [f64])| {
        let product = std::panic::AssertUnwindSafe(|| product(&mut [7.0; 3]));
        std::panic::catch_unwind(product).is_err()
    };
    let x = [1.0, 2.0];
    assert!(panics(&|y| pair().apply(&x, y, &mut ())), "operator");
    assert!(panics(&|y| diagonal.apply(&x, y, &mut ())), "diagonal");
    assert!(panics(&|y| equality.apply(&x, y, &mut ())), "equality");
}
