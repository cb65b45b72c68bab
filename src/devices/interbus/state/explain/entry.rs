//! Messages about invalid profile entries.

use crate::app::Text;
use crate::devices::interbus::profile::{EntryError, ItemError};
use crate::devices::interbus::protocol::{Program, ProgramNumber};
use crate::devices::interbus::state::TEXTS;
use crate::profile::Cause;

pub fn entry_error_text(cause: &Cause) -> Option<Text> {
    Some(match cause.get()? {
        EntryError::ProgramTwice(program) => TEXTS.text("ib_entry.program_twice").with("program", program.get()),
        EntryError::CamTwice(cam) => TEXTS.text("ib_entry.cam_twice").with("cam", cam.get()),
        EntryError::Measured(item) => TEXTS.text("ib_entry.measured").with("item", item),
        EntryError::Item(ItemError::Unknown(text)) => TEXTS.text("ib_entry.unknown").with("text", format!("{text:?}")),
        EntryError::Item(ItemError::Program { number }) => {
            let text = TEXTS.text("ib_entry.program").with("program", number);
            text.with("first", 1).with("last", ProgramNumber::COUNT)
        }
        EntryError::Item(ItemError::Cam { number }) => {
            TEXTS.text("ib_entry.cam").with("cam", number).with("first", 0).with("last", Program::CAMS - 1)
        }
    })
}
