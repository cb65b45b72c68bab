//! The reasons why an SSI profile is rejected.

use crate::devices::ssi::protocol::LayoutError;

/// The reason why an entry of a profile is rejected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// The frame in the profile is invalid.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The preset exceeds the range of the frame.
    #[error("{preset} is not within 0 to {last}")]
    Preset {
        /// Preset in the profile.
        preset: u64,
        /// Last position that the frame can represent.
        last: u64,
    },
    /// The entry cannot be combined with the entry named here.
    #[error("this entry cannot be combined with {0}")]
    NotWith(&'static str),
    /// The profile has no range of positions.
    #[error("one of the entries singleturn, steps or bits is required")]
    NoPositions,
}
