//! The cyclic connection as seen by its originator: sending, receiving, counting, and loss. Pure: packets and moments
//! are arguments, and nothing waits here.
//!
//! ```text
//! drives: a dead-man each ── connection: counts, layout, intervals ──▶ packets (whoever owns a clock and a port sends them)
//! ```
//!
//! Where nothing has come for three intervals, what moves stops. Where somebody has listened for as long, the connection is
//! lost: the drives are told to stop, for as long as that takes, then to be off, and it is over. It never comes back; a person
//! opens another.

mod connection;
mod drives;
mod figures;
#[cfg(test)]
mod tests;

pub use connection::Connection;
pub use drives::Drives;
pub use figures::{Bucket, CyclicLost, Histogram, LinkFigures};
