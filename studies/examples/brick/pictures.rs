//! Pictures of the benchmark: the counterparts of the paper's figures 6.4 to 6.7, and what the solver did and cost.

use signorini::contact::ContactState;
use signorini_studies::Failure;
use signorini_studies::brick::{GAP, LENGTHS, Loading};
use signorini_studies::chart::{Chart, Curve, page};
use signorini_studies::paper::{self, PaperRow};
use signorini_studies::record::RunRecord;
use signorini_studies::run::Outcome;
use signorini_studies::snapshot::Snapshot;
use signorini_studies::surface::{Panel, Shape, Style, picture};

/// The deformed brick, friction stress and slip rate on its floor, each with its name: one panel a run.
pub(crate) fn bodies(runs: &[Outcome]) -> [(&'static str, String); 3] {
    let snapshots: Vec<&Snapshot> = runs.iter().map(|o| &o.snapshot).collect();
    let friction = |s: &&Snapshot| s.contact.stress(&s.contact.friction());
    let friction: Vec<_> = snapshots.iter().map(friction).collect();
    let rates: Vec<_> = snapshots.iter().map(|s| s.contact.slip_rate.clone()).collect();
    [
        ("brick", deformed(&snapshots)),
        (
            "friction",
            floor_map(
                &snapshots,
                &friction,
                "GPa",
                1e-9,
                "friction stress; lines: its direction on the body",
            ),
        ),
        (
            "slip-rate",
            floor_map(&snapshots, &rates, "mm/s", 1e3, "slip rate of the nodes in contact"),
        ),
    ]
}

fn caption(s: &Snapshot) -> String {
    let what = match s.loading.as_str() {
        "b" => "loading b: end pulled once",
        "c" => "loading c: end pulled, released, pulled again",
        other => other,
    };
    format!("{what}, t = {} s", s.time)
}

/// The deformed brick over the floor, coloured by the displacement, in true size.
fn deformed(snapshots: &[&Snapshot]) -> String {
    let length = |u: &[f64; 3]| u.iter().map(|c| c * c).sum::<f64>().sqrt();
    let sizes: Vec<Vec<f64>> = snapshots
        .iter()
        .map(|s| s.displacement.iter().map(length).collect())
        .collect();
    let [l, w, _] = LENGTHS;
    let floor = [[-0.1, -0.12], [l + 0.25, -0.12], [l + 0.25, w + 0.12], [-0.1, w + 0.12]];
    let floor = floor.map(|[x, y]| [x, y, -GAP]).to_vec();
    let mut behind = vec![Shape::Polygon(
        floor,
        "fill=\"#dcdcdc\" stroke=\"#999\" stroke-width=\"8\"",
    )];
    for axis in 0..3 {
        for corner in 0..4_u8 {
            let mut ends = [[0.0; 3]; 2];
            for (d, bit) in [((axis + 1) % 3, corner & 1), ((axis + 2) % 3, corner >> 1)] {
                ends.iter_mut().for_each(|e| e[d] = LENGTHS[d] * f64::from(bit));
            }
            ends[1][axis] = LENGTHS[axis];
            behind.push(Shape::Line(
                ends,
                "stroke=\"#444\" stroke-width=\"8\" stroke-dasharray=\"50 40\"",
            ));
        }
    }
    let moved = |s: &Snapshot| {
        let pairs = s.points.iter().zip(&s.displacement);
        pairs.map(|(x, u)| std::array::from_fn(|c| x[c] + u[c])).collect()
    };
    let panels: Vec<Panel<'_>> = snapshots
        .iter()
        .zip(&sizes)
        .map(|(s, values)| Panel {
            title: caption(s),
            note: "deformed, true size; dashed: unloaded; grey: rigid floor".to_owned(),
            points: moved(s),
            triangles: &s.triangles,
            values,
            behind: behind.clone(),
            before: Vec::new(),
        })
        .collect();
    let style = Style {
        eye: [0.35, -1.0, 0.42],
        flat: false,
        scale: "|u| in mm",
        factor: 1e3,
        unit: " m",
    };
    picture(&style, &panels)
}

/// The contact surface seen from above. Friction comes with its directions.
fn floor_map(snapshots: &[&Snapshot], values: &[Vec<f64>], unit: &str, factor: f64, what: &str) -> String {
    let panels: Vec<Panel<'_>> = snapshots
        .iter()
        .zip(values)
        .map(|(s, values)| Panel {
            title: caption(s),
            note: format!("{what}; white dots: the node sticks, red: it slides, none: open or fixed (at x1 = 0)"),
            points: s.contact.points.clone(),
            triangles: &s.contact.triangles,
            values,
            behind: Vec::new(),
            before: marks(s, unit == "GPa"),
        })
        .collect();
    picture(
        &Style {
            eye: [0.0, 0.0, 1.0],
            flat: true,
            scale: unit,
            factor,
            unit: " m",
        },
        &panels,
    )
}

/// Directions of friction if asked for, and what the nodes do.
fn marks(s: &Snapshot, directions: bool) -> Vec<Shape> {
    let patch = &s.contact;
    let mut shapes = Vec::new();
    let count = patch.nodes.len().max(1) as f64;
    let spacing = (LENGTHS[0] * LENGTHS[1] / count).sqrt();
    let sizes = patch.friction();
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    for ((p, f), size) in patch.points.iter().zip(&patch.friction_force).zip(&sizes) {
        if directions && *size > 1e-3 * largest {
            let tip = std::array::from_fn(|c| p[c] + 0.9 * spacing * f[c] / size);
            shapes.push(Shape::Line([*p, tip], "stroke=\"#fff\" stroke-width=\"10\""));
        }
    }
    // smaller marks on finer meshes
    let radius = (60.0 / count.sqrt()).clamp(1.2, 3.2);
    for (p, state) in patch.points.iter().zip(&patch.state) {
        let style = match state {
            Some(ContactState::Stick) => "fill=\"#fff\" stroke=\"#000\" stroke-width=\".5\"",
            Some(ContactState::Slip) => "fill=\"#e4002b\" stroke=\"#fff\" stroke-width=\".5\"",
            _ => continue,
        };
        shapes.push(Shape::Dot(*p, radius, style));
    }
    shapes
}

/// Products a step, and products and seconds of a run against the size; the paper's numbers beside them where the
/// records are of the benchmark.
pub(crate) fn growth(records: &[&RunRecord], standard: bool) -> Result<String, Failure> {
    let own = |point: fn(&RunRecord) -> (f64, f64)| -> Vec<Curve> {
        let mut loadings: Vec<&str> = records.iter().map(|r| r.loading.as_str()).collect();
        loadings.sort_unstable();
        loadings.dedup();
        let of = |name: &str| {
            records
                .iter()
                .filter(|r| r.loading == name)
                .map(|r| point(r))
                .collect::<Vec<_>>()
        };
        let curve = |(k, name): (usize, &&str)| Curve::new(format!("loading {name}"), k, of(name));
        loadings.iter().enumerate().map(curve).collect()
    };
    let paper = |cost: fn(&PaperRow, Loading) -> f64| {
        let of = move |l| paper::TABLE.iter().map(move |row| (row.n_p as f64, cost(row, l)));
        let curve = |l: Loading| Curve::new(format!("paper, {}", l.name()), 5, of(l));
        Loading::BOTH.map(curve).into_iter().filter(move |_| standard)
    };
    let chart = |title: &str, along: &str, log: bool, curves: Vec<Curve>| Chart {
        title: title.to_owned(),
        axes: [along.to_owned(), String::new()],
        log: [log; 2],
        marks: true,
        legend: true,
        curves,
    };
    let steps = own(|r| (r.n as f64, r.n_m as f64 / r.steps.len().max(1) as f64));
    let mut products = own(|r| (r.n_p as f64, r.n_m as f64));
    products.extend(paper(|row, l| row.costs(l).1 as f64));
    let mut seconds = own(|r| (r.n_p as f64, r.setup_seconds + r.solve_seconds));
    seconds.extend(paper(|row, l| row.costs(l).2));
    let charts = [
        chart("products with F a step", "n", false, steps),
        chart("products of the run", "unknowns", true, products),
        chart("seconds of the run", "unknowns", true, seconds),
    ];
    page((1080, 380), [1, 3], "", &charts)
}
