//! Pictures of any mesh surface with a nodal field, shaded, as SVG.
//!
//! Nothing depends on installed fonts: text stays text in the SVG.

use std::collections::BTreeMap;

use crate::svg::Svg;

const WIDTH: f64 = 860.0;
/// Pixels left of the body, right of it (for the scale), above and below it.
const MARGINS: [f64; 4] = [30.0, 120.0, 66.0, 100.0];
/// Bands of one colour on a scale.
const BANDS: usize = 20;
/// Direction to the lamp.
const LAMP: [f64; 3] = [0.25, -0.45, 0.86];

/// A surface and what stands on it.
#[derive(Debug, Clone)]
pub struct Panel<'a> {
    /// Headline.
    pub title: String,
    /// A line below it.
    pub note: String,
    /// Nodes, where they are drawn.
    pub points: Vec<[f64; 3]>,
    /// Triangles by nodes, outward.
    pub triangles: &'a [[u32; 3]],
    /// A value not below 0 at each node.
    pub values: &'a [f64],
    /// Drawn before the surface.
    pub behind: Vec<Shape>,
    /// Drawn over it.
    pub before: Vec<Shape>,
}

/// A shape in space, with SVG attributes.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A closed polygon.
    Polygon(Vec<[f64; 3]>, &'static str),
    /// A line.
    Line([[f64; 3]; 2], &'static str),
    /// A circle of so many pixels.
    Dot([f64; 3], f64, &'static str),
}

impl Shape {
    fn points(&self) -> &[[f64; 3]] {
        match self {
            Self::Polygon(p, _) => p,
            Self::Line(p, _) => p,
            Self::Dot(p, ..) => std::slice::from_ref(p),
        }
    }
}

/// How a picture is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Style<'a> {
    /// Direction to the eye; need not be of length 1.
    pub eye: [f64; 3],
    /// Whether facets that look away are drawn, too, and none is shaded: for plane surfaces seen from either side.
    pub flat: bool,
    /// What the scale shows, with its unit.
    pub scale: &'a str,
    /// From values to that unit.
    pub factor: f64,
    /// Unit of length, with a space before it; empty where it is not known.
    pub unit: &'a str,
}

/// One panel below the other, with one scale of colours and of lengths.
pub fn picture(style: &Style<'_>, panels: &[Panel<'_>]) -> String {
    let mut view = View::new(style.eye);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for panel in panels {
        let shapes = panel.behind.iter().chain(&panel.before).flat_map(Shape::points);
        for p in panel.points.iter().chain(shapes).map(|p| view.point(*p)) {
            for c in 0..2 {
                (low[c], high[c]) = (low[c].min(p[c]), high[c].max(p[c]));
            }
        }
    }
    let [left, right, above, below] = MARGINS;
    view.zoom = (WIDTH - left - right) / (high[0] - low[0]).max(f64::MIN_POSITIVE);
    let height = view.zoom * (high[1] - low[1]);
    let panel_height = above + height + below;
    let mut svg = Svg::new(WIDTH, panel_height * panels.len() as f64);
    let scale = Scale::new(panels.iter().flat_map(|p| p.values));
    for (k, panel) in panels.iter().enumerate() {
        let top = panel_height * k as f64;
        view.origin = [left - view.zoom * low[0], top + above - view.zoom * low[1]];
        svg.text([20.0, top + 26.0], 15.0, &panel.title);
        svg.text([20.0, top + 45.0], 12.0, &panel.note);
        shapes(&mut svg, &view, &panel.behind);
        surface(&mut svg, &view, style.flat, panel, &scale);
        shapes(&mut svg, &view, &panel.before);
        axes(&mut svg, &view, style.unit, [left + 12.0, top + panel_height - 24.0]);
        scale.bar(&mut svg, [WIDTH - 84.0, top + above + 10.0], height - 10.0, style);
    }
    svg.finish()
}

/// Parallel projection.
struct View {
    origin: [f64; 2],
    zoom: f64,
    right: [f64; 3],
    up: [f64; 3],
    eye: [f64; 3],
}

impl View {
    fn new(eye: [f64; 3]) -> Self {
        let eye = unit(eye);
        let level = [-eye[1], eye[0], 0.0];
        let right = if dot(level, level) > 1e-12 { unit(level) } else { [1.0, 0.0, 0.0] };
        Self {
            origin: [0.0; 2],
            zoom: 1.0,
            right,
            up: cross(eye, right),
            eye,
        }
    }

    fn point(&self, x: [f64; 3]) -> [f64; 2] {
        let [a, b] = self.origin;
        [a + self.zoom * dot(x, self.right), b - self.zoom * dot(x, self.up)]
    }
}

fn shapes(svg: &mut Svg, view: &View, shapes: &[Shape]) {
    for shape in shapes {
        let points: Vec<_> = shape.points().iter().map(|p| view.point(*p)).collect();
        match shape {
            Shape::Polygon(_, style) => svg.polygons(&[points], true, style),
            Shape::Line(_, style) => svg.polygons(&[points], false, style),
            Shape::Dot(_, radius, style) => svg.circle(points[0], *radius, style),
        }
    }
}

/// Painter's algorithm: far triangles first; those that look away are left out.
fn surface(svg: &mut Svg, view: &View, flat: bool, panel: &Panel<'_>, scale: &Scale) {
    let lamp = unit(LAMP);
    let mut order = Vec::new();
    let mut edges = BTreeMap::new();
    for triangle in panel.triangles {
        let x = triangle.map(|n| panel.points[n as usize]);
        let normal = unit(cross(subtract(x[1], x[0]), subtract(x[2], x[0])));
        if !flat && dot(normal, view.eye) <= 0.0 {
            continue;
        }
        // few shades, so that neighbours share a colour
        let light = (4.0 * dot(normal, lamp).max(0.0)).round() / 4.0;
        let shade = if flat { 1.0 } else { 0.72 + 0.28 * light };
        let corners = x.map(|p| view.point(p));
        let depth: f64 = x.iter().map(|p| dot(*p, view.eye)).sum();
        order.push((depth, corners, triangle.map(|n| panel.values[n as usize]), shade));
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            edges.insert((a.min(b), a.max(b)), [corners[k], corners[(k + 1) % 3]]);
        }
    }
    // the sort is stable: equal depths stay in the order of the mesh
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut path = (String::new(), Vec::new());
    let mut flush = |colour: &str, polygons: &[Vec<[f64; 2]>]| {
        let style = format!("fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"5\" stroke-linejoin=\"round\"");
        svg.polygons(polygons, true, &style);
    };
    for (_, corners, values, shade) in order {
        for (band, polygon) in bands(corners, values, scale) {
            let colour = scale.colour(band, shade);
            if colour != path.0 {
                flush(&path.0, &path.1);
                path = (colour, Vec::new());
            }
            path.1.push(polygon);
        }
    }
    flush(&path.0, &path.1);
    let edges: Vec<_> = edges.into_values().collect();
    svg.polygons(
        &edges,
        false,
        "fill=\"none\" stroke=\"#000\" stroke-opacity=\".2\" stroke-width=\"4\"",
    );
}

/// Directions of the axes that are seen, and their length: a round one of 30 to 75 pixels.
fn axes(svg: &mut Svg, view: &View, unit: &str, origin: [f64; 2]) {
    let length = round_step(30.0 / view.zoom);
    let local = View {
        origin,
        zoom: view.zoom,
        ..*view
    };
    for axis in 0..3 {
        let mut tip = [0.0; 3];
        tip[axis] = length;
        let end = local.point(tip);
        let seen = (end[0] - origin[0]).hypot(end[1] - origin[1]);
        if seen > 4.0 {
            svg.polygons(&[[origin, end]], false, "stroke=\"#222\" stroke-width=\"14\"");
            let beyond = |c: usize| end[c] + 9.0 * (end[c] - origin[c]) / seen;
            svg.text([beyond(0) - 5.0, beyond(1) + 4.0], 12.0, &format!("x{}", axis + 1));
        }
    }
    let note = format!("axes: {}{unit}", number(length, length));
    svg.text([origin[0] + view.zoom * length + 30.0, origin[1] + 12.0], 11.0, &note);
}

/// Colours of a scale, dark to light; readable in grey and by the colour-blind (after matplotlib's viridis).
const COLOURS: [[f64; 3]; 9] = [
    [68.0, 1.0, 84.0],
    [71.0, 44.0, 122.0],
    [59.0, 81.0, 139.0],
    [44.0, 113.0, 142.0],
    [33.0, 144.0, 141.0],
    [39.0, 173.0, 129.0],
    [92.0, 200.0, 99.0],
    [170.0, 220.0, 50.0],
    [253.0, 231.0, 37.0],
];

/// A linear scale from 0 to a maximum above 0, in bands of one colour.
struct Scale {
    max: f64,
}

impl Scale {
    fn new<'a>(values: impl Iterator<Item = &'a f64>) -> Self {
        let max = values.copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
        Self {
            max: if max > 0.0 { max } else { 1.0 },
        }
    }

    /// Lower end of a band.
    fn level(&self, band: usize) -> f64 {
        self.max * band as f64 / BANDS as f64
    }

    /// Colour of a band, darkened by `shade` in (0, 1].
    fn colour(&self, band: usize, shade: f64) -> String {
        let place = band as f64 / (BANDS - 1) as f64 * (COLOURS.len() - 1) as f64;
        let k = (place as usize).min(COLOURS.len() - 2);
        let mix = |c: usize| COLOURS[k][c] + (place - k as f64) * (COLOURS[k + 1][c] - COLOURS[k][c]);
        let [r, g, b] = [0, 1, 2].map(|c| (mix(c) * shade).round() as u8);
        format!("#{r:02x}{g:02x}{b:02x}")
    }

    /// A vertical bar with round numbers.
    fn bar(&self, svg: &mut Svg, [x, y]: [f64; 2], height: f64, style: &Style<'_>) {
        let step = height / BANDS as f64;
        let rect = |y: f64, height: f64| [[x, y], [x + 16.0, y], [x + 16.0, y + height], [x, y + height]];
        for band in 0..BANDS {
            let top = y + height - step * (band + 1) as f64;
            // overlapping by a little hides the seams
            let fill = format!("fill=\"{}\"", self.colour(band, 1.0));
            svg.polygons(&[rect(top, step + 0.3)], true, &fill);
        }
        svg.polygons(
            &[rect(y, height)],
            true,
            "fill=\"none\" stroke=\"#222\" stroke-width=\"8\"",
        );
        svg.text([x, y - 10.0], 12.0, style.scale);
        let max = self.max * style.factor;
        let tick = round_step(max / 5.0);
        for k in 0..=(max / tick * 1.0001) as usize {
            let value = k as f64 * tick;
            let at = y + height * (1.0 - value / max);
            let line = [[x + 16.0, at], [x + 20.0, at]];
            svg.polygons(&[line], false, "stroke=\"#222\" stroke-width=\"8\"");
            svg.text([x + 23.0, at + 4.0], 11.0, &number(value, tick));
        }
    }
}

/// 1, 2 or 5 times a power of ten, at least `rough`.
fn round_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    let leads = [1.0, 2.0, 5.0].into_iter();
    power * leads.clone().find(|c| rough / power <= *c * 1.0001).unwrap_or(10.0)
}

/// A tick with as many decimals as the step needs.
fn number(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}

/// The polygons of a triangle with linear values in each band it reaches: (band, polygon).
fn bands(corners: [[f64; 2]; 3], values: [f64; 3], scale: &Scale) -> Vec<(usize, Vec<[f64; 2]>)> {
    let clamp = |v: f64| {
        if v.is_finite() { v.clamp(0.0, scale.max) } else { 0.0 }
    };
    let values = values.map(clamp);
    let (low, high) = (
        values.iter().copied().fold(f64::INFINITY, f64::min),
        values.iter().copied().fold(0.0, f64::max),
    );
    let band = |v: f64| ((v / scale.max * BANDS as f64) as usize).min(BANDS - 1);
    let triangle: Vec<_> = corners.into_iter().zip(values).collect();
    let mut out = Vec::new();
    for k in band(low)..=band(high) {
        let upper = if k + 1 == BANDS { f64::INFINITY } else { scale.level(k + 1) };
        let above = clip(&triangle, |v| v - scale.level(k));
        let inside = clip(&above, |v| upper - v);
        if inside.len() > 2 {
            out.push((k, inside.into_iter().map(|(p, _)| p).collect()));
        }
    }
    out
}

/// The part of a polygon with values where `keep` is not negative.
fn clip(polygon: &[([f64; 2], f64)], keep: impl Fn(f64) -> f64) -> Vec<([f64; 2], f64)> {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (i, &(p, v)) in polygon.iter().enumerate() {
        let (q, w) = polygon[(i + 1) % polygon.len()];
        let (a, b) = (keep(v), keep(w));
        if a >= 0.0 {
            out.push((p, v));
        }
        if (a < 0.0) != (b < 0.0) && a != 0.0 && b != 0.0 {
            let t = a / (a - b);
            out.push(([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])], v + t * (w - v)));
        }
    }
    out
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[c] - b[c])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3])
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let n = dot(a, a).sqrt();
    a.map(|c| c / n)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(p: &[[f64; 2]]) -> f64 {
        let cross = |i: usize| {
            let (a, b) = (p[i], p[(i + 1) % p.len()]);
            a[0] * b[1] - a[1] * b[0]
        };
        (0..p.len()).map(cross).sum::<f64>() / 2.0
    }

    #[test]
    fn the_bands_fill_the_triangle() {
        let scale = Scale { max: 1.0 };
        let corners = [[0.0, 0.0], [4.0, 1.0], [1.0, 3.0]];
        for values in [[0.0, 1.0, 0.35], [0.2; 3], [0.0; 3], [1.0, 1.0, 0.5], [2.0 / 7.0; 3]] {
            let parts = bands(corners, values, &scale);
            let sum: f64 = parts.iter().map(|(_, p)| area(p)).sum();
            assert!((sum - area(&corners)).abs() < 1e-12, "{values:?}: {sum}");
        }
        assert_eq!(bands(corners, [f64::NAN, 0.0, 0.0], &scale).len(), 1);
    }

    #[test]
    fn steps_are_round_and_colours_end_at_the_anchors() {
        assert_eq!(round_step(0.013), 0.02);
        assert_eq!(round_step(5.0), 5.0);
        assert!((round_step(70.0) - 100.0).abs() < 1e-9);
        assert_eq!(number(0.04, 0.02), "0.04");
        let scale = Scale::new([0.0, 2.0].iter());
        assert_eq!(scale.colour(0, 1.0), "#440154");
        assert_eq!(scale.colour(BANDS - 1, 1.0), "#fde725");
        assert_eq!(scale.level(BANDS), 2.0);
        assert_eq!(Scale::new([].iter()).max, 1.0);
    }
}
