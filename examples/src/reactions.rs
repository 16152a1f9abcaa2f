//! What supports, floor and loads do to the body at the end of a run.

use std::fmt::Write as _;

use signorini::contact::Resultant;
use signorini::prelude::Simulation;

use crate::error::ExampleError;
use crate::record::StepRecord;
use crate::run::Sink;

/// Writes a table of the forces on the body, and their moments about the origin, at the last level.
#[derive(Debug, Default)]
pub struct ReactionTable {
    label: String,
    levels: usize,
    text: String,
}

impl ReactionTable {
    /// The table; empty before the last level.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl Sink for ReactionTable {
    fn started(&mut self, label: &str, simulation: &Simulation) -> Result<(), ExampleError> {
        self.label = label.to_owned();
        self.levels = simulation.plan().steps;
        self.text.clear();
        Ok(())
    }

    fn step(&mut self, simulation: &Simulation, step: &StepRecord) -> Result<(), ExampleError> {
        if step.step < self.levels {
            return Ok(());
        }
        let frame = simulation.result().ok_or(ExampleError::NoLevel)?;
        let reactions = frame.reactions();
        let text = &mut self.text;
        let _ = writeln!(
            text,
            "{} at {} s, on the body: forces along x, y, z in N and moments about the axes in N m",
            self.label,
            frame.time()
        );
        let mut line = |name: &str, r: &Resultant| {
            let [x, y, z] = r.force;
            let [a, b, c] = r.moment;
            let _ = writeln!(
                text,
                "  {name:12} {x:>12.4e} {y:>12.4e} {z:>12.4e}   {a:>12.4e} {b:>12.4e} {c:>12.4e}"
            );
        };
        for (k, support) in reactions.supports.iter().enumerate() {
            line(&format!("support {k}"), &support.resultant);
        }
        line("floor", &reactions.contact);
        line("loads", &reactions.loads);
        line("sum", &reactions.imbalance());
        Ok(())
    }
}
