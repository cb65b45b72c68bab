//! Link parameters and virtual device settings, given as keys with values. The `parameters!` macro declares one
//! parameter per line and creates a struct that can be parsed, validated, printed and offered as a form. A type that
//! implements [`ParameterValues`] defines the allowed values.

mod values;

use crate::expected::AllowedValues;

pub use values::{
    ANY, CustomNotation, DecimalNumbers, Keywords, Milliseconds, Millivolts, OptionalValue, ParameterValues, SWITCH,
    WholeNumbers, parse_whole,
};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RejectedParameter {
    pub key: String,
    /// The rejected value as entered.
    pub value: String,
    pub allowed: AllowedValues,
}

impl RejectedParameter {
    /// Creates an error for a rejected value. `allowed` describes the accepted values.
    pub fn new(key: &str, value: impl ToString, allowed: AllowedValues) -> Self {
        RejectedParameter { key: key.to_owned(), value: value.to_string(), allowed }
    }

    /// Replaces a secret value with asterisks.
    #[must_use]
    pub fn masked(self) -> Self {
        RejectedParameter { value: "**".to_owned(), ..self }
    }
}

/// A parameter that a user can type into a form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    pub key: &'static str,
    pub label: &'static str,
    /// Unit symbol. Empty if the parameter has no unit.
    pub unit: &'static str,
    /// Hint in an empty entry: the default that applies, or an example.
    pub hint: String,
    pub is_decimal: bool,
}

/// Returns the entries with these keys, in the order of `keys`.
pub fn select_entries(entries: &[Entry], keys: &[&str]) -> Vec<Entry> {
    keys.iter().filter_map(|key| entries.iter().find(|own| own.key == *key).cloned()).collect()
}

/// A group of parameters, declared with `parameters!`. Parameters that are not given keep their defaults.
pub trait ParameterGroup: Default {
    /// The error returned when a value is rejected.
    type Error;

    const KEYS: &'static [&'static str];

    /// Keys whose values are neither displayed nor stored.
    const SECRETS: &'static [&'static str];

    /// Sets the value of a key. Returns `false` if there is no such key.
    ///
    /// # Errors
    /// Returns an error if the key does not accept the value.
    fn set_value(&mut self, key: &str, value: &str) -> Result<bool, Self::Error>;

    /// Returns the form entries that a user can fill in, in order of declaration.
    fn entries() -> Vec<Entry>;

    /// Parses the known keys and ignores all others. If a key is repeated, the last value is used.
    ///
    /// # Errors
    /// Returns an error for the first value that its key does not accept.
    fn read(pairs: &[(String, String)]) -> Result<Self, Self::Error> {
        let mut own = Self::default();
        for (key, value) in pairs {
            own.set_value(key, value)?;
        }
        Ok(own)
    }
}

/// Declares a struct of parameters:
///
/// ```ignore
/// parameters! {
///     /// Location of a device behind a gateway.
///     pub struct Place: UrlError {
///         /// Unit to request from the gateway.
///         pub unit: u8 = 1, "unit" => Whole(Quantity::Unit, 0..=255), "connect.unit";
///         pub known: bool = false;
///     }
/// }
/// ```
///
/// Each line has a field, its type, its default, a key and its [`ParameterValues`]. If the parameter has a form entry,
/// its label follows, with an example after `like` if the default is not helpful. A line without a key declares a field
/// that is not a parameter. The value of a key preceded by `secret` is neither displayed nor stored.
#[macro_export]
macro_rules! parameters {
    (@hint $values:expr, $default:expr) => {
        ($values).format_example(&$default)
    };
    (@hint $values:expr, $default:expr, $example:literal) => {
        $example.to_owned()
    };
    (@take $key:ident, $value:ident, $values:expr) => {
        ($values).parse_value($key, $value)
    };
    (@take $key:ident, $value:ident, $values:expr, secret) => {
        ($values).parse_value($key, $value).map_err($crate::parameter::RejectedParameter::masked)
    };
    (@secret secret $key:literal) => {
        $key
    };
    (
        $(#[$meta:meta])*
        $vis:vis struct $name:ident: $error:ty {
            $(
                $(#[$doc:meta])*
                $own:vis $field:ident: $type:ty = $default:expr
                $(, $($secret:ident)? $key:literal => $values:expr $(, $label:literal $(like $example:literal)?)?)?;
            )*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        $vis struct $name {
            $($(#[$doc])* $own $field: $type,)*
        }

        impl Default for $name {
            fn default() -> Self {
                $name { $($field: $default,)* }
            }
        }

        #[allow(dead_code, reason = "not all are asked for their keys")]
        impl $name {
            $vis const KEYS: &'static [&'static str] = &[$($($key,)?)*];
        }

        impl $crate::parameter::ParameterGroup for $name {
            type Error = $error;

            const KEYS: &'static [&'static str] = $name::KEYS;

            const SECRETS: &'static [&'static str] = &[$($($($crate::parameters!(@secret $secret $key),)?)?)*];

            fn set_value(&mut self, key: &str, value: &str) -> Result<bool, $error> {
                #[allow(unused_imports, reason = "some have values of their own alone")]
                use $crate::parameter::ParameterValues as _;
                match key {
                    $($($key => self.$field = $crate::parameters!(@take key, value, $values $(, $secret)?)?,)?)*
                    _ => return Ok(false),
                }
                Ok(true)
            }

            fn entries() -> Vec<$crate::parameter::Entry> {
                #[allow(unused_imports, reason = "some have no entries")]
                use $crate::parameter::ParameterValues as _;
                vec![$($($($crate::parameter::Entry {
                    key: $key,
                    label: $label,
                    unit: ($values).unit(),
                    hint: $crate::parameters!(@hint $values, $default $(, $example)?),
                    is_decimal: ($values).is_decimal(),
                },)?)?)*]
            }
        }
    };
}
