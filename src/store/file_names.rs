//! Folder and file names derived from external strings such as serial numbers and item names.

/// How letter case is encoded in file names, given that Windows and macOS ignore it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum LetterCase {
    /// Case is not encoded, because no two names differ only in case.
    Kept,
    /// Case is encoded, because names may differ only in case.
    Told,
}

/// Returns a file or folder name without an extension for any text. The name is valid on every system, and different
/// texts yield different names. Letters, digits, `.`, `_` and `-` stay unchanged, and every other byte becomes `%XX`.
///
/// With [`LetterCase::Told`], a name with lower-case letters ends with `%` and an `l` or a `u` for each letter.
pub(super) fn safe_name(text: &str, case: LetterCase) -> String {
    if text.is_empty() {
        return "%none".to_owned();
    }
    let reserved = is_reserved(text);
    let last = text.len() - 1;
    let mut name = String::new();
    let mut cases = String::new();
    for (at, byte) in text.bytes().enumerate() {
        // A leading dot hides the folder, and Windows removes a trailing one. `.` and `..` are not valid names.
        let plain = match byte {
            b'.' => at != 0 && at != last,
            b'_' | b'-' => true,
            _ => byte.is_ascii_alphanumeric() && !(reserved && at == 0),
        };
        if !plain {
            name.push_str(&format!("%{byte:02X}"));
            continue;
        }
        name.push(char::from(byte));
        if byte.is_ascii_alphabetic() {
            cases.push(if byte.is_ascii_lowercase() { 'l' } else { 'u' });
        }
    }
    if case == LetterCase::Told && cases.contains('l') {
        name.push('%');
        name.push_str(&cases);
    }
    name
}

/// Returns whether Windows reserves the name for a device, regardless of its extension.
fn is_reserved(text: &str) -> bool {
    let stem = text.split('.').next().unwrap_or(text).to_ascii_uppercase();
    match stem.as_str() {
        "CON" | "PRN" | "AUX" | "NUL" => true,
        _ => ["COM", "LPT"].iter().any(|port| {
            stem.strip_prefix(port)
                .is_some_and(|number| number.len() == 1 && number.bytes().all(|c| c.is_ascii_digit()))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Decodes the original text from a file name, ignoring the case of the name.
    fn read_back(name: &str) -> Vec<u8> {
        let name = name.to_ascii_uppercase();
        if name == "%NONE" {
            return Vec::new();
        }
        let (name, cases) = match name.rsplit_once('%') {
            Some((name, cases)) if cases.starts_with(['L', 'U']) => (name, cases),
            _ => (name.as_str(), ""),
        };
        let mut cases = cases.bytes();
        let mut rest = name.as_bytes();
        let mut text = Vec::new();
        while let [byte, tail @ ..] = rest {
            rest = tail;
            if *byte == b'%' {
                text.push(u8::from_str_radix(str::from_utf8(&rest[..2]).unwrap(), 16).unwrap());
                rest = &rest[2..];
            } else if byte.is_ascii_alphabetic() && cases.next() == Some(b'L') {
                text.push(byte.to_ascii_lowercase());
            } else {
                text.push(*byte);
            }
        }
        text
    }

    proptest! {
        #[test]
        fn different_texts_have_different_names(text in "(?s).{0,12}|[a-zA-Z.%]{0,6}|(?i:con|lpt1)[.a]?") {
            prop_assert_eq!(read_back(&safe_name(&text, LetterCase::Told)), text.as_bytes());
        }
    }
}
