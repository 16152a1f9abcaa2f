//! The smaller examples, each with a number it must find.

use clap::Parser;
use signorini_examples::options::{BodiesOptions, FrictionlessOptions, TrescaOptions};
use signorini_examples::record::RunRecord;
use signorini_examples::{bodies, frictionless, qp_only, tresca};
use signorini_qp::Expansion;

#[test]
fn frictionless_touches_where_the_reference_does_with_fewer_products() {
    let folder = tempfile::tempdir().expect("folder");
    let json = folder.path().join("f.json");
    let line = format!("frictionless --n 1,2,3 --quiet --json {}", json.display());
    let options = FrictionlessOptions::try_parse_from(line.split_whitespace()).expect("options");
    let mut out = Vec::new();
    let outcomes = frictionless::execute(&options, &mut out).expect("run");
    let touching: Vec<usize> = outcomes.iter().map(|o| o.record.steps[0].active).collect();
    assert_eq!(touching, [6, 11, 16]);
    for outcome in &outcomes {
        let r = &outcome.record;
        let same = |k: &&frictionless::Known| k.n == r.n && k.traction == 2.5e8;
        let known = frictionless::KNOWN.iter().find(same).expect("known");
        assert!(4 * r.n_m <= known.products, "n = {}: {}", r.n, r.n_m);
        assert!(r.largest_certificate < 1e-6 && r.steps.len() == 1);
        // no friction: no tangential rows, no tangential forces
        assert_eq!(r.steps[0].tangential_force, [0.0; 2]);
    }
    let text = std::fs::read_to_string(&json).expect("file");
    let back: Vec<RunRecord> = serde_json::from_str(&text).expect("records");
    assert_eq!(back[2], outcomes[2].record);
    assert!(
        String::from_utf8(out)
            .expect("text")
            .contains("best existing code")
    );
}

#[test]
fn frictionless_with_the_higher_load_and_the_papers_method() {
    let line = "frictionless --n 2 --traction 1e9 --method paper --quiet --tolerance 1e-7";
    let options = FrictionlessOptions::try_parse_from(line.split_whitespace()).expect("options");
    let outcomes = frictionless::execute(&options, &mut Vec::new()).expect("run");
    assert_eq!(outcomes[0].record.steps[0].active, 55);
    assert_eq!(outcomes[0].record.quadratic_programs, 1);
    let bad = ["frictionless", "--traction", "inf", "--n", "1"];
    let options = FrictionlessOptions::try_parse_from(bad).expect("options");
    assert!(frictionless::execute(&options, &mut Vec::new()).is_err());
    assert!(FrictionlessOptions::try_parse_from(["frictionless", "--n", "0"]).is_err());
}

#[test]
fn given_friction_needs_one_quadratic_program_a_level() {
    let options = TrescaOptions::try_parse_from(["tresca", "--steps", "4"]).expect("options");
    let mut out = Vec::new();
    let outcomes = tresca::execute(&options, &mut out).expect("run");
    let [paper, face] = outcomes.as_slice() else {
        panic!("two methods")
    };
    assert!(paper.record.steps.iter().all(|s| s.quadratic_programs == 1));
    assert!(tresca::difference(&paper.record, &face.record) < 1e-7);
    for r in [&paper.record, &face.record] {
        assert!(r.largest_certificate < 1e-7 && r.unconverged.is_empty());
        // everything slides at the end, so the friction is at most bound times area
        let last = r.steps.last().expect("steps");
        assert_eq!(last.stick, 0);
        assert!(last.tangential_force[0] < 0.0 && last.tangential_force[0] > -3e7 * 3.0);
        assert!(r.steps.iter().all(|s| s.dissipation > 0.0));
    }
    let negative = TrescaOptions::try_parse_from(["tresca", "--bound=-1"]).expect("options");
    let error = tresca::execute(&negative, &mut Vec::new()).expect_err("bound");
    assert!(error.to_string().contains("slip bound"));
}

#[test]
fn quadratic_programs_without_mechanics() {
    let limits = [(Expansion::FixedStep, 200), (Expansion::ProjectedCg, 175)];
    for (expansion, limit) in limits {
        let r = qp_only::string(expansion).expect("string");
        assert!(r.products <= limit, "{r:?}");
        assert_eq!(r.resting, 14);
        approx::assert_relative_eq!(r.cost, -0.291_767_320_525_8, max_relative = 1e-8);
        assert!(r.kkt < 1e-4);
    }
    let d = qp_only::disc().expect("disc");
    for (x, exact) in d.x.iter().zip([0.6, 0.8, 0.2]) {
        approx::assert_abs_diff_eq!(*x, exact, epsilon = 1e-8);
    }
    approx::assert_abs_diff_eq!(d.multiplier, -0.2, epsilon = 1e-8);
    assert!(d.kkt < 1e-9);
    qp_only::execute(&mut Vec::new()).expect("print");
}

#[test]
fn a_pad_on_a_rail_sticks_then_slides() {
    let folder = tempfile::tempdir().expect("folder");
    let line = format!(
        "bodies --cells 4 --steps 10 --quiet --out {}",
        folder.path().display()
    );
    let options = BodiesOptions::try_parse_from(line.split_whitespace()).expect("options");
    let outcome = bodies::execute(&options, &mut Vec::new()).expect("run");
    let run = &outcome.record;
    assert!(run.largest_certificate < 1e-6);
    // pressed, then sheared while some of it sticks, then sliding as a whole
    assert!(run.steps[2].stick > 0 && run.steps[2].slip > 0);
    let last = run.steps.last().expect("levels");
    assert_eq!((last.stick, last.slip), (0, last.active));
    let ratio = bodies::final_ratio(run);
    assert!((ratio / bodies::COEFFICIENT - 1.0).abs() < 0.01, "{ratio}");
    // 176 when it was made; an eighth more or less
    assert!((154..=198).contains(&run.n_m), "{}", run.n_m);
    for file in ["body.pvd", "contact.pvd", "steps.csv"] {
        assert!(folder.path().join("n1-bodies").join(file).exists());
    }
}
