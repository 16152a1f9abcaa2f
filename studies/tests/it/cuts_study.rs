//! Ragged cuts cost about as much as boxes, and no step runs in circles where they stay as they are.

use signorini::fem_mesh::Brick;
use signorini::fem_mesh::decomposition::split_disconnected;
use signorini::prelude::Partition;

use crate::options;
use crate::performance::PerformanceOptions;
use crate::performance::cuts::{Case, CutLine, execute, measure, voronoi};

/// Dearest step over the mean one.
fn spike(line: &CutLine) -> f64 {
    let most = line.products.iter().max().copied().unwrap_or(0);
    (most * line.products.len()) as f64 / line.total() as f64
}

#[test]
fn parts_of_any_shape_take_at_most_a_quarter_more_products_than_boxes() {
    let options: PerformanceOptions = options("performance --cuts --n 1,2");
    let mut out = Vec::new();
    let lines = execute(&options, &mut out).expect("run");
    assert_eq!(lines.len(), 2 * 4 * 8);
    for same in lines.chunks_exact(8) {
        let boxes = same[0].total();
        for line in same {
            assert!(line.failed == 0 && line.certificate < 1e-6, "{line:?}");
            // the library's parts are the boxes
            assert!(line.cut != "library" || line.total() == boxes, "{line:?}");
            if !line.cut.ends_with("as given") {
                // on boxes, a static step takes less than the 28 asked for, and a linear one than the 12
                let asked = match line.case {
                    Case::Static => boxes.max(28),
                    Case::Linear => boxes.max(12),
                    _ => boxes,
                };
                assert!(4 * line.total() <= 5 * asked, "{boxes}: {line:?}");
            }
            assert!(spike(line) < 2.6, "{line:?}");
        }
    }
    // half of the 19 and 23 that a tolerance of 0.01 of the residual took
    let linear = |n: usize| lines[32 * (n - 1)..32 * n].iter().find(|l| l.case == Case::Linear);
    for (n, most) in [(1, 9), (2, 11)] {
        let line = linear(n).expect("line");
        assert!(line.total() <= most, "{line:?}");
    }
    let text = String::from_utf8(out).expect("text");
    assert!(text.lines().count() == 2 + lines.len() && text.contains("| grown |"));
}

/// Where predictions made no progress, the residual of subdomains that had come apart told what holds and slides
/// next: steps of 72, 256, 45 and 250 products then.
#[test]
fn no_step_of_a_ragged_cut_runs_in_circles() {
    let mesh = Brick::new([3.0, 1.0, 1.0], [45, 15, 15]).build().expect("brick");
    let parts = voronoi(&mesh, 81, 1);
    let connected = split_disconnected(&mesh, &parts).expect("parts");
    let line = measure(
        Case::Program,
        &mesh,
        3,
        &("as given".to_owned(), Partition::AsGiven(connected)),
    )
    .expect("run");
    assert!(spike(&line) < 2.0 && line.failed == 0, "{line:?}");
}
