//! Drives at an adapter or a hub over EtherNet/IP: sessions and requests, reading and writing, and all kinds of ends.

mod cuts;
mod jobs;
mod scripted;
pub(crate) mod support;
mod writing;
