//! Any bytes as a deck; what can be read becomes a scene, and one of a few elements is judged by a plan.
#![no_main]

use libfuzzer_sys::fuzz_target;
use signorini::deck::Deck;
use signorini::prelude::*;
use std::sync::LazyLock;

/// Of this process alone, in memory where that is possible.
static PATH: LazyLock<std::path::PathBuf> = LazyLock::new(|| {
    let memory = std::path::PathBuf::from("/dev/shm");
    let folder = if memory.is_dir() { memory } else { std::env::temp_dir() };
    folder.join(format!("fuzz-{}.inp", std::process::id()))
});

fuzz_target!(|bytes: &[u8]| {
    std::fs::write(&*PATH, bytes).expect("written");
    let Ok(deck) = Deck::read(&*PATH) else { return };
    let Ok(scene) = deck.scene() else { return };
    if deck.mesh().tets().len() <= 200 {
        let _ = Plan::new(&scene, &Settings::default());
    }
});
