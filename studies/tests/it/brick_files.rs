//! What the benchmark leaves: pictures, files for ParaView, CSV, tables of reactions, charts.

use signorini::prelude::Brick;
use signorini_studies::surface::{Panel, Shape, Style, picture};

use crate::brick_study::run;
use crate::{folder, options, performance, read};

#[test]
fn files_and_pictures_are_written() {
    let folder = folder("brick-files");
    let out = folder.join("out");
    let line = format!(
        "brick --n 1 --steps 5 --cells 3 --quiet --vtu-every 2 --out {}",
        out.display()
    );
    run(&line);
    for name in [
        "brick-n1.svg",
        "friction-n1.svg",
        "slip-rate-n1.svg",
        "n1-b/steps.svg",
        "n1-c/steps.svg",
    ] {
        let text = read(out.join(name));
        assert!(
            text.starts_with("<svg") && text.trim_end().ends_with("</svg>"),
            "{name}"
        );
        assert!(!text.contains("NaN") && !text.contains("inf"), "{name}");
    }
    for run in ["n1-b", "n1-c"] {
        // at rest, steps 2, 4 and the last
        for series in ["body", "contact"] {
            let list = read(out.join(run).join(format!("{series}.pvd")));
            assert_eq!(list.matches("<DataSet").count(), 4, "{list}");
            assert!(out.join(run).join(format!("{series}_0003.vtu")).is_file());
        }
        assert_eq!(read(out.join(run).join("steps.csv")).lines().count(), 6);
    }
    let none = folder.join("none");
    run(&format!(
        "brick --n 1 --steps 1 --cells 2 --loading b --quiet --vtu-every 0 --out {}",
        none.display()
    ));
    assert!(!none.join("n1-b/body_0000.vtu").exists() && none.join("n1-b/steps.csv").is_file());
}

#[test]
fn reactions_are_printed_and_written_when_asked_for() {
    let folder = folder("brick-reactions");
    let body = |options: &str| {
        let out = folder.join("out");
        let line = format!(
            "brick --n 1 --steps 2 --cells 3 --loading b --quiet {options} --out {}",
            out.display()
        );
        let (_, text) = run(&line);
        let piece = out.join("n1-b/body_0002.vtu");
        let written = std::fs::read(&piece).expect("body");
        let field = b"Name=\"reaction\"";
        (text, written.windows(field.len()).any(|w| w == field))
    };
    let (text, written) = body("");
    assert!(!text.contains("support 0") && !written);
    let (text, written) = body("--reactions");
    assert!(written);
    let force = |name: &str| {
        let line = text.lines().find(|l| l.trim_start().starts_with(name));
        let numbers = line.expect("a line").trim_start()[name.len()..].split_whitespace();
        let numbers: Vec<f64> = numbers.map(|v| v.parse().expect("a number")).collect();
        assert_eq!(numbers.len(), 6, "{text}");
        numbers
    };
    // 3 m2 under 3e9 Pa and 1 m2 under (9e8, 0, -15e8) Pa
    let (loads, sum) = (force("loads"), force("sum"));
    assert_eq!(loads[..3], [9e8, 0.0, -10.5e9]);
    assert!(sum.iter().all(|v| v.abs() < 1e-5 * 10.5e9), "{text}");
}

#[test]
fn charts_show_every_run() {
    let folder = folder("charts");
    let path = |name: &str| folder.join(name).display().to_string();
    run(&format!(
        "brick --n 1 --steps 3 --cells 3 --quiet --chart {}",
        path("growth.svg")
    ));
    let growth = read(path("growth.svg"));
    assert!(growth.contains("loading b") && growth.contains("loading c"));
    assert!(growth.contains("seconds of the run"));
    // other steps and cells: not the paper's benchmark
    assert!(!growth.contains("paper, b"));
    let line = format!("performance --n 1 --steps 2 --cells 2 --chart {}", path("ladder.svg"));
    let lines = performance::execute(&options(&line), &mut Vec::new()).expect("ladder");
    let ladder = read(path("ladder.svg"));
    for line in &lines {
        assert!(ladder.contains(&line.name.replace('\'', "&apos;")), "{}", line.name);
        assert!(ladder.contains(&format!(">\n{}\n<", line.products)));
    }
}

/// Any mesh surface with a nodal field can be drawn.
#[test]
fn a_surface_of_ones_own_is_drawn() {
    let mesh = Brick::new([1.0, 2.0, 0.5], [2, 3, 1]).build().expect("a mesh");
    let triangles: Vec<_> = mesh.facets().iter().map(|f| f.nodes).collect();
    let values: Vec<f64> = mesh.points().iter().map(|p| p[1]).collect();
    let panel = Panel {
        title: "heights <of> a body".to_owned(),
        note: String::new(),
        points: mesh.points().to_vec(),
        triangles: &triangles,
        values: &values,
        behind: Vec::new(),
        before: vec![Shape::Dot([0.0; 3], 3.0, "fill=\"#000\"")],
    };
    let style = Style {
        eye: [1.0, -1.0, 0.5],
        flat: false,
        scale: "m",
        factor: 1.0,
        unit: " m",
    };
    let text = picture(&style, &[panel.clone(), panel]);
    assert!(text.starts_with("<svg") && text.ends_with("</svg>\n") && !text.contains("NaN"));
    assert_eq!(text.matches("&lt;of&gt;").count(), 2);
    assert_eq!(text.matches("<circle").count(), 2);
}
