//! A forecast counts what the set-up will find.

use crate::common::steel;
use signorini_fem_mesh::{Decomposition, TetMesh, brick};
use signorini_tfeti::internal::{Forecast, Rate};
use signorini_tfeti::{InverseSettings, NodeSupport, Tfeti, TfetiBuilder};

fn both(mesh: &TetMesh, decomposition: &Decomposition, share: bool) -> (Forecast, Tfeti) {
    let held = mesh.nodes_on(brick::X_MIN);
    let supports = [NodeSupport::fixed(held.clone())];
    let (materials, settings) = (steel(), InverseSettings::default());
    let touched = |node| held.contains(&node);
    let found = Forecast::new(mesh, decomposition, &materials, share, &settings, touched);
    let builder = TfetiBuilder::new(mesh, decomposition, &materials).with_supports(&supports);
    (found.unwrap(), builder.with_share_translates(share).build().unwrap())
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
        let (found, system) = both(&mesh, &decomposition, share);
        let truth = system.report();
        assert_eq!(found.classes, truth.classes);
        assert_eq!(found.inverse_bytes, truth.inverse_bytes);
        assert_eq!(found.coarse_bytes, truth.coarse_bytes);
        assert_eq!(found.table_bytes, truth.table_bytes);
        assert_eq!(found.product_flops() as u64, system.dual().flops());
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
        let (found, system) = both(&mesh, &decomposition, true);
        assert_eq!(found.coarse_bytes, system.report().coarse_bytes);
        // a dense matrix would be an upper bound
        let (dim, flops) = (6.0 * parts.len() as f64, found.coarse_flops);
        assert!(flops < dim.powi(3) / 3.0 && flops > 10.0 * last, "{flops}");
        last = flops;
    }
}

#[test]
fn this_machine_has_a_rate() {
    let rate = Rate::measure();
    assert!(rate.flops > 1e7 && rate.numbers > 1e6, "{rate:?}");
}
