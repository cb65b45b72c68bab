//! Procedures for HIPERFACE encoders. They use a [`Master`], which sends requests, repeats them where this is safe, and
//! observes the timing of the protocol. "Manual" refers to SICK 8010701.
//!
//! Every change to the memory of an encoder goes through [`mod@write`] with a plan and consent.

pub mod check;
mod error;
mod fields;
pub mod find;
mod identify;
mod master;
mod position;
mod reset;
mod rest_reading;
mod save;
mod station;
mod survey;
pub mod write;

pub use crate::link::line::{Echo, LineQuality};
pub use error::{Error, ReadBackValue, ReplyDamage};
pub use fields::{UnreadableField, read_all_fields, read_field, read_field_status, read_range, try_read_field};
pub use identify::{
    Identity, identify, read_address, read_extended_label, read_settings, read_status, recorded_identity,
};
pub use master::Master;
pub use position::{
    PolledSample, PositionReading, WatchedQuantity, WatchedReading, ensure_standstill, read_analogue,
    read_analogue_limit, read_counter, read_position, read_sample, read_watched_value,
};
pub use reset::{reset, set_temporary_line_settings};
pub use rest_reading::{RestPosition, Signals, read_at_rest};
pub use save::{SaveOptions, create_profile, save};
pub use station::{AdapterParameters, Codes, InitialAccessCodes, LinkParameters, MAX_PERIODS, Station};

use survey::{ReadPolicy, read_survey};
pub use survey::{Survey, read_all_values};
