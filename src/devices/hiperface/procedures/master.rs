//! The host side of the serial line: repeats requests, reads back changes, and collects announced status codes. Single
//! exchanges are implemented in [`exchange`].
//!
//! A read is repeated at most five times within at most eight seconds. A write is never repeated without checking its
//! effect.

mod codes;
mod exchange;

use std::time::Duration;

use super::error::ReplyDamage;
use super::{Error, Station};
use crate::devices::hiperface::protocol::{Answer, Command, Reply, Request};
use crate::link::Ctx;
use crate::link::line::{MAX_ATTEMPTS, SerialLine};
use crate::units::Moment;
pub(super) use exchange::{ExchangeFailure, ReceivedAnswer};

pub struct Master<'a> {
    line: SerialLine<'a>,
    station: &'a mut Station,
}

pub(super) struct TimedReply {
    pub(super) reply: Reply,
    /// Time of the first falling edge of the reply, where its first start bit begins.
    pub(super) at: Moment,
    pub(super) sender: u8,
}

impl<'a> Master<'a> {
    /// Creates a master for one job, with the full time limit.
    pub fn new(ctx: Ctx<'a>, station: &'a mut Station) -> Self {
        station.line.begin_job();
        Master { line: SerialLine::new(ctx), station }
    }

    pub fn station(&mut self) -> &mut Station {
        self.station
    }

    pub fn now(&self) -> Moment {
        self.line.now()
    }

    /// Runs `work` without reacting to cancellation. It is used for steps that return the encoder to a safe state.
    pub fn run_uncancellable<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.line.ignore_cancellation(true);
        let result = work(self);
        self.line.ignore_cancellation(before);
        result
    }

    /// Waits for `duration`, or until the job is cancelled.
    ///
    /// # Errors
    /// Returns [`Error::Cancelled`] if the job is cancelled.
    pub fn wait(&mut self, duration: Duration) -> Result<(), Error> {
        Ok(self.line.wait(duration)?)
    }

    /// Listens without sending, and returns the bytes received.
    ///
    /// # Errors
    /// Returns an error if the connection fails, or [`Error::Cancelled`] if the job is cancelled.
    pub fn read_pending(&mut self, duration: Duration) -> Result<Vec<u8>, Error> {
        Ok(self.line.receive_pending(duration)?)
    }

    /// Sets the baud rate and parity of the host.
    ///
    /// # Errors
    /// Returns an error if the connection fails.
    pub fn set_format(&mut self, format: crate::units::CharacterFormat) -> Result<(), Error> {
        self.line.ctx.wire.set_format(format)?;
        self.station.format = format;
        Ok(())
    }

    /// Returns whether the host can set the baud rate and parity. Otherwise, they are set at the far end of the link.
    pub fn can_set_format(&self) -> bool {
        self.line.ctx.wire.can_set_format()
    }

    /// Sends a request that does not change anything in the encoder, and repeats it after line errors.
    ///
    /// # Errors
    /// Returns an error if every attempt fails, the encoder rejects the request, or the user cancels.
    pub(super) fn request(&mut self, request: &Request) -> Result<Reply, Error> {
        self.request_timed(request).map(|timed| timed.reply)
    }

    /// Runs `work` with every reply received twice, for values that will be stored.
    pub fn run_double_checked<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::replace(&mut self.station.reads_twice, true);
        let result = work(self);
        self.station.reads_twice = before;
        result
    }

    /// Sends a request like [`request`](Self::request). If the line has damaged data before, the same reply must be
    /// received twice.
    ///
    /// # Errors
    /// Returns an error from [`request`](Self::request) if the exchange fails.
    pub(super) fn request_confirmed(&mut self, request: &Request) -> Result<Reply, Error> {
        let mut reply = self.request(request)?;
        for _ in 0..MAX_ATTEMPTS {
            if !self.station.requires_double_read() {
                return Ok(reply);
            }
            let again = self.request(request)?;
            if again == reply {
                return Ok(reply);
            }
            self.station.line.quality.damaged += 1;
            reply = again;
        }
        Err(Error::Damaged { command: request.command(), tries: MAX_ATTEMPTS, cause: ReplyDamage::Inconsistent })
    }

    pub(super) fn request_timed(&mut self, request: &Request) -> Result<TimedReply, Error> {
        let mut tries = 0;
        loop {
            tries += 1;
            match self.exchange_once(request)? {
                Ok(answer) => return self.resolve_status(request, answer),
                Err(trouble) => self.prepare_retry(request, tries, trouble)?,
            }
        }
    }

    /// Sends a request that changes the encoder, and returns how often it may have been executed. If it is unclear
    /// whether an attempt succeeded, `is_done` reads back the result. The request is repeated only if it was not
    /// executed.
    ///
    /// # Errors
    /// Returns an error if the encoder rejects the request or does not execute it in five attempts. Returns
    /// [`Error::Unclear`] if `is_done` cannot determine the result.
    pub(super) fn send_verified(
        &mut self,
        request: &Request,
        mut is_done: impl FnMut(&mut Self) -> Result<bool, Error>,
    ) -> Result<u32, Error> {
        let mut tries = 0;
        loop {
            tries += 1;
            let trouble = match self.exchange_once(request)? {
                Ok(answer) => return self.acknowledge(request, answer).map(|()| tries),
                Err(trouble) => trouble,
            };
            let failure = self.prepare_retry(request, tries, trouble);
            let unclear = |cause| Error::Unclear { command: request.command(), cause: Box::new(cause) };
            // From here on, the result must be determined even after a cancellation.
            match self.run_uncancellable(&mut is_done) {
                Ok(true) => return Ok(tries),
                Ok(false) => failure?,
                Err(cause) => return Err(unclear(cause)),
            }
        }
    }

    /// Sends a request to which no encoder replies.
    ///
    /// # Errors
    /// Returns an error if the connection fails, or [`Error::Cancelled`] if the job is cancelled.
    pub(super) fn send_broadcast(&mut self, request: &Request) -> Result<(), Error> {
        self.wait_for_line()?;
        let frame = request.emit(self.station.address);
        let sent_at = self.now();
        self.send(&frame, sent_at)?;
        let timing = self.station.timing();
        let end = sent_at + timing.time_of_characters(frame.bytes().len()) + timing.timeout;
        let mut echo = Vec::new();
        while self.now() < end {
            self.line.receive(end, &mut echo)?;
        }
        self.station.line.quiet_until = self.now();
        Ok(())
    }

    /// Prepares the line for another attempt, or returns an error after the last attempt.
    pub(super) fn prepare_retry(
        &mut self,
        request: &Request,
        tries: u32,
        trouble: ExchangeFailure,
    ) -> Result<(), Error> {
        let quality = &mut self.station.line.quality;
        match &trouble {
            ExchangeFailure::Silence { .. } => quality.unanswered += 1,
            ExchangeFailure::Damage(ReplyDamage::Late) => quality.late += 1,
            ExchangeFailure::Damage(_) => quality.damaged += 1,
        }
        let longest = self.station.timing().worst_case(request) + self.station.line.margin;
        if self.line.may_retry(&mut self.station.line, tries, longest) {
            if matches!(trouble, ExchangeFailure::Silence { .. }) {
                let quiet = self.silence_duration();
                self.line.receive_late_bytes(&mut self.station.line, tries, quiet)?;
            }
            return Ok(());
        }
        let command = request.command();
        Err(match trouble {
            ExchangeFailure::Silence { echo_heard } => {
                Error::NoReply { address: self.station.address, command, tries, echo_heard }
            }
            ExchangeFailure::Damage(cause) => Error::Damaged { command, tries, cause },
        })
    }

    /// Reads the status codes that a reply announces, and converts a rejection to an error.
    pub(super) fn resolve_status(&mut self, request: &Request, answered: ReceivedAnswer) -> Result<TimedReply, Error> {
        self.station.line.clear_error();
        let (Answer::Reply { pending, .. } | Answer::Rejected { pending, .. }) = &answered.answer;
        if *pending && request.command() != Command::ReadStatus {
            self.collect_codes()?;
        }
        match answered.answer {
            Answer::Reply { reply, .. } => Ok(TimedReply { reply, at: answered.at, sender: answered.sender }),
            Answer::Rejected { codes, .. } => Err(Error::Rejected { command: request.command(), codes }),
        }
    }

    /// Completes a request that changes the encoder. Unlike [`resolve_status`](Self::resolve_status), it leaves
    /// announced status codes to the next exchange, which announces them again. As a result, a job cannot be cancelled
    /// between a change and its counting. Furthermore, status codes cannot be read after 55h and 67h, because the
    /// encoder no longer replies with the old settings.
    pub(super) fn acknowledge(&mut self, request: &Request, answered: ReceivedAnswer) -> Result<(), Error> {
        if matches!(answered.answer, Answer::Reply { .. }) {
            self.station.line.clear_error();
            return Ok(());
        }
        self.run_uncancellable(|master| master.resolve_status(request, answered)).map(drop)
    }
}
