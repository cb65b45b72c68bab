//! The virtual sine/cosine source as a producer. The clock sets its pace, as for a real source. After a delay, because
//! the computer was busy or asleep, it catches up on the last quarter of a second. Older samples are lost and counted.

use std::time::Duration;

use super::{Batch, Producer};
use crate::analysis::SampleTime;
use crate::analysis::wiring::Wires;
use crate::link::Clock;
use crate::sim::sine_cosine::{CheckedSettings, Source};
use crate::units::Moment;

/// Duration of a batch at full rate, in nanoseconds.
const BATCH_DURATION_NS: i64 = 10_000_000;
/// Maximum delay, in nanoseconds, that the source makes up for.
const MAX_CATCH_UP_NS: i64 = 250_000_000;

/// The error for samples whose settings have been discarded after too many changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the settings for the requested samples are no longer stored")]
pub struct StaleSettings;

/// A virtual analogue source driven by a clock.
#[derive(Debug)]
pub struct AnalogueSource {
    source: Source,
    next: u64,
}

impl AnalogueSource {
    /// Creates a source that starts at `start` on the stream's clock.
    pub fn new(checked: CheckedSettings, start: Moment) -> Self {
        AnalogueSource { source: Source::new(checked, SampleTime::from(start)), next: 0 }
    }
}

impl Producer for AnalogueSource {
    type Request = CheckedSettings;
    type Samples = Wires;
    type Error = StaleSettings;

    fn apply_change(&mut self, request: CheckedSettings) {
        self.source.change_settings(self.next, request);
    }

    fn next(&mut self, clock: &dyn Clock, patience: Duration) -> Result<Option<Batch<Wires>>, StaleSettings> {
        let (Some(settings), Some(time)) = (self.source.settings(), self.source.time(self.next)) else {
            return Err(StaleSettings);
        };
        let period_ns = settings.period_ns();
        let now = clock.now();
        // The samples of a batch exist once the last of them is due.
        let full = time.saturating_add_ns((BATCH_DURATION_NS - period_ns).max(0)).as_nanoseconds();
        let full = Moment::from_elapsed(Duration::from_nanos(u64::try_from(full).unwrap_or(0)));
        clock.sleep_until(full.min(now + patience));
        let late = SampleTime::from(clock.now()).nanoseconds_since(time);
        if late < 0 {
            return Ok(None);
        }
        let due = (late / period_ns + 1).unsigned_abs();
        let most = (MAX_CATCH_UP_NS / period_ns).max(1).unsigned_abs();
        let (lost, count) = (due.saturating_sub(most), due.min(most));
        let first = self.next + lost;
        let samples = self.source.samples_from(first, usize::try_from(count).unwrap_or(0)).ok_or(StaleSettings)?;
        self.next = first + count;
        let time = time.saturating_add_ns(i64::try_from(lost).unwrap_or(i64::MAX).saturating_mul(period_ns));
        Ok(Some(Batch { first, time, period_ns, lost, samples }))
    }
}
