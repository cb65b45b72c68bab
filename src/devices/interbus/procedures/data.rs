//! Process data: the OUT word to an encoder and the IN word from it.

use std::time::Duration;

use super::Error;
use crate::units::Moment;

/// Access to the cyclic process data of an encoder, with a clock.
pub trait ProcessData {
    /// Runs one cycle: writes the OUT word, then reads the IN word.
    ///
    /// # Errors
    /// Returns an error if the exchange fails or is cancelled.
    fn run_cycle(&mut self, out: u32) -> Result<u32, Error>;

    /// Reads the IN word. The OUT word remains unchanged.
    ///
    /// # Errors
    /// Returns any error that [`run_cycle`](Self::run_cycle) returns.
    fn input(&mut self) -> Result<u32, Error>;

    /// Reads the current OUT word, or returns `None` if the gateway cannot read it.
    ///
    /// # Errors
    /// Returns any error that [`run_cycle`](Self::run_cycle) returns.
    fn output(&mut self) -> Result<Option<u32>, Error>;

    fn now(&self) -> Moment;

    /// Waits for the given duration, or until the job is cancelled.
    ///
    /// # Errors
    /// Returns [`Error::Cancelled`] if the job is cancelled.
    fn wait(&mut self, duration: Duration) -> Result<(), Error>;

    /// Sets whether cancellation is ignored. Returns the previous setting.
    fn ignore_cancellation(&mut self, ignore: bool) -> bool;
}
