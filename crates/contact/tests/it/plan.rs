//! What a plan tells before any work is what the set-up finds.

use crate::common::*;

fn statics(friction: Friction) -> Scene {
    small_benchmark(friction, 1).with_analysis(Analysis::statics())
}

fn set_up(scene: Scene) -> Simulation {
    Simulation::new(scene, Settings::default()).expect("set-up")
}

/// What the plan promises is what the set-up finds.
/// A mesh in other units or in another place shows in the plan.
#[test]
fn the_plan_tells_the_range_of_the_gaps() {
    let plan = |contact: Contact| {
        let scene = Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), steel()).with_contact(contact);
        Plan::new(&scene, &Settings::default()).expect("plan")
    };
    let touching = plan(Contact::rigid(brick::Z_MIN));
    assert_eq!(touching.gaps, Some([0.0; 2]));
    assert!(touching.to_string().contains("no gap"));
    let wedge = plan(Contact::rigid(brick::Z_MIN).with_gap_field(|x| 0.25 * x[0] - 0.125));
    assert_eq!(wedge.gaps, Some([-0.125, 0.375]));
    let text = wedge.to_string();
    assert!(text.contains("gaps -1.250e-1 to 3.750e-1, starts inside"), "{text}");
    let scene = Scene::new(block([1.0; 3], [2; 3]), steel()).with_support(Support::fixed(brick::X_MIN));
    let none = Plan::new(&scene, &Settings::default()).expect("plan");
    assert_eq!(none.gaps, None);
}

/// What the set-up refuses the plan does.
#[test]
fn the_plan_keeps_the_memory_limit() {
    let settings = Settings::default().with_inverse(signorini_tfeti::InverseSettings::default().with_memory_limit(10));
    let plan = Plan::new(&statics(Friction::None), &settings).expect_err("a limit");
    let set_up = Simulation::new(statics(Friction::None), settings).expect_err("a limit");
    assert!(
        plan.to_string() == set_up.to_string() && plan.to_string().contains("memory"),
        "{plan}"
    );
}

#[test]
fn the_plan_predicts_the_rows() {
    for scene in [
        statics(Friction::None),
        statics(Friction::coulomb(0.3)),
        benchmark(ramp(), 3),
        benchmark(ramp(), 3).with_boxes([1, 1, 1]),
    ] {
        let plan = Plan::new(&scene, &Settings::default()).expect("plan");
        let simulation = set_up(scene);
        let ranges = simulation.tfeti().gluing().ranges().clone();
        assert_eq!(plan.normal_rows, ranges.normal.len());
        assert_eq!(plan.tangential_rows, ranges.tangential().len());
        assert_eq!(plan.interface_rows, ranges.interface.len());
        assert_eq!(plan.dirichlet_rows, ranges.dirichlet.len());
        assert_eq!(plan.dual(), simulation.tfeti().dual_dim());
        assert_eq!(plan.primal, simulation.tfeti().torn_dim());
        // what the plan analysed the set-up takes over
        assert_eq!(simulation.tfeti().report().analysed, 0);
    }
}

#[test]
fn the_plan_tells_what_a_formed_f_needs() {
    let formed = |scene: Scene, settings: Settings| {
        let plan = Plan::new(&scene, &settings).expect("plan");
        println!("{plan}");
        assert_eq!(plan.to_string().contains("for a hard step"), plan.formed_bytes > 0);
        let simulation = Simulation::new(scene, settings).expect("set up");
        let found = simulation.tfeti().explicit_cost().map_or(0, |cost| cost.bytes);
        (plan.formed_bytes, found, plan)
    };
    let scene = || small_benchmark(Friction::coulomb(0.3), 2);
    let (told, found, plan) = formed(scene(), Settings::default());
    let rows = plan.dual() as u64;
    assert!(told == found && told > 0 && told < 24 * rows * rows, "{told} {found}");
    assert_eq!(formed(scene(), by(Method::paper())).0, 0);
    // rows that share no subdomain have no entry
    let torn = |parts: [usize; 3]| {
        let scene = loaded_brick(block([3.0, 1.0, 1.0], [24, 8, 8]), up_down_up()).with_boxes(parts);
        scene.with_contact(foundation(Friction::coulomb(0.3)))
    };
    let (told, found, plan) = formed(torn([24, 8, 8]), Settings::default());
    let rows = plan.dual() as u64;
    assert!(
        told == found && rows > 20_000 && told < rows * rows,
        "{told} {found} {rows}"
    );
    let (told, found, plan) = formed(torn([6, 1, 1]).with_subdomains(1), Settings::default());
    assert!(told == found && plan.interface_rows == 0, "{told} {found}");
    let wide = loaded_brick(block([3.0, 3.0, 0.2], [52, 52, 1]), up_down_up());
    let (told, found, plan) = formed(
        wide.with_contact(foundation(Friction::coulomb(0.3))),
        Settings::default(),
    );
    assert!(
        told == 0 && found == 0 && plan.normal_rows + plan.tangential_rows > 8000,
        "{told} {found}"
    );
}

/// Every tetrahedron a subdomain, by mistake: six unknowns each and thirty neighbours make a coarse problem that
/// outweighs all else.
#[test]
fn the_plan_knows_what_very_small_subdomains_cost() {
    let plan = |n: usize, small: bool| {
        let mesh = block([3.0, 1.0, 1.0], [3 * n, n, n]);
        let parts = (0..mesh.tets().len() as u32).collect();
        let scene = Scene::new(mesh, steel())
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [3e8, 0.0, -3e9]))
            .with_contact(Contact::rigid(brick::Z_MIN).with_gap(0.01));
        let scene = if small { scene.with_parts_as_given(parts) } else { scene.with_boxes([3, 1, 1]) };
        Plan::new(&scene, &Settings::default()).expect("plan")
    };
    let seconds = |p: &Plan| {
        let plan = p.clone().with_machine(Rate::default());
        let times = plan.estimate.times.expect("a machine");
        times.setup + times.steps
    };
    let (coarse, fine) = (plan(3, true), plan(6, true));
    // eight times as many subdomains, nearly their square
    assert!(seconds(&fine) > 30.0 * seconds(&coarse));
    assert!(seconds(&fine) > 30.0 * seconds(&plan(6, false)));
    assert!(fine.to_string().contains("too small ones"), "{fine}");
    assert!(!plan(6, false).to_string().contains("too small ones"));
}

/// Of 24 equal subdomains that share their matrices a product is dense; if each has its own, memory sets the pace.
#[test]
fn matrices_that_are_not_shared_are_read_at_the_pace_of_memory() {
    let plan = |share: bool| {
        let scene = Scene::new(block([6.0, 2.0, 2.0], [30, 10, 10]), steel())
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [3e8, 0.0, -3e9]))
            .with_contact(Contact::rigid(brick::Z_MIN).with_gap(0.01))
            .with_boxes([6, 2, 2]);
        let settings = Settings::default().with_share_translates(share);
        Plan::new(&scene, &settings)
            .expect("plan")
            .with_machine(Rate::default())
            .estimate
    };
    let product = |e: &signorini_contact::plan::Estimate| e.times.expect("a machine").product;
    let (shared, own) = (plan(true), plan(false));
    let reading = own.inverse_bytes as f64 / 8.0 / Rate::default().numbers;
    assert!(product(&own) > 2.0 * reading);
    assert!(own.products == shared.products);
}

/// Measured on the benchmark with inner nodes displaced: 4.4 and 5.1 times the set-up of shared matrices at n = 3 and 4
/// (docs/reports/performance.md).
#[test]
fn the_set_up_of_unshared_subdomains_takes_longer() {
    let set_up = |perturbed: f64| {
        let mesh = Brick::new([3.0, 1.0, 1.0], [45, 15, 15]).perturbed(perturbed, 7);
        let scene = Scene::new(mesh.build().expect("mesh"), steel())
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::pressure(brick::Z_MAX, 1e8))
            .with_contact(foundation(Friction::coulomb(0.3)))
            .with_boxes([9, 3, 3]);
        let plan = Plan::new(&scene, &Settings::default()).expect("plan");
        plan.with_machine(Rate::default()).estimate.times.expect("times").setup
    };
    let ratio = set_up(0.15) / set_up(0.0);
    println!("{ratio}");
    assert!((2.2..8.8).contains(&ratio), "{ratio}");
}

/// The error that the plan expects is that of the estimate after the run within a factor of two and a half, on bodies
/// that are compact, long or flat, and on a slice between planes. Of linear cells that lock it says nothing.
#[test]
fn the_plan_expects_the_error_of_the_mesh() {
    let scene = |size: [f64; 3], cells: [usize; 3], order: usize, poisson: f64| {
        let mesh = block(size, cells);
        let mesh = if order == 2 { mesh.raise_order().expect("order 2") } else { mesh };
        Scene::new(mesh, uniform(210e9, poisson))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e6]))
    };
    let plane = |tag| Support::components(tag, [false, true, false]);
    let slice = scene([4.0, 0.5, 1.0], [16, 2, 4], 2, 0.3)
        .with_support(plane(brick::Y_MIN))
        .with_support(plane(brick::Y_MAX));
    let pressed = |order: usize, n: usize| {
        scene([3.0, 1.0, 1.0], [3 * n, n, n], order, 0.3)
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
    };
    for (name, scene) in [
        ("brick", pressed(1, 5)),
        ("brick of order 2", pressed(2, 3)),
        ("bar", scene([8.0, 1.0, 1.0], [32, 4, 4], 1, 0.3)),
        ("bar of order 2", scene([8.0, 1.0, 1.0], [16, 2, 2], 2, 0.3)),
        ("plate", scene([5.0, 5.0, 0.5], [20, 20, 2], 1, 0.3)),
        ("plate of order 2", scene([5.0, 5.0, 0.5], [10, 10, 1], 2, 0.3)),
        ("slice", slice),
    ] {
        let simulation = run(scene, at(1e-6)).0;
        let expected = simulation.plan().mesh_error.expect("an error");
        let result = simulation.result().expect("a step");
        let found = result.discretisation_error().expect("an estimate").relative();
        println!("{name}: expected {expected:.3}, estimated {found:.3}");
        assert!(
            found < 2.5 * expected && expected < 2.5 * found,
            "{name}: {expected}, {found}"
        );
        assert!(simulation.plan().to_string().contains("discretisation_error()"));
    }
    let locking = scene([1.0; 3], [2; 3], 1, 0.49);
    assert_eq!(
        Plan::new(&locking, &Settings::default()).expect("plan").mesh_error,
        None
    );
}

/// A contact whose nodes supports hold along its normal has no rows, in the plan, too, and is told.
#[test]
fn a_contact_that_supports_leave_nothing_is_told() {
    for held in [
        Support::components(brick::Z_MIN, [false, false, true]),
        Support::fixed(brick::Z_MIN),
    ] {
        let scene = Scene::new(block([1.0; 3], [2; 3]), uniform(1e6, 0.3))
            .with_support(held)
            .with_support(Support::fixed(brick::X_MIN))
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
            .with_load(Load::pressure(brick::Z_MAX, 1.0));
        let simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let plan = simulation.plan();
        assert_eq!((plan.normal_rows, plan.tangential_rows), (0, 0));
        assert!(
            plan.warnings()
                .iter()
                .any(|w| matches!(w.plain(), Warning::IdleContact { contact: 0 }))
        );
        assert_eq!(simulation.tfeti().gluing().ranges().contact().len(), 0);
    }
}

/// The points of several contacts on one side are not in the order of the contacts: what begins far away was missed.
#[test]
fn a_far_contact_beside_a_nearer_one_is_warned_of() {
    let scene = Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), steel())
        .with_support(Support::fixed(brick::Z_MAX))
        .with_load(Load::pressure(brick::Z_MAX, 1e6))
        .with_contact(Contact::rigid(brick::Z_MIN).with_tag(brick::X_MAX).with_gap(100.0))
        .with_contact(Contact::rigid(brick::Z_MIN).with_gap(0.1));
    let plan = Plan::new(&scene, &Settings::default()).expect("plan");
    let far = |w: &Warning| matches!(w, Warning::LargeGap { contact: 0, .. });
    assert!(plan.warnings().iter().any(far), "{:?}", plan.warnings());
}
