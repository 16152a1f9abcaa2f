//! What can be wrong with the input, and how a solver can break down.

use thiserror::Error;

/// Errors print their sentence with `{:?}`, too: that is what a user sees of a `main` that returns one.
macro_rules! debug_is_display {
    ($($error:ty),+) => {$(
        impl std::fmt::Debug for $error {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                std::fmt::Display::fmt(self, f)
            }
        }
    )+};
}

debug_is_display!(SetError, QpError);
pub(crate) use debug_is_display;

/// The data of a convex set are wrong.
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SetError {
    /// Lower and upper bounds have different lengths.
    #[error(
        "segment {segment}: {lower} lower bounds but {upper} upper bounds; give one of each a component"
    )]
    Lengths {
        /// Segment of the product.
        segment: usize,
        /// Number of lower bounds.
        lower: usize,
        /// Number of upper bounds.
        upper: usize,
    },
    /// A lower bound above the upper one, NaN, or infinite on the wrong side.
    #[error(
        "segment {segment}, component {entry}: no value lies between {lower} and {upper}; put the bounds in order"
    )]
    Bounds {
        /// Segment of the product.
        segment: usize,
        /// Component within the segment.
        entry: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// A radius is negative or NaN.
    #[error("segment {segment}, disc {entry}: the radius {radius} must be at least 0")]
    Radius {
        /// Segment of the product.
        segment: usize,
        /// Disc within the segment.
        entry: usize,
        /// Its radius.
        radius: f64,
    },
    /// More components than can be counted.
    #[error(
        "segment {segment}: with it the set has more components than can be counted; make it shorter"
    )]
    TooLong {
        /// Segment of the product.
        segment: usize,
    },
    /// Radii or bounds asked of a segment that has none.
    #[error("segment {segment} is missing or has no {wanted}; ask for a segment of that kind")]
    Kind {
        /// Segment of the product.
        segment: usize,
        /// Kind of data asked for.
        wanted: &'static str,
    },
}

/// A solver was given wrong input or broke down. Not reaching a tolerance is no error, see
/// [`Status`](crate::Status).
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum QpError {
    /// The set is wrong.
    #[error("the convex set is wrong: {0}")]
    Set(#[from] SetError),
    /// A slice or operator has the wrong length.
    #[error("{what} has length {found}, the operator needs {expected}")]
    Length {
        /// The argument.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length that fits.
        expected: usize,
    },
    /// A setting is out of its range.
    #[error("setting {name} = {value} is outside its range {range}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// NaN or infinity in an argument.
    #[error("{what} contains NaN or infinity at entry {entry}")]
    Input {
        /// The argument.
        what: &'static str,
        /// First bad entry.
        entry: usize,
    },
    /// NaN or infinity appeared in the iteration.
    #[error(
        "{quantity} became NaN or infinite after {products} products; check the operator and the scale of the data"
    )]
    NotFinite {
        /// The quantity.
        quantity: &'static str,
        /// Operator products so far.
        products: usize,
    },
    /// A direction of clearly negative curvature was met.
    #[error(
        "the operator is not positive semidefinite: curvature {curvature:e} after {products} products"
    )]
    Indefinite {
        /// `p·Ap / p·p`.
        curvature: f64,
        /// Operator products so far.
        products: usize,
    },
    /// The cost decreases for ever along a direction without curvature.
    #[error(
        "the problem is unbounded below: a feasible direction without curvature was met after {products} products; add a constraint or a support"
    )]
    Unbounded {
        /// Operator products so far.
        products: usize,
    },
    /// The free components leave a combination of the equality rows without weight.
    #[error(
        "the free components do not determine the multiplier of the equality ({motion}); more components must be free, or use smalse"
    )]
    CoarseDeficient {
        /// What stays undetermined, in the words of the projector.
        motion: String,
    },
    /// A row of an equality matrix depends on the rows before it.
    #[error(
        "row {row} of the equality matrix depends on the rows before it (remainder {remainder:e} of its norm); remove it"
    )]
    DependentRow {
        /// The row.
        row: usize,
        /// Norm of its part orthogonal to the rows before, relative to its norm.
        remainder: f64,
    },
    /// A dense matrix is not symmetric.
    #[error(
        "the matrix is not symmetric: entries ({row}, {col}) and ({col}, {row}) differ by {difference:e}"
    )]
    NotSymmetric {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        col: usize,
        /// Difference of the two entries.
        difference: f64,
    },
}

/// Checks a length.
pub(crate) fn expect_length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), QpError> {
    expect_lengths([(what, found, expected)])
}

/// Checks lengths: of what, found and expected.
pub(crate) fn expect_lengths<const N: usize>(
    lengths: [(&'static str, usize, usize); N],
) -> Result<(), QpError> {
    match lengths
        .into_iter()
        .find(|(_, found, expected)| found != expected)
    {
        Some((what, found, expected)) => Err(QpError::Length {
            what,
            found,
            expected,
        }),
        None => Ok(()),
    }
}

/// Checks that all entries are finite.
pub(crate) fn expect_finite(what: &'static str, x: &[f64]) -> Result<(), QpError> {
    match x.iter().position(|v| !v.is_finite()) {
        Some(entry) => Err(QpError::Input { what, entry }),
        None => Ok(()),
    }
}
