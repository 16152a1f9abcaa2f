//! The pages: every link leads somewhere, and tutorials show the programs as they are.

use std::collections::BTreeMap;
use std::fs::read_to_string;
use std::path::{Path, PathBuf};

use signorini::prelude::*;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All pages with their text.
fn pages() -> Vec<(PathBuf, String)> {
    let mut found: Vec<PathBuf> = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"]
        .iter()
        .map(|name| root().join(name))
        .collect();
    let mut folders = vec![root().join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "md") {
                found.push(path);
            }
        }
    }
    let text = |path: &PathBuf| read_to_string(path).expect("a page");
    found.into_iter().map(|p| (p.clone(), text(&p))).collect()
}

/// Lines in and out of blocks of code: `(inside, line)`.
fn lines(text: &str) -> Vec<(bool, &str)> {
    let mut inside = false;
    let mut all = Vec::new();
    for line in text.lines() {
        if line.starts_with("```") {
            inside = !inside;
        } else {
            all.push((inside, line));
        }
    }
    all
}

/// The anchors of a page, as GitHub makes them.
fn anchors(text: &str) -> Vec<String> {
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    let headings = lines(text)
        .into_iter()
        .filter(|(inside, line)| !inside && line.starts_with('#'));
    headings
        .map(|(_, line)| {
            let words = line.trim_start_matches('#').trim().to_lowercase();
            let name: String = words
                .chars()
                .filter(|c| c.is_alphanumeric() || " -_".contains(*c))
                .map(|c| if c == ' ' { '-' } else { c })
                .collect();
            let seen = count.entry(name.clone()).or_default();
            *seen += 1;
            match *seen {
                1 => name,
                n => format!("{name}-{}", n - 1),
            }
        })
        .collect()
}

#[test]
fn every_link_leads_somewhere() {
    for (path, text) in pages() {
        for (_, line) in lines(&text).into_iter().filter(|(inside, _)| !inside) {
            for rest in line.split("](").skip(1) {
                let link = rest.split(')').next().unwrap_or_default();
                if link.starts_with("http") || line.starts_with("$$") {
                    continue;
                }
                let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
                let folder = path.parent().expect("a folder");
                let target = if file.is_empty() { path.clone() } else { folder.join(file) };
                assert!(target.exists(), "{}: {link}", path.display());
                if !anchor.is_empty() {
                    let names = anchors(&read_to_string(&target).expect("a page"));
                    assert!(names.iter().any(|n| n == anchor), "{}: {link}", path.display());
                }
            }
        }
    }
}

#[test]
fn tutorials_show_the_programs() {
    let mut shown = 0;
    for (path, text) in pages() {
        if !path.starts_with(root().join("docs/tutorials")) {
            continue;
        }
        // a page without a program of its own shows lines of the test below
        let program = text
            .split("--example ")
            .nth(1)
            .and_then(|c| c.split_whitespace().next());
        let file = program.map_or("tests/docs/mod.rs".to_owned(), |name| format!("{name}.rs"));
        let program = read_to_string(root().join("examples").join(file)).expect("the program of the tutorial");
        let program: Vec<&str> = program.lines().map(str::trim).collect();
        let mut rust = false;
        for line in text.lines() {
            if line.starts_with("```") {
                rust = line.starts_with("```rust");
            } else if rust && !line.trim().starts_with("//") {
                assert!(program.contains(&line.trim()), "{}: {line}", path.display());
                shown += 1;
            }
        }
    }
    assert!(shown > 40, "{shown}");
}

/// The lines of the tutorial about certificates, which shows and explains all their parts.
#[test]
fn a_certificate_has_the_parts_that_are_explained() {
    let page = read_to_string(root().join("docs/tutorials/certificate.md")).expect("a page");
    let scene = crate::crack::scene(2).expect("scene");
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let result = simulation.step().expect("step");
    let report = result.report();
    println!("{}, {} products", report.status, report.counters.products);
    for (name, violation) in result.certificate().parts() {
        println!("  {name}: {:.1e}", violation.relative());
        for shown in [format!("\n  {name}: "), format!("\n| {name} | ")] {
            assert_eq!(page.matches(&shown).count(), 1, "{name}");
        }
    }
    let explained = page.lines().filter(|line| line.starts_with("| ")).count();
    // with their head
    assert_eq!(explained, result.certificate().parts().len() + 1);
}
