//! The recording of a device, as far as it is common to all kinds.

use std::time::Duration;

use super::recorder::Recorder;

/// The recording of a device while it is read.
pub trait Recording {
    fn recorder(&self) -> &Recorder;

    #[doc(hidden)]
    fn recorder_mut(&mut self) -> &mut Recorder;

    /// Returns the number of samples that were taken and dropped before they were recorded.
    fn dropped(&self) -> u64;

    /// Sets the interval of polling; `begins`: there was none before.
    #[doc(hidden)]
    fn poll(&mut self, interval: Option<Duration>, begins: bool);
}
