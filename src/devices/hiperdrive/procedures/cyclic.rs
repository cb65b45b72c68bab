//! Originator side of the cyclic connection: sending, receiving, statistics and loss detection. The caller passes in
//! packets and the time, and no call blocks.
//!
//! ```text
//! drives: a dead-man each ── connection: counts, layout, intervals ──▶ packets (sent by the owner of a clock and a
//! port)
//! ```
//!
//! Motion stops if nothing has arrived for three intervals. The connection is lost if nothing arrives for another three
//! intervals of uninterrupted listening. The drives are then stopped and switched off, and the connection ends. It is
//! never restored, but the user can open another one.

mod connection;
mod drives;
mod figures;
mod parameter_words;
#[cfg(test)]
mod tests;

pub use connection::Connection;
pub use drives::Drives;
pub use figures::{Bucket, ConnectionLoss, Histogram, LinkStatistics};
pub use parameter_words::{ParameterReading, ParameterReadings, ParameterResult, ParameterWords};
