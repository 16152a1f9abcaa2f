//! Runs a CalculiX or Abaqus deck: `cargo run --release --example deck -- part.inp --out DIR`.
//!
//! Prints what the deck asks for and does not get, the plan, and a line a step; progress and warnings on standard error.
//! With `--out` series for ParaView and a table are written.

use std::path::{Path, PathBuf};

use signorini::deck::Deck;
use signorini::prelude::*;

const USAGE: &str = "usage: deck PART.inp [--out FOLDER]";

fn main() -> Result<(), Error> {
    let (mut part, mut out) = (None, None);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--out" => out = arguments.next().map(PathBuf::from),
            _ if part.is_none() && !argument.starts_with('-') => part = Some(argument),
            other => {
                eprintln!("{other:?} is not understood; {USAGE}");
                std::process::exit(2);
            }
        }
    }
    let Some(part) = part else {
        eprintln!("{USAGE}");
        std::process::exit(2);
    };
    run(Path::new(&part), out.as_deref())
}

fn run(part: &Path, out: Option<&Path>) -> Result<(), Error> {
    let deck = Deck::read(part)?;
    for ignored in deck.ignored() {
        println!("{ignored}");
    }
    let name = part.file_stem().unwrap_or_default().to_string_lossy();
    let writer = |folder| ResultWriter::new(folder, name).with_field(ResultField::Stress);
    let mut writer = out.map(writer);
    let mut simulation = Simulation::new(deck.scene()?, Settings::default())?;
    println!("{}", simulation.plan());
    println!("      time  products    touch    slide  normal force  friction force  largest u  certificate");
    let mut table = |step: &StepResult| -> Result<(), Error> {
        let (sum, u) = (step.summary(), step.displacement());
        let length = |u: &[f64; 3]| u[0].hypot(u[1]).hypot(u[2]);
        let largest = u.iter().map(length).fold(0.0, f64::max);
        println!(
            "{:10.4} {:9} {:8} {:8} {:13.5e} {:15.5e} {largest:10.3e} {:12.0e}",
            step.time(),
            step.report().counters.products,
            sum.active,
            sum.slip,
            sum.normal_force,
            length(&sum.friction_force),
            step.certificate().largest()
        );
        if let Some(writer) = &mut writer {
            writer.write(step)?;
        }
        step.require_converged()?;
        Ok(())
    };
    let mut observer = |step: &StepResult| Flow::from(table(step));
    let report = simulation.run(&mut (Progress::new(std::io::stderr()), &mut observer))?;
    if let Some(error) = report.mesh_error {
        println!("estimated error of the mesh: {:.0} %", 100.0 * error);
    }
    if let Some(writer) = writer {
        println!("written: {}", writer.path().display());
    }
    Ok(())
}
