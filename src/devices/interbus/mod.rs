//! INTERBUS K3 encoders and their cams.

pub mod commands;
pub mod jobs;
pub mod procedures;
pub mod profile;
pub mod protocol;
pub mod sim;
pub mod state;
pub mod views;

use crate::kinds::Kind;

pub const KIND: Kind = Kind { view: &views::InterbusView, commands: &commands::InterbusCommands, at_adapter: None };
