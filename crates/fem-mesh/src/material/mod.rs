//! Hooke's law with a general elasticity tensor, materials by region, and stress-free strain.
//!
//! Uses: nothing. In: moduli or a tensor, numbers of regions. Out: laws that are symmetric and elliptic.

mod eigenstrain;
mod hooke;
mod regions;

pub use eigenstrain::Eigenstrain;
pub use hooke::{Hooke, HookeError};
pub use regions::{MaterialError, Materials};
