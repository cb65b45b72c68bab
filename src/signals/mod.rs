//! Signals: sine and cosine without a device.

pub(crate) mod commands;
pub mod state;
pub mod views;
