//! Support for the open adapter.

pub(crate) mod commands;
pub mod jobs;
pub mod procedures;
pub mod protocol;
pub mod sim;
pub mod state;
