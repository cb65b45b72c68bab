//! Process data: the OUT word that an encoder gets, and the IN word that it gives.

use std::time::Duration;

use super::Error;
use crate::units::Moment;

/// The process data of one encoder, and their time.
pub trait ProcessData {
    /// One cycle: OUT is this word, and IN what is read after that.
    ///
    /// # Errors
    /// The way to the encoder, or the user's wish.
    fn cycle(&mut self, out: u32) -> Result<u32, Error>;

    /// The IN word; OUT is left alone.
    ///
    /// # Errors
    /// As [`cycle`](Self::cycle).
    fn input(&mut self) -> Result<u32, Error>;

    /// The OUT word as it stands on the way to the encoder; `None` where that cannot be told.
    ///
    /// # Errors
    /// As [`cycle`](Self::cycle).
    fn output(&mut self) -> Result<Option<u32>, Error>;

    fn now(&self) -> Moment;

    /// Waits; ends early when the user wishes.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    fn wait(&mut self, duration: Duration) -> Result<(), Error>;

    /// Sets whether a request to end is ignored; returns the previous setting.
    fn shield(&mut self, shielded: bool) -> bool;
}
