//! A name in English with an optional German translation.

use std::fmt;

/// A name from a description, in English and possibly in German.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, serde::Deserialize)]
#[serde(from = "String")]
pub struct Name {
    english: String,
    german: Option<String>,
}

impl Name {
    /// Creates a name without a translation. The name may be empty.
    pub fn new(english: impl Into<String>) -> Self {
        Name { english: english.into(), german: None }
    }

    /// Returns the English name.
    pub fn english(&self) -> &str {
        &self.english
    }

    /// Returns the German name, or the English one if the description provides none.
    pub fn german(&self) -> &str {
        self.german.as_deref().unwrap_or(&self.english)
    }

    /// Returns whether the name is empty.
    pub fn is_empty(&self) -> bool {
        self.english.is_empty()
    }

    pub(super) fn translate(&mut self, german: String) {
        self.german = Some(german);
    }
}

impl From<String> for Name {
    fn from(english: String) -> Self {
        Name::new(english)
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.english)
    }
}
