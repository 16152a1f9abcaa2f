//! Files of results: series for ParaView and a table, written step by step.
//!
//! `writer` is the observer, `fields` makes the fields of bodies and surfaces, `table` a row per step. Files are
//! replaced atomically, so that they are complete at any moment.
//!
//! Uses: `simulation`, `result`, `error`. In: a [`StepResult`](crate::StepResult) per step. Out: files.

mod fields;
mod table;
mod writer;

pub use fields::ResultField;
pub use writer::ResultWriter;
