//! Messages about rejected profile entries.

use crate::app::Text;
use crate::devices::biss::profile::EntryError;
use crate::devices::biss::state::TEXTS;
use crate::profile::Cause;

pub fn entry_error_text(cause: &Cause) -> Option<Text> {
    let hex = |bank: &u8| format!("0x{bank:02X}");
    Some(match cause.get()? {
        EntryError::Twice(bank) => TEXTS.text("biss_entry.twice").with("bank", hex(bank)),
        EntryError::Order { first, last } => {
            TEXTS.text("biss_entry.order").with("first", hex(first)).with("last", hex(last))
        }
        EntryError::Outside { bank, first, last } => {
            TEXTS.text("biss_entry.outside").with("bank", hex(bank)).with("first", hex(first)).with("last", hex(last))
        }
        EntryError::Length { got, expected } => {
            TEXTS.text("biss_entry.length").with("got", got).with("expected", expected)
        }
        EntryError::Release(text) => TEXTS.text("biss_entry.release").with("text", format!("{text:?}")),
        EntryError::Marked(text) => TEXTS.text("biss_entry.marked").with("item", format!("{text:?}")),
    })
}
