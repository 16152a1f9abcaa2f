//! The curves as tables and CSV.

use std::fmt::Write as _;

use signorini_studies::Failure;
use signorini_studies::record::columns;

use super::{Curve, Sample, Study};

// Writing to a string cannot fail, so the results of `write!` are dropped.

/// The curves of a study as text.
pub(super) fn text(study: Study, curves: &[Curve]) -> String {
    let mut out = String::new();
    let reference = curves.first().map_or("", |c| c.reference.as_str());
    let _ = writeln!(out, "\nstudy {}; reference: {reference}", study.name());
    for curve in curves {
        let _ = writeln!(
            out,
            "  {}\n  {:>10} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>11} {:>9}",
            curve.name,
            curve.parameter,
            "products",
            "set-up s",
            "solve s",
            "error u",
            "force",
            "work",
            "certificate",
            "estimate"
        );
        for s in &curve.samples {
            let estimate = s.estimate.map_or("-".to_owned(), |e| format!("{e:.1e}"));
            let _ = writeln!(
                out,
                "  {:>10.3e} {:>9} {:>9.3} {:>9.3} {:>9.1e} {:>9.1e} {:>9.1e} {:>11.1e} {estimate:>9}{}",
                s.parameter,
                s.products,
                s.setup_seconds,
                s.seconds,
                s.errors.u,
                s.errors.force,
                s.errors.work,
                s.certificate,
                if s.unconverged > 0 {
                    format!("  {} STEPS NOT CONVERGED", s.unconverged)
                } else {
                    String::new()
                }
            );
        }
        if curve.samples.len() > 1 {
            let o = &curve.orders;
            let _ = writeln!(
                out,
                "  order in the parameter: u {:.2}, force {:.2}, work {:.2}",
                o.u, o.force, o.work
            );
        }
    }
    for curve in curves {
        if let Some((products, seconds)) = cost_of_six_digits(curve) {
            let _ = writeln!(
                out,
                "  {}: from certificate 1e-4 to 1e-10 costs {products:.2} times the products, {seconds:.2} times the time",
                curve.name
            );
        }
    }
    out
}

/// Cost of a certificate of 1e-10 over that of 1e-4, products and seconds, interpolated along the curve in the
/// logarithm of the certificate; `None` for curves that do not span them.
fn cost_of_six_digits(curve: &Curve) -> Option<(f64, f64)> {
    let at = |certificate: f64, cost: fn(&Sample) -> f64| {
        curve.samples.windows(2).find_map(|pair| {
            let [a, b] = [&pair[0], &pair[1]].map(|s| (s.certificate.ln(), cost(s)));
            let x = (certificate.ln() - a.0) / (b.0 - a.0);
            (0.0..=1.0).contains(&x).then_some(a.1 + x * (b.1 - a.1))
        })
    };
    let ratio = |cost| Some(at(1e-10, cost)? / at(1e-4, cost)?);
    Some((ratio(|s| s.products as f64)?, ratio(|s| s.seconds)?))
}

/// Columns of [`csv`]: those of a curve, and those of a sample.
const COLUMNS: &str = "study,curve=name,parameter_name=parameter,parameter=sample/parameter,products=sample/products,\
                       setup_seconds=sample/setup_seconds,seconds=sample/seconds,error_u=sample/errors/u,\
                       error_force=sample/errors/force,error_work=sample/errors/work,certificate=sample/certificate,\
                       unconverged=sample/unconverged,estimate=sample/estimate,order_u=orders/u,\
                       order_force=orders/force,order_work=orders/work,reference";

/// All samples, one a line.
pub(super) fn csv(curves: &[Curve]) -> Result<String, Failure> {
    let mut rows = Vec::new();
    for curve in curves {
        for sample in &curve.samples {
            let mut row = serde_json::to_value(Curve {
                samples: Vec::new(),
                ..curve.clone()
            })?;
            row["sample"] = serde_json::to_value(sample)?;
            rows.push(row);
        }
    }
    Ok(columns(COLUMNS, &rows))
}
