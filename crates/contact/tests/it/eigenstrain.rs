//! Strain that makes no stress: temperature, a part that shrinks, a bolt that is tightened.

use crate::common::*;
use signorini_fem_mesh::fields::nodal_stresses;
use signorini_fem_mesh::{Eigenstrain, TetMesh};

const YOUNG: f64 = 2.1e11;
/// 80 K of steel.
const WARM: f64 = 12e-6 * 80.0;
const LENGTHS: [f64; 3] = [2.0, 1.0, 1.0];

fn block(order: usize) -> TetMesh {
    let mesh = Brick::new(LENGTHS, [4, 2, 2]).perturbed(0.1, 7).build().expect("brick");
    if order == 2 { mesh.raise_order().expect("order") } else { mesh }
}

/// A block on three planes of symmetry, so that it may grow.
fn on_planes(mesh: TetMesh, poisson: f64) -> Scene {
    let sides = [brick::X_MIN, brick::Y_MIN, brick::Z_MIN];
    let scene = Scene::new(mesh, uniform(YOUNG, poisson)).with_boxes([2, 1, 1]);
    (0..3).fold(scene, |scene, c| {
        scene.with_support(Support::components(sides[c], std::array::from_fn(|k| k == c)))
    })
}

fn largest(values: &[[f64; 6]]) -> f64 {
    values.iter().flatten().fold(0.0, |a, v| a.max(v.abs()))
}

#[test]
fn a_block_that_may_grow_has_no_stress() {
    for (order, poisson) in [(1, 0.3), (2, 0.3), (2, 0.4999)] {
        let scene = on_planes(block(order), poisson).with_load(Load::eigenstrain(Eigenstrain::expansion(WARM)));
        let mut simulation = Simulation::new(scene, Settings::default()).expect("simulation");
        let result = simulation.step().expect("step");
        for (u, x) in result.displacement().iter().zip(result.scene().mesh().points()) {
            (0..3).for_each(|c| assert!((u[c] - WARM * x[c]).abs() < 1e-9 * WARM, "{u:?} at {x:?}"));
        }
        // what full suppression would take
        let bulk = YOUNG / (1.0 - 2.0 * poisson) * WARM;
        assert!(
            largest(&result.stress()) < 1e-8 * bulk,
            "{:e}",
            largest(&result.stress())
        );
        let (mesh, u) = (result.scene().mesh(), result.displacement());
        let smooth = nodal_stresses(mesh, &result.materials(), u.as_flattened()).expect("stresses");
        assert_eq!(result.nodal_stress(), smooth);
        assert!(largest(&smooth) < 1e-8 * bulk, "{:e}", largest(&smooth));
        assert!(result.strain_energy() < 1e-15 * bulk * WARM);
        assert!(result.reactions().loads.force.iter().all(|f| f.abs() < 1e-9 * bulk));
        assert!(result.discretisation_error().expect("estimate").relative() < 1e-6);
    }
}

/// A temperature that grows along z bends a block without stress; a quadratic displacement.
#[test]
fn temperatures_at_nodes_bend_a_quadratic_block_without_stress() {
    for poisson in [0.3, 0.4999] {
        let mesh = block(2);
        let rise: Vec<f64> = mesh.points().iter().map(|x| 80.0 * x[2]).collect();
        let held = mesh.points().iter().position(|x| *x == [0.0; 3]).expect("corner") as u32;
        let scene = Scene::new(mesh, uniform(YOUNG, poisson))
            .with_boxes([2, 1, 1])
            .with_support(Support::components(brick::X_MIN, [true, false, false]))
            .with_support(Support::components(brick::Y_MIN, [false, true, false]))
            .with_support(Support::components(vec![held], [false, false, true]))
            .with_load(Load::eigenstrain(Eigenstrain::expansion(12e-6).with_factors(rise)));
        let settings = Settings::default().with_tolerance(1e-10);
        let mut simulation = Simulation::new(scene, settings).expect("simulation");
        let result = simulation.step().expect("step");
        for (u, [x, y, z]) in result.displacement().iter().zip(result.scene().mesh().points()) {
            let exact = [x * z, y * z, 0.5 * (z * z - x * x - y * y)].map(|v| WARM * v);
            (0..3).for_each(|c| assert!((u[c] - exact[c]).abs() < 1e-7 * WARM, "{u:?}, {exact:?}"));
        }
        let bulk = YOUNG / (1.0 - 2.0 * poisson) * WARM;
        assert!(
            largest(&result.stress()) < 1e-7 * bulk,
            "{:e}",
            largest(&result.stress()) / bulk
        );
    }
}

/// A bar that grows by 80 K towards a wall, half of its elongation away: pressure comes when the gap is closed.
#[test]
fn a_warm_bar_presses_on_the_wall_that_stops_it() {
    let gap = 0.5 * WARM * LENGTHS[0];
    for order in [1, 2] {
        let scene = on_planes(block(order), 0.3)
            .with_load(
                Load::eigenstrain(Eigenstrain::expansion(WARM)).with_history(History::ramp(1.0, 1.0).expect("ramp")),
            )
            .with_contact(Contact::rigid(brick::X_MAX).with_gap(gap))
            .with_analysis(Analysis::quasistatic(1.0, 4));
        let mut simulation = Simulation::new(scene, Settings::default().with_tolerance(1e-9)).expect("simulation");
        for _ in 0..4 {
            let result = simulation.step().expect("step");
            let exact = YOUNG * (result.time() * WARM - 0.5 * WARM).max(0.0);
            let force = -result.points().iter().map(|p| p.normal_force).sum::<f64>();
            assert!((force - exact).abs() < 1e-7 * YOUNG * WARM, "{force:e}, {exact:e}");
            let worst = result.stress().iter().map(|s| (s[0] + exact).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-6 * YOUNG * WARM, "{worst:e}");
            let energy = 0.5 * exact * exact / YOUNG * 2.0;
            assert!((result.strain_energy() - energy).abs() < 1e-6 * YOUNG * WARM * WARM);
            assert!(result.certificate().largest() < 1e-6);
        }
    }
}

/// The right half of a bar between two planes is tightened: the same pull in both halves.
#[test]
fn a_region_that_is_tightened_pulls_the_other() {
    let mesh = Brick::new(LENGTHS, [4, 2, 2]).build().expect("brick");
    let of = |tet: usize| u32::from(mesh.tet_points(tet).iter().map(|x| x[0]).sum::<f64>() > 4.0);
    let regions = (0..mesh.tets().len()).map(of).collect();
    let mesh = mesh.with_regions(regions).expect("regions");
    let strain = Eigenstrain::new([-1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]).in_region(1);
    let planes = |scene: Scene| scene.with_support(Support::components(brick::X_MAX, [true, false, false]));
    let scene = planes(on_planes(mesh.clone(), 0.3)).with_load(Load::eigenstrain(strain.clone()));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("simulation");
    let result = simulation.step().expect("step");
    let pull = 0.5e-3 * YOUNG;
    assert!(
        result
            .stress()
            .iter()
            .all(|s| (s[0] - pull).abs() < 1e-6 * pull && s[1].abs() < 1e-6 * pull)
    );
    let reaction = result.reactions().supports[3].resultant.force;
    assert!((reaction[0] - pull).abs() < 1e-6 * pull, "{reaction:?}");

    // what stands in the materials is a load that is constant
    let scene = Scene::new(mesh, uniform(YOUNG, 0.3).with_eigenstrain(1.0, strain)).with_boxes([2, 1, 1]);
    assert_eq!(scene.loads().len(), 1);
    let twin = [brick::X_MIN, brick::Y_MIN, brick::Z_MIN].into_iter().enumerate();
    let scene = planes(twin.fold(scene, |scene, (c, side)| {
        scene.with_support(Support::components(side, std::array::from_fn(|k| k == c)))
    }));
    let mut twin = Simulation::new(scene, Settings::default()).expect("simulation");
    assert_eq!(
        twin.step().expect("step").torn_displacement(),
        result.torn_displacement()
    );
}

#[test]
fn strains_that_mean_nothing_are_refused() {
    let nodes = block(1).points().len();
    let mut factors = vec![1.0; nodes];
    factors[5] = f64::NAN;
    let cases = [
        (Eigenstrain::expansion(f64::INFINITY), "load 0: an eigenstrain is [inf"),
        (
            Eigenstrain::expansion(1e-3).in_region(4),
            "load 0: an eigenstrain is given in region 4, but",
        ),
        (
            Eigenstrain::expansion(1e-3).with_factors(vec![1.0; 3]),
            "load 0: an eigenstrain has 3 factors for 45 nodes",
        ),
        (
            Eigenstrain::expansion(1e-3).with_factors(factors),
            "load 0: the factor of an eigenstrain at node 5 is NaN",
        ),
    ];
    for (strain, expected) in cases {
        let scene = on_planes(block(1), 0.3).with_load(Load::eigenstrain(strain));
        let error = Simulation::new(scene, Settings::default())
            .expect_err("refused")
            .to_string();
        assert!(error.starts_with(expected), "{error}");
    }
}

/// Nothing but a side of the other touches two warm blocks, one on the other: what rounding leaves of forces in balance
/// pushes neither, and all forces are zero.
#[test]
fn warm_bodies_that_nothing_holds_rest() {
    for friction in [Friction::None, Friction::coulomb(0.2)] {
        let mesh = with_second(&block(1), &lifted(&block(1), LENGTHS[2]));
        let contact = Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(friction);
        let scene = Scene::new(mesh, uniform(YOUNG, 0.3))
            .with_subdomains(6)
            .with_load(Load::eigenstrain(Eigenstrain::expansion(WARM)))
            .with_contact(contact);
        let mut simulation = Simulation::new(scene, Settings::default()).expect("simulation");
        let result = simulation.step().expect("step");
        assert!(result.report().status.converged() && result.report().counters.products <= 3);
        assert!(largest(&result.stress()) < 1e-9 * YOUNG * WARM);
    }
}

/// None at all were taken for a factor of one at each node.
#[test]
fn no_factors_are_a_wrong_number_of_them() {
    let warm = Load::eigenstrain(Eigenstrain::expansion(1e-5).with_factors(Vec::new()));
    let scene = Scene::new(crate::common::block([1.0; 3], [1; 3]), steel())
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(warm);
    let text = refused(&scene).to_string();
    assert!(text.contains("0 factors for 8 nodes"), "{text}");
}
