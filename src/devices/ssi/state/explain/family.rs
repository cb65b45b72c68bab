//! What the files of the families say in sentences: those that are built in are known in both languages, others are quoted.

use crate::app::Text;
use crate::app::explain::{self as general, plain, syntax};
use crate::devices::ssi::protocol::FamilyError;
use crate::devices::ssi::state::TEXTS;
use crate::store::StoreError;

/// The first that fits counts.
const NOTES: &[&str] = &[
    "ssi_note.safety",
    "ssi_note.ones",
    "ssi_note.thirty",
    "ssi_note.three",
    "ssi_note.fixed_multiturn",
    "ssi_note.fixed_singleturn",
    "ssi_note.pauses",
    "ssi_note.burst_before",
    "ssi_note.right",
    "ssi_note.kh53",
    "ssi_note.source_length",
    "ssi_note.source",
];

/// A note or the source of a family.
pub fn note(words: &str) -> Text {
    NOTES.iter().find_map(|id| TEXTS.recognised(id, words)).unwrap_or_else(|| plain(words))
}

/// A family of the user's own that cannot be read or used.
pub fn store(error: &StoreError) -> Text {
    let StoreError::Refused(cause) = error else { return general::store(error) };
    match cause.get::<FamilyError>() {
        Some(FamilyError { file, line, column, what }) => {
            TEXTS.text("store.ssi_family").with("path", file).with_text("why", syntax(*line, *column, what))
        }
        None => general::store(error),
    }
}

#[cfg(test)]
mod tests {
    use super::note;
    use crate::app::Language;
    use crate::devices::ssi::protocol::Families;

    #[test]
    fn what_the_families_say_is_said_in_german_too() {
        for family in Families::built_in().iter() {
            for words in family.notes.iter().chain([&family.source]) {
                let text = note(words);
                assert_eq!(text.words(Language::English), *words);
                assert_ne!(text.words(Language::German), *words);
            }
        }
        // A family of the user's own says what its file says.
        assert_eq!(note("Own words").words(Language::German), "Own words");
    }
}
