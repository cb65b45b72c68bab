//! What every line has on which a host asks and a device answers in frames: silences, echoes, replies that come late, and
//! how often and how long one asks again. What the frames say is the business of each device's own folder; here no byte
//! of them is looked at, but for an echo.

use std::collections::VecDeque;
use std::time::Duration;

use crate::bits::MaskedBytes;
use crate::link::{Ctx, Direction, LinkError, LinkErrorKind};
use crate::units::Moment;

/// Tries before a reading command fails.
pub(crate) const TRIES: u32 = 5;
/// No new try when nothing sensible came back for so long: a command has to end within ten seconds.
const PATIENCE: Duration = Duration::from_secs(8);
/// No wire is slower than this.
const LONGEST_MARGIN: Duration = Duration::from_secs(2);
/// A wish to end is heard at least so often.
const SLICE: Duration = Duration::from_millis(50);
/// A line on which bytes keep coming for so long has no silence.
const NEVER_SILENT: Duration = Duration::from_secs(2);
/// Bytes that are kept at most of what is no frame: a socket brings more noise than anybody can read.
pub(crate) const MOST_KEPT: usize = 4096;

/// Whether the adapter gives our own bytes back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Echo {
    /// Not known yet: learned with the first exchange.
    Unknown,
    /// It does.
    On,
    /// It does not.
    Off,
}

impl Echo {
    /// The values of `echo=`.
    pub(crate) const ALLOWED: &'static str = "auto, on or off";

    /// A value of `echo=`.
    pub(crate) fn read(text: &str) -> Option<Self> {
        match text {
            "auto" => Some(Echo::Unknown),
            "on" => Some(Echo::On),
            "off" => Some(Echo::Off),
            _ => None,
        }
    }

    /// What has come behind the echo of `sent`; `None` while it may still be the echo.
    pub(crate) fn strip<'l>(self, line: &'l [u8], sent: &[u8]) -> Option<&'l [u8]> {
        match self {
            Echo::Off => Some(line),
            Echo::On => line.get(sent.len()..),
            Echo::Unknown => match line.strip_prefix(sent) {
                Some(reply) => Some(reply),
                None if sent.starts_with(line) => None,
                None => Some(line),
            },
        }
    }

    /// What the first exchange with a right answer has taught.
    pub(crate) fn learn(&mut self, echo_heard: bool) {
        if *self == Echo::Unknown {
            *self = if echo_heard { Echo::On } else { Echo::Off };
        }
    }
}

/// The values of `margin=`.
pub(crate) const MARGIN_ALLOWED: &str = "milliseconds from 0 to 2000";

/// A value of `margin=`.
pub(crate) fn read_margin(text: &str) -> Option<Duration> {
    text.parse().ok().filter(|ms| *ms <= 2000).map(Duration::from_millis)
}

/// How good a line is, counted since the session began.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LineQuality {
    /// Requests that were sent, repeated ones included.
    pub requests: u64,
    /// Replies that could be understood.
    pub replies: u64,
    /// Requests that were sent again.
    pub retries: u64,
    /// Replies that were damaged, and requests that the device says were.
    pub damaged: u64,
    /// Requests to which nothing came back.
    pub silent: u64,
    /// Replies that came after their time.
    pub late: u64,
    /// How long the newest replies took, from the first byte of the request to that of the reply.
    answers: VecDeque<Duration>,
}

impl LineQuality {
    /// Answer times that are kept.
    const ANSWERS: usize = 1000;

    /// Something had to be asked again, or came too late.
    pub fn is_troubled(&self) -> bool {
        self.troubles() != [0; 4]
    }

    /// What changes when something goes wrong.
    pub fn troubles(&self) -> [u64; 4] {
        [self.retries, self.damaged, self.silent, self.late]
    }

    /// The time within which `percent` of the newest replies came; `None` where there were none.
    pub fn answered_within(&self, percent: usize) -> Option<Duration> {
        let mut times: Vec<Duration> = self.answers.iter().copied().collect();
        times.sort_unstable();
        let at = (times.len() * percent).div_ceil(100).saturating_sub(1);
        times.get(at).copied()
    }

    fn answered_after(&mut self, time: Duration) {
        if self.answers.len() == Self::ANSWERS {
            self.answers.pop_front();
        }
        self.answers.push_back(time);
    }
}

/// What is known about a line, from one job to the next.
#[derive(Clone, Debug)]
pub struct LineState {
    /// How much longer than the protocol's worst case a reply may take: USB adapters and device servers deliver late.
    pub margin: Duration,
    /// Whether the adapter echoes.
    pub echo: Echo,
    /// Exchanges that failed and had to be repeated or given up, since the session began.
    pub damaged: u64,
    /// How good it is.
    pub quality: LineQuality,
    /// No request before this moment.
    pub(crate) quiet_until: Moment,
    /// Since when nothing sensible came back.
    troubled_since: Option<Moment>,
    /// When the first request was sent that has no reply yet.
    outstanding_since: Option<Moment>,
    /// When the last request was sent.
    last_sent: Moment,
}

impl LineState {
    /// A line that nobody has used.
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

    /// When that reply began.
    pub(crate) fn answer_began(&mut self, at: Moment) {
        self.quality.answered_after(at.since(self.last_sent));
    }

    /// What came makes sense: patience begins anew.
    pub(crate) fn recovered(&mut self) {
        self.troubled_since = None;
    }

    /// From now on replies may come that much later, and half as much again.
    fn allow_for(&mut self, lateness: Duration) {
        let margin = (self.margin + lateness).saturating_mul(3) / 2;
        self.margin = margin.min(LONGEST_MARGIN).max(self.margin);
        tracing::warn!(
            "replies come later than expected: waiting {} ms longer; margin= in the link says so beforehand",
            self.margin.as_millis()
        );
    }
}

/// Why something on a line ends early.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LineError {
    /// The user wished it.
    Cancelled,
    /// Bytes keep arriving where there should be silence.
    NeverSilent,
    /// The wire.
    Link(LinkError),
}

impl From<LinkError> for LineError {
    fn from(error: LinkError) -> Self {
        LineError::Link(error)
    }
}

/// The host's side of a line, for one job.
pub(crate) struct Line<'a> {
    /// All that the job got.
    pub(crate) ctx: Ctx<'a>,
    /// How long one goes on asking without an answer, where that is not the usual.
    pub(crate) patience: Option<Duration>,
    shielded: bool,
    /// What was let pass, where that is kept.
    passed: Option<Vec<u8>>,
}

impl<'a> Line<'a> {
    /// The line of a job.
    pub(crate) fn new(ctx: Ctx<'a>) -> Self {
        Line { ctx, patience: None, shielded: false, passed: None }
    }

    /// Now.
    pub(crate) fn now(&self) -> Moment {
        self.ctx.clock.now()
    }

    /// From now on a wish to end is heard, or is not; gives back whether it was not.
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
    pub(crate) fn overhear(&mut self, duration: Duration) -> Result<Vec<u8>, LineError> {
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

    /// Before each exchange: the user's wish.
    ///
    /// # Errors
    /// [`LineError::Cancelled`].
    pub(crate) fn start(&mut self) -> Result<(), LineError> {
        if !self.shielded && self.ctx.cancel.stops_transaction() { Err(LineError::Cancelled) } else { Ok(()) }
    }

    /// Before each exchange on a line without packets: the user's wish, and silence on the line. Where somebody talks, silence has to last for
    /// `quiet`.
    ///
    /// # Errors
    /// See [`LineError`].
    pub(crate) fn begin(&mut self, state: &mut LineState, quiet: Duration) -> Result<(), LineError> {
        self.start()?;
        let mut stray = Vec::new();
        // Looks at least once: what came while nobody listened is no part of the next reply.
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

    /// Takes what comes, at most until `until`.
    ///
    /// # Errors
    /// The wire.
    pub(crate) fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        self.ctx.wire.receive(until, into)
    }

    /// From now on keeps what comes too late or behind a reply, until it is taken.
    pub(crate) fn keep_passed(&mut self) {
        self.passed = Some(Vec::new());
    }

    /// Takes what came too late or behind a reply since it is kept, and keeps no more of it.
    pub(crate) fn take_passed(&mut self) -> Vec<u8> {
        self.passed.take().unwrap_or_default()
    }

    /// Lets bytes pass that are no reply to what was asked. Of noise without an end only the first are kept.
    pub(crate) fn pass(&mut self, bytes: &[u8]) {
        if let Some(passed) = &mut self.passed {
            passed.extend(bytes.iter().take(MOST_KEPT.saturating_sub(passed.len())));
        }
    }

    /// Tells bytes that were received to whoever watches.
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
        // Who is known to be silent for long is asked often.
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

    /// Something came late: every request that is without a reply may still get one. The first of them tells how late
    /// the wire is at most, and for so long after the last of them nothing is sent.
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
