//! The common behaviour of lines with frames: silence, echoes, late replies, repetition and time-outs. The devices' own
//! folders decode the frames; no byte is interpreted here, except for the echo.

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

/// Tries before a reading command fails.
pub(crate) const TRIES: u32 = 5;
/// No new try when nothing sensible came back for so long: a command has to end within ten seconds.
const PATIENCE: Duration = Duration::from_secs(8);
/// A wish to end is heard at least so often.
const SLICE: Duration = Duration::from_millis(50);
/// A line on which bytes keep coming for so long has no silence.
const NEVER_SILENT: Duration = Duration::from_secs(2);
/// Bytes that are kept at most of what is no frame: a socket brings more noise than anybody can read.
pub(crate) const MOST_KEPT: usize = 4096;

/// Why an exchange on a line ends early.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LineError {
    /// The user wished it.
    Cancelled,
    /// Bytes keep arriving where there should be silence.
    NeverSilent,
    /// The wire.
    Link(LinkError),
}

impl LineError {
    /// Returns it as an error of the device at the line.
    pub(crate) fn at_device<E>(self, cancelled: E, never_silent: E, link: fn(LinkError) -> E) -> E {
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

/// The host's side of a line, for one job.
pub(crate) struct SerialLine<'a> {
    /// All that the job got.
    pub(crate) ctx: Ctx<'a>,
    /// How long to keep asking without an answer, if not the default.
    pub(crate) patience: Option<Duration>,
    shielded: bool,
    /// The skipped bytes, if they are kept.
    passed: Option<Vec<u8>>,
}

impl<'a> SerialLine<'a> {
    /// The line of a job.
    pub(crate) fn new(ctx: Ctx<'a>) -> Self {
        SerialLine { ctx, patience: None, shielded: false, passed: None }
    }

    /// Now.
    pub(crate) fn now(&self) -> Moment {
        self.ctx.clock.now()
    }

    /// Sets whether a request to end is ignored; returns the previous setting.
    pub(crate) fn shield(&mut self, shielded: bool) -> bool {
        std::mem::replace(&mut self.shielded, shielded)
    }

    /// # Errors
    /// [`LineError::Cancelled`] where the user wished an end.
    pub(crate) fn check_cancel(&self) -> Result<(), LineError> {
        if !self.shielded && self.ctx.cancel.is_requested() { Err(LineError::Cancelled) } else { Ok(()) }
    }

    /// Waits; ends early when the user wishes.
    ///
    /// # Errors
    /// [`LineError::Cancelled`].
    pub(crate) fn wait(&mut self, duration: Duration) -> Result<(), LineError> {
        let end = self.now() + duration;
        while self.now() < end {
            self.check_cancel()?;
            let slice = (self.now() + SLICE).min(end);
            self.ctx.clock.sleep_until(slice);
        }
        Ok(())
    }

    /// Listens without sending; gives back what it heard, of noise without an end the first bytes.
    ///
    /// # Errors
    /// The wire, or [`LineError::Cancelled`].
    pub(crate) fn drain(&mut self, duration: Duration) -> Result<Vec<u8>, LineError> {
        let end = self.now() + duration;
        let mut heard = Vec::new();
        while self.now() < end {
            self.check_cancel()?;
            let slice = (self.now() + SLICE).min(end);
            self.ctx.wire.receive(slice, &mut heard)?;
            heard.truncate(MOST_KEPT);
        }
        self.show_hidden(end, heard.len());
        Ok(heard)
    }

    /// Checks for the user's request to end before an exchange.
    ///
    /// # Errors
    /// [`LineError::Cancelled`].
    pub(crate) fn start(&mut self) -> Result<(), LineError> {
        if !self.shielded && self.ctx.cancel.stops_transaction() { Err(LineError::Cancelled) } else { Ok(()) }
    }

    /// Prepares an exchange on a line without packets: checks for cancellation and waits for silence. On a busy line,
    /// the silence has to last for `quiet`.
    ///
    /// # Errors
    /// See [`LineError`].
    pub(crate) fn begin(&mut self, state: &mut LineState, quiet: Duration) -> Result<(), LineError> {
        self.start()?;
        let mut stray = Vec::new();
        // Looks at least once: bytes that arrived while no one listened do not belong to the next reply.
        loop {
            self.ctx.wire.receive(state.quiet_until.max(self.now()), &mut stray)?;
            if stray.is_empty() {
                return Ok(());
            }
            self.show_hidden(self.now(), stray.len());
            self.pass(&stray);
            stray.clear();
            self.wait_for_silence(state, quiet)?;
        }
    }

    /// Sends a frame, and shows of it what may be shown: also where a recording does not know it.
    ///
    /// # Errors
    /// The wire.
    pub(crate) fn send(&mut self, bytes: &[u8], shown: MaskedBytes, at: Moment) -> Result<(), LinkError> {
        let text = shown.to_string();
        self.ctx.trace.record(at, Direction::Sent, shown);
        self.ctx.wire.send(bytes).map_err(|mut error| {
            if let LinkErrorKind::NotRecorded(request) = &mut error.kind {
                *request = text;
            }
            error
        })
    }

    /// Receives bytes, at most until `until`.
    ///
    /// # Errors
    /// The wire.
    pub(crate) fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        self.ctx.wire.receive(until, into)
    }

    /// Keeps bytes that come too late or after a reply, until they are taken.
    pub(crate) fn keep_passed(&mut self) {
        self.passed = Some(Vec::new());
    }

    /// Takes the bytes that came too late or after a reply since they are kept, and stops keeping them.
    pub(crate) fn take_passed(&mut self) -> Vec<u8> {
        self.passed.take().unwrap_or_default()
    }

    /// Lets bytes pass that are no reply to what was asked. Of noise without an end only the first are kept.
    pub(crate) fn pass(&mut self, bytes: &[u8]) {
        if let Some(passed) = &mut self.passed {
            passed.extend(bytes.iter().take(MOST_KEPT.saturating_sub(passed.len())));
        }
    }

    /// Passes received bytes to the trace.
    pub(crate) fn show(&mut self, at: Moment, shown: MaskedBytes) {
        self.ctx.trace.record(at, Direction::Received, shown);
    }

    fn show_hidden(&mut self, at: Moment, count: usize) {
        self.show(at, MaskedBytes::hidden(count));
    }

    /// Counts a try that gave no answer; true when there may be another. `longest` is the time that a try takes at most.
    pub(crate) fn may_ask_again(&mut self, state: &mut LineState, tries: u32, longest: Duration) -> bool {
        let now = self.now();
        state.damaged += 1;
        // The first try counts as well: at 600 bit/s it alone may take three seconds.
        let since = *state.troubled_since.get_or_insert(now - longest);
        let next_end = (now + longest).since(since);
        let again = match self.patience {
            None => tries < TRIES && next_end < PATIENCE,
            Some(patience) => next_end < patience,
        };
        state.quality.retries += u64::from(again);
        again
    }

    /// Listens on after a silence, longer each time: what comes now is the reply to a request before, on a wire that is
    /// slower than its margin says, and would be taken for the reply to the next.
    ///
    /// # Errors
    /// See [`LineError`].
    pub(crate) fn hear_late(&mut self, state: &mut LineState, tries: u32, quiet: Duration) -> Result<(), LineError> {
        // A device known to be silent for long is asked often.
        let doublings = tries.min(if self.patience.is_some() { 1 } else { 8 });
        let patience = state.margin.saturating_mul(1 << doublings).min(LONGEST_MARGIN);
        let end = self.now() + patience;
        let mut late = Vec::new();
        while late.is_empty() {
            if self.now() >= end {
                return Ok(());
            }
            // On a slow wire this takes seconds: a wish to end is heard in them.
            self.check_cancel()?;
            let slice = (self.now() + SLICE).min(end);
            self.ctx.wire.receive(slice, &mut late)?;
        }
        self.show_hidden(self.now(), late.len());
        self.pass(&late);
        self.let_late_ones_pass(state, quiet)
    }

    /// Lets late bytes pass: every request without a reply may still get one. The first of them shows the maximum delay
    /// of the wire, and for that long after the last of them nothing is sent.
    ///
    /// # Errors
    /// See [`LineError`].
    pub(crate) fn let_late_ones_pass(&mut self, state: &mut LineState, quiet: Duration) -> Result<(), LineError> {
        let now = self.now();
        let lateness = now.since(state.outstanding_since.unwrap_or(now)).min(LONGEST_MARGIN);
        let passed = state.last_sent + lateness + state.margin;
        let mut late = Vec::new();
        while self.now() < passed {
            late.clear();
            self.ctx.wire.receive(passed, &mut late)?;
            self.pass(&late);
        }
        self.wait_for_silence(state, quiet)?;
        state.allow_for(lateness);
        Ok(())
    }

    /// Listens until nothing came for `quiet`.
    ///
    /// # Errors
    /// The wire, or [`LineError::NeverSilent`].
    pub(crate) fn wait_for_silence(&mut self, state: &mut LineState, quiet: Duration) -> Result<(), LineError> {
        let give_up = self.now() + NEVER_SILENT;
        let mut stray = Vec::new();
        loop {
            stray.clear();
            self.ctx.wire.receive(self.now() + quiet, &mut stray)?;
            if stray.is_empty() {
                state.quiet_until = self.now();
                return Ok(());
            }
            self.pass(&stray);
            if self.now() > give_up {
                return Err(LineError::NeverSilent);
            }
        }
    }
}
