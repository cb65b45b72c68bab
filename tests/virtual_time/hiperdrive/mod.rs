//! Drives at an adapter or a hub over EtherNet/IP: sessions and requests, reading and writing, and every way in which
//! they can end.

mod cuts;
mod jobs;
mod scripted;
pub(crate) mod support;
mod writing;
