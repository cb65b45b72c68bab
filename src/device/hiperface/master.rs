//! The host's side of the line: one exchange at a time, in the protocol's rhythm (manual, "Dialog Timing").
//!
//! A reply ends with its last byte where its length is known, else with silence. The dead time after it is spent
//! listening: a byte there means that the frame was longer than it should be, and nothing of it is shown.
//! Reading is repeated, at most five times and for at most eight seconds; what writes is never repeated blindly.

use std::time::Duration;

use super::error::Damage;
use super::{Echo, Error, Station};
use crate::bits::MaskedBytes;
use crate::link::{Ctx, Direction, LinkError, LinkErrorKind};
use crate::protocol::hiperface::{Answer, Command, Reply, Request, SecretFrame, StatusCode};
use crate::units::Moment;

/// Tries before a reading command fails.
const TRIES: u32 = 5;
/// No new try when nothing sensible came back for so long: a command has to end within ten seconds.
const PATIENCE: Duration = Duration::from_secs(8);
/// Most codes an encoder queues is four; the fifth reading finds the queue empty.
const MOST_CODES: u32 = 5;

/// What an encoder says to a request that the line has damaged. A byte 00h that got lost leaves the checksum right.
const DAMAGED_REQUEST: [StatusCode; 3] = [StatusCode::PARITY, StatusCode::CHECKSUM, StatusCode::LENGTH];

/// The host's side of a HIPERFACE line.
pub struct Master<'a> {
    ctx: Ctx<'a>,
    station: &'a mut Station,
    shielded: bool,
}

/// An exchange that gave no answer.
pub(super) enum Trouble {
    /// Nothing came back but, maybe, our own bytes.
    Silence {
        /// Our own bytes came back.
        echo_heard: bool,
    },
    /// Something came back and is broken.
    Damage(Damage),
}

/// What came back, without the echo.
struct Heard {
    reply: Vec<u8>,
    /// When the first byte of the reply was complete.
    first_at: Moment,
    echo_heard: bool,
    damage: Option<Damage>,
}

/// A reply and when it began.
pub(super) struct Timed {
    pub(super) reply: Reply,
    /// The falling edge of the start bit of the reply's address.
    pub(super) at: Moment,
    /// The address it came from.
    pub(super) sender: u8,
}

impl<'a> Master<'a> {
    /// A master on this line, for one job: it has its patience before it.
    pub fn new(ctx: Ctx<'a>, station: &'a mut Station) -> Self {
        station.troubled_since = None;
        Master { ctx, station, shielded: false }
    }

    /// What is known about the line.
    pub fn station(&mut self) -> &mut Station {
        self.station
    }

    /// Now.
    pub fn now(&self) -> Moment {
        self.ctx.clock.now()
    }

    /// Does what leads back to a safe state: in it, a wish to end is not heard.
    pub fn shielded<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::replace(&mut self.shielded, true);
        let result = work(self);
        self.shielded = before;
        result
    }

    /// Waits; ends early when the user wishes.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn wait(&mut self, duration: Duration) -> Result<(), Error> {
        let end = self.now() + duration;
        while self.now() < end {
            self.check_cancel()?;
            let slice = (self.now() + Duration::from_millis(50)).min(end);
            self.ctx.clock.sleep_until(slice);
        }
        Ok(())
    }

    /// Listens without sending; gives back what it heard.
    ///
    /// # Errors
    /// The wire, or [`Error::Cancelled`].
    pub fn overhear(&mut self, duration: Duration) -> Result<Vec<u8>, Error> {
        let end = self.now() + duration;
        let mut heard = Vec::new();
        while self.now() < end {
            self.check_cancel()?;
            let slice = (self.now() + Duration::from_millis(50)).min(end);
            self.ctx.wire.receive(slice, &mut heard)?;
        }
        self.ctx.trace.record(end, Direction::Received, MaskedBytes::hidden(heard.len()));
        Ok(heard)
    }

    /// Sets speed and parity of our side.
    ///
    /// # Errors
    /// The wire.
    pub fn set_format(&mut self, format: crate::units::CharacterFormat) -> Result<(), Error> {
        self.ctx.wire.set_format(format)?;
        self.station.format = format;
        Ok(())
    }

    /// Asks something that changes nothing in the encoder, and repeats it when the line fails.
    ///
    /// # Errors
    /// When every try failed, when the encoder refused, or when the user wished an end.
    pub fn ask(&mut self, request: &Request) -> Result<Reply, Error> {
        self.ask_timed(request).map(|timed| timed.reply)
    }

    /// Does what reads something that is to be kept: in it, every answer has to come twice.
    pub fn thoroughly<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::replace(&mut self.station.thorough, true);
        let result = work(self);
        self.station.thorough = before;
        result
    }

    /// As [`ask`](Self::ask); where the line has damaged something before, the answer has to come twice.
    ///
    /// # Errors
    /// As [`ask`](Self::ask).
    pub fn ask_confirmed(&mut self, request: &Request) -> Result<Reply, Error> {
        let mut reply = self.ask(request)?;
        for _ in 0..TRIES {
            if !self.station.reads_twice() {
                return Ok(reply);
            }
            let again = self.ask(request)?;
            if again == reply {
                return Ok(reply);
            }
            reply = again;
        }
        Err(Error::Damaged { command: request.command(), tries: TRIES, cause: Damage::Inconsistent })
    }

    pub(super) fn ask_timed(&mut self, request: &Request) -> Result<Timed, Error> {
        let mut tries = 0;
        loop {
            tries += 1;
            match self.attempt(request)? {
                Ok(answer) => return self.settle(request, answer),
                Err(trouble) => self.may_try_again(request, tries, trouble)?,
            }
        }
    }

    /// Sends something that changes the encoder. Where it is unclear whether it was carried out, `is_done` reads back;
    /// only when it was not, it is sent again. Gives back how often it may have been carried out.
    ///
    /// # Errors
    /// The encoder refused, `is_done` could not tell ([`Error::Unclear`]), or it was not done after five tries.
    pub fn tell(
        &mut self,
        request: &Request,
        mut is_done: impl FnMut(&mut Self) -> Result<bool, Error>,
    ) -> Result<u32, Error> {
        let mut tries = 0;
        loop {
            tries += 1;
            let trouble = match self.attempt(request)? {
                Ok(answer) => return self.acknowledge(request, answer).map(|()| tries),
                Err(trouble) => trouble,
            };
            let failure = self.may_try_again(request, tries, trouble);
            let unclear = |cause| Error::Unclear { command: request.command(), cause: Box::new(cause) };
            // From here on the line has to tell what happened, also when the user wishes an end.
            match self.shielded(&mut is_done) {
                Ok(true) => return Ok(tries),
                Ok(false) => failure?,
                Err(cause) => return Err(unclear(cause)),
            }
        }
    }

    /// Sends a request that has no reply.
    ///
    /// # Errors
    /// The wire, or [`Error::Cancelled`].
    pub fn tell_all(&mut self, request: &Request) -> Result<(), Error> {
        self.begin()?;
        let frame = request.emit(self.station.address);
        let sent_at = self.now();
        self.send(&frame, sent_at)?;
        let timing = self.station.timing();
        let end = sent_at + timing.characters(frame.bytes().len()) + timing.timeout;
        let mut echo = Vec::new();
        while self.now() < end {
            self.ctx.wire.receive(end, &mut echo)?;
        }
        self.station.quiet_until = self.now();
        Ok(())
    }

    /// One exchange. The outer error ends everything; the inner one may be tried again.
    pub(super) fn attempt(&mut self, request: &Request) -> Result<Result<Answered, Trouble>, Error> {
        if self.station.echo == Echo::Unknown && request.command() != Command::ReadTypeLabel {
            self.ask(&Request::ReadTypeLabel)?;
        }
        self.begin()?;
        let frame = request.emit(self.station.address);
        let sent_at = self.now();
        self.send(&frame, sent_at)?;
        let heard = self.listen(request, &frame, sent_at)?;
        let (first_at, reply) = (heard.first_at, heard.reply.clone());
        let judgement = self.judge(request, heard);
        // What is broken after a frame with an access code may be our own bytes come back: nothing of it is shown.
        let secret = judgement.is_err() && frame.is_secret();
        let shown = if secret { MaskedBytes::hidden(reply.len()) } else { MaskedBytes::clear(&reply) };
        self.ctx.trace.record(first_at, Direction::Received, shown);
        Ok(judgement)
    }

    /// What is right about a broken line before the next try; an error when there is to be none.
    pub(super) fn may_try_again(&mut self, request: &Request, tries: u32, trouble: Trouble) -> Result<(), Error> {
        let now = self.now();
        self.station.damaged += 1;
        let since = *self.station.troubled_since.get_or_insert(now);
        let next_end = now + self.station.timing().worst_case(request) + self.station.margin;
        if tries < TRIES && next_end.since(since) < PATIENCE {
            return Ok(());
        }
        let command = request.command();
        Err(match trouble {
            Trouble::Silence { echo_heard } => {
                Error::NoReply { address: self.station.address, command, tries, echo_heard }
            }
            Trouble::Damage(cause) => Error::Damaged { command, tries, cause },
        })
    }

    /// Reads the codes that an answer announces, and tells a refusal from a reply.
    pub(super) fn settle(&mut self, request: &Request, answered: Answered) -> Result<Timed, Error> {
        self.station.troubled_since = None;
        let (Answer::Reply { pending, .. } | Answer::Rejected { pending, .. }) = &answered.answer;
        if *pending && request.command() != Command::ReadStatus {
            self.collect_codes()?;
        }
        match answered.answer {
            Answer::Reply { reply, .. } => Ok(Timed { reply, at: answered.at, sender: answered.sender }),
            Answer::Rejected { codes, .. } => Err(Error::Rejected { command: request.command(), codes }),
        }
    }

    /// As [`settle`](Self::settle), for what changes the encoder. Codes that a reply announces are left to the next
    /// exchange, which announces them again: no wish to end comes between a change and its being counted, and after 55h
    /// and 67h the encoder is no longer to be found where it was asked.
    pub(super) fn acknowledge(&mut self, request: &Request, answered: Answered) -> Result<(), Error> {
        if matches!(answered.answer, Answer::Reply { .. }) {
            self.station.troubled_since = None;
            return Ok(());
        }
        self.shielded(|master| master.settle(request, answered)).map(drop)
    }

    /// Reads the whole queue into the station: 50h until the error bit is gone.
    pub(super) fn collect_codes(&mut self) -> Result<(), Error> {
        for _ in 0..MOST_CODES {
            let mut tries = 0;
            let answered = loop {
                tries += 1;
                match self.attempt(&Request::ReadStatus)? {
                    Ok(answered) => break answered,
                    Err(trouble) => self.may_try_again(&Request::ReadStatus, tries, trouble)?,
                }
            };
            let (Answer::Reply { pending, .. } | Answer::Rejected { pending, .. }) = answered.answer;
            if let Answer::Reply { reply: Reply::Status(codes), .. } = answered.answer {
                self.station.codes_met.extend(codes.into_iter().filter(|code| *code != StatusCode::OK));
            }
            if !pending {
                break;
            }
        }
        Ok(())
    }

    fn check_cancel(&self) -> Result<(), Error> {
        if !self.shielded && self.ctx.cancel.is_requested() { Err(Error::Cancelled) } else { Ok(()) }
    }

    /// Before each exchange: the user's wish, the dead time, and silence on the line.
    fn begin(&mut self) -> Result<(), Error> {
        if !self.shielded && self.ctx.cancel.stops_transaction() {
            return Err(Error::Cancelled);
        }
        let mut stray = Vec::new();
        while self.now() < self.station.quiet_until {
            self.ctx.wire.receive(self.station.quiet_until, &mut stray)?;
            if !stray.is_empty() {
                self.ctx.trace.record(self.now(), Direction::Received, MaskedBytes::hidden(stray.len()));
                stray.clear();
                self.wait_for_silence()?;
            }
        }
        Ok(())
    }

    /// Sends a frame, and shows of it what may be shown: also where a recording does not know it.
    fn send(&mut self, frame: &SecretFrame, sent_at: Moment) -> Result<(), LinkError> {
        self.ctx.trace.record(sent_at, Direction::Sent, frame.masked());
        self.ctx.wire.send(frame.bytes()).map_err(|mut error| {
            if let LinkErrorKind::NotRecorded(request) = &mut error.kind {
                *request = frame.masked().to_string();
            }
            error
        })
    }

    /// Listens until nothing came for the time-out.
    fn wait_for_silence(&mut self) -> Result<(), Error> {
        let quiet = self.dead_time() + self.station.margin;
        let give_up = self.now() + Duration::from_secs(2);
        let mut stray = Vec::new();
        loop {
            stray.clear();
            self.ctx.wire.receive(self.now() + quiet, &mut stray)?;
            if stray.is_empty() {
                self.station.quiet_until = self.now();
                return Ok(());
            }
            if self.now() > give_up {
                return Err(Error::NeverSilent);
            }
        }
    }

    /// tT has to be greater than the time-out: one bit more.
    fn dead_time(&self) -> Duration {
        self.station.timing().timeout + self.station.format.baud.time_of_bits(1)
    }

    fn listen(&mut self, request: &Request, frame: &SecretFrame, sent_at: Moment) -> Result<Heard, Error> {
        let timing = self.station.timing();
        let deadline = sent_at + timing.worst_case(request) + self.station.margin;
        let gap = timing.timeout + self.station.margin;
        let mut line = Vec::new();
        let mut first_at = sent_at;
        loop {
            let reply = self.without_echo(&line, frame);
            if reply.is_some_and(|reply| request.reply_length(reply).is_none_or(|length| reply.len() >= length.max)) {
                break;
            }
            let begun = reply.is_some_and(|reply| !reply.is_empty());
            let until = if begun { self.now() + gap } else { deadline };
            let before = line.len();
            self.ctx.wire.receive(until, &mut line)?;
            if line.len() == before {
                break;
            }
            if !begun && self.without_echo(&line, frame).is_some_and(|reply| !reply.is_empty()) {
                first_at = self.now();
            }
        }
        let trailing = self.hear_the_dead_time(&mut line)?;
        Ok(self.take_apart(&line, request, frame, first_at, trailing))
    }

    /// The dead time, listening. True when something came that belongs to no reply.
    fn hear_the_dead_time(&mut self, line: &mut Vec<u8>) -> Result<bool, Error> {
        let before = line.len();
        let quiet_until = self.now() + self.dead_time();
        self.ctx.wire.receive(quiet_until, line)?;
        self.station.quiet_until = quiet_until;
        let trailing = line.len() > before;
        if trailing {
            self.wait_for_silence()?;
        }
        Ok(trailing)
    }

    /// The reply as far as it has come; `None` while it may still be the echo.
    fn without_echo<'l>(&self, line: &'l [u8], frame: &SecretFrame) -> Option<&'l [u8]> {
        let sent = frame.bytes();
        match self.station.echo {
            Echo::Off => Some(line),
            Echo::On => line.get(sent.len()..),
            Echo::Unknown => match line.strip_prefix(sent) {
                Some(reply) => Some(reply),
                None if sent.starts_with(line) => None,
                None => Some(line),
            },
        }
    }

    fn take_apart(
        &self,
        line: &[u8],
        request: &Request,
        frame: &SecretFrame,
        first_at: Moment,
        trailing: bool,
    ) -> Heard {
        let sent = frame.bytes();
        let echo_heard = line.starts_with(sent);
        let reply = self.without_echo(line, frame).unwrap_or_default().to_vec();
        let is_reply = |rest: &[u8]| request.parse_reply(self.station.address, rest).is_ok();
        let wrong_echo = match self.station.echo {
            Echo::On => !echo_heard && !line.is_empty(),
            // An echo and a reply have a right checksum together as well: to 50h that is a reply with four codes.
            Echo::Off => line.strip_prefix(sent).is_some_and(is_reply),
            Echo::Unknown => false,
        };
        let damage = if wrong_echo { Some(Damage::Echo) } else { trailing.then_some(Damage::Trailing) };
        Heard { reply, first_at, echo_heard, damage }
    }

    fn judge(&mut self, request: &Request, heard: Heard) -> Result<Answered, Trouble> {
        if let Some(damage) = heard.damage {
            return Err(Trouble::Damage(damage));
        }
        if heard.reply.is_empty() {
            return Err(Trouble::Silence { echo_heard: heard.echo_heard });
        }
        let answer =
            request.parse_reply(self.station.address, &heard.reply).map_err(|e| Trouble::Damage(Damage::Reply(e)))?;
        if let Answer::Rejected { codes, .. } = &answer
            && let Some(code) = codes.iter().find(|code| DAMAGED_REQUEST.contains(code))
        {
            // The request was right when it left: the line damaged it.
            return Err(Trouble::Damage(Damage::AtEncoder(*code)));
        }
        if self.station.echo == Echo::Unknown {
            self.station.echo = if heard.echo_heard { Echo::On } else { Echo::Off };
        }
        let sender = heard.reply.first().copied().unwrap_or(self.station.address);
        Ok(Answered { answer, sender, at: heard.first_at - self.station.timing().character })
    }
}

/// An answer and when it began.
pub(super) struct Answered {
    pub(super) answer: Answer,
    /// The address it came from.
    pub(super) sender: u8,
    at: Moment,
}
