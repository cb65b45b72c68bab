//! What several devices speak.

pub mod bridge;
pub mod ethernet_ip;
pub mod ubicom;
