//! Charts by `plotters` as SVG: curves on linear or logarithmic axes, several charts a page, and bars.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::Failure;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Whichever of these the reader has.
const FONT: &str = "Helvetica, Arial, DejaVu Sans, sans-serif";

const COLOURS: [RGBColor; 6] = [
    RGBColor(31, 98, 168),
    RGBColor(214, 39, 40),
    RGBColor(44, 140, 60),
    RGBColor(150, 90, 180),
    RGBColor(225, 130, 20),
    RGBColor(110, 110, 110),
];

/// A named curve. On a logarithmic axis what is not above zero is left out.
#[derive(Debug, Clone)]
pub struct Curve {
    /// What the legend says.
    pub name: String,
    /// Which of six colours; the last is grey.
    pub colour: usize,
    /// The points.
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    /// A curve.
    pub fn new(name: impl Into<String>, colour: usize, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let (name, points) = (name.into(), points.into_iter().collect());
        Self { name, colour, points }
    }

    fn colour(&self) -> RGBColor {
        COLOURS[self.colour % COLOURS.len()]
    }
}

/// Curves over two axes with their names.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Headline; may be empty.
    pub title: String,
    /// Names of the axes.
    pub axes: [String; 2],
    /// Which axes are logarithmic; the others begin at zero.
    pub log: [bool; 2],
    /// Whether points are marked.
    pub marks: bool,
    /// Whether the curves are named in the chart.
    pub legend: bool,
    /// The curves.
    pub curves: Vec<Curve>,
}

/// Charts in `rows` and `columns`. A heading that is not empty stands above, with the names of the first chart's
/// curves.
pub fn page(size: (u32, u32), [rows, columns]: [usize; 2], heading: &str, charts: &[Chart]) -> Result<String, Failure> {
    sheet(size, |root| {
        let (above, below) = root.split_vertically(if heading.is_empty() { 0 } else { 46 });
        if !heading.is_empty() {
            above.draw_text(heading, &font(16), (12, 6))?;
            let mut x = 12;
            for curve in charts.iter().take(1).flat_map(|c| &c.curves) {
                let colour = curve.colour();
                let line = [(x, 36), (x + 20, 36)];
                above.draw(&PathElement::new(line, colour.stroke_width(2)))?;
                above.draw(&Circle::new((x + 10, 36), 3, colour.filled()))?;
                above.draw_text(&curve.name, &font(13), (x + 26, 29))?;
                x += 50 + 7 * curve.name.chars().count() as i32;
            }
        }
        let areas = below.split_evenly((rows, columns));
        areas.iter().zip(charts).try_for_each(|(area, chart)| one(area, chart))
    })
}

/// The text of a white page on which something is drawn.
fn sheet(size: (u32, u32), draw: impl FnOnce(&Area<'_>) -> Result<(), Failure>) -> Result<String, Failure> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&WHITE)?;
        draw(&root)?;
        root.present()?;
    }
    Ok(text)
}

fn font(size: i32) -> TextStyle<'static> {
    TextStyle::from((FONT, size).into_font())
}

fn one(area: &Area<'_>, chart: &Chart) -> Result<(), Failure> {
    let place = |value: f64, log: bool| if log { value.log10() } else { value };
    let curves: Vec<(&Curve, Vec<(f64, f64)>)> = chart
        .curves
        .iter()
        .map(|c| {
            let points = c
                .points
                .iter()
                .map(|p| (place(p.0, chart.log[0]), place(p.1, chart.log[1])));
            (c, points.filter(|p| p.0.is_finite() && p.1.is_finite()).collect())
        })
        .collect();
    let all = || curves.iter().flat_map(|c| &c.1);
    // room for the legend
    let room = if chart.legend { 0.45 } else { 0.0 };
    let x = range(all().map(|p| p.0), chart.log[0], 0.0);
    let y = range(all().map(|p| p.1), chart.log[1], room);
    let label = |log: bool| {
        move |v: &f64| {
            if log { short(10f64.powf(*v)) } else { short(*v) }
        }
    };
    let mut drawn = ChartBuilder::on(area)
        .caption(&chart.title, (FONT, 16))
        .margin(8)
        .margin_right(16)
        .x_label_area_size(38)
        .y_label_area_size(62)
        .build_cartesian_2d(x, y)?;
    drawn
        .configure_mesh()
        .max_light_lines(0)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc(&chart.axes[0])
        .y_desc(&chart.axes[1])
        .x_labels(6)
        .y_labels(7)
        .x_label_formatter(&label(chart.log[0]))
        .y_label_formatter(&label(chart.log[1]))
        .label_style((FONT, 12))
        .draw()?;
    for (curve, points) in &curves {
        let colour = curve.colour();
        let line = LineSeries::new(points.iter().copied(), colour.stroke_width(2));
        let line = drawn.draw_series(line)?;
        if chart.legend {
            let sample = move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2));
            line.label(curve.name.as_str()).legend(sample);
        }
        if chart.marks {
            drawn.draw_series(points.iter().map(|p| Circle::new(*p, 3, colour.filled())))?;
        }
    }
    if chart.legend {
        drawn
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.85))
            .border_style(COLOURS[5])
            .label_font((FONT, 12))
            .draw()?;
    }
    Ok(())
}

/// Groups of horizontal bars, each with its count: one group a name, in it one bar for each of `kinds` (or none).
pub fn bars(title: &str, kinds: &[String], groups: &[(&str, Vec<Option<usize>>)]) -> Result<String, Failure> {
    let (bar, top, left, right) = (12, 62, 430, 920);
    let group = bar * kinds.len() as i32 + 12;
    let bottom = top + group * groups.len() as i32;
    let fill = |k: usize| COLOURS[k % COLOURS.len()].filled();
    let most = groups.iter().flat_map(|g| g.1.iter().flatten()).max();
    let scale = f64::from(right - left) / (*most.unwrap_or(&1)).max(1) as f64;
    sheet((1000, (bottom + 10) as u32), |root| {
        root.draw_text(title, &font(16), (14, 8))?;
        for (k, kind) in kinds.iter().enumerate() {
            let x = 14 + 190 * k as i32;
            root.draw(&Rectangle::new([(x, 36), (x + 12, 46)], fill(k)))?;
            root.draw_text(kind, &font(12), (x + 18, 35))?;
        }
        for (row, (name, counts)) in groups.iter().enumerate() {
            let y = top + group * row as i32;
            root.draw_text(name, &font(12), (14, y + (group - 12) / 2 - 6))?;
            for (k, count) in counts.iter().enumerate() {
                let Some(count) = count else { continue };
                let (y, end) = (y + bar * k as i32, left + (scale * *count as f64) as i32);
                root.draw(&Rectangle::new([(left, y), (end, y + bar - 2)], fill(k)))?;
                root.draw_text(&count.to_string(), &font(11), (end + 5, y - 1))?;
            }
        }
        Ok(root.draw(&PathElement::new([(left, top - 6), (left, bottom)], COLOURS[5]))?)
    })
}

/// A range around the values; with `room` above them, as a part of it.
fn range(values: impl Iterator<Item = f64>, log: bool, room: f64) -> Range<f64> {
    let nothing = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.fold(nothing, |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return 0.0..1.0;
    }
    if log {
        let pad = (0.06 * (high - low)).max(0.1);
        return low - pad..high + pad + room * (high - low).max(1.0);
    }
    let (low, high) = (low.min(0.0), high.max(0.0));
    let size = (high - low).max(1e-9);
    low - if low < 0.0 { 0.06 * size } else { 0.0 }..high + (0.05 + room) * size
}

/// A number with two digits after its first: 0.025, 3, 500, 2e4.
fn short(v: f64) -> String {
    if v == 0.0 {
        return "0".to_owned();
    }
    let log = v.abs().log10();
    let unit = 10f64.powf(log.floor() - 1.0);
    let rounded = (v / unit).round() * unit;
    if (0.01..9999.0).contains(&rounded.abs()) {
        let decimals = (1.0 - log.floor()).max(0.0) as usize;
        let text = format!("{rounded:.decimals$}");
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    } else {
        format!("{v:.1e}").replace(".0e", "e")
    }
}
