//! Bytes as a checkpoint with the right checksum: as they are, or as changes of a good one. What can be read is refused
//! by a run, or goes on.
#![no_main]

use libfuzzer_sys::fuzz_target;
use signorini::prelude::*;
use std::sync::{LazyLock, Mutex};

static RUN: LazyLock<Mutex<Simulation>> = LazyLock::new(|| {
    let mesh = Brick::new([3.0, 1.0, 1.0], [3, 1, 1]).build().expect("brick");
    let steel = Hooke::isotropic(211.9e9, 0.277).expect("steel");
    let scene = Scene::new(mesh, steel.into())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 30e8))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
        .with_analysis(Analysis::quasistatic(1.0, 4));
    Mutex::new(Simulation::new(scene, Settings::default()).expect("set-up"))
});

/// What stands behind the checksum of a good checkpoint.
static GOOD: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut run = RUN.lock().expect("one thread");
    let _ = run.step().expect("step");
    run.state().to_bytes().expect("encode")
});

fuzz_target!(|bytes: &[u8]| {
    let payload = match bytes.split_first() {
        Some((0, rest)) => rest.to_vec(),
        _ => {
            let mut payload = GOOD[12..].to_vec();
            for change in bytes.chunks_exact(3) {
                let at = usize::from(u16::from_le_bytes([change[0], change[1]])) % payload.len();
                payload[at] = change[2];
            }
            payload
        }
    };
    let mut whole = GOOD[..4].to_vec();
    let sum = payload.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    whole.extend(sum.to_le_bytes());
    whole.extend(payload);
    let Ok(state) = State::from_bytes(&whole) else { return };
    let mut run = RUN.lock().expect("one thread");
    if run.resume(state).is_ok() && !run.is_finished() {
        let _ = run.step();
    }
});
