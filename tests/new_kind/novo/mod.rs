//! An invented kind of encoder called Novo.

mod commands;
mod device_type;
pub(crate) mod jobs;
mod memory;
pub(crate) mod profile;
pub(crate) mod protocol;
pub(crate) mod sim;
pub(crate) mod state;
mod view;
mod write;

use encoder_studio::kinds::Kind;

/// The entry for Novo encoders in the list of kinds.
pub(crate) const NOVO: Kind = Kind { view: &view::NovoView, commands: &commands::NovoCommands, at_adapter: None };
