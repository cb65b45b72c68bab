//! The state of a line that is kept between jobs.

use std::time::Duration;

use super::{Echo, LineQuality};
use crate::parameter::Milliseconds;
use crate::units::Moment;

/// No wire is slower than this.
pub(super) const LONGEST_MARGIN: Duration = Duration::from_secs(2);

/// How much later than the protocol's worst case a reply may arrive.
pub(crate) const MARGIN: Milliseconds = Milliseconds(0..=LONGEST_MARGIN.as_millis() as u64);

/// The state of a line that is kept between jobs.
#[derive(Clone, Debug)]
pub struct LineState {
    /// How much later than the protocol's worst case a reply may arrive: USB adapters and device servers deliver late.
    pub margin: Duration,
    /// Whether the adapter echoes.
    pub echo: Echo,
    /// Exchanges that failed and had to be repeated or given up, since the session began.
    pub damaged: u64,
    /// The quality of the line.
    pub quality: LineQuality,
    /// No request before this moment.
    pub(crate) quiet_until: Moment,
    /// Since when nothing sensible came back.
    pub(super) troubled_since: Option<Moment>,
    /// When the first request was sent that has no reply yet.
    pub(super) outstanding_since: Option<Moment>,
    /// When the last request was sent.
    pub(super) last_sent: Moment,
}

impl LineState {
    /// Creates the state of an unused line.
    pub(crate) fn new(margin: Duration) -> Self {
        LineState {
            margin,
            echo: Echo::Unknown,
            damaged: 0,
            quality: LineQuality::default(),
            quiet_until: Moment::START,
            troubled_since: None,
            outstanding_since: None,
            last_sent: Moment::START,
        }
    }

    /// The last exchange failed.
    pub fn is_troubled(&self) -> bool {
        self.troubled_since.is_some()
    }

    /// A job begins: it has its patience before it.
    pub(crate) fn begin_job(&mut self) {
        self.troubled_since = None;
        self.outstanding_since = None;
    }

    /// A request leaves now.
    pub(crate) fn sent(&mut self, at: Moment) {
        self.outstanding_since.get_or_insert(at);
        self.last_sent = at;
        self.quality.requests += 1;
    }

    /// A reply that can be understood has come.
    pub(crate) fn answered(&mut self) {
        self.outstanding_since = None;
        self.quality.replies += 1;
    }

    /// Notes when the reply began.
    pub(crate) fn answer_began(&mut self, at: Moment) {
        self.quality.answered_after(at.since(self.last_sent));
    }

    /// Resets the patience after a valid reply.
    pub(crate) fn recovered(&mut self) {
        self.troubled_since = None;
    }

    /// Allows further replies to come that much later, plus half as much again.
    pub(super) fn allow_for(&mut self, lateness: Duration) {
        let margin = (self.margin + lateness).saturating_mul(3) / 2;
        self.margin = margin.min(LONGEST_MARGIN).max(self.margin);
        tracing::warn!(
            "replies come later than expected: waiting {} ms longer; margin= in the link says so beforehand",
            self.margin.as_millis()
        );
    }
}
