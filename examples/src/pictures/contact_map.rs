//! The contact surface seen from above: friction and slip rate, the counterparts of figures 6.6 and 6.7.

use signorini::contact::ContactState;

use super::bands::bands;
use super::caption;
use super::colour::{Scale, number};
use super::svg::{Anchor, Svg};
use crate::brick::LENGTHS;
use crate::snapshot::Snapshot;

const WIDTH: f64 = 860.0;
const PANEL: f64 = 330.0;
/// Pixels a metre.
const ZOOM: f64 = 225.0;
const LEFT: f64 = 62.0;
const BANDS: usize = 24;

/// Friction stress `|lambda_T|` over nodal area, with directions of the friction force on the body.
#[must_use]
pub fn friction(snapshots: &[&Snapshot]) -> String {
    let values: Vec<_> = snapshots
        .iter()
        .map(|s| s.contact.friction_stress())
        .collect();
    let what = "friction stress: |lambda_T| of a node over its area; lines: direction of the friction on the body";
    draw(snapshots, &values, "GPa", 1e-9, what, true)
}

/// Slip rate of nodes in contact.
#[must_use]
pub fn slip_rate(snapshots: &[&Snapshot]) -> String {
    let values: Vec<_> = snapshots
        .iter()
        .map(|s| s.contact.slip_rate.clone())
        .collect();
    draw(
        snapshots,
        &values,
        "mm/s",
        1e3,
        "slip rate of the nodes in contact",
        false,
    )
}

fn draw(
    snapshots: &[&Snapshot],
    values: &[Vec<f64>],
    unit: &str,
    factor: f64,
    what: &str,
    directions: bool,
) -> String {
    let mut svg = Svg::new(WIDTH, PANEL * snapshots.len() as f64 + 34.0);
    let scale = Scale::new(values.iter().flatten(), BANDS);
    for (k, (snapshot, values)) in snapshots.iter().zip(values).enumerate() {
        let top = PANEL * k as f64;
        svg.text(
            20.0,
            top + 24.0,
            15.0,
            Anchor::Start,
            &caption(&snapshot.loading, snapshot.time),
        );
        svg.text(20.0, top + 42.0, 12.0, Anchor::Start, what);
        let base = top + 56.0 + ZOOM * LENGTHS[1];
        let place = |p: [f64; 2]| [LEFT + ZOOM * p[0], base - ZOOM * p[1]];
        map(&mut svg, snapshot, values, &scale, place);
        if directions {
            arrows(&mut svg, snapshot, place);
        }
        states(&mut svg, snapshot, place);
        frame(&mut svg, place);
        scale.bar(
            &mut svg,
            [WIDTH - 84.0, top + 66.0],
            ZOOM * LENGTHS[1] - 10.0,
            factor,
            unit,
        );
    }
    legend(&mut svg, PANEL * snapshots.len() as f64 + 12.0, directions);
    svg.finish()
}

/// All bands of one colour in one path.
fn map(
    svg: &mut Svg,
    snapshot: &Snapshot,
    values: &[f64],
    scale: &Scale,
    place: impl Fn([f64; 2]) -> [f64; 2],
) {
    let patch = &snapshot.contact;
    let mut layers = vec![Vec::new(); scale.bands];
    for triangle in &patch.triangles {
        let corners = triangle.map(|n| place(patch.points[n as usize]));
        for (band, polygon) in bands(corners, triangle.map(|n| values[n as usize]), scale) {
            layers[band].push(polygon);
        }
    }
    svg.open_tenths("stroke-width=\"4\"");
    for (band, polygons) in layers.iter().enumerate() {
        let colour = scale.colour(band, 1.0);
        let style = format!("fill=\"{colour}\" stroke=\"{colour}\"");
        svg.polygons(polygons, true, &style);
    }
    svg.close();
}

/// A short line from each node that carries friction.
fn arrows(svg: &mut Svg, snapshot: &Snapshot, place: impl Fn([f64; 2]) -> [f64; 2]) {
    let patch = &snapshot.contact;
    let spacing = (LENGTHS[0] * LENGTHS[1] / patch.nodes.len().max(1) as f64).sqrt();
    let sizes = patch.friction();
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    for ((p, f), size) in patch.points.iter().zip(&patch.friction_force).zip(&sizes) {
        if *size > 1e-3 * largest {
            let reach = 0.9 * spacing / size;
            let tip = [p[0] + reach * f[0], p[1] + reach * f[1]];
            svg.line(place(*p), place(tip), "stroke=\"#fff\" stroke-width=\"1\"");
        }
    }
}

/// Stick: filled; slip: ring; open: a dot.
fn states(svg: &mut Svg, snapshot: &Snapshot, place: impl Fn([f64; 2]) -> [f64; 2]) {
    let patch = &snapshot.contact;
    // smaller marks on finer meshes
    let radius = (60.0 / (patch.nodes.len() as f64).sqrt()).clamp(1.2, 3.2);
    for (p, state) in patch.points.iter().zip(&patch.state) {
        mark(svg, place(*p), *state, (10.0 * radius).round() / 10.0);
    }
}

fn mark(svg: &mut Svg, at: [f64; 2], state: Option<ContactState>, radius: f64) {
    match state {
        Some(ContactState::Stick) => svg.circle(
            at,
            radius,
            "fill=\"#fff\" stroke=\"#000\" stroke-width=\".5\"",
        ),
        Some(ContactState::Slip) => svg.circle(
            at,
            radius,
            "fill=\"#e4002b\" stroke=\"#fff\" stroke-width=\".5\"",
        ),
        _ => {}
    }
}

fn frame(svg: &mut Svg, place: impl Fn([f64; 2]) -> [f64; 2]) {
    let ([x0, y0], [x1, y1]) = (place([0.0, 0.0]), place([LENGTHS[0], LENGTHS[1]]));
    svg.rect(x0, y1, x1 - x0, y0 - y1, "fill=\"none\" stroke=\"#222\"");
    let stroke = "stroke=\"#222\"";
    for k in 0..=6 {
        let x = 0.5 * f64::from(k);
        let [px, _] = place([x, 0.0]);
        svg.line([px, y0], [px, y0 + 5.0], stroke);
        svg.text(px, y0 + 18.0, 11.0, Anchor::Middle, &number(x, 0.5));
    }
    for k in 0..=2 {
        let y = 0.5 * f64::from(k);
        let [_, py] = place([0.0, y]);
        svg.line([x0 - 5.0, py], [x0, py], stroke);
        svg.text(x0 - 18.0, py + 4.0, 11.0, Anchor::Middle, &number(y, 0.5));
    }
    svg.text(
        (x0 + x1) / 2.0,
        y0 + 34.0,
        12.0,
        Anchor::Middle,
        "x1 in m (fixed at 0)",
    );
    svg.text_upward(x0 - 38.0, (y0 + y1) / 2.0, 12.0, "x2 in m");
}

fn legend(svg: &mut Svg, y: f64, directions: bool) {
    let entries = [
        (Some(ContactState::Stick), "node sticks"),
        (Some(ContactState::Slip), "node slides"),
    ];
    let mut x = LEFT;
    for (state, text) in entries {
        mark(svg, [x, y - 4.0], state, 3.2);
        svg.text(x + 9.0, y, 12.0, Anchor::Start, text);
        x += 120.0;
    }
    let rest = if directions {
        "no mark: open (or fixed, at x1 = 0)"
    } else {
        "no mark: open (drawn as 0) or fixed"
    };
    svg.text(x, y, 12.0, Anchor::Start, rest);
}
