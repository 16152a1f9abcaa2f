//! The deformed brick over the floor, coloured by the displacement: the counterpart of figures 6.4 and 6.5.

use std::collections::BTreeMap;

use super::bands::bands;
use super::caption;
use super::colour::Scale;
use super::svg::{Anchor, Svg};
use crate::brick::{GAP, LENGTHS};
use crate::snapshot::Snapshot;

const WIDTH: f64 = 860.0;
const PANEL: f64 = 440.0;
/// Pixels a metre.
const ZOOM: f64 = 205.0;
const BANDS: usize = 16;
/// Direction from the brick to the eye, not normalised.
const EYE: [f64; 3] = [0.35, -1.0, 0.42];
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
    let mut colours = Vec::new();
    for (k, (snapshot, size)) in snapshots.iter().zip(&sizes).enumerate() {
        let top = PANEL * k as f64;
        let view = View::new([58.0, top + 326.0]);
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
        outline(&mut svg, &view);
        surface(&mut svg, &view, snapshot, size, &scale, &mut colours);
        axes(&mut svg, [110.0, top + PANEL - 34.0]);
        let title = "|u| in mm";
        scale.bar(
            &mut svg,
            [WIDTH - 84.0, top + 70.0],
            PANEL - 120.0,
            1e3,
            title,
        );
    }
    svg.classes(&colours);
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
    svg.open_tenths("fill=\"#dcdcdc\" stroke=\"#999\" stroke-width=\"8\"");
    svg.polygons(&[polygon], true, "");
    svg.close();
}

/// Painter's algorithm: far triangles first; those that look away are left out.
fn surface(
    svg: &mut Svg,
    view: &View,
    snapshot: &Snapshot,
    size: &[f64],
    scale: &Scale,
    colours: &mut Vec<String>,
) {
    let lamp = unit(LAMP);
    let mut order = Vec::new();
    let mut edges = BTreeMap::new();
    for (t, triangle) in snapshot.triangles.iter().enumerate() {
        let node = |n: u32| {
            add(
                snapshot.points[n as usize],
                snapshot.displacement[n as usize],
            )
        };
        let x = triangle.map(node);
        let normal = unit(cross(subtract(x[1], x[0]), subtract(x[2], x[0])));
        if dot(normal, view.eye) > 0.0 {
            let depth = dot(add(add(x[0], x[1]), x[2]), view.eye);
            // few shades, so that neighbours share a colour
            let shade = 0.72 + 0.28 * (4.0 * dot(normal, lamp).max(0.0)).round() / 4.0;
            let corners = x.map(|p| view.point(p));
            order.push((depth, t, corners, shade));
            for k in 0..3 {
                let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
                edges.insert((a.min(b), a.max(b)), [corners[k], corners[(k + 1) % 3]]);
            }
        }
    }
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    svg.open_tenths("stroke-width=\"5\" stroke-linejoin=\"round\"");
    let mut path: (usize, Vec<Vec<[f64; 2]>>) = Default::default();
    for (_, t, corners, shade) in &order {
        let values = snapshot.triangles[*t].map(|n| size[n as usize]);
        for (band, polygon) in bands(*corners, values, scale) {
            let class = class(colours, scale.colour(band, *shade));
            if class != path.0 {
                svg.polygons(&path.1, true, &format!("class=\"k{}\"", path.0));
                path = (class, Vec::new());
            }
            path.1.push(polygon);
        }
    }
    svg.polygons(&path.1, true, &format!("class=\"k{}\"", path.0));
    svg.close();
    svg.open_tenths("fill=\"none\" stroke=\"#000\" stroke-opacity=\".25\" stroke-width=\"4\"");
    let edges: Vec<_> = edges.into_values().collect();
    svg.polygons(&edges, false, "");
    svg.close();
}

/// Number of a colour in the table, entered if it is new.
fn class(colours: &mut Vec<String>, colour: String) -> usize {
    match colours.iter().position(|c| *c == colour) {
        Some(k) => k,
        None => {
            colours.push(colour);
            colours.len() - 1
        }
    }
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
fn axes(svg: &mut Svg, origin: [f64; 2]) {
    let view = View::new(origin);
    let length = 0.2;
    for (axis, name) in ["x1", "x2", "x3"].iter().enumerate() {
        let mut tip = [0.0; 3];
        tip[axis] = length;
        let style = "stroke=\"#222\" stroke-width=\"1.4\"";
        svg.line(view.point([0.0; 3]), view.point(tip), style);
        tip[axis] = length + 0.06;
        let label = view.point(tip);
        svg.text(label[0], label[1] + 4.0, 12.0, Anchor::Middle, name);
    }
    let note = "axes: 0.2 m";
    svg.text(
        origin[0] + 75.0,
        origin[1] + 16.0,
        11.0,
        Anchor::Start,
        note,
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
