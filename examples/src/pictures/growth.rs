//! Cost against size: products a step, products and seconds of a run beside the paper's.

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::brick::Loading;
use crate::error::ExampleError;
use crate::paper;
use crate::record::RunRecord;

const SIZE: (u32, u32) = (1080, 380);
const COLOURS: [RGBColor; 2] = [RGBColor(31, 98, 168), RGBColor(214, 39, 40)];
const GREY_: RGBColor = RGBColor(110, 110, 110);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A named curve; those of the paper are grey.
struct Curve {
    name: String,
    colour: RGBColor,
    points: Vec<(f64, f64)>,
}

/// Three charts side by side over the records of one or both loadings. The paper's numbers stand beside them where the
/// records are of the benchmark.
///
/// # Errors
/// [`ExampleError::Picture`] if the drawing library refuses.
pub fn growth(records: &[&RunRecord], standard: bool) -> Result<String, ExampleError> {
    let mut text = String::new();
    draw(records, standard, &mut text).map_err(|reason| ExampleError::Picture {
        what: "the chart of cost against size",
        reason,
    })?;
    Ok(text)
}

fn draw(records: &[&RunRecord], standard: bool, text: &mut String) -> Result<(), String> {
    let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
    root.fill(&WHITE).map_err(|e| e.to_string())?;
    let areas = root.split_evenly((1, 3));
    let [steps, products, seconds] = areas.as_slice() else {
        return Err("the page cannot be split".to_owned());
    };
    let steps_of = |r: &RunRecord| r.steps.len().max(1) as f64;
    let own = curves(records, |r| (r.n as f64, r.n_m as f64 / steps_of(r)));
    linear(steps, "products with F a step", &own)?;
    let size = |r: &RunRecord| (r.n_p as f64).log10();
    let beside = |own: Vec<Curve>, cost: fn(&paper::PaperRow, Loading) -> f64| {
        let mut all = own;
        if standard {
            all.extend(Loading::BOTH.map(|loading| {
                let point =
                    |row: &paper::PaperRow| ((row.n_p as f64).log10(), cost(row, loading).log10());
                Curve {
                    name: format!("paper, {}", loading.name()),
                    colour: GREY_,
                    points: paper::TABLE.iter().map(point).collect(),
                }
            }));
        }
        all
    };
    let own = curves(records, |r| (size(r), (r.n_m as f64).log10()));
    let all = beside(own, |row, loading| row.costs(loading).1 as f64);
    logarithmic(products, "products of the run", &all)?;
    let own = curves(records, |r| {
        let all = r.setup_seconds + r.solve_seconds;
        (size(r), all.max(1e-9).log10())
    });
    let all = beside(own, |row, loading| row.costs(loading).2);
    logarithmic(seconds, "seconds of the run", &all)?;
    root.present().map_err(|e| e.to_string())
}

/// One curve for each loading.
fn curves(records: &[&RunRecord], point: impl Fn(&RunRecord) -> (f64, f64)) -> Vec<Curve> {
    let mut out: Vec<Curve> = Vec::new();
    for record in records {
        let name = format!("loading {}", record.loading);
        let place = out.iter().position(|c| c.name == name);
        let place = place.unwrap_or_else(|| {
            out.push(Curve {
                name,
                colour: COLOURS[out.len() % COLOURS.len()],
                points: Vec::new(),
            });
            out.len() - 1
        });
        out[place].points.push(point(record));
    }
    out
}

fn linear(area: &Area<'_>, title: &str, curves: &[Curve]) -> Result<(), String> {
    let points = || curves.iter().flat_map(|c| &c.points);
    let high = points().map(|p| p.1).fold(1.0, f64::max);
    let last = points().map(|p| p.0).fold(1.0, f64::max);
    let label = |v: &f64| format!("{v}");
    let ranges = [0.0..1.05 * last, 0.0..1.4 * high];
    chart(area, title, "n", ranges, curves, &label)
}

fn logarithmic(area: &Area<'_>, title: &str, curves: &[Curve]) -> Result<(), String> {
    let points = || curves.iter().flat_map(|c| &c.points);
    let range = |value: fn(&(f64, f64)) -> f64, room: f64| {
        let low = points().map(value).fold(f64::INFINITY, f64::min);
        let high = points().map(value).fold(f64::NEG_INFINITY, f64::max);
        match low <= high {
            true => low - 0.2..high + room,
            false => 0.0..1.0,
        }
    };
    let ranges = [range(|p| p.0, 0.2), range(|p| p.1, 1.2)];
    let label = |v: &f64| format!("{:.0e}", 10_f64.powf(*v));
    chart(area, title, "primal unknowns", ranges, curves, &label)
}

fn chart(
    area: &Area<'_>,
    title: &str,
    along: &str,
    [x, y]: [std::ops::Range<f64>; 2],
    curves: &[Curve],
    label: &dyn Fn(&f64) -> String,
) -> Result<(), String> {
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 16))
        .margin(8)
        .margin_right(16)
        .x_label_area_size(36)
        .y_label_area_size(52)
        .build_cartesian_2d(x, y)
        .map_err(|e| e.to_string())?;
    chart
        .configure_mesh()
        .max_light_lines(0)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc(along)
        .x_labels(6)
        .y_labels(7)
        .x_label_formatter(&label)
        .y_label_formatter(&label)
        .label_style(("sans-serif", 12))
        .draw()
        .map_err(|e| e.to_string())?;
    for curve in curves {
        let colour = curve.colour;
        let points = || curve.points.iter().copied();
        chart
            .draw_series(LineSeries::new(points(), colour.stroke_width(2)))
            .map_err(|e| e.to_string())?
            .label(curve.name.as_str())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
        chart
            .draw_series(points().map(|p| Circle::new(p, 3, colour.filled())))
            .map_err(|e| e.to_string())?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.85))
        .border_style(GREY_)
        .label_font(("sans-serif", 12))
        .draw()
        .map_err(|e| e.to_string())
}
