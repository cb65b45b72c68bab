//! Profiles of SSI encoders: frame, counting direction, preset and reading settings. The encoder has no memory. A
//! profile is never written to it, so there is no plan and no backup.

#![warn(missing_docs)]

mod compare;
mod entry_error;
mod record;
mod take;
mod text;

pub use entry_error::EntryError;
pub use record::{ReadingSettings, SsiProfile, UnknownEntries};
