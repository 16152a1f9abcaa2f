//! The smaller studies, each with a number it must find.

use clap::Parser;
use signorini_studies::brick::LIMITS;
use signorini_studies::record::RunRecord;

use crate::bodies::{self, BodiesOptions, COEFFICIENT};
use crate::calculix::beam::LIMIT;
use crate::calculix::{self, CalculixOptions};
use crate::frictionless::{self, FrictionlessOptions};
use crate::order::{self, OrderOptions};
use crate::parts::{self, PartRun, PartsOptions};
use crate::{assert_close, folder, options, read};

#[test]
fn frictionless_touches_where_the_reference_does_with_fewer_products() {
    let json = folder("frictionless").join("f.json");
    let line = format!("frictionless --n 1,2,3 --quiet --json {}", json.display());
    let options = options::<FrictionlessOptions>(&line);
    let mut out = Vec::new();
    let outcomes = frictionless::execute(&options, &mut out).expect("run");
    let touching: Vec<usize> = outcomes.iter().map(|o| o.record.steps[0].active).collect();
    assert_eq!(touching, [6, 11, 16]);
    for outcome in &outcomes {
        let r = &outcome.record;
        let same = |k: &&frictionless::Known| k.0 == r.n && k.1 == 2.5e8;
        let known = frictionless::KNOWN.iter().find(same).expect("known");
        assert!(4 * r.n_m <= known.2, "n = {}: {}", r.n, r.n_m);
        assert!(r.largest_certificate < 1e-6 && r.steps.len() == 1);
        // no friction: no tangential rows, no tangential forces
        assert_eq!(r.steps[0].tangential_force, [0.0; 2]);
    }
    let back: Vec<RunRecord> = serde_json::from_str(&read(&json)).expect("records");
    assert_eq!(back[2], outcomes[2].record);
    assert!(String::from_utf8(out).expect("text").contains("best existing code"));
}

#[test]
fn frictionless_with_the_higher_load_and_the_papers_method() {
    let line = "frictionless --n 2 --traction 1e9 --method paper --quiet --tolerance 1e-7";
    let options = options::<FrictionlessOptions>(line);
    let outcomes = frictionless::execute(&options, &mut Vec::new()).expect("run");
    assert_eq!(outcomes[0].record.steps[0].active, 55);
    assert_eq!(outcomes[0].record.quadratic_programs, 1);
    let options = crate::options("frictionless --traction inf --n 1");
    assert!(frictionless::execute(&options, &mut Vec::new()).is_err());
    assert!(FrictionlessOptions::try_parse_from(["frictionless", "--n", "0"]).is_err());
}

#[test]
fn a_pad_on_a_rail_sticks_then_slides() {
    let folder = folder("bodies");
    let line = format!("bodies --cells 4 --steps 10 --quiet --out {}", folder.display());
    let options = options::<BodiesOptions>(&line);
    let outcome = bodies::execute(&options, &mut Vec::new()).expect("run");
    let run = &outcome.record;
    assert!(run.largest_certificate < 1e-6);
    // pressed, then sheared while some of it sticks, then sliding as a whole
    assert!(run.steps[2].stick > 0 && run.steps[2].slip > 0);
    let last = run.steps.last().expect("steps");
    assert_eq!((last.stick, last.slip), (0, last.active));
    let ratio = bodies::final_ratio(run);
    assert!((ratio / COEFFICIENT - 1.0).abs() < 0.01, "{ratio}");
    // 155 measured; 164 where the first set is solved as far as one that follows a solved set
    assert!((136..=160).contains(&run.n_m), "{}", run.n_m);
    for file in ["body.pvd", "contact.pvd", "steps.csv"] {
        assert!(folder.join("n1-bodies").join(file).exists());
    }
}

fn parts(line: &str) -> Vec<PartRun> {
    let runs = parts::execute(&options::<PartsOptions>(line), &mut Vec::new()).expect("runs");
    for run in &runs {
        assert!(
            run.steps.iter().all(|s| s.converged() && s.certificate < 1e-6),
            "{}",
            run.part
        );
    }
    runs
}

#[test]
fn real_parts_are_cut_and_solved() {
    let runs = parts("parts");
    let names: Vec<&str> = runs.iter().map(|run| run.part.as_str()).collect();
    let all = [
        "bracket", "dovetail", "flange", "hub", "lug", "plates", "punch", "sphere", "tooth",
    ];
    assert_eq!(names, all);
    let of = |part: &str| &runs[all.iter().position(|name| *name == part).expect("a part")];
    for run in &runs {
        let [least, most] = run.tets;
        // bodies smaller than a part are one
        let even = 2 * least >= most || ["dovetail", "lug"].contains(&run.part.as_str());
        assert!(even, "{}: {least} to {most} tetrahedra", run.part);
    }
    // interior points end where rounding of the balance of its bodies does: 21,515 products before, without an answer
    let dearest = of("flange").steps.iter().map(|s| s.n_m).max().expect("steps");
    assert!(dearest <= 700, "{dearest}");
    // 7 nodes on the radius of the contact's disc: the area is right to 12 per cent
    let ball = of("sphere").hertz.as_ref().expect("a ball");
    assert!(ball.radius.abs() < 0.12, "{}", ball.radius);
    // it carries its load, and smoothing widens the edge of so small a contact by a facet
    assert!(ball.force.abs() < 1e-6 && ball.middle.abs() < 0.15, "{ball}");
    let plot = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("hertz.svg");
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/meshes/sphere-0.4.msh");
    let folder = plot.with_file_name("pictures");
    parts(&format!(
        "parts {mesh} --plot {} --pictures {}",
        plot.display(),
        folder.display()
    ));
    let picture = std::fs::read_to_string(folder.join("sphere-0.4.svg")).expect("a picture");
    assert!(picture.contains("von Mises stress at t = 1") && picture.matches("<path").count() > 5);
    assert!(!picture.contains("NaN"));
    let text = std::fs::read_to_string(plot).expect("a plot");
    assert!(text.contains("pressed nodes") && text.contains("Hertz"));
    // 16 products where the last active set is known
    let runs = parts(&format!("parts {mesh} --subdomains 1,4"));
    assert!(runs.iter().all(|run| run.steps[0].n_m <= 30), "{runs:?}");
}

/// Every run's dearest step takes at most so many products.
fn no_step_is_dearer(line: &str, most: usize) {
    for run in parts(line) {
        let dearest = run.steps.iter().map(|s| s.n_m).max().expect("steps");
        assert!(
            dearest <= most,
            "{} to {} tetrahedra: {dearest}",
            run.tets[0],
            run.tets[1]
        );
    }
}

#[test]
fn a_bracket_that_its_friction_holds_costs_the_same_in_any_fine_partition() {
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/meshes/bracket-6.msh");
    no_step_is_dearer(&format!("parts {mesh} --subdomains 1,2,3,4,8,30,100,500"), 60);
    let none = options::<PartsOptions>("parts nowhere.msh");
    assert!(parts::execute(&none, &mut Vec::new()).is_err());
}

/// No load at all, and both faces touch from the first: what presses is a plate that moves.
#[test]
fn a_pad_that_nothing_but_a_motion_presses_costs_no_more_in_few_parts() {
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/meshes/plates-3.5.msh");
    no_step_is_dearer(&format!("parts {mesh} --subdomains 1,2,3,4,5,8"), 115);
}

#[test]
fn quadratic_elements_are_nearer_with_fewer_unknowns() {
    let options = options::<OrderOptions>("order --mesh 1/10,2/3,2/4/1.3 --rounds 1");
    let mut out = Vec::new();
    let rows = order::execute(&options, &mut out).expect("run");
    let [linear, coarse, graded] = &rows[..] else {
        panic!("{rows:?}")
    };
    assert!(coarse.unknowns < linear.unknowns / 4 && graded.unknowns < linear.unknowns / 2);
    for row in [coarse, graded] {
        assert!(row.errors[0].abs() < linear.errors[0].abs(), "{rows:?}");
        assert!(row.estimate < linear.estimate);
    }
    assert!(
        graded.errors[0].abs() < 2e-3 && (linear.errors[0].abs() - 7.6e-3).abs() < 3e-4,
        "{rows:?}"
    );
    assert!(String::from_utf8(out).expect("text").contains("friction force"));
    for wrong in ["3/4", "2/4x4", "2/4/0.5", "2/4/1.5/1", "2/4.5", "2"] {
        assert!(
            OrderOptions::try_parse_from(["order", "--mesh", wrong]).is_err(),
            "{wrong}"
        );
    }
}

/// Long cells: the points step by their compliance, or sets run in circles and take twice the products.
#[test]
fn graded_quadratic_elements_do_not_run_in_circles() {
    let line = "order --rounds 1 --mesh 2/8/1.8";
    let rows = order::execute(&options::<OrderOptions>(line), &mut Vec::new()).expect("run");
    assert!(rows[0].products < 170, "{}", rows[0].products);
}

/// Meshes graded towards edges and rims: the errors of forces that issue 17 asks for, products that stay moderate where
/// cells are a hundred times as long as wide, and an error of the strains that falls faster than the singular edges
/// allow on equal cells.
#[test]
fn graded_quadratic_elements_reach_per_mille_and_per_cent() {
    let line = "order --rounds 1 --reference 2/6/2.2 --mesh 2/18x4x6/1x1x1.5,2/24x6x6/1x1x1.3,2/2,2/4,2/2/2.2,2/4/2.2";
    let rows = order::execute(&options::<OrderOptions>(line), &mut Vec::new()).expect("run");
    assert!(
        rows[0].errors[1].abs() < 1e-2 && rows[1].errors[0].abs() < 1e-3,
        "{rows:?}"
    );
    assert!(rows[..2].iter().all(|row| row.products < 60), "{rows:?}");
    // 8294 of a ragged cut on the same cells half as wide
    assert!(rows[5].products < 150, "{rows:?}");
    let slope = |rows| order::slope(rows, |row| row.energy).expect("reference");
    let (equal, graded) = (slope(&rows[2..4]), slope(&rows[4..]));
    assert!(equal < 1.1 && graded > equal + 0.3, "{equal} {graded}");
}

/// 3,915 quadratic tetrahedra of the sizes that the estimate on a first mesh asks for; the limit is that of meshes of
/// both orders, docs/reports/real-parts.md.
#[test]
fn a_bracket_of_wanted_sizes_moves_as_it_must() {
    let line = format!(
        "parts --order 2 --threads 1 {}/meshes/wanted/bracket-0.06.msh",
        env!("CARGO_MANIFEST_DIR")
    );
    let mut out = Vec::new();
    let runs = parts::execute(&options::<PartsOptions>(&line), &mut out).expect("run");
    let text = String::from_utf8(out).expect("text");
    let moved: f64 = text
        .lines()
        .last()
        .and_then(|l| l.split('|').rev().nth(1)?.trim().parse().ok())
        .expect("mm");
    assert!((moved / 0.0662 - 1.0).abs() < 0.02, "{text}");
    assert!(runs[0].steps.iter().all(|step| step.converged()), "{text}");
}

/// Against the same brick by the builder: other loads (pressures), another floor.
#[test]
fn decks_beside_calculix_are_the_static_brick() {
    let line = format!(
        "calculix --linear 4 --quadratic 2 --beam 1 --ccx no-such-program --out {}",
        folder("calculix").display()
    );
    let mut out = Vec::new();
    let (rows, beams) = calculix::execute(&options::<CalculixOptions>(&line), &mut out).expect("run");
    assert!(beams.iter().all(|beam| beam.calculix.is_none()));
    assert!(
        String::from_utf8(out)
            .expect("text")
            .contains("no-such-program is not found")
    );
    let exact = rows.iter().filter(|row| row.law.slopes == [None; 2]);
    let found: Vec<[f64; 3]> = exact.map(|row| row.force.expect("converged")).collect();
    let line = "order --mesh 1/4,2/2 --rounds 1";
    let known = order::execute(&options::<OrderOptions>(line), &mut Vec::new()).expect("run");
    assert_eq!((found.len(), known.len()), (2, 2));
    for (found, known) in found.iter().zip(&known) {
        let [normal, friction] = [0, 1].map(|k| LIMITS[k] * (1.0 + known.errors[k]));
        assert_close(found[2], normal, 1e-6);
        assert_close(found[0], friction, 1e-5);
    }
}

/// The only other code that is run here; nothing is tested where it is not installed.
#[test]
fn calculix_finds_the_same_forces_for_the_same_law() {
    let line = format!(
        "calculix --linear 4 --quadratic 2 --beam 2 --out {}",
        folder("ccx").display()
    );
    let (rows, beams) = calculix::execute(&options::<CalculixOptions>(&line), &mut Vec::new()).expect("run");
    for beam in &beams {
        assert_close(beam.own, LIMIT, 0.01);
        // elements of second order are worth the same in both
        if let (Some(other), "C3D20" | "C3D15") = (beam.calculix, beam.kind) {
            assert_close(beam.own, other, 0.003);
        }
    }
    let find = |own: bool, name: &str| rows.iter().find(|r| r.own == own && r.law.name == name && r.order == 1);
    for (own, other) in [
        ("exact", "mortar"),
        ("node to surface, recommended", "node to surface, recommended"),
    ] {
        let Some(other) = find(false, other) else { return };
        let [own, other] = [find(true, own).and_then(|r| r.force), other.force].map(|force| force.expect("converged"));
        assert_close(own[2], other[2], 1e-3);
        assert_close(own[0], other[0], 0.03);
    }
}
