//! Protocols shared by several devices.

pub mod bridge;
pub mod ethernet_ip;
pub mod ubicom;
