//! The hash of a report's content, from which the report number is derived.

use std::fmt;

use sha2::{Digest, Sha256};

use super::Report;

/// The SHA-256 hash of a report's content. The content does not include the print time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContentHash(String);

/// Number of hash digits in a report number.
const NUMBER_DIGITS: usize = 10;

impl Report {
    /// Returns the hash of the report's content.
    pub fn content_hash(&self) -> ContentHash {
        // Texts, numbers and lists can always be written as JSON.
        let content = serde_json::to_vec(self).unwrap_or_default();
        ContentHash(sha256_hex(&content))
    }
}

/// Returns the SHA-256 hash of bytes as lower-case hexadecimal digits, like `sha256sum`.
pub fn sha256_hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

impl ContentHash {
    /// Returns the report number, which consists of the first digits of the hash.
    pub fn report_number(&self) -> String {
        let digits: String = self.0.chars().take(NUMBER_DIGITS).collect();
        digits.to_ascii_uppercase()
    }
}

impl fmt::Display for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}
