//! The brick without friction, static: small enough to compare solvers product by product.

use std::io::Write;

use signorini::prelude::*;

use crate::app::strict;
use crate::brick::{GAP, clamped};
use crate::error::ExampleError;
use crate::options::FrictionlessOptions;
use crate::record::{RunRecord, write_json};
use crate::run::{Header, Outcome, pool, run};
use crate::table::warnings;

/// What the best existing code (T-FETI with bounds) needs, to 1e-6.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Subdomains along the short edges.
    pub n: usize,
    /// Pressure on the top, Pa.
    pub traction: f64,
    /// Products of the solve at its best settings.
    pub products: usize,
    /// Products at its defaults.
    pub at_defaults: Option<usize>,
    /// Seconds of solve and set-up on two processes.
    pub seconds: Option<(f64, f64)>,
}

const fn known(n: usize, products: usize, defaults: usize, solve: f64, setup: f64) -> Known {
    Known {
        n,
        traction: 2.5e8,
        products,
        at_defaults: Some(defaults),
        seconds: Some((solve, setup)),
    }
}

const fn higher(n: usize, products: usize) -> Known {
    Known {
        n,
        traction: 1e9,
        products,
        at_defaults: None,
        seconds: None,
    }
}

/// Counts and times of that code.
pub const KNOWN: [Known; 9] = [
    known(1, 126, 151, 0.005, 0.005),
    known(2, 163, 228, 0.041, 0.026),
    known(3, 186, 289, 0.199, 0.095),
    known(4, 208, 373, 0.540, 0.221),
    known(5, 242, 407, 1.250, 0.430),
    higher(2, 165),
    higher(3, 186),
    higher(4, 214),
    higher(5, 223),
];

/// The scene: pressure on the top only, a smooth floor below the gap.
///
/// # Errors
/// [`Error`] for sizes that are 0 or too large.
pub fn scene(n: usize, cells: usize, traction: f64) -> Result<Scene, Error> {
    Ok(clamped(n, cells, 0.0)?
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -traction]))
        .with_contact(Contact::rigid(brick::Z_MIN).with_gap(GAP)))
}

/// Solves all sizes and prints the table.
///
/// # Errors
/// [`ExampleError`] as [`execute`](crate::app::execute).
pub fn execute(
    options: &FrictionlessOptions,
    out: &mut impl Write,
) -> Result<Vec<Outcome>, ExampleError> {
    let pool = pool(options.common.threads)?;
    let mut outcomes = Vec::new();
    for &n in &options.n {
        let scene = scene(n, options.common.cells, options.traction)?;
        let header = Header {
            n,
            loading: "frictionless".to_owned(),
            cells: options.common.cells,
            formula: "static".to_owned(),
            it_name: options.common.method.iterations().to_owned(),
        };
        let settings = options.common.settings();
        outcomes.push(pool.install(|| run(scene, settings, &header, &mut []))?);
    }
    let records: Vec<&RunRecord> = outcomes.iter().map(|o| &o.record).collect();
    print(options, &records, out)?;
    if let Some(path) = &options.common.json {
        write_json(path, records.iter().copied())?;
    }
    strict(options.common.strict, records.into_iter())?;
    Ok(outcomes)
}

fn print(
    options: &FrictionlessOptions,
    records: &[&RunRecord],
    out: &mut impl Write,
) -> Result<(), ExampleError> {
    let method = records.first().map_or("", |r| r.method.as_str());
    writeln!(
        out,
        "frictionless brick, {:e} Pa, method {method}, tolerance {:e}\n",
        options.traction, options.common.tolerance
    )?;
    writeln!(out, "{:72}| best existing code, to 1e-6", "")?;
    writeln!(
        out,
        " n     n_d  touch products (norm)   it  set-up s   solve s  certificate | products  defaults  set-up s   solve s"
    )?;
    for run in records {
        let Some(step) = run.steps.first() else {
            continue;
        };
        write!(
            out,
            "{:>2} {:>7} {:>6} {:>8} {:>6} {:>4} {:>9.3} {:>9.4} {:>12.1e} |",
            run.n,
            run.n_d,
            step.active,
            run.n_m,
            run.n_m_setup,
            run.it,
            run.setup_seconds,
            run.solve_seconds,
            run.largest_certificate
        )?;
        let same = |k: &&Known| k.n == run.n && k.traction == options.traction && run.cells == 5;
        match KNOWN.iter().find(same) {
            Some(k) => {
                let defaults = k.at_defaults.map_or("-".to_owned(), |v| v.to_string());
                let (solve, setup) = k.seconds.map_or(("-".to_owned(), "-".to_owned()), |s| {
                    (format!("{:.3}", s.0), format!("{:.3}", s.1))
                });
                writeln!(
                    out,
                    " {:>8} {defaults:>9} {setup:>9} {solve:>9}",
                    k.products
                )?;
            }
            None => writeln!(out, "        -         -         -         -")?,
        }
    }
    write!(out, "{}", warnings(records))?;
    Ok(())
}
