//! Reasons why an INTERBUS profile is refused.

use super::item::{Item, ItemError};
use crate::devices::interbus::protocol::{CamNumber, ProgramNumber};

/// The reason why a profile entry is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// The program occurs twice.
    #[error("program {} appears twice", .0.get())]
    ProgramTwice(ProgramNumber),
    /// The cam occurs twice in its program.
    #[error("cam {} appears twice", .0.get())]
    CamTwice(CamNumber),
    /// The program, cam or marked item is unknown.
    #[error(transparent)]
    Item(#[from] ItemError),
    /// The marked item is not a setting.
    #[error("{0} is measured and does not belong to the mounting")]
    Measured(Item),
}
