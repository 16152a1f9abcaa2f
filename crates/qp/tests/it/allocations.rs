//! With a workspace made before, a solve allocates nothing.

use crate::common::{self, Random};
use allocation_counter::measure;
use signorini_qp::kprgp::{Expansion, KprgpWorkspace};
use signorini_qp::smalse::SmalseWorkspace;
use signorini_qp::{KprgpSettings, MovingSet, ProductSet, QuadraticCost, Segment, SmalseSettings, kprgp, smalse};

#[test]
fn solves_allocate_nothing() {
    let mut r = Random::new(8);
    let n = 40;
    let (a, norm) = common::spd(n, 3.0, &mut r);
    let mut set = ProductSet::new(vec![
        Segment::upper(vec![0.0; 10]),
        Segment::discs(vec![0.1; 10]),
        Segment::Free(10),
    ])
    .expect("set");
    let b = r.vector(n);
    for expansion in [Expansion::FixedStep, Expansion::ProjectedCg] {
        let settings = KprgpSettings::default().with_expansion(expansion);
        let mut work = KprgpWorkspace::new(&a);
        let mut x = vec![0.0; n];
        let mut products = 0;
        let count = measure(|| {
            let t = 1e-8;
            let report =
                kprgp(&QuadraticCost::new(&a, &b, norm), &set, t, &settings, &mut x, &mut work).expect("solve");
            products = report.products.total();
        });
        assert!(products > 10);
        assert_eq!(count.count_total, 0, "{expansion:?}");
    }
    let (c, e) = common::equality(n, 5, &set, &mut r);
    let mut work = SmalseWorkspace::new(&a, &c);
    let (mut x, mut beta) = (vec![0.0; n], vec![0.0; 5]);
    let mut outer = 0;
    let count = measure(|| {
        let settings = SmalseSettings::default();
        let cost = QuadraticCost::new(&a, &b, norm).with_equality(&c, &e);
        let report = smalse(
            &cost,
            MovingSet::fixed(&mut set),
            &mut x,
            &mut beta,
            &settings,
            &mut work,
        );
        outer = report.expect("solve").outer;
    });
    assert!(outer > 1);
    assert_eq!(count.count_total, 0);
}
