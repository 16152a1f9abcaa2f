//! The deformed brick over the floor, coloured by the displacement: the counterpart of figures 6.4 and 6.5.

use super::bands::bands;
use super::caption;
use super::colour::Scale;
use super::svg::{Anchor, Svg};
use crate::brick::{GAP, LENGTHS};
use crate::snapshot::Snapshot;

const WIDTH: f64 = 860.0;
const PANEL: f64 = 345.0;
/// Pixels a metre.
const ZOOM: f64 = 222.0;
const BANDS: usize = 20;
/// Direction from the brick to the eye, not normalised.
const EYE: [f64; 3] = [0.55, -1.0, 0.5];
/// Direction to the lamp.
const LAMP: [f64; 3] = [0.25, -0.45, 0.86];

/// One panel a snapshot, with a common scale of colours. Displacements are drawn in true size.
#[must_use]
pub fn deformed(snapshots: &[&Snapshot]) -> String {
    let mut svg = Svg::new(WIDTH, PANEL * snapshots.len() as f64);
    let sizes: Vec<Vec<f64>> = snapshots
        .iter()
        .map(|s| s.displacement.iter().map(|u| norm(*u)).collect())
        .collect();
    let scale = Scale::new(sizes.iter().flatten(), BANDS);
    for (k, (snapshot, size)) in snapshots.iter().zip(&sizes).enumerate() {
        let top = PANEL * k as f64;
        let view = View::new([58.0, top + 246.0]);
        svg.text(
            20.0,
            top + 26.0,
            15.0,
            Anchor::Start,
            &caption(&snapshot.loading, snapshot.time),
        );
        let note = "deformed, true size; dashed: unloaded; grey: rigid floor";
        svg.text(20.0, top + 45.0, 12.0, Anchor::Start, note);
        floor(&mut svg, &view);
        surface(&mut svg, &view, snapshot, size, &scale);
        outline(&mut svg, &view);
        axes(&mut svg, top + PANEL - 28.0);
        let title = "|u| in mm";
        scale.bar(
            &mut svg,
            [WIDTH - 84.0, top + 70.0],
            PANEL - 120.0,
            1e3,
            title,
        );
    }
    svg.finish()
}

/// Parallel projection.
struct View {
    origin: [f64; 2],
    right: [f64; 3],
    up: [f64; 3],
    eye: [f64; 3],
}

impl View {
    /// The origin of space is drawn at `origin`.
    fn new(origin: [f64; 2]) -> Self {
        let eye = unit(EYE);
        let right = unit([-eye[1], eye[0], 0.0]);
        Self {
            origin,
            right,
            up: cross(eye, right),
            eye,
        }
    }

    fn point(&self, x: [f64; 3]) -> [f64; 2] {
        [
            self.origin[0] + ZOOM * dot(x, self.right),
            self.origin[1] - ZOOM * dot(x, self.up),
        ]
    }
}

fn floor(svg: &mut Svg, view: &View) {
    let [l, w, _] = LENGTHS;
    let z = -GAP;
    let corners = [
        [-0.1, -0.12, z],
        [l + 0.25, -0.12, z],
        [l + 0.25, w + 0.12, z],
        [-0.1, w + 0.12, z],
    ];
    let polygon: Vec<_> = corners.iter().map(|c| view.point(*c)).collect();
    svg.polygons(
        &[polygon],
        "fill=\"#dcdcdc\" stroke=\"#999\" stroke-width=\"0.8\"",
    );
}

/// Painter's algorithm: far triangles first; those that look away are left out.
fn surface(svg: &mut Svg, view: &View, snapshot: &Snapshot, size: &[f64], scale: &Scale) {
    let lamp = unit(LAMP);
    let mut order = Vec::new();
    for (t, triangle) in snapshot.triangles.iter().enumerate() {
        let x = triangle.map(|n| {
            add(
                snapshot.points[n as usize],
                snapshot.displacement[n as usize],
            )
        });
        let normal = unit(cross(subtract(x[1], x[0]), subtract(x[2], x[0])));
        if dot(normal, view.eye) > 0.0 {
            let depth = dot(add(add(x[0], x[1]), x[2]), view.eye);
            // few shades, so that neighbours share a path
            let shade = 0.72 + 0.28 * (4.0 * dot(normal, lamp).max(0.0)).round() / 4.0;
            order.push((depth, t, x.map(|p| view.point(p)), shade));
        }
    }
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut run: (String, Vec<Vec<[f64; 2]>>) = Default::default();
    for (_, t, corners, shade) in &order {
        let values = snapshot.triangles[*t].map(|n| size[n as usize]);
        for (band, polygon) in bands(*corners, values, scale) {
            let colour = scale.colour(band, *shade);
            if colour != run.0 {
                paint(svg, &mut run);
                run.0 = colour;
            }
            run.1.push(polygon);
        }
    }
    paint(svg, &mut run);
    let edges: Vec<Vec<[f64; 2]>> = order.iter().map(|o| o.2.to_vec()).collect();
    let thin = 0.35;
    svg.polygons(
        &edges,
        &format!("fill=\"none\" stroke=\"#000\" stroke-opacity=\"0.3\" stroke-width=\"{thin}\""),
    );
}

fn paint(svg: &mut Svg, run: &mut (String, Vec<Vec<[f64; 2]>>)) {
    let colour = &run.0;
    let style = format!("fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\".5\"");
    svg.polygons(&run.1, &style);
    run.1.clear();
}

/// The edges of the unloaded brick.
fn outline(svg: &mut Svg, view: &View) {
    for axis in 0..3 {
        for corner in 0..4 {
            let mut a = [0.0; 3];
            let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
            a[p] = LENGTHS[p] * f64::from(corner & 1);
            a[q] = LENGTHS[q] * f64::from(corner >> 1);
            let mut b = a;
            b[axis] = LENGTHS[axis];
            let style = "stroke=\"#444\" stroke-width=\"0.8\" stroke-dasharray=\"5 4\"";
            svg.line(view.point(a), view.point(b), style);
        }
    }
}

/// Directions of the axes, and their length.
fn axes(svg: &mut Svg, bottom: f64) {
    let view = View::new([WIDTH - 225.0, bottom]);
    let length = 0.25;
    for (axis, name) in ["x1", "x2", "x3"].iter().enumerate() {
        let mut tip = [0.0; 3];
        tip[axis] = length;
        let (a, b) = (view.point([0.0; 3]), view.point(tip));
        svg.line(a, b, "stroke=\"#222\" stroke-width=\"1.4\"");
        tip[axis] = length + 0.07;
        let label = view.point(tip);
        svg.text(label[0], label[1] + 4.0, 12.0, Anchor::Middle, name);
    }
    svg.text(
        WIDTH - 225.0,
        bottom + 20.0,
        11.0,
        Anchor::Middle,
        "axes: 0.25 m",
    );
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let n = norm(a);
    a.map(|c| c / n)
}
