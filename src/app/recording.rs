//! The recording of a device, as far as it is common to all kinds.

use std::time::Duration;

use super::recorder::Recorder;

pub trait Recording {
    fn recorder(&self) -> &Recorder;

    #[doc(hidden)]
    fn recorder_mut(&mut self) -> &mut Recorder;

    /// Returns the number of samples that were dropped before they could be recorded.
    fn dropped_count(&self) -> u64;

    /// Sets the polling interval. `begins` states whether polling was off before.
    #[doc(hidden)]
    fn poll(&mut self, interval: Option<Duration>, begins: bool);
}
