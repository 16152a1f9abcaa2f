//! What the solvers have in common: status, counts.

/// How a solve ended. All of these are in an `Ok` report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Status {
    /// The tolerance was reached.
    Converged,
    /// The allowed number of operator products or outer steps was spent. SMALSE ends so where no point of the set
    /// satisfies the equality.
    IterationLimit,
    /// No further progress: the gradient is at the level of rounding errors, above the tolerance. The active-set method
    /// ends so where no point of a fixed set satisfies the equality.
    Stagnated,
    /// The set, as it follows the solution, holds no point that satisfies the equality.
    Infeasible,
}

impl Status {
    /// Whether the tolerance was reached.
    #[must_use]
    pub fn converged(self) -> bool {
        self == Self::Converged
    }
}

/// Numbers that add up, field by field.
macro_rules! counts {
    ($(#[$about:meta])* $name:ident { $($(#[$meaning:meta])* $field:ident,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize))]
        pub struct $name {
            $($(#[$meaning])* pub $field: usize,)*
        }

        impl $name {
            /// All together.
            #[must_use]
            pub fn total(&self) -> usize {
                [$(self.$field),*].iter().sum()
            }
        }

        impl std::ops::AddAssign for $name {
            fn add_assign(&mut self, other: Self) {
                $(self.$field += other.$field;)*
            }
        }
    };
}

counts! {
    /// Steps by kind.
    Steps {
        /// Conjugate gradient steps that stayed inside the set.
        cg,
        /// Expansions of the active set.
        expansion,
        /// Releases from the active set.
        proportioning,
    }
}

counts! {
    /// Operator products by cause.
    Products {
        /// Gradient at the start.
        initial,
        /// Along conjugate gradient directions, those that end in an expansion included.
        cg,
        /// Gradients after expansions.
        expansion,
        /// Products of proportioning steps.
        proportioning,
        /// Repeated steps after a long step that did not decrease the cost.
        fallback,
        /// Gradients computed afresh: against drift, and after the caller changed the set.
        restart,
        /// For the reference of a relative tolerance.
        reference,
    }
}
