//! The recording of a device, in a form common to all kinds of devices.

use std::time::Duration;

use super::recorder::Recorder;

pub trait Recording {
    fn recorder(&self) -> &Recorder;

    #[doc(hidden)]
    fn recorder_mut(&mut self) -> &mut Recorder;

    /// Returns the number of samples that were dropped before they could be recorded.
    fn dropped_count(&self) -> u64;

    /// Sets the polling interval. `begins` states whether polling begins with this call.
    #[doc(hidden)]
    fn poll(&mut self, interval: Option<Duration>, begins: bool);
}
