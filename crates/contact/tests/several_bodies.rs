//! Several bodies in one scene: the obstacle is rigid, so none knows of the others, however different their sizes are.

mod common;

use common::{assert_certified, block, distance, forces, methods, ramp, step, tight, uniform};
use signorini_contact::{
    Analysis, Contact, ContactError, Friction, Load, PointState, Scene, Settings, Simulation,
    Support,
};
use signorini_fem_mesh::{FacetTag, Hooke, Materials, TetMesh, brick};

const FAR: f64 = 10.0;

/// Tags of the second body.
fn other(tag: FacetTag) -> FacetTag {
    match tag {
        brick::Z_MIN => brick::Z_MIN,
        FacetTag(t) => FacetTag(t + 100),
    }
}

/// The first body: a clamped bar that is pressed on the floor.
fn bar() -> TetMesh {
    block([3.0, 1.0, 1.0], [6, 2, 2])
}

/// The second one: a block that lies on the floor, far from the first.
fn cube() -> TetMesh {
    block([1.0; 3], [3; 3])
        .map_points(|x| [x[0], x[1] + FAR, x[2]])
        .expect("moved")
        .map_tags(other)
}

fn on_the_floor(scene: Scene, friction: Friction) -> Scene {
    let parts = scene.mesh().components();
    scene
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
        .with_parts(parts)
        .with_analysis(Analysis::quasistatic(1.0, 3))
}

fn bar_loads(scene: Scene) -> Scene {
    scene
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [2e6, 0.0, -2e7]).with_history(ramp()))
}

/// Loads of the block, times a factor: pressed and pushed, part of the floor slides.
fn cube_loads(scene: Scene, factor: f64) -> Scene {
    let top = other(brick::Z_MAX);
    let load = Load::traction(top, [factor * 2e6, 0.0, -factor * 1e7]);
    scene.with_load(load.with_history(ramp()))
}

fn both(young: f64) -> Scene {
    let bar = bar();
    let mesh = bar.append(&cube()).expect("two bodies");
    let regions = mesh.components();
    let steel = Hooke::isotropic(2e11, 0.3).expect("steel");
    let soft = Hooke::isotropic(young, 0.3).expect("soft");
    let materials = Materials::new(vec![(0, steel), (1, soft)]).expect("two materials");
    Scene::new(mesh.with_regions(regions).expect("regions"), materials)
}

/// Points of the last level that belong to a body, which must be certified.
fn last(
    scene: Scene,
    settings: Settings,
    keep: impl Fn(f64) -> bool,
    what: &str,
) -> Vec<PointState> {
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let positions: Vec<f64> = simulation
        .constrained_points()
        .iter()
        .map(|p| p.position()[1])
        .collect();
    let mut points = Vec::new();
    while !simulation.is_finished() {
        let level = step(&mut simulation);
        assert_certified(&level, what);
        points = level.points;
    }
    let kept = points.into_iter().zip(positions).filter(|(_, y)| keep(*y));
    kept.map(|(p, _)| p).collect()
}

fn of_the_bar(y: f64) -> bool {
    y < FAR / 2.0
}

fn of_the_block(y: f64) -> bool {
    y > FAR / 2.0
}

#[test]
fn a_light_body_is_solved_beside_a_heavy_one() {
    let friction = || Friction::coulomb(0.3);
    let alone = last(
        on_the_floor(
            cube_loads(Scene::new(cube(), uniform(2e11, 0.3)), 1.0),
            friction(),
        ),
        tight(),
        of_the_block,
        "block",
    );
    let bar = last(
        on_the_floor(bar_loads(Scene::new(bar(), uniform(2e11, 0.3))), friction()),
        tight(),
        of_the_bar,
        "bar",
    );
    for (young, factor) in [
        (2e11, 1e-12),
        (2e11, 1e-7),
        (2e11, 1e9),
        (2e4, 1e-7),
        (2e18, 1e7),
    ] {
        // steps of the paper's methods are those of the softest body: without a preconditioner stiff ones wait for ever
        let count = if young == 2e11 { 3 } else { 1 };
        for method in methods().into_iter().take(count) {
            let what = format!("E {young:e}, loads times {factor:e}, {}", method.name());
            let scene = || on_the_floor(cube_loads(bar_loads(both(young)), factor), friction());
            let settings = Settings::default().with_method(method.clone());
            let points = last(scene(), settings.clone(), of_the_block, &what);
            let scaled: Vec<f64> = forces(&points).iter().map(|f| f / factor).collect();
            let off = distance(&scaled, &forces(&alone));
            assert!(off < 2e-5, "{what}: the block is {off:e} off");
            let off = distance(
                &forces(&last(scene(), settings, of_the_bar, &what)),
                &forces(&bar),
            );
            assert!(off < 2e-5, "{what}: the bar is {off:e} off");
        }
    }
}

#[test]
fn given_slip_bounds_keep_their_newtons() {
    let friction = || Friction::tresca(1.5e-3);
    let cube_alone = cube_loads(Scene::new(cube(), uniform(2e11, 0.3)), 1e-9);
    let held = |scene: Scene| scene.with_support(Support::fixed(other(brick::X_MIN)));
    let alone = last(
        on_the_floor(held(cube_alone), friction()),
        tight(),
        of_the_block,
        "block",
    );
    let scene = on_the_floor(held(cube_loads(bar_loads(both(2e11)), 1e-9)), friction());
    let points = last(scene, Settings::default(), of_the_block, "both");
    let off = distance(&forces(&points), &forces(&alone));
    assert!(off < 2e-5, "{off:e}");
    assert!(
        points
            .iter()
            .any(|p| p.slip_bound > 0.0 && p.slip_rate > 0.0),
        "some slide"
    );
}

#[test]
fn a_body_that_only_moves_is_solved_beside_a_loaded_one() {
    let moved = |scene: Scene| {
        let top = Support::fixed(other(brick::Z_MAX));
        scene.with_support(top.with_motion([2e-13, 0.0, -1e-12], ramp()))
    };
    let friction = || Friction::coulomb(0.3);
    let alone = on_the_floor(moved(Scene::new(cube(), uniform(2e11, 0.3))), friction());
    let alone = last(alone, tight(), of_the_block, "block");
    let scene = on_the_floor(moved(bar_loads(both(2e11))), friction());
    let points = last(scene, Settings::default(), of_the_block, "both");
    let off = distance(&forces(&points), &forces(&alone));
    assert!(off < 2e-5, "{off:e}");
}

/// A soft block that its support moves without touching, beside a loaded bar: its forces are rounding errors.
#[test]
fn a_body_that_moves_without_forces_does_not_disturb_another() {
    let bar = last(
        on_the_floor(
            bar_loads(Scene::new(bar(), uniform(2e11, 0.3))),
            Friction::None,
        ),
        tight(),
        of_the_bar,
        "bar",
    );
    for (young, motion) in [(0.2, 1e-5), (2.0, 1e-5), (0.2, 1e-3), (2e11, 1e-5)] {
        let top = Support::fixed(other(brick::Z_MAX));
        let scene =
            bar_loads(both(young)).with_support(top.with_motion([motion, 0.0, motion], ramp()));
        let scene = on_the_floor(scene, Friction::None);
        let points = last(scene, Settings::default(), of_the_bar, "both");
        let off = distance(&forces(&points), &forces(&bar));
        assert!(off < 2e-5, "E {young:e}, motion {motion:e}: {off:e}");
    }
}

/// A force that nothing balances is found under another body's load 1e12 times as large.
#[test]
fn a_light_body_that_nothing_holds_is_refused() {
    let top = other(brick::Z_MAX);
    let scene = bar_loads(both(2e11)).with_load(Load::traction(top, [0.0, 0.0, 1e-5]));
    let error = Simulation::new(on_the_floor(scene, Friction::None), Settings::default());
    match error.expect_err("refused") {
        ContactError::NotHeld { body, force, .. } => {
            assert_eq!(body, 1);
            assert!((force - 1e-5).abs() < 1e-12, "{force:e}");
        }
        error => panic!("{error}"),
    }
}
