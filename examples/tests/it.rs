//! What plain programs must find. `.ci/run` runs all of them.
#![allow(dead_code, missing_docs, unreachable_pub)]

#[path = "../bolt.rs"]
mod bolt;
#[path = "../coupled.rs"]
mod coupled;
#[path = "../crack.rs"]
mod crack;
#[path = "../deck.rs"]
mod deck;
#[path = "../from_mesh.rs"]
mod from_mesh;
#[path = "../own_mesh.rs"]
mod own_mesh;
#[path = "../parameters.rs"]
mod parameters;
#[path = "../qp_only.rs"]
mod qp_only;
#[path = "../tresca.rs"]
mod tresca;

mod docs;
#[cfg(unix)]
mod signal;

use signorini::prelude::*;
use signorini_qp::kprgp::Expansion;

/// The program in the README is the example `first`, to the letter.
#[test]
fn the_readme_shows_the_first_program() {
    let readme = include_str!("../../README.md");
    let example = include_str!("../first.rs");
    let program = example
        .split_once("\n\n")
        .map_or(example, |(_, program)| program)
        .trim();
    assert!(readme.contains(program), "copy examples/first.rs into the README");
    assert!(program.lines().count() <= 40);
}

/// Slip is that without friction under what friction leaves of the shear: 0.7 of it at first, then 0.5, -0.7, -0.7,
/// 0.7. In a plate without an end it is `4 (1 - nu^2) / E` times that stress times `sqrt(1 - x^2)`; edges that are held
/// a crack's length away take a fifth of it.
#[test]
fn the_crack_slides_as_the_formula_says() {
    let slips = crack::slips(4).expect("crack");
    for (slip, expected) in slips.iter().zip([0.0, 1.0, 5.0 / 7.0, -1.0, -1.0, 1.0]) {
        assert!((slip / slips[1] - expected).abs() < 1e-5, "{slips:?}");
    }
    let scene = crack::scene(4).expect("scene");
    let nodes = scene.mesh().nodes_on(scene.contacts()[0].tags()[0]);
    let across = |n: &u32| (1.0 - scene.mesh().points()[*n as usize][0].powi(2)).max(0.0).sqrt();
    let mean = nodes.iter().map(across).sum::<f64>() / nodes.len() as f64;
    let stress = (1.0 - crack::FRICTION) * 1e-3 * 1e9 / (2.0 * 1.25);
    let endless = 4.0 * (1.0 - 0.25 * 0.25) / 1e9 * stress * mean;
    assert!((slips[1] / endless - 0.8).abs() < 0.04, "{} {endless}", slips[1]);
}

/// What tightens goes through plates and bolt; then these hardly give the bolt any of the pull until they part.
#[test]
fn the_bolt_takes_the_pull_once_the_plates_part() {
    let rows = bolt::rows().expect("bolt");
    assert_eq!(rows.len(), 12);
    let near = |a: f64, b: f64| (a - b).abs() < 1e-3;
    for [time, pull, bolt, plates, shortened] in &rows {
        let tightened = 10.0 * time.min(1.0);
        let what = format!("{time}: {pull} {bolt} {plates} {shortened}");
        assert!(near(bolt - plates, *pull), "{what}");
        if *pull <= 7.5 {
            assert!((-1e-3..0.02 * pull + 1e-3).contains(&(bolt - tightened)), "{what}");
        } else if *pull > 12.0 {
            assert!(near(*bolt, *pull) && near(*plates, 0.0), "{what}");
        }
        assert!(*time < 1.0 || near(*shortened, rows[5][4]), "{what}");
    }
}

/// What friction warms presses the harder.
#[test]
fn the_force_of_the_brake_grows_as_heat_tells() {
    let forces = coupled::run(10).expect("coupled");
    let growth = (forces[9] / forces[0]).ln() / 27.0;
    let rate = coupled::rate(forces[0]);
    assert!((growth / rate - 1.0).abs() < 0.05, "{growth} {rate}");
}

#[test]
fn a_mesh_of_ones_own_becomes_a_series() {
    let folder = concat!(env!("CARGO_TARGET_TMPDIR"), "/own_mesh");
    own_mesh::run(folder).expect("own_mesh");
    let series = std::fs::read_to_string(format!("{folder}/roller.pvd")).expect("a series");
    // at rest, and ten steps
    assert_eq!(series.matches("<DataSet").count(), 11);
}

/// The newcomer's path: twenty lines from a mesh, none from a deck, to what ParaView opens.
#[test]
fn from_a_mesh_or_a_deck_to_paraview() {
    let program = include_str!("../from_mesh.rs").split_once("pub fn run").expect("run").1;
    assert!(program.lines().count() <= 20);
    let folder = concat!(env!("CARGO_TARGET_TMPDIR"), "/newcomer");
    from_mesh::run(concat!(env!("CARGO_MANIFEST_DIR"), "/roller.msh"), folder).expect("from_mesh");
    let pad = concat!(env!("CARGO_MANIFEST_DIR"), "/decks/pad.inp");
    let words = [pad, "--out", folder].map(String::from);
    deck::command(words.into_iter()).expect("deck");
    for (series, steps) in [
        ("roller.pvd", 5),
        ("roller_contact.pvd", 5),
        ("pad.pvd", 5),
        ("pad_contact.pvd", 5),
    ] {
        let text = std::fs::read_to_string(format!("{folder}/{series}")).expect("a series");
        assert_eq!(text.matches("<DataSet").count(), steps + 1, "{series}");
    }
}

#[test]
fn a_slip_bound_that_is_data_takes_one_quadratic_program_a_step() {
    let mut pulls = Vec::new();
    for method in [Method::paper(), Method::default()] {
        let programs = usize::from(method.kind().to_string() == "paper");
        let settings = Settings::default().with_method(method).with_tolerance(1e-8);
        let mut simulation = Simulation::new(tresca::scene(3e7).expect("scene"), settings).expect("set-up");
        while !simulation.is_finished() {
            let result = simulation.step().expect("step");
            result.require_converged().expect("convergence");
            assert!(programs == 0 || result.report().counters.quadratic_programs == programs);
            assert!(result.certificate().largest() < 1e-7 && result.summary().friction_work > 0.0);
        }
        let last = *simulation.result().expect("a result").summary();
        // everything slides at the end, so the friction is at most bound times area
        assert_eq!(last.stick, 0);
        assert!(last.friction_force[0] < 0.0 && last.friction_force[0] > -3e7 * 3.0);
        pulls.push(last.friction_force[0]);
    }
    assert!((pulls[0] - pulls[1]).abs() < 1e-7 * pulls[0].abs());
    let negative = tresca::scene(-1.0).expect("scene");
    let Err(error) = Simulation::new(negative, Settings::default()) else {
        panic!("a slip bound cannot be negative");
    };
    assert!(error.to_string().contains("slip bound"));
}

/// The pull is a quarter of the pressing force.
#[test]
fn a_quarter_holds_the_block() {
    use parameters::Outcome;
    let block = parameters::block().expect("block");
    for coefficient in [0.1, 0.24, 0.26, 1.0] {
        match parameters::solve(&block, coefficient).expect("solved") {
            Outcome::Slides(needed) => assert!(coefficient < 0.25 && (needed - 0.25).abs() < 1e-4, "{needed}"),
            Outcome::Held(result) => {
                let sum = result.summary();
                let pull = sum.friction_force[0] / sum.normal_force;
                assert!(coefficient > 0.25 && (pull + 0.25).abs() < 1e-6, "{pull}");
            }
        }
    }
}

#[test]
fn quadratic_programs_without_mechanics() {
    for (expansion, limit) in [(Expansion::FixedStep, 200), (Expansion::ProjectedCg, 175)] {
        let (report, resting, kkt) = qp_only::string(expansion).expect("string");
        assert!(report.products.total() <= limit, "{report:?}");
        // with the two fixed ends 14
        assert_eq!(resting, 12);
        assert!((report.cost + 0.291_767_320_525_8).abs() < 3e-9);
        assert!(kkt < 1e-4);
    }
    let (x, multiplier, kkt) = qp_only::disc().expect("disc");
    for (x, exact) in x.iter().zip([0.6, 0.8, 0.2]) {
        assert!((x - exact).abs() < 1e-8);
    }
    assert!((multiplier + 0.2).abs() < 1e-8 && kkt < 1e-9);
}
