//! Steps use the memory of those before.

use allocation_counter::measure;
use signorini_contact::{Analysis, Contact, Friction, Load, Scene, Settings, Simulation, Support};
use signorini_fem_mesh::{Brick, History, Hooke, Materials, brick};

/// What is recovered takes the place of the last result, unless somebody keeps that; multipliers and products that of
/// the step three before. What is left are panels of products and solves.
#[test]
fn a_step_takes_the_memory_of_the_last_one() {
    let mesh = Brick::new([3.0, 1.0, 1.0], [36, 12, 12]).build().expect("mesh");
    let law = Hooke::isotropic(2e11, 0.3).expect("law");
    let ramp = History::ramp(1.0, 1.0).expect("ramp");
    let scene = Scene::new(mesh, Materials::uniform(law))
        .with_support(Support::fixed(brick::X_MIN))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e8]).with_history(ramp))
        .with_boxes([9, 3, 3])
        .with_analysis(Analysis::quasistatic(1.0, 6));
    // the counter sees one thread
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("pool");
    pool.install(|| {
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let mut times = |kept: bool| {
            let result = simulation.result().cloned().filter(|_| kept);
            let mut torn = 0;
            let taken = measure(|| torn = simulation.step().expect("step").torn_displacement().len());
            drop(result);
            taken.bytes_total as f64 / (8 * torn) as f64
        };
        let all = [false, false, false, false, false, true].map(&mut times);
        assert!(all[3..5].iter().all(|taken| *taken < 7.4), "{all:?} torn vectors");
        assert!(all[5] > 9.0, "{all:?} torn vectors");
    });
}
