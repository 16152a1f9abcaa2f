//! The projector by two levels: exact, symmetric in its two forms, and small where subdomains are translates.

use crate::common::{Brick, distance, noise, norm, steel};
use signorini_fem_mesh::decomposition::{PartCount, even_parts};
use signorini_fem_mesh::{Decomposition, FacetTag, SurfaceFrame, brick};
use signorini_qp::laws::check_equality_laws;
use signorini_qp::vector::dot;
use signorini_qp::{Equality, EqualityProjector, QpError};
use signorini_tfeti::internal::{ActiveSetFactor, Forecast, forecast_levels};
use signorini_tfeti::{
    ActiveSetProjector, ContactConstraint, InverseSettings, NodeSupport, RowWeights, Tfeti, TfetiBuilder,
};

fn space(system: &Tfeti, kind: ActiveSetFactor) -> ActiveSetProjector {
    let contact = system.gluing().ranges().contact().end;
    ActiveSetProjector::with_factor(system.coarse(), contact, None, kind).unwrap()
}

/// Weights of an active set: about that share of the contact rows is free.
fn active_set(system: &Tfeti, share: f64, seed: u64) -> Vec<f64> {
    let contact = system.gluing().ranges().contact().end;
    let mut w = vec![1.0; system.dual_dim()];
    for (w, v) in w[..contact].iter_mut().zip(noise(contact, seed)) {
        *w = f64::from(u8::from(0.5 * (v + 1.0) < share));
    }
    w
}

fn off(system: &Tfeti, x: &[f64], e: &[f64]) -> f64 {
    let (coarse, mut g) = (system.coarse(), vec![0.0; e.len()]);
    coarse.apply(x, &mut g, &mut coarse.scratch());
    distance(&g, e) / norm(x)
}

/// `space` is a projector to the kernel of `G` that changes free rows only, and its other forms belong to it.
fn check_projector(system: &Tfeti, space: &mut ActiveSetProjector, what: &str) {
    let contact = system.gluing().ranges().contact().end;
    let (x, y, e) = (
        noise(system.dual_dim(), 5),
        noise(system.dual_dim(), 6),
        noise(system.coarse().rows(), 7),
    );
    for (share, seed) in [(0.5, 1), (1.0, 2), (0.1, 3)] {
        let w = active_set(system, share, seed);
        assert_eq!(space.set_weights(&w), Ok(true), "{what}");
        let mut p = x.clone();
        space.project(&mut p);
        assert!(off(system, &p, &vec![0.0; e.len()]) < 1e-12, "{what}");
        for k in (0..contact).filter(|&k| w[k] == 0.0) {
            assert_eq!(p[k], x[k], "{what}");
        }
        let mut again = p.clone();
        space.project(&mut again);
        assert!(distance(&again, &p) < 1e-11 * norm(&p), "{what}");
        // (P x) y = x (P^T y)
        let mut t = y.clone();
        space.project_transpose(&mut t);
        let size = norm(&x) * norm(&t) + norm(&p) * norm(&y);
        assert!((dot(&p, &y) - dot(&x, &t)).abs() < 1e-12 * size, "{what}");
        // the amplitudes are those of the residual
        let mut alpha = e.clone();
        space.amplitudes(&y, &mut alpha);
        let mut motion = vec![0.0; y.len()];
        system
            .coarse()
            .apply_transpose(&alpha, &mut motion, &mut system.coarse().scratch());
        motion.iter_mut().zip(&y).for_each(|(m, y)| *m += y);
        assert!(distance(&motion, &t) < 1e-11 * norm(&t), "{what}");
        let mut b = x.clone();
        space.balance(&mut b, &e);
        assert!(off(system, &b, &e) < 1e-12, "{what}");
        if space.loose().is_empty() {
            let mut b = x.clone();
            space.repair(&mut b, &e);
            assert!(off(system, &b, &e) < 1e-12, "{what}");
        }
    }
}

#[test]
fn it_is_a_projector_that_changes_free_rows_only() {
    // translates, cut in a grid; the last has no two subdomains that are alike
    for b in [Brick::new(2, 2), Brick::new(4, 1), Brick::of(3, 2, 0.1)] {
        let system = b.system();
        check_projector(&system, &mut space(&system, ActiveSetFactor::Levels), "brick");
    }
}

/// A brick on another one, with points of contact between both, under the lower and at a side of the upper one.
fn two_bodies(parts: usize, supports: &[FacetTag]) -> Tfeti {
    let one = |lift: f64, tags: u32| {
        let mesh = brick::Brick::new([3.0, 1.0, 1.0], [9, 3, 3]).build().unwrap();
        let mesh = mesh.map_points(|[x, y, z]| [x, y, z + lift]).unwrap();
        mesh.map_tags(|tag| FacetTag(tag.0 + tags))
    };
    let mesh = one(0.0, 0).append(&one(1.0, 100)).unwrap();
    let upper = |tag: FacetTag| FacetTag(tag.0 + 100);
    let parts = even_parts(&mesh, &vec![0; mesh.tets().len()], PartCount::Exactly(parts)).unwrap();
    let decomposition = Decomposition::from_parts(&mesh, &parts).unwrap();
    let at = |node: &u32| mesh.points()[*node as usize].map(|v| (1e6 * v).round() as i64);
    let top = mesh.nodes_on(brick::Z_MAX);
    let frame = |normal| SurfaceFrame::from_normal(normal).unwrap();
    let mut contact = Vec::new();
    for node in mesh.nodes_on(upper(brick::Z_MIN)) {
        let partner = top.iter().copied().find(|other| at(other) == at(&node));
        contact.push(
            ContactConstraint::new(node, frame([0.0, 0.0, -1.0]))
                .with_friction(true)
                .with_partner(partner),
        );
    }
    let faces = [(brick::Z_MIN, [0.0, 0.0, -1.0]), (upper(brick::Y_MAX), [0.0, 1.0, 0.0])];
    for (tag, normal) in faces {
        let nodes = mesh.nodes_on(tag);
        // a node of one row only: those of an edge belong to one face
        let known = |node: &u32| contact.iter().all(|c: &ContactConstraint| c.side.nodes()[0].0 != *node);
        let own: Vec<u32> = nodes.into_iter().filter(known).collect();
        contact.extend(
            own.into_iter()
                .map(|node| ContactConstraint::new(node, frame(normal)).with_friction(true)),
        );
    }
    let supports: Vec<_> = supports
        .iter()
        .map(|tag| NodeSupport::fixed(mesh.nodes_on(*tag)))
        .collect();
    let materials = steel();
    TfetiBuilder::new(&mesh, &decomposition, &materials)
        .with_supports(&supports)
        .with_contact(&contact)
        .build()
        .unwrap()
}

/// Graph parts of two bodies with three faces of contact; contact alone holds none of them, one, or both.
#[test]
fn bodies_parts_and_faces_of_any_kind_have_two_levels() {
    let upper = FacetTag(brick::X_MIN.0 + 100);
    for (supports, loose) in [(&[brick::X_MIN, upper][..], 0), (&[brick::X_MIN], 6), (&[], 12)] {
        for parts in [60, 200] {
            let system = two_bodies(parts, supports);
            let what = format!("{parts} parts, {loose} loose modes");
            let mut levels = space(&system, ActiveSetFactor::Levels);
            assert!(levels.has_levels() && levels.loose().len() == loose, "{what}");
            check_projector(&system, &mut levels, &what);
            // what the exact one leaves to be done is nearly the same
            let mut exact = space(&system, ActiveSetFactor::Sparse);
            let w = active_set(&system, 0.6, 9);
            let x = noise(system.dual_dim(), 10);
            let (mut a, mut b) = (x.clone(), x.clone());
            for (space, x) in [(&mut levels, &mut a), (&mut exact, &mut b)] {
                space.set_weights(&w).unwrap();
                space.project(x);
            }
            assert!(
                distance(&a, &b) < 0.5 * distance(&x, &b),
                "{what}: {}",
                distance(&a, &b) / distance(&x, &b)
            );
        }
    }
}

/// Sets that hold no body go the way of the whole matrix, and back.
#[test]
fn open_sets_of_a_body_that_contact_alone_holds_are_deficient() {
    let system = two_bodies(60, &[brick::X_MIN]);
    let mut levels = space(&system, ActiveSetFactor::Levels);
    levels.set_coarse_rhs(&noise(system.coarse().rows(), 3));
    assert_eq!(levels.set_weights(&active_set(&system, 0.6, 1)), Ok(true));
    let open = active_set(&system, 0.0, 1);
    assert!(matches!(
        levels.set_weights(&open),
        Err(QpError::CoarseDeficient { .. })
    ));
    check_projector(&system, &mut levels, "after an open set");
}

/// Where nothing is gained two levels are off: the bricks of the benchmark up to n = 5.
#[test]
fn few_subdomains_have_one_level_and_many_have_two() {
    for (n, levels) in [(1, false), (3, false), (5, false), (10, true)] {
        let system = Brick::new(n, 1).system();
        assert_eq!(space(&system, ActiveSetFactor::Auto).has_levels(), levels, "n = {n}");
    }
}

/// The factor of the rows that are always free, of equal regions once, solves as the sparse factor does.
#[test]
fn equal_regions_are_eliminated_once_and_the_solution_is_that_of_the_whole() {
    let system = Brick::new(5, 1).system();
    let (mut levels, mut sparse) = (
        space(&system, ActiveSetFactor::Levels),
        space(&system, ActiveSetFactor::Sparse),
    );
    let (x, e) = (noise(system.dual_dim(), 5), noise(system.coarse().rows(), 6));
    let (mut a, mut b) = (x.clone(), x);
    levels.repair(&mut a, &e);
    sparse.repair(&mut b, &e);
    assert!(distance(&a, &b) < 1e-12 * norm(&b));
    let (shared, whole) = (levels.factor().stored(), sparse.factor().stored());
    // each tile is kept twice, once rounded
    assert!(2 * shared < 3 * whole, "{shared} of {whole}");
}

/// Between active sets what changes is projected in single precision, and no more than that is rounded.
#[test]
fn changes_between_active_sets_are_rounded() {
    let system = Brick::new(4, 2).system();
    let contact = system.gluing().ranges().contact().end;
    let e = noise(system.coarse().rows(), 7);
    // gradients of points next to a solution are rigid motions but for little
    let mut rigid = vec![0.0; system.dual_dim()];
    system
        .coarse()
        .apply_transpose(&e, &mut rigid, &mut system.coarse().scratch());
    let near = |x: &[f64], seed: u64| -> Vec<f64> {
        let change = noise(x.len(), seed);
        x.iter().zip(&change).map(|(x, c)| x + 1e-6 * c).collect()
    };
    for (kind, rounds) in [(ActiveSetFactor::Levels, true), (ActiveSetFactor::Split, false)] {
        let mut space = space(&system, kind);
        assert!(space.rounds_steps());
        for problem in 0..2 {
            space.set_coarse_rhs(&e);
            for set in 0..3 {
                space.set_weights(&active_set(&system, 0.5, set)).unwrap();
                let gradient = near(&rigid, 5 + set);
                let [mut found, mut truth] = [gradient.clone(), gradient];
                space.project_gradient(&mut found);
                space.project_transpose(&mut truth);
                let off = distance(&found, &truth) / norm(&truth);
                assert!(off < 1e-6, "{kind:?}, problem {problem}, set {set}: {off:e}");
                // the first of a problem has all digits
                assert_eq!(found != truth, rounds && set > 0, "{kind:?}, {problem}, {set}");
                space.set_weights(&active_set(&system, 0.5, set + 9)).unwrap();
                assert_eq!(space.project_gradient_again(&mut found), rounds);
                space.project_transpose(&mut truth);
                let off = distance(&found, &truth) / norm(&truth);
                assert!(!rounds || off < 1e-6, "{problem}, {set}, again: {off:e}");
            }
        }
        let mut x = rigid.clone();
        space.repair(&mut x, &e);
        let moved = [&near(&x[..contact], 8)[..], &x[contact..]].concat();
        let [mut step, mut truth] = [moved.clone(), moved];
        space.repair_step(&mut step, &e);
        space.repair(&mut truth, &e);
        assert!(off(&system, &step, &e) < 1e-12 && (step != truth) == rounds);
    }
}

/// What a plan counts is what is stored: regions that are equal once, at most a quarter more.
#[test]
fn a_forecast_counts_what_two_levels_store() {
    for (n, perturbation) in [(8, 0.0), (7, 0.1)] {
        let b = Brick::of(n, 1, perturbation);
        let system = b.system();
        let settings = InverseSettings::default();
        let found = Forecast::new(&b.mesh, &b.decomposition, &b.materials, true, &settings, &[], |_| false).unwrap();
        let forecast = |rows| forecast_levels(&found, b.bottom.iter().copied(), b.fixed.iter().copied(), rows, true);
        let mut space = space(&system, ActiveSetFactor::Auto);
        assert!(space.has_levels());
        let always = space.factor().stored();
        space.set_weights(&active_set(&system, 0.5, 1)).unwrap();
        let stored = 8.0 * (always + space.factor().stored()) as f64;
        let counted = forecast(system.dual_dim());
        let ratio = counted.unwrap().bytes as f64 / stored;
        assert!((0.75..1.25).contains(&ratio), "n = {n}: {ratio}");
        // the report says the same, and nothing of a factor that nobody makes
        let mut known = found.clone();
        known.coarse = counted;
        let (supports, contact) = (b.supports(), b.contact(true));
        let builder = TfetiBuilder::of_forecast(&known).with_supports(&supports);
        let other = builder.with_contact(&contact).build().unwrap();
        assert_eq!(other.report().coarse_bytes, counted.unwrap().bytes);
        assert_eq!(other.coarse().factor_size(), system.coarse().factor_size());
        assert_ne!(other.report().coarse_bytes, 8 * system.coarse().factor_size() as u64);
    }
    // one level
    let b = Brick::new(3, 1);
    let (materials, settings) = (steel(), InverseSettings::default());
    let found = Forecast::new(&b.mesh, &b.decomposition, &materials, true, &settings, &[], |_| false).unwrap();
    assert_eq!(
        forecast_levels(&found, b.bottom.iter().copied(), b.fixed.iter().copied(), 5000, true),
        None
    );
}

/// Methods that keep all rows have the factor in which equal regions are stored once, too: its rows are orthonormal,
/// and project as those of the sparse factor do. The forecast counts it.
#[test]
fn methods_without_active_sets_share_equal_regions() {
    for (n, perturbation) in [(8, 0.0), (7, 0.1)] {
        let b = Brick::of(n, 1, perturbation);
        let system = b.system();
        let shared = system.coarse_factor().unwrap();
        let ones = RowWeights::diagonal(vec![1.0; system.dual_dim()]);
        let sparse = system.coarse().factor_weighted(ones).unwrap();
        assert!(shared.stored() != sparse.stored() && sparse.orthonormal().is_none());
        let rows = shared.orthonormal().expect("regular");
        check_equality_laws(&rows, 3, 1e-11).unwrap();
        let (mut memory, mut other) = (rows.scratch(), sparse.scratch());
        let (x, e) = (noise(system.dual_dim(), 5), noise(system.coarse().rows(), 6));
        let (mut c, mut along) = (e.clone(), x.clone());
        rows.apply(&x, &mut c, &mut memory);
        rows.apply_transpose(&c, &mut along, &mut memory);
        let projected: Vec<f64> = x.iter().zip(&along).map(|(x, a)| x - a).collect();
        let mut expected = x.clone();
        sparse.project(&mut expected, None, &mut other);
        assert!(distance(&projected, &expected) < 1e-11 * norm(&x));
        // C x = rhs is G x = e, and multipliers of both belong together
        let (mut rhs, mut alpha, mut motion) = (e.clone(), e.clone(), x.clone());
        shared.particular(&e, &mut expected, &mut memory);
        rows.rhs(&e, &mut rhs, &mut memory);
        rows.apply(&expected, &mut c, &mut memory);
        assert!(distance(&c, &rhs) < 1e-11 * norm(&rhs));
        rows.amplitudes(&c, &mut alpha, &mut memory);
        system.coarse().apply_transpose(&alpha, &mut motion, &mut memory);
        rows.apply_transpose(&c, &mut along, &mut memory);
        assert!(distance(&motion, &along) < 1e-11 * norm(&along));
        let settings = InverseSettings::default();
        let found = Forecast::new(&b.mesh, &b.decomposition, &b.materials, true, &settings, &[], |_| false).unwrap();
        let (bottom, fixed) = (b.bottom.iter().copied(), b.fixed.iter().copied());
        let counted = forecast_levels(&found, bottom, fixed, system.dual_dim(), false).unwrap();
        let ratio = counted.bytes as f64 / (8 * shared.stored()) as f64;
        assert!((0.75..1.25).contains(&ratio), "n = {n}: {ratio}");
    }
}

#[test]
fn threads_change_no_bit() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let system = Brick::new(4, 1).system();
            let mut space = space(&system, ActiveSetFactor::Levels);
            space.set_weights(&active_set(&system, 0.5, 1)).unwrap();
            let mut x = noise(system.dual_dim(), 5);
            space.project_step(&mut x);
            space.project_step_transpose(&mut x);
            x
        })
    };
    assert!(run(1).iter().zip(&run(2)).all(|(a, b)| a.to_bits() == b.to_bits()));
}
