//! Drives behind an adapter or a hub over EtherNet/IP: sessions and requests, what is read and written with them, and how
//! everything ends.

mod cuts;
mod jobs;
mod scripted;
pub(crate) mod support;
mod writing;
