//! Messages for an unusable user-defined table of encoder types, and for links that cannot be opened because of it.

use crate::app::Text;
use crate::app::explain::{self as general, syntax_error_text};
use crate::devices::hiperface::jobs::TypeTableFileError;
use crate::devices::hiperface::protocol::{GeometryEntry, TypeTableError};
use crate::devices::hiperface::state::TEXTS;
use crate::store::StoreError;
use crate::worker::OpenError;

/// Explains why a user-defined table of encoder types cannot be used.
pub fn table_error_text(error: &StoreError) -> Text {
    let StoreError::Refused(cause) = error else { return general::store_error_text(error) };
    match cause.get::<TypeTableFileError>() {
        Some(TypeTableFileError { path, cause }) => TEXTS
            .text("store.encoder_types")
            .with("path", path.display())
            .with_text("why", type_table_error_text(cause)),
        None => general::store_error_text(error),
    }
}

pub fn open_error_text(error: &OpenError) -> Text {
    match error {
        OpenError::Store(error) => table_error_text(error),
        other => general::open_error_text(other),
    }
}

fn type_table_error_text(error: &TypeTableError) -> Text {
    match error {
        TypeTableError::Syntax { line, column, problem: what } => {
            syntax_error_text(*line, *column, general::literal_text(what))
        }
        TypeTableError::Range { code, entry, range } => TEXTS
            .text("detail.range")
            .with("code", format!("{code:02X}h"))
            .with_text("entry", geometry_entry_text(*entry))
            .with("low", range.start())
            .with("high", range.end()),
    }
}

fn geometry_entry_text(entry: GeometryEntry) -> Text {
    TEXTS.text(match entry {
        GeometryEntry::Periods => "shape_entry.periods",
        GeometryEntry::Turns => "shape_entry.turns",
        GeometryEntry::PeriodLength => "shape_entry.period_length",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};
    use crate::devices::hiperface::protocol::EncoderTypes;
    use crate::profile::Cause;

    #[test]
    fn explains_table_errors_in_both_languages() {
        let zero = r#"(types: [(code: 1, name: "x", shape: Some(rotary(periods: 0, turns: 1)))])"#;
        let cause = EncoderTypes::parse(zero).unwrap_err();
        let why = type_table_error_text(&cause);
        assert_eq!(why.to_string_in(English), cause.to_string());
        assert_eq!(why.terminal_text(), cause.to_string());
        assert_eq!(why.to_string_in(German), "Typ 01h: periods (Perioden) muss zwischen 1 und 134217728 liegen");
        let broken = TypeTableFileError { path: "own.ron".into(), cause };
        let error = StoreError::Refused(Cause::new(broken)).into();
        assert_eq!(
            open_error_text(&error).to_string_in(English),
            "The table of encoder types in own.ron cannot be used: type 01h: periods must be between 1 and 134217728. \
             Correct or remove the file."
        );
    }
}
