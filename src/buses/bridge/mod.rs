//! The open adapter, which connects encoders to a PC with the bridge protocol.

pub(crate) mod commands;
pub mod jobs;
pub mod procedures;
pub mod protocol;
pub mod sim;
pub mod state;
