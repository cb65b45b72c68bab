//! Review titles and job names for changes to an encoder.

use super::format;
use crate::app::Text;
use crate::devices::hiperface::jobs::Change;
use crate::devices::hiperface::state::{ByteEditError, TEXTS};

pub fn change_text(change: &Change) -> Text {
    match change {
        Change::Restore { profile, .. } => Text::new("change.restore").with("serial", &profile.identity.serial_number),
        Change::Store(edits) => {
            let bytes: usize = edits.iter().map(|(_, bytes)| bytes.len()).sum();
            TEXTS.text(if bytes == 1 { "change.store_one" } else { "change.store" }).with("bytes", bytes)
        }
        Change::CreateField { number, status } => {
            TEXTS.text("change.create").with("number", number).with_text("status", format::field_status(*status))
        }
        Change::Redefine { number, status } => {
            TEXTS.text("change.redefine").with("number", number).with_text("status", format::field_status(*status))
        }
        Change::LockField { number, lock: true } => TEXTS.text("change.lock").with("number", number),
        Change::LockField { number, lock: false } => TEXTS.text("change.unlock").with("number", number),
        Change::ResizeField { number, size } => {
            TEXTS.text("change.resize").with("number", number).with("bytes", size.bytes())
        }
        Change::DeleteField { number } => TEXTS.text("change.delete").with("number", number),
        Change::ChangeCode { number, .. } => TEXTS.text("change.code").with("number", number),
        Change::SetPosition { wanted, synchronise: false, .. } => TEXTS.text("change.position").with("wanted", wanted),
        Change::SetPosition { wanted, synchronise: true, .. } => {
            TEXTS.text("change.synchronise").with("wanted", wanted)
        }
        Change::ShiftPosition { steps } => TEXTS.text("change.shift").with("steps", format!("{steps:+}")),
        Change::SetAddress(address) => TEXTS.text("change.address").with("address", address),
        Change::Configure(settings) => {
            TEXTS.text("change.settings").with_text("settings", format::line_settings(*settings))
        }
        Change::ClearCounter => TEXTS.text("change.clear_counter"),
        Change::IncrementCounter => TEXTS.text("change.increment_counter"),
    }
}

/// Explains why `count` bytes from index `start` cannot be edited.
pub fn edit_error_text(error: &ByteEditError, count: usize, start: usize) -> Text {
    match error {
        ByteEditError::NoField { field } => TEXTS.text("staged.no_field").with("field", field),
        ByteEditError::Locked { field } => TEXTS.text("staged.locked").with("field", field),
        ByteEditError::Outside { field, last } => super::out_of_field_text(*field, *last, start, count),
    }
}
