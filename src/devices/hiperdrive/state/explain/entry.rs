//! Messages about rejected profiles.

use super::error::out_of_range;
use super::names::parameter_name_text;
use crate::app::Text;
use crate::devices::hiperdrive::profile::{EntryError, ItemError};
use crate::devices::hiperdrive::state::TEXTS;
use crate::profile::Cause;

pub fn entry_error_text(cause: &Cause) -> Option<Text> {
    Some(match cause.get()? {
        EntryError::DriveTwice(drive) => TEXTS.text("hd_wrong.drive_twice").with("drive", drive.get()),
        EntryError::Twice(own) => TEXTS.text("hd_wrong.twice").with("item", own),
        EntryError::Marked(ItemError::Unknown(text)) => {
            TEXTS.text("hd_wrong.unknown").with("text", format!("{text:?}"))
        }
        EntryError::Marked(ItemError::NoParameter(number)) => {
            TEXTS.text("hd_wrong.no_parameter").with("number", number)
        }
        EntryError::Marked(ItemError::NoDrive { number, drive }) => {
            TEXTS.text("hd_wrong.no_drive").with("number", number).with("drive", drive)
        }
        EntryError::NoMounting(own) => TEXTS.text("hd_wrong.no_mounting").with("item", own),
        EntryError::NotKept(own) => TEXTS.text("hd_wrong.not_kept").with_text("name", parameter_name_text(own.0)),
        EntryError::NoParameter(number) => TEXTS.text("hd_wrong.no_parameter").with("number", number),
        EntryError::NoParameterOfDrive { number, drive } => {
            TEXTS.text("hd_wrong.no_parameter_of_drive").with("number", number).with("drive", drive.get())
        }
        EntryError::OutOfRange(error) => out_of_range(error),
    })
}
