//! Sums over the contact points of each contact.

use crate::common::*;
use crate::halving;
use signorini_tfeti::internal::on_ranks;

/// A block between a rough floor and a rough plate that comes down and moves along.
fn clamped_between(mesh: TetMesh) -> Scene {
    let plate = Contact::rigid(brick::Z_MAX).with_friction(Friction::coulomb(0.2));
    Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::components(brick::X_MIN, [true, false, false]))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
        .with_contact(plate.with_motion([2e-4, 0.0, -1e-3], ramp()))
        .with_analysis(Analysis::quasistatic(1.0, 2))
}

/// All numbers of a summary, as they are printed.
fn told(sums: &[ContactSummary]) -> String {
    format!("{sums:?}")
}

type Of = fn(&ContactSummary) -> f64;

fn of_each(result: &StepResult) -> Vec<ContactSummary> {
    let contacts = result.scene().contacts().len();
    assert!(result.summary_of(contacts).is_none());
    (0..contacts).map_while(|k| result.summary_of(k).copied()).collect()
}

/// Floor and plate push against each other: together nothing, each what its reaction is, on the area of its side.
#[test]
fn each_contact_has_its_own_sums() {
    for mesh in [
        block([2.0, 1.0, 1.0], [6, 3, 3]),
        block([2.0, 1.0, 1.0], [4, 2, 2]).raise_order().expect("quadratic"),
    ] {
        let mut simulation = Simulation::new(clamped_between(mesh), tight()).expect("set-up");
        while !simulation.is_finished() {
            let result = simulation.step().expect("step");
            result.require_converged().expect("converged");
            let (all, own, reactions) = (*result.summary(), of_each(&result), result.reactions());
            assert_eq!(own.len(), 2);
            assert!(norm(&all.resultant) < 0.5 * own[0].normal_force);
            for (k, s) in own.iter().enumerate() {
                assert_close(&s.resultant, &reactions.contacts[k].force, 1e-12, "reaction");
                assert!(s.normal_force > 0.0 && s.friction_work > 0.0);
                assert!((s.area / 2.0 - 1.0).abs() < 1e-12, "{}", s.area);
                let points = result.points().iter().filter(|p| p.surface == k);
                let pressures = points.map(|p| -p.normal_force / p.area);
                assert_eq!(s.max_pressure, pressures.fold(0.0, f64::max));
            }
            assert_eq!(own[0].obstacle_work, 0.0);
            let sum = |of: Of| [of(&own[0]) + of(&own[1]), of(&all)];
            for [parts, whole] in [
                sum(|s| s.area),
                sum(|s| s.normal_force),
                sum(|s| s.friction_work),
                sum(|s| s.dissipation),
                sum(|s| s.obstacle_work),
                sum(|s| s.normal_norm.powi(2)),
                sum(|s| s.friction_norm.powi(2)),
                sum(|s| (s.active + 1000 * s.stick + 1_000_000 * s.slip) as f64),
            ] {
                assert!((parts / whole - 1.0).abs() < 1e-12, "{parts:e} {whole:e}");
            }
            let largest: [Of; 3] = [|s| s.max_pressure, |s| s.max_slip_rate, |s| s.max_penetration];
            for of in largest {
                assert_eq!(of(&own[0]).max(of(&own[1])), of(&all));
            }
        }
    }
}

/// A uniform pressure is the largest one, whatever the elements and how unequal the triangles.
#[test]
fn a_uniform_pressure_is_the_largest() {
    let linear = Brick::new([1.0; 3], [4; 3]).perturbed(0.15, 7).build().expect("brick");
    for mesh in [linear.clone(), linear.raise_order().expect("quadratic")] {
        let scene = Scene::new(mesh, uniform(1e9, 0.3))
            .with_support(Support::components(brick::X_MIN, [true, false, false]))
            .with_support(Support::components(brick::Y_MIN, [false, true, false]))
            .with_load(Load::pressure(brick::Z_MAX, 1e5))
            .with_contact(Contact::rigid(brick::Z_MIN));
        let mut simulation = Simulation::new(scene, tight()).expect("set-up");
        let result = simulation.step().expect("step");
        let sum = result.summary();
        assert!((sum.max_pressure / 1e5 - 1.0).abs() < 1e-6, "{}", sum.max_pressure);
        assert!((sum.area - 1.0).abs() < 1e-12);
        assert_eq!(result.summary_of(0), Some(sum));
        assert!(result.summary_of(1).is_none());
    }
}

/// The works of a step that is taken in parts are those of its parts: all of the floor, none of a wall far away.
#[test]
fn halved_steps_have_the_works_of_their_parts() {
    let scene = halving::scene(&halving::WHOLE, DifferenceFormula::BACKWARD_EULER)
        .with_contact(Contact::rigid(brick::Y_MAX).with_gap(0.5));
    let between = |products: usize| {
        let settings = halving::short_of(products)
            .with_extrapolation(false)
            .with_step_halving(6);
        let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
        while !simulation.is_finished() {
            let result = simulation.step().expect("step");
            let (all, own) = (result.summary(), of_each(&result));
            let works: [Of; 2] = [|s| s.friction_work, |s| s.dissipation];
            for of in works {
                assert_eq!((of(&own[0]), of(&own[1])), (of(all), 0.0));
            }
        }
        simulation.counters().between
    };
    assert!(
        [12, 13, 14, 15, 16, 18, 20]
            .map(between)
            .iter()
            .any(|between| *between > 0)
    );
}

#[test]
fn ranks_have_the_same_sums() {
    let sums = |settings: Settings| {
        let scene = clamped_between(block([2.0, 1.0, 1.0], [6, 3, 3])).with_subdomains(5);
        let mut simulation = Simulation::new(scene, settings).expect("set-up");
        let mut text = String::new();
        while !simulation.is_finished() {
            let result = simulation.step().expect("step");
            text += &told(&of_each(&result));
            text += &told(&[*result.summary()]);
        }
        text
    };
    let alone = sums(Settings::default());
    for ranks in on_ranks(2, |c| sums(Settings::default().with_communicator(c))) {
        assert_eq!(ranks.expect("no panic"), alone);
    }
}
