//! The recording of a device, as far as it is the same for every kind.

use std::time::Duration;

use super::recorder::Recorder;

/// The recording of a device while it is read.
pub trait Recording {
    /// Returns its lines.
    fn recorder(&self) -> &Recorder;

    #[doc(hidden)]
    fn recorder_mut(&mut self) -> &mut Recorder;

    /// Returns the number of samples that were taken and dropped before they were recorded.
    fn dropped(&self) -> u64;

    /// Samples are asked for at this interval from now on; `begins`: they were not before.
    #[doc(hidden)]
    fn poll(&mut self, interval: Option<Duration>, begins: bool);
}
