//! EtherNet/IP.

pub mod commands;
pub mod protocol;
