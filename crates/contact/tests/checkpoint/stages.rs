//! Couplings that are locked, supports and contacts that start and end, in runs of several ranks that are broken off.

use crate::Folder;
use signorini_contact::{
    Analysis, Contact, Coupling, Flow, Friction, Load, Scene, Settings, Simulation, StepResult, Support,
};
use signorini_fem_mesh::{Brick, FacetTag, History, Hooke, Materials, brick};
use signorini_tfeti::internal::on_ranks;
use std::path::Path;

/// Two ranks go on together from states before and after the lock.
#[test]
fn locked_couplings_of_several_ranks() {
    let bar = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).build().expect("brick");
    let left = |tet: usize| Some(bar.tet_points(tet).iter().map(|p| p[0]).sum::<f64>() < 4.0);
    let sides = [31, 32].map(FacetTag);
    let (mesh, _) = bar.cut(left, sides).expect("cut");
    let hold = |c: usize| c > 0;
    let bolt = Coupling::relative(0, [1.0, 0.5, 0.5]).with_held(std::array::from_fn(hold));
    let scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(1e9, 0.3).expect("Hooke")))
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(Support::fixed(brick::X_MAX))
        .with_contact(Contact::tied(sides[0], sides[1]))
        .with_coupling(bolt.with_lock(std::array::from_fn(|c| !hold(c)), 0.5))
        .with_load(Load::on_coupling(0, [1e6, 0.0, 0.0], [0.0; 3]).with_history(History::ramp(1.0, 1.0).expect("ramp")))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 4));
    assert_goes_on(&scene, "locked");
}

/// Two ranks go on together from states before and after a support and a contact start and end.
#[test]
fn supports_and_contacts_of_several_ranks() {
    let bar = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).build().expect("brick");
    let ramp = || History::ramp(1.0, 1.0).expect("ramp");
    let floor = || Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3));
    let clamp = Support::fixed(brick::X_MAX).with_motion([0.0, 1e-3, 0.0], ramp());
    let scene = Scene::new(bar, Materials::uniform(Hooke::isotropic(1e9, 0.3).expect("Hooke")))
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(clamp.with_end(0.25))
        .with_support(Support::fixed(brick::Z_MAX).with_start(0.5))
        .with_contact(floor().with_end(0.5))
        .with_contact(floor().with_start(0.75))
        .with_load(Load::pressure(brick::Z_MAX, 1e6).with_history(ramp()))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 4));
    assert_goes_on(&scene, "stages");
}

/// Runs of two ranks that are broken off after each step end as one that is not.
fn assert_goes_on(scene: &Scene, name: &str) {
    let run = |steps: usize, folder: &Path, settings: Settings| {
        let mut simulation = Simulation::new(scene.clone(), settings.with_share_translates(false)).expect("set-up");
        let mut observer = |result: &StepResult| {
            if result.step() + 1 == steps { Flow::Stop } else { Flow::Continue }
        };
        let _ = simulation.run_or_resume(folder, 1, &mut observer).expect("run");
        simulation.state().to_bytes().expect("encode")
    };
    let [whole, folder] = ["whole", "ranks"].map(|run| Folder::new(&format!("{name}-{run}")));
    let whole = run(4, &whole.0, Settings::default());
    for steps in 1..=4 {
        for run in on_ranks(2, |c| run(steps, &folder.0, Settings::default().with_communicator(c))) {
            assert!(run.expect("no panic") == whole || steps < 4);
        }
    }
}
