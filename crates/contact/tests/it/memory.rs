//! Steps use the memory of those before.

use crate::common::*;
use allocation_counter::measure;

/// What a step takes at once stays below a torn vector, of which its result has two.
#[test]
fn a_step_takes_the_memory_of_the_last_one() {
    let scene = loaded_brick(block([3.0, 1.0, 1.0], [12, 4, 4]), ramp())
        .with_contact(foundation(Friction::coulomb(0.3)))
        .with_boxes([12, 4, 4])
        .with_analysis(paper_steps(1.0, 4));
    // the counter sees one thread
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("pool");
    pool.install(|| {
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let torn = (0..2).map(|_| simulation.step().expect("step").torn_displacement().len());
        let bytes = 8 * torn.max().expect("two steps") as u64;
        for step in 2..4 {
            let taken = measure(|| drop(simulation.step().expect("step"))).bytes_max;
            assert!(taken < bytes, "step {step}: {taken} of {bytes}");
        }
    });
}
