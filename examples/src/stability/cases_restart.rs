//! Restarts from states that are of no use.

use super::block::Block;
use super::case::{Case, Failure, Setup};
use signorini::prelude::*;

fn block() -> Block {
    Block {
        friction: Friction::None,
        cells: [3; 3],
        ..Block::default()
    }
}

/// State after `levels` levels.
fn state_after(setup: Setup, levels: usize) -> Result<State, Failure> {
    let mut simulation = Simulation::new(setup.scene, setup.settings)?;
    for _ in 0..levels {
        simulation.step()?;
    }
    Ok(simulation.state().clone())
}

fn resumed(scene: &Block, other: &Block, levels: usize) -> Result<Setup, Failure> {
    let mut setup = scene.setup()?;
    setup.start = Some(state_after(other.setup()?, levels)?);
    Ok(setup)
}

/// Format number and checksum before the state.
const HEAD: usize = 12;

/// Reads and writes the numbers of a stored state: postcard keeps lengths as varints and numbers as eight bytes. The checksum
/// (FNV-1a) is made to fit what was written.
pub fn garble(bytes: &mut [u8], vectors: usize, mut value: impl FnMut(f64) -> f64) {
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
    let _level = varint(bytes, &mut at);
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
    let sum = bytes
        .iter()
        .skip(HEAD)
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
    if let Some(place) = bytes.get_mut(4..HEAD) {
        place.copy_from_slice(&sum.to_le_bytes());
    }
}

fn garbage(scene: &Block, size: f64) -> Result<Setup, Failure> {
    let mut setup = scene.setup()?;
    let mut bytes = state_after(scene.setup()?, 3)?.to_bytes()?;
    let mut seed = 1_u64;
    // lambda, F lambda and the coarse multiplier of two levels
    garble(&mut bytes, 6, |_| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        size * ((seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
    });
    setup.start = Some(State::from_bytes(&bytes)?);
    Ok(setup)
}

/// Wrong guesses, garbage, other problems.
#[must_use]
pub fn cases() -> Vec<Case> {
    const GROUP: &str = "Restarts";
    const SAME: &str = "uninterrupted";
    let opposite = Block {
        top: block().top.map(|v| -10.0 * v),
        gap: 0.0,
        ..block()
    };
    let softer = Block {
        young: block().young / 1e3,
        ..block()
    };
    let friction = Block {
        friction: Friction::coulomb(0.3),
        ..block()
    };
    let other_friction = Block {
        young: block().young / 1e3,
        friction: Friction::coulomb(0.9),
        ..block()
    };
    let rough = friction.clone();
    vec![
        Case::new(GROUP, SAME, "what the others have to reach", || {
            block().setup()
        }),
        Case::new(
            GROUP,
            "from opposite loads",
            "start values of a problem loaded ten times as much the other way",
            move || resumed(&block(), &opposite, 3),
        )
        .same_as(SAME, 1e-5),
        Case::new(
            GROUP,
            "from another material",
            "the stored F lambda belongs to another F",
            move || resumed(&block(), &softer, 3),
        )
        .same_as(SAME, 1e-5),
        Case::new(
            GROUP,
            "from garbage",
            "random start values of the size of the forces, random F lambda",
            || garbage(&block(), 1e9),
        )
        .same_as(SAME, 1e-5),
        Case::new(
            GROUP,
            "from huge garbage",
            "random start values 1e12 times too large",
            || garbage(&block(), 1e20),
        )
        .same_as(SAME, 1e-5),
        Case::new(
            GROUP,
            "with friction, from another problem",
            "another material and coefficient, and its slip so far",
            move || resumed(&friction, &other_friction, 3),
        ),
        Case::new(
            GROUP,
            "with friction, from garbage",
            "random start values, true slip so far",
            move || garbage(&rough, 1e9),
        )
        .same_as("with friction, uninterrupted", 1e-5),
        Case::new(
            GROUP,
            "with friction, uninterrupted",
            "what the one above has to reach",
            || {
                Block {
                    friction: Friction::coulomb(0.3),
                    ..block()
                }
                .setup()
            },
        ),
    ]
}
