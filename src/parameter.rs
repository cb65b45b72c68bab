//! Parameters of a link and settings of a virtual device as keys with values. The `parameters!` macro creates a struct
//! with one line per parameter, from which parameters are parsed, validated, printed and offered in a form. The allowed
//! values are a type that implements [`Values`].

mod values;

use crate::expected::Expected;

pub use values::{ANY, Checked, Decimal, Maybe, Milliseconds, Millivolts, SWITCH, Values, Whole, Words, number};

/// A value that a parameter does not take.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    pub key: String,
    /// The value as it was written.
    pub value: String,
    pub allowed: Expected,
}

impl Refused {
    /// Creates the error for `value`; `allowed` are the possible values.
    pub fn new(key: &str, value: impl ToString, allowed: Expected) -> Self {
        Refused { key: key.to_owned(), value: value.to_string(), allowed }
    }

    /// Returns it without the value, which is a secret.
    #[must_use]
    pub fn masked(self) -> Self {
        Refused { value: "**".to_owned(), ..self }
    }
}

/// A parameter that a user can type into a form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    pub key: &'static str,
    pub label: &'static str,
    /// The symbol of the unit; empty if there is none.
    pub unit: &'static str,
    /// The default while the entry is empty, or an example.
    pub hint: String,
    /// Whether it is a number that may have a decimal point.
    pub is_decimal: bool,
}

/// Returns the entries with these keys, in the order of the keys.
pub fn chosen(entries: &[Entry], keys: &[&str]) -> Vec<Entry> {
    keys.iter().filter_map(|key| entries.iter().find(|own| own.key == *key).cloned()).collect()
}

/// A group of parameters, made by `parameters!`. The default applies to those that are not given.
pub trait Parameters: Default {
    /// The reason why a value is refused.
    type Error;

    /// Their keys, in the order in which they are declared.
    const KEYS: &'static [&'static str];

    /// The keys among them whose values are neither shown nor kept.
    const SECRETS: &'static [&'static str];

    /// Sets a value; returns false if the key does not exist.
    ///
    /// # Errors
    /// Returns an error if the key does not take the value.
    fn set(&mut self, key: &str, value: &str) -> Result<bool, Self::Error>;

    /// Returns the entries that a user can type, in the order of declaration.
    fn entries() -> Vec<Entry>;

    /// Parses the existing keys; others are ignored. Of a key given twice the last one counts.
    ///
    /// # Errors
    /// Returns the first value that its key does not take.
    fn read(pairs: &[(String, String)]) -> Result<Self, Self::Error> {
        let mut own = Self::default();
        for (key, value) in pairs {
            own.set(key, value)?;
        }
        Ok(own)
    }
}

/// Declares a struct of parameters:
///
/// ```ignore
/// parameters! {
///     /// The gateway.
///     pub struct Place: UrlError {
///         /// The unit that the gateway is asked for.
///         pub unit: u8 = 1, "unit" => Whole(Quantity::Unit, 0..=255), "connect.unit";
///         pub known: bool = false;
///     }
/// }
/// ```
///
/// A line has field, type, default, key and [`Values`]; then, for a form, the text that names the entry, with an example
/// after `like` where the default says little. A line without a key is a field and no parameter. The value of a key with
/// `secret` before it is neither shown nor kept.
#[macro_export]
macro_rules! parameters {
    (@hint $values:expr, $default:expr) => {
        ($values).print(&$default)
    };
    (@hint $values:expr, $default:expr, $example:literal) => {
        $example.to_owned()
    };
    (@take $key:ident, $value:ident, $values:expr) => {
        ($values).take($key, $value)
    };
    (@take $key:ident, $value:ident, $values:expr, secret) => {
        ($values).take($key, $value).map_err($crate::parameter::Refused::masked)
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
            /// The keys, in the order in which they are declared.
            $vis const KEYS: &'static [&'static str] = &[$($($key,)?)*];
        }

        impl $crate::parameter::Parameters for $name {
            type Error = $error;

            const KEYS: &'static [&'static str] = $name::KEYS;

            const SECRETS: &'static [&'static str] = &[$($($($crate::parameters!(@secret $secret $key),)?)?)*];

            fn set(&mut self, key: &str, value: &str) -> Result<bool, $error> {
                #[allow(unused_imports, reason = "some have values of their own alone")]
                use $crate::parameter::Values as _;
                match key {
                    $($($key => self.$field = $crate::parameters!(@take key, value, $values $(, $secret)?)?,)?)*
                    _ => return Ok(false),
                }
                Ok(true)
            }

            fn entries() -> Vec<$crate::parameter::Entry> {
                #[allow(unused_imports, reason = "some have no entries")]
                use $crate::parameter::Values as _;
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
