//! Quality of a serial line: error counters and reply times.

use std::collections::VecDeque;
use std::time::Duration;

/// Line quality measured since the start of the session.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LineQuality {
    /// Number of requests sent, including retries.
    pub requests: u64,
    /// Number of valid replies received.
    pub replies: u64,
    /// Number of repeated requests.
    pub retries: u64,
    /// Number of damaged replies, and of requests that the device reported as damaged.
    pub damaged: u64,
    /// Number of requests without a reply.
    pub unanswered: u64,
    /// Number of replies that arrived too late.
    pub late: u64,
    /// Most recent reply times, each from the first byte of a request to the first byte of its reply.
    answers: VecDeque<Duration>,
}

impl LineQuality {
    const MAX_REPLY_TIMES: usize = 1000;

    /// Returns whether any error has been counted.
    pub fn has_errors(&self) -> bool {
        self.counts() != [0; 4]
    }

    /// Returns the numbers of retries, damaged replies, unanswered requests and late replies.
    pub fn counts(&self) -> [u64; 4] {
        [self.retries, self.damaged, self.unanswered, self.late]
    }

    /// Returns the given percentile of the most recent reply times, or `None` without replies.
    pub fn answer_time_percentile(&self, percent: usize) -> Option<Duration> {
        let mut times: Vec<Duration> = self.answers.iter().copied().collect();
        times.sort_unstable();
        let at = (times.len() * percent).div_ceil(100).saturating_sub(1);
        times.get(at).copied()
    }

    pub(super) fn record_answer_time(&mut self, time: Duration) {
        if self.answers.len() == Self::MAX_REPLY_TIMES {
            self.answers.pop_front();
        }
        self.answers.push_back(time);
    }
}
