//! Where subdomains are many the coarse problem has two levels: the answer is that of few subdomains.

use crate::common::*;
use signorini_qp::EqualityProjector;
use signorini_tfeti::ActiveSetProjector;
use std::collections::BTreeMap;

/// Cells along a unit of length.
const CELLS: usize = 7;

/// A clamped brick on a rough floor, and a block on it that friction alone holds.
fn scene(friction: Friction) -> Scene {
    let n = CELLS;
    let lower = block([3.0, 1.0, 1.0], [3 * n, n, n]);
    let upper = block([1.0, 1.0, 2.0 / n as f64], [n, n, 2])
        .map_points(|[x, y, z]| [x + 1.0, y, z + 1.0])
        .expect("moved");
    Scene::new(with_second(&lower, &upper), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction.clone()))
        .with_contact(Contact::between(brick::Z_MAX, second(brick::Z_MIN)).with_friction(friction))
        .with_load(Load::traction(second(brick::Z_MAX), [5e6, 2e6, -1e8]))
        .with_analysis(Analysis::quasistatic(1.0, 1))
}

/// Every cell a subdomain.
fn many(scene: Scene) -> Scene {
    let mesh = scene.mesh();
    let cell = |tet: usize| {
        let points = mesh.tet_points(tet);
        let at = [0, 1, 2].map(|c| points.iter().map(|p| p[c]).sum::<f64>() / 4.0 * CELLS as f64);
        at.map(|v| v.floor() as u32)
    };
    let cells: Vec<[u32; 3]> = (0..mesh.tets().len()).map(cell).collect();
    let mut numbers = BTreeMap::new();
    for cell in &cells {
        let next = numbers.len() as u32;
        numbers.entry(*cell).or_insert(next);
    }
    let parts = cells.iter().map(|cell| numbers[cell]).collect();
    scene.with_parts_as_given(parts)
}

fn has_levels(simulation: &Simulation) -> bool {
    let tfeti = simulation.tfeti();
    let rows = tfeti.gluing().ranges().contact().end;
    ActiveSetProjector::new(tfeti.coarse(), rows, None)
        .expect("projector")
        .has_levels()
}

/// Whether the factor of all rows is not the sparse one.
fn shares_regions(simulation: &Simulation) -> bool {
    let coarse = simulation.tfeti().coarse();
    let factor = simulation.tfeti().coarse_factor().expect("a factor");
    factor.free_motions().is_empty() && factor.stored() != coarse.factor_size()
}

#[test]
fn two_bodies_of_which_contact_alone_holds_one() {
    let friction = Friction::coulomb(0.4);
    let few = solve(scene(friction.clone()).with_subdomains(12), tight());
    assert_certified(&few, "few");
    assert!(few.summary.stick > 0 && few.summary.slip > 0, "{:?}", few.summary);
    for preconditioner in [Preconditioner::Lumped, Preconditioner::Dirichlet] {
        let settings = tight().with_preconditioner(preconditioner);
        let (simulation, results) = run(many(scene(friction.clone())), settings);
        let what = format!("{preconditioner:?}");
        assert!(has_levels(&simulation), "{what}");
        assert_certified(&results[0], &what);
        assert!(!results[0].report.fallback, "{what}");
        let off = distance(&results[0].displacement, &few.displacement);
        assert!(off <= 1e-5, "{what}: {off:e}");
    }
}

/// SMALSE and the linear solver run on the factor in which equal regions are stored once, are certified and find the
/// same, where the default has two levels.
#[test]
fn the_other_methods_find_the_same() {
    let bound = || scene(Friction::None).with_support(Support::fixed(second(brick::X_MIN)));
    let default = solve(many(bound()), tight());
    let settings = Settings::default().with_method(Method::one_loop()).with_tolerance(1e-5);
    let (simulation, results) = run(many(bound()), settings);
    let smalse = &results[0];
    assert!(smalse.report.status.converged() && smalse.certificate.largest() <= 1e-4);
    assert!(shares_regions(&simulation));
    let off = distance(&smalse.displacement, &default.displacement);
    assert!(off <= 1e-3, "{off:e}");
    let glued = || {
        Scene::new(block([3.0, 1.0, 1.0], [3 * CELLS, CELLS, CELLS]), steel())
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::X_MAX, [1e7, 0.0, -1e7]))
            .with_analysis(Analysis::statics())
    };
    let (simulation, results) = run(many(glued()), tight());
    assert!(shares_regions(&simulation));
    let (a, b) = (&results[0], solve(glued().with_subdomains(8), tight()));
    assert_certified(a, "linear");
    let off = distance(&a.displacement, &b.displacement);
    assert!(off <= 1e-5, "{off:e}");
}

/// The plan counts two levels where they are used, but for what contact pairs add.
#[test]
fn the_plan_counts_what_is_built() {
    let scene = many(scene(Friction::coulomb(0.4)));
    let plan = Plan::new(&scene, &Settings::default()).expect("plan");
    let simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let (tfeti, rows) = (simulation.tfeti(), simulation.tfeti().gluing().ranges().contact().end);
    let mut space = ActiveSetProjector::new(tfeti.coarse(), rows, None).expect("projector");
    let always = space.factor().stored();
    space.set_weights(&vec![1.0; tfeti.dual_dim()]).expect("all free");
    let ratio = plan.estimate.coarse_bytes as f64 / (8 * (always + space.factor().stored())) as f64;
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
}

/// Beside equations: the end of the brick moves as a point.
#[test]
fn equations_across_many_subdomains() {
    let loaded = || {
        let scene = scene(Friction::coulomb(0.4)).with_coupling(Coupling::point([9.0; 3]));
        let end = scene.mesh().nodes_on(brick::X_MAX).into_iter();
        let end: Vec<u32> = end.filter(|n| scene.mesh().points()[*n as usize][2] > 1e-9).collect();
        let along = [1.0, 0.0, 0.0];
        let moved = |node: u32| Equation::new([(node, along)]).with_point(0, [-1.0, 0.0, 0.0]);
        let scene = scene.with_load(Load::on_coupling(0, along.map(|c| 1e7 * c), [0.0; 3]));
        end.into_iter().map(moved).fold(scene, Scene::with_equation)
    };
    let few = solve(loaded().with_subdomains(12), tight());
    let (simulation, results) = run(many(loaded()), tight());
    assert!(has_levels(&simulation));
    let off = distance(&results[0].displacement, &few.displacement);
    assert!(off <= 1e-5, "{off:e}");
}
