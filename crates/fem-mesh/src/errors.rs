//! How errors are written down: once.

/// Defines an error. A variant is `Name { fields } = "message";`: the message says what is wrong, where, and the
/// remedy; it is the documentation of the variant, too, and what a `main` that returns the error prints. Behind `from`
/// stand errors of other crates that are passed on as they are.
#[doc(hidden)]
#[macro_export]
macro_rules! errors {
    (
        $(#[$about:meta])*
        $name:ident $(from { $($(#[$gate:meta])* $other:ident($error:ty)),* $(,)? })? {
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
            $($(
                /// An error of another crate, as it is.
                $(#[$gate])*
                #[error(transparent)]
                $other(#[from] $error),
            )*)?
        }

        // errors print their sentence with `{:?}`, too, and what their sources add to it
        impl std::fmt::Debug for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                let mut said = self.to_string();
                f.write_str(&said)?;
                let mut next = std::error::Error::source(self);
                while let Some(source) = next {
                    let text = source.to_string();
                    if !said.contains(&text) {
                        write!(f, "\n  because {text}")?;
                        said.push_str(&text);
                    }
                    next = source.source();
                }
                Ok(())
            }
        }
    };
}
