//! What can be wrong with the input, and how a solver can break down.

/// Defines an error. A variant is `Name { fields } = "message";`: the message says what is wrong, where, and the
/// remedy; it is the documentation of the variant, too, and what a `main` that returns the error prints.
macro_rules! errors {
    (
        $(#[$about:meta])*
        $name:ident {
            $(
                $variant:ident $({ $($field:ident: $type:ty),* })? $(($inner:ty))?
                = $message:literal $(, $argument:expr)*;
            )*
        }
    ) => {
        $(#[$about])*
        #[derive(thiserror::Error)]
        #[non_exhaustive]
        pub enum $name {
            $(
                #[doc = $message]
                #[error($message $(, $argument)*)]
                $variant $({ $(#[allow(missing_docs)] $field: $type),* })? $(($inner))?,
            )*
        }

        // errors print their sentence with `{:?}`, too
        impl std::fmt::Debug for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                std::fmt::Display::fmt(self, f)
            }
        }
    };
}

errors! {
    /// The data of a convex set are wrong.
    #[derive(Clone, PartialEq)]
    SetError {
        Lengths { segment: usize, lower: usize, upper: usize } =
            "segment {segment}: {lower} lower bounds but {upper} upper bounds; give one of each a component";
        Bounds { segment: usize, entry: usize, lower: f64, upper: f64 } =
            "segment {segment}, component {entry}: no value lies between {lower} and {upper}; put the bounds in \
            order";
        Radius { segment: usize, entry: usize, radius: f64 } =
            "segment {segment}, disc {entry}: the radius {radius} must be at least 0";
        TooLong { segment: usize } =
            "segment {segment}: with it the set has more components than can be counted; make it shorter";
        Kind { segment: usize, wanted: &'static str } =
            "segment {segment} is missing or has no {wanted}; ask for a segment of that kind";
    }
}

errors! {
    /// A solver was given wrong input or broke down. Not reaching a tolerance is no error, see
    /// [`Status`](crate::Status).
    #[derive(Clone, PartialEq)]
    QpError {
        Set(SetError) = "the convex set is wrong: {0}";
        Length { what: &'static str, found: usize, expected: usize } =
            "{what} has length {found}, the operator needs {expected}";
        Setting { name: &'static str, value: f64, range: &'static str } =
            "setting {name} = {value} is outside its range {range}";
        Input { what: &'static str, entry: usize } = "{what} contains NaN or infinity at entry {entry}";
        Scale { entry: usize, value: f64 } =
            "the scale of component {entry} is {value}; that of a constrained component must be positive";
        Slope { disc: usize, component: usize, slope: f64 } =
            "the radius at component {disc} cannot follow component {component} by {slope}; give one finite slope to the \
            first component of a disc, or to an interval symmetric to zero";
        NotFinite { quantity: &'static str, products: usize } =
            "{quantity} became NaN or infinite after {products} products; check the operator and the scale of the \
            data";
        Indefinite { curvature: f64, products: usize } =
            "the operator is not positive semidefinite: curvature {curvature:e} after {products} products";
        Unbounded { products: usize } =
            "the problem is unbounded below: a feasible direction without curvature was met after {products} \
            products; add a constraint or a support";
        CoarseDeficient { motion: String } =
            "the free components do not determine the multiplier of the equality ({motion}); more components must be \
            free, or use smalse";
        DependentRow { row: usize, remainder: f64 } =
            "row {row} of the equality matrix depends on the rows before it (remainder {remainder:e} of its norm); \
            remove it";
        NotSymmetric { row: usize, col: usize, difference: f64 } =
            "the matrix is not symmetric: entries ({row}, {col}) and ({col}, {row}) differ by {difference:e}";
    }
}

impl From<SetError> for QpError {
    fn from(error: SetError) -> Self {
        Self::Set(error)
    }
}

/// Checks a length.
pub(crate) fn expect_length(what: &'static str, found: usize, expected: usize) -> Result<(), QpError> {
    expect_lengths([(what, found, expected)])
}

/// Checks lengths: of what, found and expected.
pub(crate) fn expect_lengths<const N: usize>(lengths: [(&'static str, usize, usize); N]) -> Result<(), QpError> {
    match lengths.into_iter().find(|(_, found, expected)| found != expected) {
        Some((what, found, expected)) => Err(QpError::Length { what, found, expected }),
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
