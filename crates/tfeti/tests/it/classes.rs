//! Classes of translates, the report, and systems with few rows.

use crate::common::Brick;
use signorini_fem_mesh::{Decomposition, Hooke, Materials};
use signorini_tfeti::internal::Classes;
use signorini_tfeti::{NodeSupport, TfetiBuilder, TfetiError};

fn classes(b: &Brick, share: bool) -> Classes {
    Classes::find(&b.mesh, &b.decomposition, &b.materials, share).unwrap()
}

#[test]
fn two_parities_make_two_classes() {
    let b = Brick::new(2, 5);
    let found = classes(&b, true);
    assert_eq!(
        found.classes().iter().map(|c| c.members.len()).collect::<Vec<_>>(),
        [12, 12]
    );
    assert_eq!(classes(&b, false).classes().len(), 24);
    // An even number of cells has one parity only.
    assert_eq!(classes(&Brick::new(2, 4), true).classes().len(), 1);
    for (k, class) in found.classes().iter().enumerate() {
        for (m, &s) in class.members.iter().enumerate() {
            assert_eq!(found.place(s as usize), (k, m));
        }
    }
}

#[test]
fn perturbed_subdomains_share_nothing() {
    assert_eq!(classes(&Brick::of(2, 4, 0.05), true).classes().len(), 24);
}

#[test]
fn a_far_away_body_shares_as_much_as_a_near_one() {
    let mut b = Brick::new(1, 4);
    b.mesh = b.mesh.clone().map_points(|p| [p[0] + 1e4, p[1] - 3e4, p[2]]).unwrap();
    b.decomposition = Decomposition::boxes(&b.mesh, [3, 1, 1]).unwrap();
    assert_eq!(classes(&b, true).classes().len(), 1);
}

#[test]
fn materials_tell_translates_apart() {
    let mut b = Brick::new(1, 4);
    let regions = b.decomposition.parts().to_vec();
    b.mesh = b.mesh.clone().with_regions(regions).unwrap();
    let law = |e| Hooke::isotropic(e, 0.3).unwrap();
    // Regions 0 and 2 are different regions of equal material.
    b.materials = Materials::new(vec![(0, law(1e9)), (1, law(2e9)), (2, law(1e9))]).unwrap();
    let found = classes(&b, true);
    assert_eq!(
        found.classes().iter().map(|c| c.members.clone()).collect::<Vec<_>>(),
        [vec![0, 2], vec![1]]
    );
    b.materials = Materials::new(vec![(0, law(1e9))]).unwrap();
    let error = Classes::find(&b.mesh, &b.decomposition, &b.materials, true).unwrap_err();
    assert!(matches!(error, TfetiError::Material { .. }));
}

#[test]
fn report_tells_what_was_built() {
    let b = Brick::new(1, 5);
    let system = b.system();
    let report = system.report();
    assert_eq!(
        (report.classes.len(), report.factorisations, report.analysed),
        (2, 3, 2)
    );
    assert_eq!((system.subdomains(), system.torn_dim()), (3, 1944));
    assert_eq!((system.dual_dim(), system.gluing().rows_as_paper()), (594, 612));
}

#[test]
fn bodies_without_rows_and_single_supported_bodies_build() {
    let b = Brick::new(1, 2);
    let whole = Decomposition::whole(&b.mesh);
    let free = TfetiBuilder::new(&b.mesh, &whole, &b.materials).build().unwrap();
    assert_eq!(
        (free.dual_dim(), free.coarse_factor().unwrap().free_motions().len()),
        (0, 6)
    );
    let supports = [NodeSupport::fixed(b.fixed.clone())];
    let held = TfetiBuilder::new(&b.mesh, &whole, &b.materials)
        .with_supports(&supports)
        .build()
        .unwrap();
    assert!(held.coarse_factor().unwrap().free_motions().is_empty());
    assert!(held.lumped().is_ok() && held.dirichlet().is_ok());
}
