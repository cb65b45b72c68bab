//! The command palette: search and ranking of actions by name.

/// Returns how well a name matches the typed text: 0 is best, and `None` means that a word is missing. Case and word
/// order do not matter.
pub(crate) fn match_score(typed: &str, name: &str) -> Option<usize> {
    let (typed, name) = (typed.to_lowercase(), name.to_lowercase());
    typed.split_whitespace().map(|word| match_quality(word, &name)).sum()
}

/// Returns how well a name matches a word: 0 at the start of the name, 1 at the start of a word, 2 within a word.
fn match_quality(word: &str, name: &str) -> Option<usize> {
    name.match_indices(word)
        .map(|(at, _)| match name.get(..at).and_then(|before| before.chars().next_back()) {
            None => 0,
            Some(before) if !before.is_alphanumeric() => 1,
            Some(_) => 2,
        })
        .min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requires_every_typed_word() {
        let cases = [
            ("", "Save", Some(0)),
            ("sa", "Save", Some(0)),
            ("AS", "Save as…", Some(1)),
            ("as", "Last backup", Some(2)),
            ("mem sk", "SKM36: Memory", Some(1)),
            ("memory x", "SKM36: Memory", None),
            ("prüfen", "Gerät prüfen", Some(1)),
            ("ÄNDERUNG", "Alle Änderungen verwerfen", Some(1)),
            ("  ", "Save", Some(0)),
        ];
        for (typed, name, expected) in cases {
            assert_eq!(match_score(typed, name), expected, "{typed:?} in {name:?}");
        }
    }
}
