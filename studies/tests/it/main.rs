//! The studies, called as their programs call them. The program of each is a module here, of which a test uses a part.
#![allow(dead_code, unreachable_pub)]

#[path = "../../examples/accuracy/main.rs"]
mod accuracy;
#[path = "../../examples/bodies.rs"]
mod bodies;
#[path = "../../examples/brick/main.rs"]
mod brick;
#[path = "../../examples/calculix/main.rs"]
mod calculix;
#[path = "../../examples/cases/main.rs"]
mod cases;
#[path = "../../examples/effects/main.rs"]
mod effects;
#[path = "../../examples/frictionless.rs"]
mod frictionless;
#[path = "../../examples/order.rs"]
mod order;
#[path = "../../examples/parts.rs"]
mod parts;
#[path = "../../examples/performance/main.rs"]
mod performance;
#[path = "../../examples/stability/main.rs"]
mod stability;

mod accuracy_study;
mod brick_files;
mod brick_study;
mod cases_study;
mod cuts_study;
mod effects_study;
mod small_studies;
mod stability_study;

use std::path::{Path, PathBuf};

use clap::Parser;

/// An empty folder of this name.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    // nothing there is as good
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).expect("a folder");
    path
}

fn read(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Options from a command line.
fn options<T: Parser>(line: &str) -> T {
    T::try_parse_from(line.split_whitespace()).expect("options")
}

fn assert_close(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * a.abs().max(b.abs()), "{a} {b}");
}
