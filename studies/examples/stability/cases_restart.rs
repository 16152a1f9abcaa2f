//! Restarts from states that are of no use.

use super::case::{Case, Setup, ToSetup};
use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::{Block, TOP};

fn block() -> Block {
    Block {
        floor: Some(Friction::None),
        cells: [3; 3],
        ..Block::default()
    }
}

/// State after `steps` steps.
fn state_after(setup: Setup, steps: usize) -> Result<State, Failure> {
    let mut simulation = Simulation::new(setup.scene, setup.settings)?;
    for _ in 0..steps {
        simulation.step()?;
    }
    Ok(simulation.state().clone())
}

fn resumed(scene: &Block, other: &Block, steps: usize) -> Result<Setup, Failure> {
    let mut setup = scene.setup()?;
    setup.start = Some(state_after(other.setup()?, steps)?);
    Ok(setup)
}

/// Format number and checksum before the state.
const HEAD: usize = 12;

/// Reads and writes the numbers of a stored state: postcard keeps lengths as varints and numbers as eight bytes. The
/// checksum (FNV-1a) is made to fit what was written.
pub(crate) fn garble(bytes: &mut [u8], vectors: usize, mut value: impl FnMut(f64) -> f64) {
    let mut at = HEAD;
    let varint = |bytes: &[u8], at: &mut usize| {
        let (mut out, mut shift) = (0_usize, 0);
        while let Some(&byte) = bytes.get(*at) {
            *at += 1;
            out |= usize::from(byte & 0x7f) << shift;
            shift += 7;
            if byte & 0x80 == 0 {
                break;
            }
        }
        out
    };
    let _step = varint(bytes, &mut at);
    for _ in 0..vectors {
        let length = varint(bytes, &mut at);
        for _ in 0..length {
            let Some(chunk) = bytes.get_mut(at..at + 8) else {
                break;
            };
            let mut raw = [0; 8];
            raw.copy_from_slice(chunk);
            chunk.copy_from_slice(&value(f64::from_le_bytes(raw)).to_le_bytes());
            at += 8;
        }
    }
    let sum = bytes.iter().skip(HEAD).fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    if let Some(place) = bytes.get_mut(4..HEAD) {
        place.copy_from_slice(&sum.to_le_bytes());
    }
}

/// Numbers in [0, 1) from a seed.
pub(crate) fn dice(mut seed: u64) -> impl FnMut() -> f64 {
    move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn garbage(scene: &Block, size: f64) -> Result<Setup, Failure> {
    let mut setup = scene.setup()?;
    let mut bytes = state_after(scene.setup()?, 3)?.to_bytes()?;
    // lambda, F lambda and the coarse multiplier of two steps
    let mut next = dice(1);
    garble(&mut bytes, 6, |_| size * (next() - 0.5));
    setup.start = Some(State::from_bytes(&bytes)?);
    Ok(setup)
}

/// Wrong guesses, garbage, other problems.
pub(crate) fn cases() -> Vec<Case> {
    const GROUP: &str = "Restarts";
    const SAME: &str = "uninterrupted";
    const ROUGH: &str = "with friction, uninterrupted";
    let smooth = block;
    let rough = || Block {
        floor: Some(Friction::coulomb(0.3)),
        ..block()
    };
    let softer = |block: Block| Block {
        young: block.young / 1e3,
        ..block
    };
    let opposite = || Block {
        top: TOP.map(|v| -10.0 * v),
        gap: 0.0,
        ..block()
    };
    let slippery = || Block {
        floor: Some(Friction::coulomb(0.9)),
        ..block()
    };
    let case = |name: &str, hard, build: fn() -> Result<Setup, Failure>| Case::new(GROUP, name, hard, build);
    let from =
        |name: &str, hard, this: Block, other: Block| Case::new(GROUP, name, hard, move || resumed(&this, &other, 3));
    vec![
        Case::brick(GROUP, SAME, "what the others have to reach", smooth()),
        from(
            "from opposite loads",
            "start values of a problem loaded ten times as much the other way",
            smooth(),
            opposite(),
        )
        .same_as(SAME, 1e-5),
        from(
            "from another material",
            "the stored F lambda belongs to another F",
            smooth(),
            softer(smooth()),
        )
        .same_as(SAME, 1e-5),
        case(
            "from garbage",
            "random start values of the size of the forces, random F lambda",
            || garbage(&block(), 1e9),
        )
        .same_as(SAME, 1e-5),
        case("from huge garbage", "random start values 1e12 times too large", || {
            garbage(&block(), 1e20)
        })
        .same_as(SAME, 1e-5),
        from(
            "with friction, from another problem",
            "another material and coefficient, and its slip so far",
            rough(),
            softer(slippery()),
        ),
        Case::new(
            GROUP,
            "with friction, from garbage",
            "random start values, true slip so far",
            move || garbage(&rough(), 1e9),
        )
        .same_as(ROUGH, 1e-5),
        Case::brick(GROUP, ROUGH, "what the one above has to reach", rough()),
    ]
}
