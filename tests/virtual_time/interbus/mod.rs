//! A K3 encoder at its gateway: the handshake, reading and writing, and every way in which they can end.

mod cuts;
mod handshake;
mod jobs;
mod scripted;
pub(crate) mod support;
mod wire;
mod writing;
