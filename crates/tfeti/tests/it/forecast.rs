//! A forecast counts what the set-up will find.

use crate::common::steel;
use signorini_fem_mesh::{Decomposition, TetMesh, brick};
use signorini_qp::SymmetricOperator;
use signorini_tfeti::internal::{Forecast, InverseKind, Rate};
use signorini_tfeti::{InverseSettings, NodeSupport, Tfeti, TfetiBuilder, TfetiError};

/// A forecast is compared with a system that was built without it, and with one that took over what it found.
fn both(mesh: &TetMesh, decomposition: &Decomposition, share: bool, mut check: impl FnMut(&Forecast<'_>, &Tfeti)) {
    let held = mesh.nodes_on(brick::X_MIN);
    let supports = [NodeSupport::fixed(held.clone())];
    let (materials, settings) = (steel(), InverseSettings::default());
    let touched = |node| held.contains(&node);
    let mut found = Forecast::new(mesh, decomposition, &materials, share, &settings, &[], touched).unwrap();
    found.count_coarse().unwrap();
    let build = |b: TfetiBuilder<'_>| b.with_supports(&supports).build().unwrap();
    let alone = build(TfetiBuilder::new(mesh, decomposition, &materials).with_share_translates(share));
    let system = build(TfetiBuilder::of_forecast(&found));
    check(&found, &alone);
    assert_eq!(alone.report().analysed, found.classes.len());
    assert_eq!(system.report().analysed, 0, "patterns are not analysed twice");
    let other = build(TfetiBuilder::of_forecast(&found).with_share_translates(!share));
    assert!(other.report().analysed > 0, "classes of another kind");
    // the same bits
    let rows = alone.dual_dim();
    let x: Vec<f64> = (0..rows).map(|i| (i as f64).sin()).collect();
    let [a, b] = [&alone, &system].map(|t| {
        let mut y = vec![0.0; rows];
        t.dual().apply(&x, &mut y, &mut t.dual().scratch());
        y
    });
    assert!(a == b && alone.report().classes == system.report().classes);
}

#[test]
fn a_forecast_is_what_the_set_up_finds() {
    for (cells, boxes, share) in [
        ([15, 5, 5], [3, 1, 1], true),
        ([12, 8, 8], [3, 2, 2], true),
        ([12, 8, 8], [3, 2, 2], false),
    ] {
        let mesh = brick::Brick::new([3.0, 1.0, 1.0], cells).build().unwrap();
        let decomposition = Decomposition::boxes(&mesh, boxes).unwrap();
        both(&mesh, &decomposition, share, |found, system| {
            let truth = system.report();
            assert_eq!(found.classes, truth.classes);
            assert_eq!(found.inverse_bytes, truth.inverse_bytes);
            assert_eq!(found.coarse.unwrap().bytes, truth.coarse_bytes);
            assert_eq!(found.table_bytes, truth.table_bytes);
            assert_eq!(found.product_flops() as u64, system.dual().flops());
        });
    }
}

/// Every tetrahedron a subdomain: a node couples up to thirty of them.
#[test]
fn the_coarse_factor_of_very_small_subdomains_is_counted() {
    let mut last = 0.0;
    for n in [2, 3] {
        let mesh = brick::Brick::new([3.0, 1.0, 1.0], [3 * n, n, n]).build().unwrap();
        let parts: Vec<u32> = (0..mesh.tets().len() as u32).collect();
        let decomposition = Decomposition::from_parts(&mesh, &parts).unwrap();
        let mut flops = 0.0;
        both(&mesh, &decomposition, true, |found, system| {
            let coarse = found.coarse.unwrap();
            assert_eq!(coarse.bytes, system.report().coarse_bytes);
            flops = coarse.flops;
        });
        // a dense matrix would be an upper bound
        let dim = 6.0 * parts.len() as f64;
        assert!(flops < dim.powi(3) / 3.0 && flops > 10.0 * last, "{flops}");
        last = flops;
    }
}

#[test]
fn this_machine_has_a_rate() {
    let rate = Rate::measure();
    assert!(rate.flops > 1e7 && rate.numbers > 1e6, "{rate:?}");
}

/// A limit that the forecast keeps is kept by the set-up, too: of one body that is stored for one column.
#[test]
fn forecast_and_set_up_keep_the_same_limit() {
    let mesh = brick::Brick::new([3.0, 1.0, 1.0], [24, 8, 8]).build().unwrap();
    let decomposition = Decomposition::whole(&mesh);
    let materials = steel();
    let supports = [NodeSupport::fixed(mesh.nodes_on(brick::X_MIN))];
    let forecast = |limit: u64| {
        let settings = InverseSettings::default().with_kind(InverseKind::Sparse);
        let settings = settings.with_memory_limit(limit);
        let touched = |node| supports[0].nodes.contains(&node);
        Forecast::new(&mesh, &decomposition, &materials, true, &settings, &[], touched)
    };
    let needed = forecast(u64::MAX).unwrap().inverse_bytes;
    let built = TfetiBuilder::of_forecast(&forecast(needed).unwrap())
        .with_supports(&supports)
        .build();
    assert_eq!(built.unwrap().report().inverse_bytes, needed);
    let (limit, refused) = (needed - 1, forecast(needed - 1).err());
    assert_eq!(refused, Some(TfetiError::Memory { needed, limit }));
}
