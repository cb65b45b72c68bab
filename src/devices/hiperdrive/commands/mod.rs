//! The commands for HIPERDRIVE drives behind an adapter or a hub; words and packets are explained offline as well.

mod act;
mod args;
mod decode;
mod find;
mod image;
mod inspect;
mod meaning;
mod r#move;
mod plan;
mod position;
mod profiles;
mod run;
mod simulate;
mod write;

use crate::app::Text;
use crate::cli::args::OfDrive;
use crate::cli::kind::Kind;
use crate::cli::{Failure, Result};
use crate::devices::hiperdrive::profile::{Item, ItemError};
use crate::devices::hiperdrive::protocol::{KIND, PARAMETERS};

pub(crate) use args::{Move, Order};
pub(crate) use r#move::drive_to;

/// What can be done with drives.
pub(crate) const COMMANDS: Kind = Kind {
    name: KIND,
    find: find::find,
    identify: inspect::identify,
    status: |common, output, _| inspect::status(common, output),
    position: position::position,
    read: inspect::read,
    save: profiles::save,
    write: write::write,
    act: act::act,
    decode: decode::decode,
    restore: profiles::restore,
    simulated: simulate::simulated,
    present: profiles::present,
    compare: profiles::compare,
    remark: |_| None,
    other_device: profiles::other_device,
};

/// All parameters with their numbers, a line each: for the help, since a number alone says nothing.
pub(crate) fn listed_parameters() -> String {
    let mut text = "\
Parameters of HIPERDRIVE, of the device below 100, of drive 1 from 101 on (drive 2 from 201 on, and so on to drive 8):
"
    .to_owned();
    for row in &PARAMETERS {
        let unit = if row.unit.is_empty() { String::new() } else { format!(", {}", row.unit) };
        text.push_str(&format!("  {:3}  {}{unit}\n", row.number, row.name));
    }
    text
}

/// The parameter that a user names, of the drive that is named beside it.
fn item(text: &str, of: &OfDrive) -> Result<Item> {
    let item = text.parse::<Item>().and_then(|item| match (of.drive, Item::number(text)) {
        (Some(drive), Some(number)) => Item::of(number, Some(drive)),
        (Some(drive), None) if item.0.drive().map(|own| own.get()) != Some(drive) => {
            Err(ItemError::NoDrive { number: item.0.base(), drive })
        }
        _ => Ok(item),
    });
    item.map_err(|error| {
        Failure::Usage(match error {
            ItemError::NoParameter(number) => Text::new("hd_said.unknown").with("number", number).terminal(),
            error => error.to_string(),
        })
    })
}
