//! Hooke's law with a general elasticity tensor, and which law fills which region.
//!
//! Uses: nothing. In: moduli or a tensor, numbers of regions. Out: laws that are symmetric and elliptic.

mod hooke;
mod regions;

pub use hooke::{Hooke, HookeError};
pub use regions::{MaterialError, Materials};
