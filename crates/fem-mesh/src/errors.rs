//! How errors are written down: once.

/// Defines an error. A variant is `Name { fields } = "message";`: the message says what is wrong, where, and the
/// remedy; it is the documentation of the variant, too, and what a `main` that returns the error prints.
#[doc(hidden)]
#[macro_export]
macro_rules! errors {
    (
        $(#[$about:meta])*
        $name:ident {
            $(
                $variant:ident $({ $($field:ident: $type:ty),* })? $(($(#[$from:meta])? $inner:ty))?
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
                $variant $({ $(#[allow(missing_docs)] $field: $type),* })? $(($(#[$from])? $inner))?,
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
