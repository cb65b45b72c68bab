//! Asset names. An asset is the motor or axis on which a device is mounted. It stays the same when the encoder is
//! replaced.

use std::fmt;
use std::str::FromStr;

/// Maximum number of characters in a name.
const LONGEST: usize = 80;

/// The name of an asset. Letter case and inner spaces are significant, because the name may come from a scanner.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct AssetName(String);

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AssetNameError {
    #[error("the name is empty")]
    Empty,
    #[error("the name has {found} characters, but at most {most} are allowed")]
    TooLong { found: usize, most: usize },
    #[error("the name contains a control character")]
    ControlCharacter,
}

impl AssetName {
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl FromStr for AssetName {
    type Err = AssetNameError;

    /// Parses a name. Surrounding spaces are removed.
    fn from_str(text: &str) -> Result<Self, AssetNameError> {
        let name = text.trim();
        let found = name.chars().count();
        match found {
            0 => Err(AssetNameError::Empty),
            _ if name.chars().any(is_control) => Err(AssetNameError::ControlCharacter),
            _ if found > LONGEST => Err(AssetNameError::TooLong { found, most: LONGEST }),
            _ => Ok(AssetName(name.to_owned())),
        }
    }
}

impl fmt::Display for AssetName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Returns whether a character is a control character, a line separator or a text direction mark.
fn is_control(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checks_names() {
        let name = |text: &str| text.parse::<AssetName>().map(|name| name.to_string());
        for good in ["M-17", "Achse 3 · Süd", "電動機/7", &"x".repeat(80)] {
            assert_eq!(name(good), Ok(good.to_owned()));
        }
        assert_eq!(name("  axis 7\t"), Ok("axis 7".to_owned()), "a scanner may add a tab");
        assert_eq!(name(" \t"), Err(AssetNameError::Empty));
        assert_eq!(name(&"ä".repeat(81)), Err(AssetNameError::TooLong { found: 81, most: 80 }));
        for bad in ["a\nb", "a\0b", "\u{1b}[31m", "a\u{202e}b", "a\u{2028}b"] {
            assert_eq!(name(bad), Err(AssetNameError::ControlCharacter), "{bad:?}");
        }
    }
}
