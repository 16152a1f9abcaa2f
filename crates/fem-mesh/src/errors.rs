//! How errors are written down: once.

/// A number in words, with an exponent where it would have many digits.
pub fn number(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

/// A place in words, with five digits.
pub fn place(place: &[f64; 3]) -> String {
    let [x, y, z] = place.map(|c| number(format!("{c:.4e}").parse().unwrap_or(c)));
    format!("({x}, {y}, {z})")
}

/// What an error says, and what its sources add.
pub fn with_sources(error: &dyn std::error::Error) -> String {
    let mut said = error.to_string();
    let mut next = error.source();
    while let Some(source) = next {
        let text = source.to_string();
        // errors of others may repeat their sources
        if !said.contains(&text) {
            said = format!("{said}: {text}");
        }
        next = source.source();
    }
    said
}

/// Defines an error. A variant is `Name { fields } = "message";`: the message says what is wrong, where, and the
/// remedy; it is the documentation of the variant, too, and what a `main` that returns the error prints. An inner error
/// that it tells is no source beside it: its field is `r#source`, which thiserror does not take for one. Behind `from`
/// stand errors of other crates that are passed on as they are, behind `as` those that are not converted by `?`.
#[doc(hidden)]
#[macro_export]
macro_rules! errors {
    (
        $(#[$about:meta])*
        $name:ident $(from { $($(#[$gate:meta])* $other:ident($error:ty)),* $(,)? })?
            $(as { $($own:ident($own_error:ty)),* })? {
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
            $($(
                /// An error of another crate, as it is.
                $(#[$gate])*
                #[error(transparent)]
                $other(#[from] $error),
            )*)?
            $($(
                /// An error of another crate, as it is.
                #[error(transparent)]
                $own($own_error),
            )*)?
        }

        // errors print their sentence with `{:?}`, too, and what their sources add to it
        impl std::fmt::Debug for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(&$crate::with_sources(self))
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_places_are_short() {
        let told = [0.0, -1.0, 0.3, 1e300, -2.5e-9, f64::NAN].map(number);
        assert_eq!(told, ["0", "-1", "0.3", "1e300", "-2.5e-9", "NaN"]);
        assert_eq!(place(&[1.0 / 3.0, -2.0, 1e-30]), "(0.33333, -2, 1e-30)");
        assert_eq!(place(&[f64::NAN, f64::INFINITY, 123_456.0]), "(NaN, inf, 123460)");
    }
}
