//! The program `signorini`, which solves a CalculiX or Abaqus deck: `signorini part.inp --out DIR`.
//!
//! Prints what the deck asks for and does not get, the plan, a line a step, and the reactions at the end; progress and
//! warnings on standard error. Normal and friction forces of the lines are sums of their lengths at all points.
//! With `--out` series for ParaView and a table are written. With `--states` the run is stored in that folder every
//! five minutes, and the same command goes on from there. Ctrl-C ends it after the step, a second one at once.
//!
//! It ends with 0 where all steps converged, with 1 and a message where not, or where the deck is wrong; with 2 where
//! the command is, and with 130 after Ctrl-C.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::Parser;
use signorini::contact::Part;
use signorini::deck::Deck;
use signorini::prelude::*;

/// How a program ends that Ctrl-C has stopped.
const STOPPED: i32 = 130;

/// Time between two states that are stored.
const BETWEEN_STATES: Duration = Duration::from_secs(300);

/// Solves a CalculiX or Abaqus deck: contact with Coulomb friction.
#[derive(Debug, Parser)]
#[command(name = "signorini")]
struct Arguments {
    /// The deck.
    model: PathBuf,
    /// Folder for series that ParaView opens and a table.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Folder for states, from which the same command goes on.
    #[arg(long, value_name = "FOLDER")]
    states: Option<PathBuf>,
    /// Threads; by default as many as there are cores.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Relative accuracy of a step.
    #[arg(long, value_name = "T")]
    tolerance: Option<f64>,
    /// Subdomains; by default as many as is cheapest.
    #[arg(long, value_name = "N")]
    subdomains: Option<usize>,
    /// Prints what the deck asks for and does not get, the plan and warnings, and solves nothing.
    #[arg(long)]
    plan: bool,
}

/// The program with its arguments, without its name. It ends the process where these are wrong, or after Ctrl-C.
///
/// # Errors
/// What is wrong with the deck or a file, or the first step that did not converge.
pub fn command(arguments: impl Iterator<Item = String>) -> Result<(), Error> {
    let arguments = Arguments::parse_from(std::iter::once("signorini".into()).chain(arguments));
    if let Some(threads) = arguments.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build_global().map_err(std::io::Error::other)?;
    }
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let handler = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(STOPPED);
        }
    });
    if let Err(error) = handler {
        eprintln!("Ctrl-C will end the program at once: {error}");
    }
    if run(&arguments, stop)? {
        std::process::exit(STOPPED);
    }
    Ok(())
}

/// Whether it was stopped.
fn run(arguments: &Arguments, stop: Arc<AtomicBool>) -> Result<bool, Error> {
    let deck = Deck::read(&arguments.model)?;
    print_ignored(&deck);
    let mut settings = Settings::default().with_step_halving(deck.step_halving());
    if let Some(tolerance) = arguments.tolerance {
        settings = settings.with_tolerance(tolerance);
    }
    let mut scene = deck.scene()?;
    if let Some(subdomains) = arguments.subdomains {
        scene = scene.with_subdomains(subdomains);
    }
    if arguments.plan {
        println!("{}", Plan::new(&scene, &settings)?);
        return Ok(false);
    }
    let name = arguments.model.file_stem().unwrap_or_default().to_string_lossy();
    let writer = |folder| ResultWriter::new(folder, name).with_field(ResultField::Stress);
    let mut writer = arguments.out.as_ref().map(writer);
    let states = arguments.states.as_deref();
    let mut simulation = Simulation::new(scene, settings)?;
    println!("{}", simulation.plan());
    println!("      time  products    touch    slide  normal force  friction force  largest u  certificate");
    let mut table = |step: &StepResult| -> Result<(), Error> {
        let (sum, u) = (step.summary(), step.displacement());
        let length = |u: &[f64; 3]| u[0].hypot(u[1]).hypot(u[2]);
        let largest = u.iter().map(length).fold(0.0, f64::max);
        // lengths at the points: those of two pairs, or around an axis, would cancel
        let friction: f64 = step.points().iter().map(|point| length(&point.friction_force)).sum();
        println!(
            "{:10.4} {:9} {:8} {:8} {:13.5e} {:15.5e} {largest:10.3e} {:12.0e}",
            step.time(),
            step.report().counters.products,
            sum.active,
            sum.slip,
            sum.normal_force,
            friction,
            step.certificate().largest()
        );
        if let Some(writer) = &mut writer {
            writer.write(step)?;
        }
        step.require_converged()?;
        Ok(())
    };
    let write = |step: &StepResult| Flow::from(table(step));
    let mut observer = ((Progress::new(std::io::stderr()), write), stop);
    let report = match states {
        Some(folder) => simulation.run_or_resume(folder, BETWEEN_STATES, &mut observer)?,
        None => simulation.run(&mut observer)?,
    };
    if report.stopped {
        println!("stopped at {} s", simulation.result().map_or(0.0, |step| step.time()));
        if let Some(folder) = states {
            println!("the same command goes on from {}", folder.display());
        }
    }
    if let Some(step) = simulation.result() {
        print_reactions(&deck, step);
    }
    if let Some(error) = report.mesh_error {
        println!("estimated error of the mesh: {:.0} %", 100.0 * error);
    }
    if let Some(writer) = writer {
        println!("written: {}", writer.path().display());
    }
    Ok(report.stopped)
}

/// The forces that hold the body at the end, by the sets of the deck, with the numbers of their supports in the table,
/// and those of its contacts.
fn print_reactions(deck: &Deck, step: &StepResult) {
    let reactions = step.reactions();
    let names = deck.support_names();
    for (first, name) in names.iter().enumerate() {
        if names[..first].contains(name) {
            continue;
        }
        let own = names.iter().enumerate().filter(|(_, other)| *other == name);
        let (mut numbers, mut sum) = (Vec::new(), [0.0; 3]);
        for (k, _) in own {
            numbers.push(k.to_string());
            let force = reactions.supports[k].resultant.force;
            (0..3).for_each(|c| sum[c] += force[c]);
        }
        let [x, y, z] = sum;
        println!(
            "reaction at {name} (support {}): {x:.5e} {y:.5e} {z:.5e}",
            numbers.join(", ")
        );
    }
    for (k, contact) in reactions.contacts.iter().enumerate() {
        let [x, y, z] = contact.force;
        // sections of bolts are among the couplings
        let Some(name) = step.scene().name(Part::Contact(k)) else {
            continue;
        };
        println!("force of contact {k} ({name}): {x:.5e} {y:.5e} {z:.5e}");
    }
    for (k, (name, motion)) in deck.coupling_names().iter().zip(step.couplings()).enumerate() {
        let coupling = &step.scene().couplings()[k];
        let reactions = step.reactions_about(coupling.reference());
        let (what, held) = match coupling.tied() {
            Some(contact) => ("transfers", reactions.contacts[contact]),
            None => ("held by", reactions.couplings[k]),
        };
        let six = |[a, b]: [[f64; 3]; 2]| {
            [a, b]
                .concat()
                .iter()
                .map(|v| format!("{v:.5e}"))
                .collect::<Vec<_>>()
                .join(" ")
        };
        println!(
            "coupling {k} ({name}): moved and turned by {}, {what} {}",
            six([motion.displacement, motion.rotation]),
            six([held.force, held.moment])
        );
    }
}

/// What the deck asks for and does not get, each where it stands first.
fn print_ignored(deck: &Deck) {
    let mut told = BTreeSet::new();
    for ignored in deck.ignored() {
        if told.insert((ignored.word.to_uppercase(), &ignored.why)) {
            println!("{ignored}");
        }
    }
    let again = deck.ignored().len() - told.len();
    if again > 0 {
        println!("and {again} more of these");
    }
}
