//! The parts of a frame exchange that all serial protocols have in common: silence, echoes, late replies, retries and
//! time-outs. The device modules decode the frames. This module interprets only the echo.

mod echo;
mod quality;
mod state;

use std::time::Duration;

pub use echo::Echo;
pub use quality::LineQuality;
pub use state::LineState;
pub(crate) use state::MARGIN;

use state::LONGEST_MARGIN;

use super::{Ctx, Direction, LinkError, LinkErrorKind};
use crate::bits::MaskedBytes;
use crate::units::Moment;

/// Maximum number of attempts to send a read command.
pub(crate) const MAX_ATTEMPTS: u32 = 5;
/// Maximum time for retrying a command without a valid reply. A command must finish within ten seconds.
const RETRY_TIMEOUT: Duration = Duration::from_secs(8);
/// Longest interval between two checks for cancellation.
const CANCEL_CHECK_INTERVAL: Duration = Duration::from_millis(50);
/// Duration of continuous reception after which waiting for silence fails.
const MAX_CONTINUOUS_RECEPTION: Duration = Duration::from_secs(2);
/// Maximum number of unexpected bytes to keep. A socket can deliver unlimited noise.
pub(crate) const MAX_UNEXPECTED_BYTES: usize = 4096;

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LineError {
    Cancelled,
    /// Bytes kept arriving although the line should have been silent.
    NeverSilent,
    Link(LinkError),
}

impl LineError {
    /// Converts the error to a device's error type.
    pub(crate) fn into_device_error<E>(self, cancelled: E, never_silent: E, link: fn(LinkError) -> E) -> E {
        match self {
            LineError::Cancelled => cancelled,
            LineError::NeverSilent => never_silent,
            LineError::Link(error) => link(error),
        }
    }
}

impl From<LinkError> for LineError {
    fn from(error: LinkError) -> Self {
        LineError::Link(error)
    }
}

pub(crate) struct SerialLine<'a> {
    pub(crate) ctx: Ctx<'a>,
    /// Time during which unanswered requests are repeated, or `None` for the default.
    pub(crate) retry_time: Option<Duration>,
    ignores_cancellation: bool,
    /// Skipped bytes, or `None` if they are not being recorded.
    recorded_bytes: Option<Vec<u8>>,
}

impl<'a> SerialLine<'a> {
    pub(crate) fn new(ctx: Ctx<'a>) -> Self {
        SerialLine { ctx, retry_time: None, ignores_cancellation: false, recorded_bytes: None }
    }

    pub(crate) fn now(&self) -> Moment {
        self.ctx.clock.now()
    }

    /// Sets whether cancellation is ignored, and returns the previous setting.
    pub(crate) fn ignore_cancellation(&mut self, ignore: bool) -> bool {
        std::mem::replace(&mut self.ignores_cancellation, ignore)
    }

    /// Returns [`LineError::Cancelled`] if the user has cancelled.
    pub(crate) fn check_cancel(&self) -> Result<(), LineError> {
        if !self.ignores_cancellation && self.ctx.cancel.is_requested() { Err(LineError::Cancelled) } else { Ok(()) }
    }

    /// Waits for the given duration. Returns [`LineError::Cancelled`] if the user cancels.
    pub(crate) fn wait(&mut self, duration: Duration) -> Result<(), LineError> {
        let end = self.now() + duration;
        while self.now() < end {
            self.check_cancel()?;
            let slice = (self.now() + CANCEL_CHECK_INTERVAL).min(end);
            self.ctx.clock.sleep_until(slice);
        }
        Ok(())
    }

    /// Receives for the given duration without sending. At most [`MAX_UNEXPECTED_BYTES`] bytes are returned.
    pub(crate) fn receive_pending(&mut self, duration: Duration) -> Result<Vec<u8>, LineError> {
        let end = self.now() + duration;
        let mut heard = Vec::new();
        while self.now() < end {
            self.check_cancel()?;
            let slice = (self.now() + CANCEL_CHECK_INTERVAL).min(end);
            self.ctx.wire.receive(slice, &mut heard)?;
            heard.truncate(MAX_UNEXPECTED_BYTES);
        }
        self.trace_hidden_bytes(end, heard.len());
        Ok(heard)
    }

    /// Begins a transaction. Returns [`LineError::Cancelled`] if the user has cancelled.
    pub(crate) fn start(&mut self) -> Result<(), LineError> {
        if !self.ignores_cancellation && self.ctx.cancel.stops_transaction() {
            Err(LineError::Cancelled)
        } else {
            Ok(())
        }
    }

    /// Begins an exchange, and skips bytes that arrived before it. After such bytes, the line must be silent for
    /// `quiet`.
    ///
    /// # Errors
    /// Returns a [`LineError`] if the user cancels or the line stays busy.
    pub(crate) fn begin_exchange(&mut self, state: &mut LineState, quiet: Duration) -> Result<(), LineError> {
        self.start()?;
        let mut stray = Vec::new();
        // Bytes that arrived before the request do not belong to its reply, so the line is read at least once.
        loop {
            self.ctx.wire.receive(state.quiet_until.max(self.now()), &mut stray)?;
            if stray.is_empty() {
                return Ok(());
            }
            self.trace_hidden_bytes(self.now(), stray.len());
            self.skip_bytes(&stray);
            stray.clear();
            self.wait_for_silence(state, quiet)?;
        }
    }

    /// Sends a frame and records `shown`, its masked form, in the trace. If a replayed recording does not contain the
    /// frame, the error shows only the masked bytes.
    pub(crate) fn send(&mut self, bytes: &[u8], shown: MaskedBytes, at: Moment) -> Result<(), LinkError> {
        let text = shown.to_string();
        self.ctx.trace.record_frame(at, Direction::Sent, shown);
        self.ctx.wire.send(bytes).map_err(|mut error| {
            if let LinkErrorKind::NotRecorded(request) = &mut error.kind {
                *request = text;
            }
            error
        })
    }

    pub(crate) fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        self.ctx.wire.receive(until, into)
    }

    /// Starts recording skipped bytes, which are not part of a reply.
    pub(crate) fn record_late_bytes(&mut self) {
        self.recorded_bytes = Some(Vec::new());
    }

    /// Stops recording, and returns the recorded bytes.
    pub(crate) fn take_late_bytes(&mut self) -> Vec<u8> {
        self.recorded_bytes.take().unwrap_or_default()
    }

    /// Skips bytes that are not part of a reply. During recording, the first [`MAX_UNEXPECTED_BYTES`] bytes are kept.
    pub(crate) fn skip_bytes(&mut self, bytes: &[u8]) {
        if let Some(recorded) = &mut self.recorded_bytes {
            recorded.extend(bytes.iter().take(MAX_UNEXPECTED_BYTES.saturating_sub(recorded.len())));
        }
    }

    pub(crate) fn show(&mut self, at: Moment, shown: MaskedBytes) {
        self.ctx.trace.record_frame(at, Direction::Received, shown);
    }

    fn trace_hidden_bytes(&mut self, at: Moment, count: usize) {
        self.show(at, MaskedBytes::fully_masked(count));
    }

    /// Counts a failed attempt, and returns whether another one is allowed. `longest` is the maximum duration of an
    /// attempt.
    pub(crate) fn may_retry(&mut self, state: &mut LineState, tries: u32, longest: Duration) -> bool {
        let now = self.now();
        state.damaged += 1;
        // The first attempt counts as well. At 600 bit/s, it alone may take three seconds.
        let since = *state.failing_since.get_or_insert(now - longest);
        let next_end = (now + longest).duration_since(since);
        let again = match self.retry_time {
            None => tries < MAX_ATTEMPTS && next_end < RETRY_TIMEOUT,
            Some(retry_time) => next_end < retry_time,
        };
        state.quality.retries += u64::from(again);
        again
    }

    /// Waits for a late reply after a time-out, and skips it, because it would be mistaken for the reply to the next
    /// request. The wait becomes longer with each attempt.
    ///
    /// # Errors
    /// Returns a [`LineError`] if the user cancels, the line is never silent or the connection fails.
    pub(crate) fn receive_late_bytes(
        &mut self,
        state: &mut LineState,
        tries: u32,
        quiet: Duration,
    ) -> Result<(), LineError> {
        // A device that is expected to be silent for a long time is polled at short intervals.
        let doublings = tries.min(if self.retry_time.is_some() { 1 } else { 8 });
        let patience = state.margin.saturating_mul(1 << doublings).min(LONGEST_MARGIN);
        let end = self.now() + patience;
        let mut late = Vec::new();
        while late.is_empty() {
            if self.now() >= end {
                return Ok(());
            }
            // On a slow connection this takes seconds, so cancellation is checked in between.
            self.check_cancel()?;
            let slice = (self.now() + CANCEL_CHECK_INTERVAL).min(end);
            self.ctx.wire.receive(slice, &mut late)?;
        }
        self.trace_hidden_bytes(self.now(), late.len());
        self.skip_bytes(&late);
        self.discard_late_answers(state, quiet)
    }

    /// Skips the late replies to all unanswered requests. The first late byte shows how late replies are. Bytes are
    /// skipped until even a reply to the last request would have arrived and the line is silent for `quiet`.
    ///
    /// # Errors
    /// Returns a [`LineError`] if the line is never silent or the connection fails.
    pub(crate) fn discard_late_answers(&mut self, state: &mut LineState, quiet: Duration) -> Result<(), LineError> {
        let now = self.now();
        let lateness = now.duration_since(state.outstanding_since.unwrap_or(now)).min(LONGEST_MARGIN);
        let passed = state.last_sent + lateness + state.margin;
        let mut late = Vec::new();
        while self.now() < passed {
            late.clear();
            self.ctx.wire.receive(passed, &mut late)?;
            self.skip_bytes(&late);
        }
        self.wait_for_silence(state, quiet)?;
        state.raise_margin(lateness);
        Ok(())
    }

    /// Skips bytes until the line has been silent for `quiet`. Returns [`LineError::NeverSilent`] if bytes keep
    /// arriving.
    pub(crate) fn wait_for_silence(&mut self, state: &mut LineState, quiet: Duration) -> Result<(), LineError> {
        let give_up = self.now() + MAX_CONTINUOUS_RECEPTION;
        let mut stray = Vec::new();
        loop {
            stray.clear();
            self.ctx.wire.receive(self.now() + quiet, &mut stray)?;
            if stray.is_empty() {
                state.quiet_until = self.now();
                return Ok(());
            }
            self.skip_bytes(&stray);
            if self.now() > give_up {
                return Err(LineError::NeverSilent);
            }
        }
    }
}
