//! BiSS C encoders.

pub mod commands;
pub mod jobs;
pub mod procedures;
pub mod profile;
pub mod protocol;
pub mod sim;
pub mod state;
pub mod views;

use crate::kinds::Kind;

pub const KIND: Kind =
    Kind { view: &views::BissView, commands: &commands::BissCommands, at_adapter: Some(&sim::AttachableEncoder) };
