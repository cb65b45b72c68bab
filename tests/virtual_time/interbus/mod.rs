//! A K3 encoder at its gateway: the handshake, reading and writing, and all kinds of ends.

mod cuts;
mod handshake;
mod jobs;
mod scripted;
pub(crate) mod support;
mod wire;
mod writing;
