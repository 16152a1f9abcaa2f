//! The pictures of the tutorials, drawn anew; `--help` lists the options.

#[allow(dead_code, missing_docs)]
#[path = "../../examples/own_mesh.rs"]
pub mod own_mesh;
#[allow(dead_code, missing_docs)]
#[path = "../../examples/two_bodies.rs"]
pub mod two_bodies;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use signorini::prelude::*;
use signorini_studies::draw::{Shown, result};
use signorini_studies::{Failure, exit, save};

const ROLLER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/roller.msh");

/// Options of `pictures`.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(name = "pictures", about = "The pictures of the tutorials")]
pub struct PicturesOptions {
    /// The folder that they are written into.
    #[arg(long, value_name = "FOLDER", default_value = "docs/img")]
    pub out: PathBuf,
}

#[allow(dead_code)]
fn main() -> ExitCode {
    exit(execute(&PicturesOptions::parse(), &mut std::io::stdout()))
}

/// Runs the programs of the tutorials to their ends and draws those.
pub fn execute(options: &PicturesOptions, out: &mut impl Write) -> Result<(), Failure> {
    for (name, scene, eye) in [
        ("two-bodies", two_bodies::scene(4, 10, 10.0)?, [0.9, -1.6, 0.8]),
        ("roller", own_mesh::scene(ROLLER)?, [0.7, -1.6, 0.5]),
    ] {
        let mut simulation = Simulation::new(scene, Settings::default())?;
        simulation.run(&mut Silent)?.require_converged()?;
        let last = simulation.result().ok_or("a scene without steps")?;
        let path = options.out.join(name).with_extension("svg");
        save(&path, &result(last, Shown::VonMises, eye))?;
        writeln!(out, "{}", path.display())?;
    }
    Ok(())
}
