//! The EtherNet/IP protocol and its offline decoder.

pub mod commands;
pub mod protocol;
