//! Protocols that several devices use.

pub mod bridge;
pub mod ethernet_ip;
pub mod ubicom;
