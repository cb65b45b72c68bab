//! Why an INTERBUS profile is refused.

use super::item::{Item, ItemError};
use crate::devices::interbus::protocol::{CamNumber, ProgramNumber};

/// Why an entry of a profile is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// A program that is already in the list.
    #[error("program {} appears twice", .0.get())]
    ProgramTwice(ProgramNumber),
    /// A cam that is already in its program.
    #[error("cam {} appears twice", .0.get())]
    CamTwice(CamNumber),
    /// An unknown program, cam or marked item.
    #[error(transparent)]
    Item(#[from] ItemError),
    /// The marked item is not a setting.
    #[error("{0} is measured and does not belong to the mounting")]
    Measured(Item),
}
