//! The facade: programs that know it alone, and the ways to be wrong.

mod bad_input;
mod facade;
mod oblique_supports;
