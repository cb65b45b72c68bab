//! A K3 encoder at its gateway: the handshake, reading, writing, and how jobs end.

mod cuts;
mod handshake;
mod jobs;
mod scripted;
pub(crate) mod support;
mod wire;
mod writing;
