//! Process data: the OUT word sent to an encoder, and the IN word received from it.

use std::time::Duration;

use super::Error;
use crate::units::Moment;

/// Cyclic process data of an encoder, with a clock.
pub trait ProcessData {
    /// Carries out one cycle, which sends the OUT word and then reads the IN word.
    ///
    /// # Errors
    /// Errors of the exchange, or cancellation.
    fn cycle(&mut self, out: u32) -> Result<u32, Error>;

    /// Reads the IN word without changing OUT.
    ///
    /// # Errors
    /// As [`cycle`](Self::cycle).
    fn input(&mut self) -> Result<u32, Error>;

    /// Reads the current OUT word, or returns `None` if it cannot be read.
    ///
    /// # Errors
    /// As [`cycle`](Self::cycle).
    fn output(&mut self) -> Result<Option<u32>, Error>;

    fn now(&self) -> Moment;

    /// Waits, but returns early if cancelled.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    fn wait(&mut self, duration: Duration) -> Result<(), Error>;

    /// Sets whether cancellation is ignored, and returns the previous setting.
    fn ignore_cancellation(&mut self, shielded: bool) -> bool;
}
