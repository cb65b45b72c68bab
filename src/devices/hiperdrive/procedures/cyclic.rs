//! Originator side of the cyclic connection: sending, receiving, counting and loss detection. Pure: packets and times
//! are arguments, and nothing blocks.
//!
//! ```text
//! drives: a dead-man each ── connection: counts, layout, intervals ──▶ packets (sent by the owner of a clock and a
//! port)
//! ```
//!
//! If nothing has arrived for three intervals, motion stops. If nothing arrives in a further such period of
//! uninterrupted listening, the connection is lost: the drives are stopped, then switched off, and the connection ends.
//! It is never restored; the user opens another.

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
