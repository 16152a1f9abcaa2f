//! A progress bar a run: step, touching nodes, products.

use indicatif::{ProgressBar, ProgressStyle};
use signorini::prelude::Simulation;

use crate::error::ExampleError;
use crate::record::{RunRecord, StepRecord};
use crate::run::Sink;

const TEMPLATE: &str = "{prefix:10} [{bar:30}] {pos:>3}/{len} {elapsed:>4} {msg}";

/// Shows a run on the terminal. On a stream that is no terminal it prints one line at the end.
#[derive(Debug, Default)]
pub struct Progress {
    bar: Option<ProgressBar>,
    products: usize,
    unconverged: usize,
}

impl Sink for Progress {
    fn started(&mut self, label: &str, simulation: &Simulation) -> Result<(), ExampleError> {
        let bar = ProgressBar::new(simulation.plan().steps as u64);
        let style = ProgressStyle::with_template(TEMPLATE)
            .unwrap_or_else(|_| ProgressStyle::default_bar())
            .progress_chars("=> ");
        bar.set_style(style);
        bar.set_prefix(label.to_owned());
        self.products = 0;
        self.unconverged = 0;
        self.bar = Some(bar);
        Ok(())
    }

    fn step(&mut self, _: &Simulation, step: &StepRecord) -> Result<(), ExampleError> {
        self.products += step.n_m;
        self.unconverged += usize::from(!step.converged());
        if let Some(bar) = &self.bar {
            let (active, slip) = (step.active, step.slip);
            let products = self.products;
            let failed = failed(self.unconverged);
            bar.set_message(format!(
                "{active} touch, {slip} slide, {products} products{failed}"
            ));
            bar.inc(1);
        }
        Ok(())
    }

    fn finished(&mut self, record: &RunRecord) -> Result<(), ExampleError> {
        let Some(bar) = self.bar.take() else {
            return Ok(());
        };
        if bar.is_hidden() {
            let (steps, products) = (record.steps.len(), record.n_m);
            eprintln!(
                "n{}-{}: {steps} steps, {products} products, {:.2} s{}",
                record.n,
                record.loading,
                record.solve_seconds,
                failed(record.unconverged.len())
            );
        }
        bar.finish();
        Ok(())
    }
}

/// Words for levels that did not converge, none if all did.
fn failed(levels: usize) -> String {
    match levels {
        0 => String::new(),
        levels => format!(", {levels} NOT CONVERGED"),
    }
}
