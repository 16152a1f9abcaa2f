//! Several ranks, here threads, build and apply one system: the same bits, the work spread evenly, one exchange a
//! product.

use crate::common::*;
use signorini_qp::SymmetricOperator;
use signorini_tfeti::internal::{InverseKind, on_ranks};
use signorini_tfeti::{Communicator, InverseSettings, SetupReport, Tfeti, Traffic};
use std::sync::Arc;

fn system(b: &Brick, kind: InverseKind, share: bool, communicator: &Arc<dyn Communicator>) -> Tfeti {
    let (supports, contact) = (b.supports(), b.contact(true));
    b.builder(&supports)
        .with_contact(&contact)
        .with_share_translates(share)
        .with_inverse(InverseSettings::default().with_kind(kind))
        .with_communicator(communicator)
        .build()
        .unwrap()
}

/// Everything that ranks compute together.
fn all_bits(system: &Tfeti) -> Vec<u64> {
    let x = noise(system.dual_dim(), 3);
    let mut y = vec![0.0; x.len()];
    let mut all = product(system, &x);
    for preconditioner in [system.lumped().unwrap(), system.dirichlet().unwrap()] {
        preconditioner.apply(&x, &mut y, &mut preconditioner.scratch());
        all.extend(&y);
    }
    let contact = system.gluing().ranges().contact();
    for diagonal in [Tfeti::row_compliance, Tfeti::row_stiffness] {
        let mut out = vec![0.0; contact.len()];
        diagonal(system, contact.clone(), &mut out);
        all.extend(out);
    }
    all.extend(system.row_weights().unwrap_or_default());
    let force = noise(system.torn_dim(), 4);
    let u = system.recover(&force, &x, &noise(6 * system.subdomains(), 5)).unwrap();
    all.extend(system.equilibrium_residual(&u, &force, &x).unwrap());
    all.extend(u);
    all.into_iter().map(f64::to_bits).collect()
}

#[test]
fn any_number_of_ranks_computes_the_same_bits() {
    // 192 translates in panels of 24, 24 different subdomains, 3 translates in one panel, of which four ranks are idle
    for (n, cells, perturbation, share, counts) in [
        (4, 2, 0.0, true, &[1, 2, 3, 4][..]),
        (2, 3, 0.0, false, &[2, 3]),
        (2, 2, 0.1, true, &[2, 4]),
        (1, 3, 0.0, true, &[5]),
    ] {
        let b = Brick::of(n, cells, perturbation);
        for kind in [InverseKind::Auto, InverseKind::Dense, InverseKind::Sparse] {
            let plain = build(&b, kind, share);
            let expected = all_bits(&plain);
            assert_eq!(plain.traffic(), Traffic::default());
            for &ranks in counts {
                let found = on_ranks(ranks, |c| {
                    let system = system(&b, kind, share, &c);
                    let bits = all_bits(&system);
                    let before = system.traffic().exchanges;
                    product(&system, &noise(system.dual_dim(), 6));
                    assert_eq!(system.traffic().exchanges - before, u64::from(ranks > 1));
                    (bits, system.dual().flops(), system.report().clone())
                });
                let what = format!("n = {n}, {kind:?}, {ranks} ranks");
                let found: Vec<_> = found.into_iter().map(|rank| rank.expect("no panic")).collect();
                assert!(found.iter().all(|rank| rank.0 == expected), "{what}");
                assert_eq!(
                    found.iter().map(|rank| rank.1).sum::<u64>(),
                    plain.dual().flops(),
                    "{what}"
                );
                let reports: Vec<&SetupReport> = found.iter().map(|rank| &rank.2).collect();
                spread(&reports, plain.report(), &what);
            }
        }
    }
}

/// Matrices that are not shared are held once, and tables shrink.
fn spread(ranks: &[&SetupReport], whole: &SetupReport, what: &str) {
    let held: u64 = ranks.iter().map(|r| r.inverse_bytes).sum();
    assert!(ranks.iter().all(|r| r.inverse_bytes <= whole.inverse_bytes), "{what}");
    if whole.classes.iter().all(|c| c.members == 1) {
        assert_eq!(held, whole.inverse_bytes, "{what}");
        let most = ranks.iter().map(|r| r.inverse_bytes).max().unwrap_or(0);
        assert!(
            most as f64 <= 1.25 * (held / ranks.len() as u64) as f64,
            "{what}: {most} of {held}"
        );
    }
    // where a rank has more than a few subdomains
    if ranks.len() > 1 && whole.subdomains > 100 {
        assert!(ranks.iter().all(|r| r.table_bytes < whole.table_bytes), "{what}");
    }
}
