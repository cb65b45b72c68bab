//! What a user wants, in words: the title of a review, the name of a job.

use super::words;
use crate::app::Text;
use crate::devices::hiperface::jobs::Change;
use crate::devices::hiperface::state::StagedError;

/// A change in words.
pub fn change(change: &Change) -> Text {
    match change {
        Change::Restore { profile, .. } => Text::new("change.restore").with("serial", &profile.identity.serial_number),
        Change::Store(edits) => {
            let bytes: usize = edits.iter().map(|(_, bytes)| bytes.len()).sum();
            Text::new(if bytes == 1 { "change.store_one" } else { "change.store" }).with("bytes", bytes)
        }
        Change::CreateField { number, status } => {
            Text::new("change.create").with("number", number).with_text("status", words::field_status(*status))
        }
        Change::Redefine { number, status } => {
            Text::new("change.redefine").with("number", number).with_text("status", words::field_status(*status))
        }
        Change::LockField { number, lock: true } => Text::new("change.lock").with("number", number),
        Change::LockField { number, lock: false } => Text::new("change.unlock").with("number", number),
        Change::ResizeField { number, size } => {
            Text::new("change.resize").with("number", number).with("bytes", size.bytes())
        }
        Change::DeleteField { number } => Text::new("change.delete").with("number", number),
        Change::ChangeCode { number, .. } => Text::new("change.code").with("number", number),
        Change::SetPosition { wanted, synchronise: false, .. } => Text::new("change.position").with("wanted", wanted),
        Change::SetPosition { wanted, synchronise: true, .. } => Text::new("change.synchronise").with("wanted", wanted),
        Change::ShiftPosition { steps } => Text::new("change.shift").with("steps", format!("{steps:+}")),
        Change::SetAddress(address) => Text::new("change.address").with("address", address),
        Change::Configure(settings) => {
            Text::new("change.settings").with_text("settings", words::line_settings(*settings))
        }
        Change::ClearCounter => Text::new("change.clear_counter"),
        Change::IncrementCounter => Text::new("change.increment_counter"),
    }
}

/// Why an edit of `count` bytes from `start` cannot be made.
pub fn staged(error: &StagedError, count: usize, start: usize) -> Text {
    match error {
        StagedError::NoField { field } => Text::new("staged.no_field").with("field", field),
        StagedError::Locked { field } => Text::new("staged.locked").with("field", field),
        StagedError::Outside { field, last } => super::out_of_field(*field, *last, start, count),
    }
}
