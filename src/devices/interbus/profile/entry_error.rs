//! Errors in the entries of an INTERBUS profile.

use super::item::{Item, ItemError};
use crate::devices::interbus::protocol::{CamNumber, ProgramNumber};

/// The reason why a profile entry is rejected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// The program occurs twice.
    #[error("program {} appears twice", .0.get())]
    ProgramTwice(ProgramNumber),
    /// The cam occurs twice in its program.
    #[error("cam {} appears twice", .0.get())]
    CamTwice(CamNumber),
    /// The program, the cam or the marked item does not exist.
    #[error(transparent)]
    Item(#[from] ItemError),
    /// The marked item is a measured value and not a setting.
    #[error("{0} is a measured value and cannot be specific to a mounting")]
    Measured(Item),
}
