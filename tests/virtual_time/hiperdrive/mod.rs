//! Drives at an adapter or a hub over EtherNet/IP: sessions and requests, reading, writing, and how jobs end.

mod cuts;
mod jobs;
mod scripted;
pub(crate) mod support;
mod writing;
