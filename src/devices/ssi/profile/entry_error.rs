//! Why an SSI profile is refused.

use crate::devices::ssi::protocol::LayoutError;

/// Why an entry of a profile is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// A frame that cannot work.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// A position that the frame does not have.
    #[error("{preset} is not within 0 to {last}")]
    Preset {
        /// As in the profile.
        preset: u64,
        /// The last position.
        last: u64,
    },
    /// Entries that exclude one another.
    #[error("not together with {0}")]
    NotWith(&'static str),
    /// The range of positions is missing.
    #[error("the range of positions needs singleturn, steps or bits")]
    NoPositions,
}
