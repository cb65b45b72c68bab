//! SSI encoders: their frames, jobs, profiles and views.

pub mod commands;
pub mod jobs;
pub mod procedures;
pub mod profile;
pub mod protocol;
pub mod sim;
pub mod state;
pub mod views;

use crate::kinds::Kind;

pub const KIND: Kind = Kind {
    view: &views::SsiView,
    commands: &commands::SsiCommands,
    at_adapter: Some(&sim::AttachableEncoder::DEFAULT_ADAPTER),
};
