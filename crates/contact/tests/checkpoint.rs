//! States as bytes: a run that was stored and read back continues bit for bit.
#![cfg(feature = "checkpoint")]

mod common;

use common::{bits, methods, rest, small_benchmark, state_bits, step, weakening};
use signorini_contact::{Accuracy, Friction, Settings, Simulation, State};

#[test]
fn a_stored_run_continues_bit_for_bit() {
    let mut settings = methods()
        .map(|m| Settings::default().with_method(m))
        .to_vec();
    settings.push(Settings::default().with_accuracy(Accuracy::Relative(1e-5)));
    settings.push(Settings::default().with_accuracy(Accuracy::balanced()));
    for settings in settings {
        for law in [Friction::coulomb(0.3), weakening()] {
            let new = || {
                Simulation::new(small_benchmark(law.clone(), 4), settings.clone()).expect("set-up")
            };
            let mut simulation = new();
            let (mut stored, mut levels) = (Vec::new(), Vec::new());
            while !simulation.is_finished() {
                stored.push(simulation.state().to_bytes().expect("encode"));
                levels.push(step(&mut simulation));
            }
            for (k, bytes) in stored.iter().enumerate() {
                let mut again = new();
                again
                    .resume(State::from_bytes(bytes).expect("decode"))
                    .expect("resume");
                for (a, b) in rest(&mut again).iter().zip(&levels[k..]) {
                    assert_eq!(bits(a), bits(b), "resumed after level {k}");
                    assert_eq!(a.report.accuracy, b.report.accuracy);
                }
                assert_eq!(state_bits(again.state()), state_bits(simulation.state()));
            }
        }
    }
}
