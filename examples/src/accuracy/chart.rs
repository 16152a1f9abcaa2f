//! Error against cost on logarithmic axes: displacement, force and work side by side; products above, seconds below.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::{Curve, Sample, Study};
use crate::error::ExampleError;

const SIZE: (u32, u32) = (1080, 640);
const COLOURS: [RGBColor; 6] = [
    RGBColor(31, 98, 168),
    RGBColor(214, 39, 40),
    RGBColor(44, 140, 60),
    RGBColor(150, 90, 180),
    RGBColor(225, 130, 20),
    RGBColor(110, 110, 110),
];
const ERRORS: [&str; 3] = ["displacement", "contact force", "work of friction"];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// The chart of a study as SVG.
pub(super) fn draw(study: Study, curves: &[Curve]) -> Result<String, ExampleError> {
    let mut text = String::new();
    page(study, curves, &mut text).map_err(|reason| ExampleError::Picture {
        what: "the chart of errors against cost",
        reason,
    })?;
    Ok(text)
}

fn page(study: Study, curves: &[Curve], text: &mut String) -> Result<(), String> {
    let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
    root.fill(&WHITE).map_err(|e| e.to_string())?;
    let (legend, charts) = root.split_vertically(46);
    names(&legend, study, curves)?;
    let products: fn(&Sample) -> f64 = |s| s.products as f64;
    let seconds: fn(&Sample) -> f64 = |s| s.seconds;
    let costs = [
        ("products with F", products),
        ("seconds, set-up apart", seconds),
    ];
    for (k, area) in charts.split_evenly((2, 3)).iter().enumerate() {
        let (label, cost) = costs[k / 3];
        panel(area, curves, k % 3, label, cost)?;
    }
    root.present().map_err(|e| e.to_string())
}

fn names(area: &Area<'_>, study: Study, curves: &[Curve]) -> Result<(), String> {
    let style = |size: i32| TextStyle::from(("sans-serif", size).into_font());
    let along = match study {
        Study::Mesh => "Curves run along the cell size.",
        Study::Time => "Curves run along the time step.",
        Study::Effects => "One point for each scene.",
        Study::Tolerance | Study::Method => "Curves run along the tolerance.",
    };
    let title = format!(
        "Study {}: relative error against cost. {along}",
        study.name()
    );
    area.draw_text(&title, &style(16), (12, 6))
        .map_err(|e| e.to_string())?;
    let mut x = 12;
    for (k, curve) in curves.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        area.draw(&PathElement::new(
            [(x, 36), (x + 20, 36)],
            colour.stroke_width(2),
        ))
        .map_err(|e| e.to_string())?;
        area.draw(&Circle::new((x + 10, 36), 3, colour.filled()))
            .map_err(|e| e.to_string())?;
        area.draw_text(&curve.name, &style(13), (x + 26, 29))
            .map_err(|e| e.to_string())?;
        x += 50 + 7 * curve.name.chars().count() as i32;
    }
    Ok(())
}

fn panel(
    area: &Area<'_>,
    curves: &[Curve],
    which: usize,
    label: &str,
    cost: fn(&Sample) -> f64,
) -> Result<(), String> {
    let points: Vec<Vec<(f64, f64)>> = curves
        .iter()
        .map(|c| {
            let all = c.samples.iter().map(|s| (cost(s), s.errors.get(which)));
            // zeros and missing values have no logarithm
            all.filter(|p| p.0 > 0.0 && p.1 > 0.0)
                .map(|p| (p.0.log10(), p.1.log10()))
                .collect()
        })
        .collect();
    let x = range(points.iter().flatten().map(|p| p.0));
    let y = range(points.iter().flatten().map(|p| p.1));
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .margin_right(16)
        .x_label_area_size(38)
        .y_label_area_size(58)
        .build_cartesian_2d(x, y)
        .map_err(|e| e.to_string())?;
    chart
        .configure_mesh()
        .max_light_lines(0)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc(label)
        .y_desc(ERRORS[which])
        .x_labels(6)
        .y_labels(8)
        .x_label_formatter(&|v| short(*v))
        .y_label_formatter(&|v| short(*v))
        .label_style(("sans-serif", 12))
        .draw()
        .map_err(|e| e.to_string())?;
    for (k, line) in points.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        chart
            .draw_series(LineSeries::new(
                line.iter().copied(),
                colour.stroke_width(2),
            ))
            .map_err(|e| e.to_string())?;
        chart
            .draw_series(line.iter().map(|p| Circle::new(*p, 3, colour.filled())))
            .map_err(|e| e.to_string())?;
    }
    Ok(())
}

/// A range a little wider than the values.
fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    if low > high {
        return -1.0..1.0;
    }
    let room = (0.06 * (high - low)).max(0.1);
    low - room..high + room
}

/// A logarithm as its number with two digits: 0.025, 3, 500, 2e4.
fn short(log: f64) -> String {
    let v = 10f64.powf(log);
    let unit = 10f64.powf(log.floor() - 1.0);
    let rounded = (v / unit).round() * unit;
    if (0.01..9999.0).contains(&rounded) {
        let decimals = (1.0 - log.floor()).max(0.0) as usize;
        let text = format!("{rounded:.decimals$}");
        match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            false => text,
        }
    } else {
        let text = format!("{v:.1e}");
        text.replace(".0e", "e")
    }
}
