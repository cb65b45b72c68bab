//! A notice on the terminal while a device replies slowly. Without it, a slow network would look like a hang.

use std::time::{Duration, Instant};

use crate::link::ReplyTimes;

/// Time before the first notice.
const FIRST_NOTICE_DELAY: Duration = Duration::from_secs(3);
/// Interval between checks after the first notice.
const CHECK_INTERVAL: Duration = Duration::from_millis(500);
/// Reply time from which a device is considered slow.
const SLOW_REPLY_TIME: Duration = Duration::from_millis(100);

pub struct ReplyTiming {
    pub(crate) replies: ReplyTimes,
    /// Time-out for a reply, as set by `timeout=` in the link.
    pub(crate) timeout: Duration,
    /// Maximum value of `timeout=`.
    pub(crate) longest: Duration,
}

/// A monitor for long commands, which prints one notice if slow replies delay the command.
pub(super) struct SlowReplyNotice {
    timing: Option<ReplyTiming>,
    next_check: Instant,
}

impl SlowReplyNotice {
    /// Starts measuring the time. If `timing` is `None`, the device is never reported as slow.
    pub(super) fn start(timing: Option<ReplyTiming>) -> Self {
        SlowReplyNotice { timing, next_check: Instant::now() + FIRST_NOTICE_DELAY }
    }

    /// Returns the time until the next check, or `None` if no further check is needed.
    pub(super) fn time_until_check(&self) -> Option<Duration> {
        self.timing.as_ref().map(|_| self.next_check.saturating_duration_since(Instant::now()))
    }

    /// Returns the notice if it is due.
    pub(super) fn take_message(&mut self) -> Option<String> {
        let now = Instant::now();
        let words = self.timing.as_ref().filter(|_| now >= self.next_check).and_then(ReplyTiming::message);
        match words {
            Some(_) => self.timing = None,
            None if now >= self.next_check => self.next_check = now + CHECK_INTERVAL,
            None => {}
        }
        words
    }
}

impl ReplyTiming {
    /// Returns a notice if the device has not replied yet or replies slowly. If replies may exceed the time limit, it
    /// recommends a longer limit or a check of the network.
    fn message(&self) -> Option<String> {
        let (timeout, longest) = (self.timeout, self.replies.longest_reply_time());
        let more = if timeout < self.longest {
            format!("Set timeout={} in the link to allow more time for a reply.", self.longest.as_millis())
        } else {
            "Check the load of the network.".to_owned()
        };
        let ms = |time: Duration| format!("{} ms", time.as_millis());
        match self.replies.average() {
            None => {
                Some(format!("The device has not answered yet; the request is repeated every {}. {more}", ms(timeout)))
            }
            Some(usual) if usual < SLOW_REPLY_TIME => None,
            Some(usual) if longest < timeout / 2 => {
                Some(format!("The device answers slowly: a reply takes {}.", ms(usual)))
            }
            Some(_) => Some(format!(
                "The device answers slowly: a reply takes up to {}, the time limit is {}. {more}",
                ms(longest),
                ms(timeout)
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the message for a time-out and a list of reply times, all in milliseconds.
    fn message(timeout: u64, took: &[u64]) -> Option<String> {
        let replies = ReplyTimes::default();
        took.iter().for_each(|ms| replies.record(Duration::from_millis(*ms)));
        ReplyTiming { replies, timeout: Duration::from_millis(timeout), longest: Duration::from_secs(2) }.message()
    }

    #[test]
    fn reports_slow_replies_with_remedy() {
        assert_eq!(message(1000, &[3, 5, 4]), None, "what takes long does so for other reasons");
        assert_eq!(message(1000, &[299, 301]).unwrap(), "The device answers slowly: a reply takes 300 ms.");
        assert_eq!(
            message(1000, &[600, 800]).unwrap(),
            "The device answers slowly: a reply takes up to 800 ms, the time limit is 1000 ms. \
             Set timeout=2000 in the link to allow more time for a reply."
        );
        assert_eq!(
            message(1000, &[]).unwrap(),
            "The device has not answered yet; the request is repeated every 1000 ms. \
             Set timeout=2000 in the link to allow more time for a reply."
        );
        assert!(message(2000, &[1500]).unwrap().ends_with("Check the load of the network."));
    }

    #[test]
    fn notice_appears_late_and_once() {
        let replies = ReplyTimes::default();
        replies.record(Duration::from_millis(300));
        let timing =
            |replies| ReplyTiming { replies, timeout: Duration::from_secs(1), longest: Duration::from_secs(2) };
        let mut notice = SlowReplyNotice::start(Some(timing(replies)));
        assert!(
            notice.take_message().is_none()
                && notice.time_until_check().is_some_and(|left| left > FIRST_NOTICE_DELAY / 2)
        );
        notice.next_check = Instant::now();
        assert!(notice.take_message().is_some());
        assert!(notice.take_message().is_none() && notice.time_until_check().is_none());
        assert!(SlowReplyNotice::start(None).time_until_check().is_none());
    }
}
