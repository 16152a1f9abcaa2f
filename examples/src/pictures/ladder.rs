//! The ladder of methods as bars: products with F on a linear axis.

use super::svg::{Anchor, Svg};
use crate::performance::Line;

const BAR: f64 = 11.0;
const GAP: f64 = 12.0;
const LEFT: f64 = 445.0;
const RIGHT: f64 = 920.0;
const TOP: f64 = 62.0;
const COLOURS: [&str; 4] = ["#1f62a8", "#7fb0dd", "#d62728", "#f0a0a0"];

/// One group of bars for each method, one bar in it for each size and loading.
#[must_use]
pub fn ladder(lines: &[Line]) -> String {
    let key = |l: &Line| format!("n = {}, H/h = {}, {}", l.n, l.cells, l.loading.name());
    let (mut names, mut runs): (Vec<&str>, Vec<String>) = (Vec::new(), Vec::new());
    for line in lines {
        if !names.contains(&line.name) {
            names.push(line.name);
        }
        if !runs.contains(&key(line)) {
            runs.push(key(line));
        }
    }
    let most = lines.iter().map(|l| l.products).max().unwrap_or(1).max(1) as f64;
    let group = runs.len() as f64 * BAR + GAP;
    let height = TOP + names.len() as f64 * group + 20.0;
    let mut svg = Svg::new(1000.0, height);
    svg.text(
        14.0,
        22.0,
        16.0,
        Anchor::Start,
        "Products with F of all steps",
    );
    for (k, run) in runs.iter().enumerate() {
        let x = 14.0 + 190.0 * k as f64;
        svg.rect(x, 36.0, 12.0, 10.0, &fill(k));
        svg.text(x + 18.0, 45.0, 12.0, Anchor::Start, run);
    }
    for (row, name) in names.iter().enumerate() {
        let y = TOP + row as f64 * group;
        let middle = y + 0.5 * (group - GAP) + 4.0;
        svg.text(14.0, middle, 12.0, Anchor::Start, name);
        for line in lines.iter().filter(|l| l.name == *name) {
            let Some(k) = runs.iter().position(|r| *r == key(line)) else {
                continue;
            };
            let (y, width) = (
                y + k as f64 * BAR,
                (RIGHT - LEFT) * line.products as f64 / most,
            );
            svg.rect(LEFT, y, width, BAR - 1.0, &fill(k));
            let count = line.products.to_string();
            svg.text(
                LEFT + width + 5.0,
                y + BAR - 2.0,
                10.0,
                Anchor::Start,
                &count,
            );
        }
    }
    let style = "stroke=\"#999\"";
    svg.line([LEFT, TOP - 6.0], [LEFT, height - 20.0], style);
    svg.finish()
}

fn fill(k: usize) -> String {
    format!("fill=\"{}\"", COLOURS[k % COLOURS.len()])
}
