//! The promises of this crate, one module each.

mod active_set;
mod allocations;
mod common;
mod equality;
mod flat;
mod interior_point;
mod kkt;
mod kprgp;
mod mehrotra;
mod obstacle_string;
mod radius_slopes;
mod refusals;
mod rounded_steps;
mod sets;
mod smalse;
mod smalse_growth;
