//! Line state that is kept between jobs.

use std::time::Duration;

use super::{Echo, LineQuality};
use crate::parameter::Milliseconds;
use crate::units::Moment;

/// Longest reply delay that is supported for a connection.
pub(super) const LONGEST_MARGIN: Duration = Duration::from_secs(2);

/// Range of the extra time allowed for a reply beyond the protocol's worst case.
pub(crate) const MARGIN: Milliseconds = Milliseconds(0..=LONGEST_MARGIN.as_millis() as u64);

/// The state of a line, kept between jobs.
#[derive(Clone, Debug)]
pub struct LineState {
    /// Extra time allowed for a reply beyond the protocol's worst case, because USB adapters and device servers deliver
    /// bytes late.
    pub margin: Duration,
    /// Whether the adapter echoes sent bytes.
    pub echo: Echo,
    /// Number of failed attempts since the start of the session.
    pub damaged: u64,
    /// Counters and reply times since the start of the session.
    pub quality: LineQuality,
    pub(crate) quiet_until: Moment,
    /// Start of the first failed attempt since the last valid reply, if any.
    pub(super) failing_since: Option<Moment>,
    /// Time of the first unanswered request, if any.
    pub(super) outstanding_since: Option<Moment>,
    pub(super) last_sent: Moment,
}

impl LineState {
    pub(crate) fn new(margin: Duration) -> Self {
        LineState {
            margin,
            echo: Echo::Unknown,
            damaged: 0,
            quality: LineQuality::default(),
            quiet_until: Moment::START,
            failing_since: None,
            outstanding_since: None,
            last_sent: Moment::START,
        }
    }

    /// Returns whether the last exchange failed.
    pub fn has_errors(&self) -> bool {
        self.failing_since.is_some()
    }

    pub(crate) fn begin_job(&mut self) {
        self.failing_since = None;
        self.outstanding_since = None;
    }

    pub(crate) fn mark_sent(&mut self, at: Moment) {
        self.outstanding_since.get_or_insert(at);
        self.last_sent = at;
        self.quality.requests += 1;
    }

    pub(crate) fn mark_replied(&mut self) {
        self.outstanding_since = None;
        self.quality.replies += 1;
    }

    pub(crate) fn record_answer_start(&mut self, at: Moment) {
        self.quality.record_answer_time(at.duration_since(self.last_sent));
    }

    pub(crate) fn clear_error(&mut self) {
        self.failing_since = None;
    }

    /// Raises the margin to 1.5 times the sum of the margin and `lateness`, up to [`LONGEST_MARGIN`].
    pub(super) fn raise_margin(&mut self, lateness: Duration) {
        let margin = (self.margin + lateness).saturating_mul(3) / 2;
        self.margin = margin.min(LONGEST_MARGIN).max(self.margin);
        tracing::warn!(
            "replies come later than expected: waiting {} ms longer; margin= in the link says so beforehand",
            self.margin.as_millis()
        );
    }
}
