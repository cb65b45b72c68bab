//! Reply times of a device, which can be read from any thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Measured reply times of a session, shared by all clones.
#[derive(Clone, Debug, Default)]
pub struct ReplyTimes(Arc<Measured>);

#[derive(Debug, Default)]
struct Measured {
    count: AtomicU64,
    sum: AtomicU64,
    longest: AtomicU64,
}

impl ReplyTimes {
    /// Records the time between a request and its reply, even if the reply was late.
    pub(crate) fn record(&self, took: Duration) {
        let took = u64::try_from(took.as_micros()).unwrap_or(u64::MAX);
        self.0.sum.fetch_add(took, Ordering::Relaxed);
        self.0.longest.fetch_max(took, Ordering::Relaxed);
        // The count is increased last, so a thread that reads it also sees the other values.
        self.0.count.fetch_add(1, Ordering::Release);
    }

    /// Returns the average reply time, or `None` before the first reply.
    pub fn average(&self) -> Option<Duration> {
        let count = self.0.count.load(Ordering::Acquire);
        self.0.sum.load(Ordering::Relaxed).checked_div(count).map(Duration::from_micros)
    }

    /// Returns the longest reply time, or zero before the first reply.
    pub fn longest_reply_time(&self) -> Duration {
        Duration::from_micros(self.0.longest.load(Ordering::Relaxed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_share_reply_times() {
        let (replies, ms) = (ReplyTimes::default(), Duration::from_millis);
        let seen = replies.clone();
        assert_eq!((seen.average(), seen.longest_reply_time()), (None, Duration::ZERO));
        [100, 500, 300].into_iter().for_each(|took| replies.record(ms(took)));
        assert_eq!((seen.average(), seen.longest_reply_time()), (Some(ms(300)), ms(500)));
    }
}
