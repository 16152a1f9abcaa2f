//! What happened over time: nodes in contact, forces, cost and certificate of the steps.

use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

use crate::error::ExampleError;
use crate::record::{RunRecord, StepRecord};

const SIZE: (u32, u32) = (900, 980);
const BLUE_: RGBColor = RGBColor(31, 98, 168);
const RED_: RGBColor = RGBColor(214, 39, 40);
const GREEN_: RGBColor = RGBColor(44, 140, 60);
const GREY_: RGBColor = RGBColor(110, 110, 110);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Curve<'a> = (&'a str, RGBColor, Vec<(f64, f64)>);

/// Four charts over time, one below the other.
///
/// # Errors
/// [`ExampleError::Picture`] if the drawing library refuses.
pub fn steps(record: &RunRecord) -> Result<String, ExampleError> {
    let mut text = String::new();
    draw(record, &mut text).map_err(|reason| ExampleError::Picture {
        what: "the chart of the steps",
        reason,
    })?;
    Ok(text)
}

fn draw(record: &RunRecord, text: &mut String) -> Result<(), String> {
    let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
    root.fill(&WHITE).map_err(|e| e.to_string())?;
    let rows = root.split_evenly((4, 1));
    let [nodes, forces, cost, quality] = rows.as_slice() else {
        return Err("the page cannot be split".to_owned());
    };
    let curve = |value: fn(&StepRecord) -> f64| -> Vec<(f64, f64)> {
        record.steps.iter().map(|s| (s.t, value(s))).collect()
    };
    let title = format!(
        "n = {}, loading {}, method {}: nodes of the contact surface",
        record.n, record.loading, record.method
    );
    linear(
        nodes,
        &title,
        "nodes",
        &[
            ("in contact", GREY_, curve(|s| s.active as f64)),
            ("stick", BLUE_, curve(|s| s.stick as f64)),
            ("slip", RED_, curve(|s| s.slip as f64)),
        ],
    )?;
    linear(
        forces,
        "contact forces on the body",
        "MN",
        &[
            ("normal", GREY_, curve(|s| 1e-6 * s.normal_force)),
            (
                "friction along x1",
                RED_,
                curve(|s| 1e-6 * s.tangential_force[0]),
            ),
        ],
    )?;
    linear(
        cost,
        &format!("cost of the steps: products with F, and {}", record.it_name),
        "a step",
        &[
            ("products", BLUE_, curve(|s| s.n_m as f64)),
            (record.it_name.as_str(), GREEN_, curve(|s| s.it as f64)),
        ],
    )?;
    logarithmic(
        quality,
        "certificate: largest relative violation of all conditions",
        "relative",
        &[
            ("certificate", BLUE_, curve(|s| s.certificate)),
            (
                "tolerance",
                GREY_,
                record
                    .steps
                    .iter()
                    .map(|s| (s.t, record.tolerance))
                    .collect(),
            ),
        ],
    )?;
    root.present().map_err(|e| e.to_string())
}

fn linear(area: &Area<'_>, title: &str, unit: &str, curves: &[Curve<'_>]) -> Result<(), String> {
    let values = || curves.iter().flat_map(|c| c.2.iter().map(|p| p.1));
    let high = values().fold(0.0, f64::max);
    let low = values().fold(0.0, f64::min);
    // room for the legend
    let room = 0.45 * (high - low).max(1e-9);
    let low = if low < 0.0 { low - 0.15 * room } else { 0.0 };
    chart(area, title, unit, low..high + room, curves, &|v| {
        format!("{v}")
    })
}

fn logarithmic(
    area: &Area<'_>,
    title: &str,
    unit: &str,
    curves: &[Curve<'_>],
) -> Result<(), String> {
    // zeros have no logarithm: steps without contact are left out
    let curves: Vec<Curve<'_>> = curves
        .iter()
        .map(|(n, c, v)| (*n, *c, v.iter().copied().filter(|p| p.1 > 0.0).collect()))
        .collect();
    let values = || curves.iter().flat_map(|c| c.2.iter().map(|p| p.1));
    let high = 300.0 * values().fold(1e-12, f64::max);
    let low = values().fold(high, f64::min) / 3.0;
    chart(area, title, unit, (low..high).log_scale(), &curves, &|v| {
        format!("{v:.0e}")
    })
}

fn chart<Y>(
    area: &Area<'_>,
    title: &str,
    unit: &str,
    range: Y,
    curves: &[Curve<'_>],
    label: &dyn Fn(&f64) -> String,
) -> Result<(), String>
where
    Y: AsRangedCoord<Value = f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let end = curves
        .iter()
        .flat_map(|c| c.2.last())
        .map(|p| p.0)
        .fold(0.0, f64::max);
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 17))
        .margin(10)
        .margin_right(20)
        .x_label_area_size(34)
        .y_label_area_size(66)
        .build_cartesian_2d(0.0..end.max(1e-9), range)
        .map_err(|e| e.to_string())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc("t in s")
        .y_desc(unit)
        .y_labels(6)
        .y_label_formatter(&label)
        .label_style(("sans-serif", 13))
        .draw()
        .map_err(|e| e.to_string())?;
    for (name, colour, points) in curves {
        let colour = *colour;
        chart
            .draw_series(LineSeries::new(
                points.iter().copied(),
                colour.stroke_width(2),
            ))
            .map_err(|e| e.to_string())?
            .label(*name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.85))
        .border_style(GREY_)
        .label_font(("sans-serif", 13))
        .draw()
        .map_err(|e| e.to_string())
}
