//! The cyclic connection as seen by its originator: sending, receiving, counting, and loss. Pure: packets and times are
//! arguments, and nothing waits here.
//!
//! ```text
//! drives: a dead-man each ── connection: counts, layout, intervals ──▶ packets (sent by the owner of a clock and a port)
//! ```
//!
//! If nothing has arrived for three intervals, motion stops. After that time of uninterrupted listening, the connection is
//! lost: the drives are stopped, then switched off, and the connection ends. It is never restored; the user opens another.

mod connection;
mod drives;
mod figures;
mod parameter_words;
#[cfg(test)]
mod tests;

pub use connection::Connection;
pub use drives::Drives;
pub use figures::{Bucket, CyclicLost, Histogram, LinkFigures};
pub use parameter_words::{ParameterReading, ParameterReadings, ParameterResult, ParameterWords};
