//! Hooke's law with a general elasticity tensor, which law fills which region, and strain without stress.
//!
//! Uses: nothing. In: moduli or a tensor, numbers of regions. Out: laws that are symmetric and elliptic.

mod free_strain;
mod hooke;
mod regions;

pub use free_strain::FreeStrain;
pub use hooke::{Hooke, HookeError};
pub use regions::{MaterialError, Materials};
