//! The benchmark: its sizes, its results, and what it says to bad options.

use clap::Parser;
use signorini::prelude::{Settings, Simulation};
use signorini_studies::brick::{Block, Loading, sizes};
use signorini_studies::paper;
use signorini_studies::record::RunRecord;
use signorini_studies::run::{Outcome, strict, warnings};

use crate::brick::{BrickOptions, execute};
use crate::{assert_close, folder, options, read};

/// Runs a command line, with pictures in a folder of its own.
pub(crate) fn run(line: &str) -> (Vec<Outcome>, String) {
    let mut options: BrickOptions = options(line);
    if options.out.is_none() {
        options.out = Some(std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("brick"));
        options.vtu_every = 0;
    }
    let mut out = Vec::new();
    let outcomes = execute(&options, &mut out).expect("run");
    (outcomes, String::from_utf8(out).expect("text"))
}

#[test]
fn table_6_1_has_exactly_the_papers_sizes() {
    for row in &paper::TABLE {
        let scene = Block {
            steps: 1,
            ..Block::benchmark(row.n, Loading::B)
        }
        .scene()
        .expect("scene");
        let s = sizes(&scene, &Settings::default()).expect("sizes");
        assert_eq!((s.n_s, s.n_p, s.n_d_paper), (row.n_s, row.n_p, row.n_d));
        // contact rows of the 5n + 1 nodes on the fixed edge depend on the rows of the support
        assert_eq!(s.n_d_paper - s.n_d, 3 * (5 * row.n + 1));
        if row.n <= 3 {
            let simulation = Simulation::new(scene, Settings::default()).expect("set-up");
            let gluing = simulation.tfeti().gluing();
            assert_eq!(gluing.rows_as_paper(), row.n_d);
            assert_eq!(gluing.ranges().total(), s.n_d);
        }
    }
}

/// Quadratic elements with about as many unknowns take up to a quarter more products: 20 % at n = 1, 9 % at n = 2.
#[test]
fn elements_of_order_two_need_little_more_products() {
    let products = |line: &str| {
        let (outcomes, text) = run(line);
        assert!(text.contains("not the benchmark as it stands"), "{text}");
        let record = &outcomes[0].record;
        assert!(
            record.unconverged.is_empty() && record.largest_certificate < 1e-6,
            "{record:?}"
        );
        (record.n_p as f64, record.n_m as f64)
    };
    for (n, most) in [(1, 1.21), (2, 1.1)] {
        let (linear, one) = products(&format!("brick --n {n} --loading b --cells 4 --quiet"));
        let (quadratic, two) = products(&format!("brick --n {n} --loading b --cells 2 --order 2 --quiet"));
        assert!((quadratic / linear - 1.0).abs() < 0.1, "{linear} {quadratic}");
        assert!(two <= most * one, "n = {n}: {two} products, {one} with order 1");
    }
    let bad = BrickOptions::try_parse_from(["brick", "--order", "3"]).expect_err("order");
    assert!(bad.to_string().contains("order 1 or 2"));
}

/// Steps that follow the mesh, so that the contact front passes as many nodes in each: 12.4, 12.5 and 12.2 products a
/// step, and 12.6 still at n = 8.
#[test]
fn products_a_step_do_not_grow_with_the_mesh_if_steps_follow_it() {
    for n in [1, 2, 3] {
        let steps = 25 * n;
        let line = format!("brick --n {n} --loading b --cells 2 --order 2 --steps {steps} --quiet");
        let record = &run(&line).0[0].record;
        assert!(
            record.unconverged.is_empty() && record.largest_certificate < 1e-6,
            "{record:?}"
        );
        let products = record.n_m as f64 / steps as f64;
        assert!(products < 12.6, "n = {n}: {products} products a step");
    }
}

#[test]
fn five_steps_of_both_loadings_by_all_methods_agree() {
    let (face, text) = run("brick --n 1 --steps 5 --quiet --threads 1 --tolerance 1e-8");
    assert_eq!(face.len(), 2);
    assert!(text.contains("Table 6.1") && text.contains("final state depends on the loading"));
    assert!(text.contains("not the benchmark as it stands"));
    for outcome in &face {
        let r = &outcome.record;
        assert!(r.unconverged.is_empty() && r.largest_certificate < 1e-7, "{r:?}");
        assert_eq!(r.steps.len(), 5);
        assert_eq!(r.n_m, r.steps.iter().map(|s| s.n_m).sum::<usize>());
        for s in &r.steps {
            assert_eq!(s.active, s.stick + s.slip);
            assert!(s.max_penetration < 1e-7);
        }
    }
    let last = |o: &Outcome| o.record.steps.last().expect("steps").clone();
    let (b, c) = (last(&face[0]), last(&face[1]));
    // the same loads at the end, but another state
    assert_eq!(b.load, c.load);
    assert_close(b.load[2], -1.05e10, 1e-9);
    assert_close(b.load[0], 9e8, 1e-9);
    assert!((b.tangential_force[0] - c.tangential_force[0]).abs() > 0.05 * b.tangential_norm);
    for method in ["paper", "one-loop"] {
        let line = format!("brick --n 1 --steps 5 --quiet --tolerance 1e-8 --method {method}");
        let (other, _) = run(&line);
        for (x, y) in [(&b, &last(&other[0])), (&c, &last(&other[1]))] {
            assert_close(x.normal_force, y.normal_force, 1e-5);
            assert_close(x.tangential_norm, y.tangential_norm, 1e-5);
            assert_eq!((x.active, x.slip), (y.active, y.slip), "{method}");
        }
        assert!(
            other
                .iter()
                .all(|o| o.record.n_m_setup > 0 && o.record.unconverged.is_empty())
        );
    }
}

#[test]
fn the_whole_benchmark_of_the_smallest_brick_stays_below_the_papers_products() {
    for method in ["face", "paper"] {
        let (outcomes, text) = run(&format!("brick --n 1 --quiet --strict --method {method}"));
        for outcome in &outcomes {
            let r = &outcome.record;
            assert!(r.largest_certificate <= 1e-6);
            let loading = Loading::BOTH.into_iter().find(|l| l.name() == r.loading);
            let (_, n_m, _) = paper::row(1).expect("row").costs(loading.expect("loading"));
            assert!(r.n_m <= n_m, "{method} {}: {}", r.loading, r.n_m);
        }
        assert!(text.contains("above: none"), "{text}");
    }
}

/// The default method on the second brick: bands of an eighth around what was measured.
#[test]
fn products_of_the_second_brick_stay_in_their_bands() {
    let (outcomes, _) = run("brick --n 2 --quiet --strict");
    for (outcome, measured) in outcomes.iter().zip([664, 697]) {
        let found = outcome.record.n_m;
        assert!(found.abs_diff(measured) <= measured / 8, "{found}, not {measured}");
    }
}

#[test]
fn the_json_has_the_names_of_the_benchmark_and_reads_back() {
    let json = folder("brick-json").join("runs.json");
    let line = format!("brick --n 1 --steps 3 --cells 3 --quiet --json {}", json.display());
    let (outcomes, _) = run(&line);
    let text = read(&json);
    let back: Vec<RunRecord> = serde_json::from_str(&text).expect("records");
    assert_eq!(back.len(), 2);
    for (read, outcome) in back.iter().zip(&outcomes) {
        assert_eq!(*read, outcome.record);
    }
    let value: serde_json::Value = serde_json::from_str(&text).expect("json");
    let names = "n loading method threads n_s n_p n_d n_d_paper it n_m n_m_setup setup_seconds solve_seconds \
                 peak_rss_bytes steps";
    for name in names.split_whitespace() {
        assert!(value[0].get(name).is_some(), "{name}");
    }
    let names = "step t it n_m active stick slip normal_force tangential_force normal_norm tangential_norm \
                 max_slip_rate max_penetration dissipation dissipation_formula certificate";
    for name in names.split_whitespace() {
        assert!(value[0]["steps"][2].get(name).is_some(), "{name}");
    }
    assert_eq!(value[0]["steps"][2]["step"], 3);
    assert_eq!(value[0]["steps"][2]["t"], 1.0);
    assert_eq!(value[1]["loading"], "c");
    // only where it says something
    assert!(value[0]["steps"][2].get("unconverged_history").is_none());
    let mut step = back[0].steps[2].clone();
    step.unconverged_history = Some(1);
    let step = serde_json::to_value(&step).expect("json");
    assert_eq!(step["unconverged_history"], 1);
}

#[test]
fn a_perturbed_brick_shares_no_matrices() {
    let count = |perturb: bool| {
        let block = Block {
            steps: 1,
            cells: [4; 3],
            perturbation: if perturb { 0.1 } else { 0.0 },
            ..Block::benchmark(1, Loading::B)
        };
        let simulation = Simulation::new(block.scene().expect("scene"), Settings::default()).expect("set-up");
        simulation.tfeti().classes().classes().len()
    };
    assert_eq!((count(false), count(true)), (1, 3));
    let (outcomes, _) = run("brick --n 1 --steps 2 --cells 4 --perturb --quiet --loading c");
    assert!(outcomes[0].record.largest_certificate < 1e-6);
}

#[test]
fn the_plan_needs_no_run() {
    let (outcomes, text) = run("brick --n 5 --plan");
    assert!(outcomes.is_empty());
    assert!(
        text.contains("96828 as the paper counts") && text.contains("rate dependent"),
        "{text}"
    );
}

#[test]
fn bad_options_are_errors() {
    for line in [
        "brick --n 0",
        "brick --n 1,x",
        "brick --n -1",
        "brick --loading d",
        "brick --method magic",
        "brick --formula none",
        "brick --steps 0",
        "brick --cells 0",
        "brick --threads many",
        "brick --tolerance tight",
        "brick --unknown",
    ] {
        assert!(BrickOptions::try_parse_from(line.split_whitespace()).is_err(), "{line}");
    }
    let folder = folder("brick-bad");
    let file = folder.join("file");
    std::fs::write(&file, "in the way").expect("file");
    let blocked = format!("brick --n 1 --cells 1 --steps 1 --quiet --out {}/sub", file.display());
    let unwritable = format!(
        "brick --n 1 --cells 1 --steps 1 --quiet --out {} --json {}/sub.json",
        folder.display(),
        file.display()
    );
    for (line, word) in [
        ("brick --n 1 --tolerance 2 --quiet", "tolerance"),
        ("brick --n 1 --tolerance nan --quiet", "tolerance"),
        ("brick --n 1000000 --quiet", "tetrahedra"),
        ("brick --n 18446744073709551615 --quiet", "tetrahedra"),
        (unwritable.as_str(), "cannot write"),
        (blocked.as_str(), "cannot write"),
    ] {
        let error = execute(&options::<BrickOptions>(line), &mut Vec::new())
            .expect_err(line)
            .to_string();
        assert!(error.contains(word), "{line}: {error}");
    }
}

#[test]
fn steps_that_did_not_converge_are_loud() {
    let (mut outcomes, _) = run("brick --n 1 --steps 2 --cells 2 --loading b --quiet");
    let record = &mut outcomes[0].record;
    assert!(strict(true, std::iter::once(&*record)).is_ok());
    record.unconverged = vec![2];
    assert!(strict(false, std::iter::once(&*record)).is_ok());
    let verdict = strict(true, std::iter::once(&*record)).expect_err("strict");
    assert!(verdict.to_string().starts_with("1 steps did not reach"));
    record.steps[1].unconverged_history = Some(1);
    let text = warnings(&[record]);
    assert!(
        text.contains("DID NOT REACH") && text.contains("1 later steps depends on step 1"),
        "{text}"
    );
}

#[test]
fn threads_change_no_bit() {
    let line = |t: usize| format!("brick --n 2 --steps 2 --loading c --quiet --threads {t}");
    let (one, two) = (run(&line(1)).0, run(&line(2)).0);
    assert_eq!(one[0].record.steps, two[0].record.steps);
    assert_eq!(one[0].snapshot.displacement, two[0].snapshot.displacement);
}
