//! Decks: what they say, that it is the same as what a program says, and what is refused.

mod assembly;
mod between;
#[path = "../../../fem-mesh/tests/it/grid.rs"]
mod boxes;
mod broken;
mod cells;
mod couplings;
mod equation;
mod gaps;
mod grid;
mod meaning;
mod names;
mod orientation;
mod pretension;
mod reading;
mod refusals;
mod rigid;
mod same_bits;
mod stages;
mod surfaces;
mod temperatures;
mod ties;
mod transforms;
mod volume;
mod write;

// for the grid of cells
use signorini_fem_mesh::mesh::CellShape;
