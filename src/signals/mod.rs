//! Signals: sine and cosine without a device.

pub mod state;
pub mod views;
