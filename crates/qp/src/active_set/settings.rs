//! Settings and report of [`active_set`](crate::active_set()).

use crate::error::QpError;
use crate::report::Status;
use crate::settings::settings;

settings! {
    /// Settings of [`active_set`](crate::active_set()). All but the floors are dimensionless.
    #[derive(Debug, Clone, PartialEq)]
    ActiveSetSettings or QpError {
        /// Estimated error of `x` relative to its norm, and of its constrained part relative to its own.
        tolerance, with_tolerance: f64 = 1e-7, in "(0, 1)";
        /// Norm of `x` that errors are at least relative to: what a vanishing solution is measured against.
        error_floor, with_error_floor: f64 = 0.0, in "[0, inf)";
        /// The same for the constrained part, which is measured against 1e-4 of the norm of `x` in any case.
        contact_error_floor, with_contact_error_floor: f64 = 0.0, in "[0, inf)";
        /// Decrease of the error on one active set before the set is looked at again.
        forcing, with_forcing: f64 = 0.4, in "(0, 1)";
        /// Active sets without a better error after which it ends as [`Status::Stagnated`]. Beyond twelve, paths to
        /// other sets are tried first.
        patience, with_patience: usize = usize::MAX, in "[1, inf)";
        /// Most active sets; five times as many once a path has led to another set.
        max_active_sets, with_max_active_sets: usize = 100, in "[1, inf)";
        /// Most operator products.
        max_products, with_max_products: usize = 10_000, in "[1, inf)";
    }
}

impl ActiveSetSettings {
    /// With no more products than these.
    #[must_use]
    pub fn limited_to(mut self, products: usize) -> Self {
        self.max_products = self.max_products.min(products);
        self
    }
}

/// What [`active_set`](crate::active_set()) did.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use = "it may not have converged: see `status`"]
pub struct ActiveSetReport {
    /// How it ended.
    pub status: Status,
    /// Active sets on which conjugate gradients ran.
    pub active_sets: usize,
    /// Conjugate gradient steps, one product each.
    pub cg_steps: usize,
    /// Products after a change of the active set and at the start, to keep `A x` exact.
    pub corrections: usize,
    /// Applications of the preconditioner.
    pub preconditionings: usize,
    /// Factorisations of `G W Gᵀ`.
    pub factorisations: usize,
    /// How often the set may have moved.
    pub hook_calls: usize,
    /// Last estimated error of `x`, relative to the norm of `x`.
    pub error: f64,
    /// Last estimated error of the constrained components, relative to their norm.
    pub(crate) constrained_error: f64,
}

impl ActiveSetReport {
    pub(crate) fn new() -> Self {
        Self {
            status: Status::IterationLimit,
            active_sets: 0,
            cg_steps: 0,
            corrections: 0,
            preconditionings: 0,
            factorisations: 0,
            hook_calls: 0,
            error: f64::INFINITY,
            constrained_error: f64::INFINITY,
        }
    }

    /// All operator products.
    #[must_use]
    pub fn products(&self) -> usize {
        self.cg_steps + self.corrections
    }
}
