//! The commands for HIPERFACE encoders.

mod act;
mod decode;
mod inspect;
mod profiles;
mod table;
mod write;

pub(super) use act::act;
pub(super) use decode::decode;
pub(super) use inspect::{find, identify, position, read, status};
pub(super) use profiles::{diff, restore, save, verify};
pub(super) use write::write;

use super::{Failure, Result};
use crate::profile::hiperface::Item;

/// The item that a user names.
fn item(text: &str) -> Result<Item> {
    text.parse().map_err(|error: crate::profile::hiperface::ItemError| Failure::Usage(error.to_string()))
}
