//! A K3 encoder behind its gateway: the handshake, what is read and written with it, and how everything ends.

mod cuts;
mod handshake;
mod jobs;
mod scripted;
pub(crate) mod support;
mod wire;
mod writing;
