//! Settings: one table a struct, with meaning, setter, default and range; the range is what is documented, checked
//! and named in errors.

use crate::error::QpError;

/// Defines a struct of settings with its setters, defaults and checks.
///
/// A line is `field, setter: type = default, in "range";` after its meaning. A range is an interval like `"(0, 1]"`
/// or `"[1, inf)"`. Behind `or` stands the error whose variant `Setting` refuses, behind `and` the settings inside of
/// these, which check themselves.
#[doc(hidden)]
#[macro_export]
macro_rules! settings {
    (
        $(#[$about:meta])*
        $name:ident or $error:ident {
            $($(#[$meaning:meta])* $field:ident, $setter:ident: $type:ty = $default:expr $(, in $range:literal)?;)*
        }
        $(and $($inner:ident),+)?
    ) => {
        $(#[$about])*
        pub struct $name {
            $(pub(crate) $field: $type,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        impl $name {
            $(
                $(#[$meaning])*
                #[doc = concat!("\n\nDefault ", stringify!($default), $(", range ", $range,)? ".")]
                #[must_use]
                pub fn $setter(mut self, value: $type) -> Self {
                    self.$field = value;
                    self
                }
            )*

            /// Checks the ranges.
            ///
            /// # Errors
            #[doc = concat!("[`", stringify!($error), "::Setting`] with the first setting out of its range.")]
            pub fn validate(&self) -> Result<(), $error> {
                $($(
                    let (name, value, range) = (stringify!($field), self.$field as f64, $range);
                    if !$crate::settings::is_in_range(value, range) {
                        return Err($error::Setting { name, value, range });
                    }
                )?)*
                $($(self.$inner.validate()?;)+)?
                Ok(())
            }
        }
    };
}
pub(crate) use settings;

/// Checks the range of a setting.
pub(crate) fn expect_setting(name: &'static str, value: f64, range: &'static str) -> Result<(), QpError> {
    if is_in_range(value, range) {
        Ok(())
    } else {
        Err(QpError::Setting { name, value, range })
    }
}

/// Whether an interval like `"(0, 1]"` contains a value.
pub fn is_in_range(value: f64, range: &str) -> bool {
    let closed = [range.starts_with('['), range.ends_with(']')];
    let mut ends = range
        .trim_matches(['(', '[', ')', ']'])
        .split(", ")
        .filter_map(|end| end.parse::<f64>().ok());
    let (Some(low), Some(high)) = (ends.next(), ends.next()) else {
        return false;
    };
    (low < value && value < high) || (closed[0] && value == low) || (closed[1] && value == high)
}

#[cfg(test)]
mod tests {
    use super::is_in_range;

    #[test]
    fn ranges_are_read_as_they_are_written() {
        for (range, inside, outside) in [
            ("(0, 1]", [1e-300, 1.0], [0.0, f64::NAN]),
            ("[0, inf)", [0.0, 1e300], [-1e-300, f64::INFINITY]),
            ("[2, 200]", [2.0, 200.0], [1.0, 201.0]),
        ] {
            assert!(inside.iter().all(|v| is_in_range(*v, range)), "{range}");
            assert!(!outside.iter().any(|v| is_in_range(*v, range)), "{range}");
        }
    }
}
