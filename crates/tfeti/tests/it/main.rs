//! The promises of the crate, one module each.

mod active_set;
mod classes;
mod coarse;
mod common;
mod equations;
mod forecast;
mod kernel;
mod levels;
mod linear;
mod operators;
mod preconditioners;
mod processes;
mod refusals;
mod rigid;
mod rows;
mod scratch;
mod sides;
mod single_precision;
mod supports;
