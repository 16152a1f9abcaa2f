//! Files of results: series for ParaView and a table, written step by step.
//!
//! `writer` is the observer, `fields` makes the fields of bodies and surfaces, `table` a row a step. Files take the
//! place of those before at once, so that they are complete at any moment.
//!
//! Uses: `simulation`, `result`, `error`. In: a [`StepResult`](crate::StepResult) a step. Out: files.

mod fields;
mod table;
mod writer;

pub use fields::ResultField;
pub use writer::ResultWriter;
