//! Texts from family files, and messages about family files that cannot be used.

use super::rejection::settings_error_reason;
use crate::app::Text;
use crate::app::explain::{self as general, literal_text, syntax_error_text};
use crate::devices::ssi::protocol::{Family, FamilyError, FamilyProblem};
use crate::devices::ssi::state::TEXTS;
use crate::store::StoreError;

/// Returns a note or the source of a family in both languages.
pub fn note_text(family: &Family, words: &str) -> Text {
    Text::new("plain.words").with_name("words", words, family.german_or_english(words))
}

/// Returns the message about a family file that cannot be read or used.
pub fn family_error_text(error: &StoreError) -> Text {
    let StoreError::Refused(cause) = error else { return general::store_error_text(error) };
    match cause.get::<FamilyError>() {
        Some(FamilyError { file, line, column, problem: what }) => TEXTS
            .text("store.ssi_family")
            .with("path", file)
            .with_text("why", syntax_error_text(*line, *column, family_problem_text(what))),
        None => general::store_error_text(error),
    }
}

fn family_problem_text(problem: &FamilyProblem) -> Text {
    match problem {
        FamilyProblem::Parser(words) => literal_text(words),
        FamilyProblem::Key(key) => TEXTS.text("ssi_family.key").with("key", format!("{key:?}")),
        FamilyProblem::German(english) => TEXTS.text("ssi_family.german").with("english", format!("{english:?}")),
        FamilyProblem::Delivered(error) => {
            TEXTS.text("ssi_family.delivered").with_text("why", settings_error_reason(error))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::note_text;
    use crate::app::Language;
    use crate::devices::ssi::protocol::Families;

    #[test]
    fn translates_family_notes_to_german() {
        for family in Families::built_in().iter() {
            for words in family.notes.iter().chain([&family.source]) {
                let text = note_text(family, words);
                assert_eq!(text.to_string_in(Language::English), *words);
                assert_ne!(text.to_string_in(Language::German), *words);
            }
        }
        // If a user-defined family has no German texts, the texts of its file are used.
        let family = Families::built_in().iter().next().cloned().unwrap();
        assert_eq!(note_text(&family, "Own words").to_string_in(Language::German), "Own words");
    }
}
