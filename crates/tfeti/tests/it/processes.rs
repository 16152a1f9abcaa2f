//! Several ranks, here threads, build and apply one system: the same bits, the work spread evenly, one exchange a
//! product, of whole vectors or of the part that each rank keeps.

use crate::common::*;
use signorini_qp::{Equality, EqualityProjector, SymmetricOperator};
use signorini_tfeti::internal::{ActiveSetFactor, InverseKind, SystemPart, on_ranks};
use signorini_tfeti::{ActiveSetProjector, Communicator, InverseSettings, SetupReport, Tfeti, Traffic};
use std::collections::BTreeSet;
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
    let alpha = noise(6 * system.subdomains(), 5);
    let [u, mut residual] = system.recover([Vec::new(), force.clone()], &x, &alpha).unwrap();
    system.complete_torn(&mut residual);
    all.extend(residual);
    let locals: Vec<Vec<f64>> = (0..system.subdomains())
        .map(|s| force[system.torn_range(s)].to_vec())
        .collect();
    let load = system.load_response(&locals).unwrap();
    let mut sum = system.combine_forces(Vec::new(), &[(2.0, &load), (0.5, &load)]);
    system.complete_torn(&mut sum);
    let whole: Vec<f64> = load.force.iter().map(|f| 2.0 * f + 0.5 * f).collect();
    assert_eq!(sum, whole);
    all.extend([sum, load.dual, load.coarse].concat());
    all.extend(u);
    all.into_iter().map(f64::to_bits).collect()
}

#[test]
fn any_number_of_ranks_computes_the_same_bits() {
    // 192 translates in panels of 24, 81 in panels of 20 and 21, 24 different subdomains, 3 translates in one panel, of
    // which four ranks are idle
    for (n, cells, perturbation, share, counts) in [
        (4, 2, 0.0, true, &[1, 2, 3, 4][..]),
        (3, 2, 0.0, true, &[2, 3]),
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
                    let before = system.traffic();
                    product(&system, &noise(system.dual_dim(), 6));
                    let after = system.traffic();
                    assert_eq!(after.exchanges - before.exchanges, u64::from(ranks > 1));
                    let bytes = after.sent + after.received - before.sent - before.received;
                    assert_eq!(bytes, if ranks > 1 { message(&system) } else { 0 });
                    // of torn vectors all are told the displacement only
                    let [force, lambda] = [system.torn_dim(), system.dual_dim()].map(|dim| noise(dim, 7));
                    let alpha = noise(6 * system.subdomains(), 8);
                    system.recover([Vec::new(), force.clone()], &lambda, &alpha).unwrap();
                    let last = system.traffic();
                    assert_eq!(last.exchanges - after.exchanges, u64::from(ranks > 1));
                    let bytes = last.sent + last.received - after.sent - after.received;
                    assert_eq!(bytes, if ranks > 1 { 8 * force.len() as u64 } else { 0 });
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
    if ranks.len() > 1 && whole.classes.iter().map(|c| c.members).sum::<usize>() > 100 {
        assert!(ranks.iter().all(|r| r.table_bytes < whole.table_bytes), "{what}");
    }
}

/// Bytes of all messages of a product of whole vectors: a number for each row that one rank computes alone, three for
/// each copy of a node in the others.
fn message(system: &Tfeti) -> u64 {
    let (mut alone, mut copies) = (0, BTreeSet::new());
    for row in 0..system.dual_dim() {
        let entries = system.gluing().row(row);
        let ranks: BTreeSet<usize> = entries.iter().map(|e| system.rank_of(e.0)).collect();
        match ranks.len() {
            1 => alone += 1,
            _ => copies.extend(entries.iter().map(|e| (e.0, e.1 / 3))),
        }
    }
    8 * (alone + 3 * copies.len() as u64)
}

/// What the default method asks of a system, of whole vectors or of the rank's part of them, which is completed. The
/// exchanges of each call come along.
fn asked(system: &Tfeti, part: Option<&SystemPart>, kind: ActiveSetFactor) -> (Vec<u64>, Vec<u64>) {
    let mut exchanges = Vec::new();
    let (dual, coarse) = part.map_or((system.dual(), system.coarse()), |part| (&part.dual, &part.coarse));
    let take = |whole: &[f64]| part.map_or(whole.to_vec(), |part| part.take(whole));
    let contact = system.gluing().ranges().contact().end;
    let mut space = ActiveSetProjector::with_factor(coarse, contact, None, kind).unwrap();
    let mut weights = vec![1.0; dual.dim()];
    weights[..contact].iter_mut().step_by(3).for_each(|w| *w = 0.0);
    space.set_weights(&weights).unwrap();
    let mut all = Vec::new();
    let mut before = system.traffic().exchanges;
    let mut tell = |found: &[f64]| {
        exchanges.push(system.traffic().exchanges - before);
        let mut whole = vec![0.0; system.dual_dim()];
        match part {
            Some(part) if found.len() == dual.dim() => part.complete(found, &mut whole),
            _ => whole = found.to_vec(),
        }
        all.extend(whole);
        before = system.traffic().exchanges;
    };
    let [x, g] = [3, 4].map(|seed| take(&noise(system.dual_dim(), seed)));
    let mut y = vec![0.0; dual.dim()];
    dual.apply(&x, &mut y, &mut dual.scratch());
    tell(&y);
    for own in [system.lumped().unwrap(), system.dirichlet().unwrap()] {
        let own = match part {
            Some(part) => own.of_part(part),
            None => own,
        };
        own.apply(&x, &mut y, &mut own.scratch());
        tell(&y);
    }
    tell(&[dual.dot(&x, &g)]);
    tell(&[dual.norm(&x)]);
    tell(&dual.dots([(&x, &g), (&g, &g)]));
    let e = noise(space.rows(), 5);
    type Work = fn(&mut ActiveSetProjector, &mut [f64], &[f64]);
    let works: [Work; 10] = [
        |s, x, _| s.project(x),
        |s, x, _| s.project_step(x),
        |s, x, _| s.project_transpose(x),
        |s, x, _| s.project_step_transpose(x),
        |s, x, e| s.repair(x, e),
        |s, x, e| s.repair_step(x, e),
        |s, x, _| s.project_gradient(x),
        |s, x, _| s.project_gradient(x),
        |s, x, _| {
            s.project_gradient_again(x);
        },
        |s, x, e| s.balance(x, e),
    ];
    for work in works {
        y.copy_from_slice(&x);
        work(&mut space, &mut y, &e);
        tell(&y);
    }
    space.compensate(&x, &noise(contact, 6), &mut y);
    tell(&y);
    let mut alpha = vec![0.0; space.rows()];
    space.amplitudes(&x, &mut alpha);
    tell(&alpha);
    (all.into_iter().map(f64::to_bits).collect(), exchanges)
}

const KINDS: [ActiveSetFactor; 3] = [ActiveSetFactor::Auto, ActiveSetFactor::Split, ActiveSetFactor::Levels];

/// Parts of vectors, which are shorter, give the bits of whole ones, with one exchange a call and less in it. Where the
/// factor is spread a solve adds two exchanges, a model of it four; where all blocks of branches belong to their ranks,
/// as on two ranks here, a solve right behind a product with `G` completes that, too.
#[test]
fn ranks_that_keep_parts_of_vectors_compute_the_same_bits() {
    for (n, cells, perturbation, ranks) in [
        (5, 4, 0.0, 2),
        (4, 4, 0.0, 3),
        (4, 2, 0.1, 4),
        (2, 2, 0.0, 2),
        (1, 3, 0.0, 5),
    ] {
        let b = Brick::of(n, cells, perturbation);
        let plain = build(&b, InverseKind::Auto, true);
        assert!(plain.part().is_none(), "one process has whole vectors");
        let expected = KINDS.map(|kind| asked(&plain, None, kind).0);
        let found = on_ranks(ranks, |c| {
            let system = system(&b, InverseKind::Auto, true, &c);
            let part = system.part().expect("nothing in the way");
            let asked = KINDS.map(|kind| asked(&system, Some(&part), kind));
            let before = system.traffic().received;
            let x = vec![1.0; part.rows()];
            part.dual.apply(&x, &mut x.clone(), &mut part.dual.scratch());
            let received = system.traffic().received - before;
            (asked, part.rows(), received)
        });
        for rank in found {
            let (asked, rows, received) = rank.expect("no panic");
            for ((kind, expected), (bits, exchanges)) in KINDS.iter().zip(&expected).zip(asked) {
                let what = format!("n = {n}, {ranks} ranks, {kind:?}");
                assert!(bits == *expected, "{what}");
                // small trees have no branches, nor has the sparse factor
                let model = if *kind == ActiveSetFactor::Levels { 4 } else { 0 };
                let spread = match (n, kind) {
                    (4.., _) => 2,
                    _ => 0,
                };
                let product = if n > 4 { 0 } else { 1 };
                let repair = product + spread;
                let transposed = repair + model;
                let projection = if model > 0 { 1 + model + spread } else { repair };
                let calls = [vec![1; 6], vec![projection; 2], vec![transposed; 2], vec![repair; 2]].concat();
                assert_eq!(exchanges[..12], calls, "{what}");
                // where only weights have changed nothing but the model is solved with
                let again = if spread > 0 { model } else { 0 };
                let rest = [transposed, transposed, again, projection, spread, transposed];
                assert_eq!(exchanges[12..], rest, "{what}");
            }
            let what = format!("n = {n}, {ranks} ranks");
            assert!(rows <= plain.dual_dim());
            if n > 4 {
                let (share, sent) = (
                    rows as f64 / plain.dual_dim() as f64,
                    received as f64 / message(&plain) as f64,
                );
                assert!(
                    share < 0.6 && sent < 0.12,
                    "{what}: {share} of the rows, {sent} of the bytes"
                );
            }
        }
    }
}

/// Of a factor that is spread a rank holds its branches and the top. That of methods without active sets gives the bits
/// of one process, too: a half solve tells sums and unknowns, a transposed one unknowns.
#[test]
fn ranks_hold_their_branches_of_a_factor() {
    let changing = Brick::of(5, 1, 0.0);
    let held = |system: &Tfeti| {
        let contact = system.gluing().ranges().contact().end;
        let kind = ActiveSetFactor::Split;
        let space = ActiveSetProjector::with_factor(system.coarse(), contact, None, kind).unwrap();
        (space.factor().held(), space.factor().stored())
    };
    let (whole, stored) = held(&build(&changing, InverseKind::Auto, true));
    assert_eq!(whole, stored);
    for (ranks, most) in [(2, 0.55), (4, 0.55)] {
        let found = on_ranks(ranks, |c| held(&system(&changing, InverseKind::Auto, true, &c)));
        for (held, counted) in found.into_iter().map(|rank| rank.expect("no panic")) {
            assert_eq!(counted, stored, "all ranks together");
            let share = held as f64 / whole as f64;
            assert!(share < most, "{ranks} ranks: {share}");
        }
    }
    let steady = Brick::of(8, 1, 0.0);
    let asked = |system: &Tfeti| {
        let rows = system.coarse_factor().unwrap().orthonormal().expect("regular");
        let (x, e, mut memory) = (
            noise(system.dual_dim(), 5),
            noise(system.coarse().rows(), 6),
            rows.scratch(),
        );
        let (mut c, mut alpha, mut along) = (e.clone(), e.clone(), x.clone());
        let before = system.traffic().exchanges;
        rows.apply(&x, &mut c, &mut memory);
        let halfway = system.traffic().exchanges;
        rows.amplitudes(&e, &mut alpha, &mut memory);
        let told = [halfway - before, system.traffic().exchanges - halfway];
        rows.factor().project(&mut along, Some(&e), &mut memory);
        let all = [c, alpha, along].concat();
        (all.into_iter().map(f64::to_bits).collect::<Vec<u64>>(), told)
    };
    let expected = asked(&build(&steady, InverseKind::Auto, true)).0;
    for ranks in [2, 3] {
        for rank in on_ranks(ranks, |c| asked(&system(&steady, InverseKind::Auto, true, &c))) {
            let (bits, told) = rank.expect("no panic");
            assert!(bits == expected && told == [2, 1], "{ranks} ranks: {told:?}");
        }
    }
}
