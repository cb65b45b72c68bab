//! Single exchanges with the timing of the protocol (manual, "Dialog Timing"): dead time, request, reply, dead time.
//!
//! A reply of known length ends with its last byte. Any other reply ends with silence. The host keeps listening during
//! the dead time that follows. A byte received during this time means that the frame was longer than expected, so the
//! whole frame is discarded.

use std::time::Duration;

use super::Master;
use crate::bits::MaskedBytes;
use crate::devices::hiperface::procedures::error::ReplyDamage;
use crate::devices::hiperface::procedures::{Echo, Error};
use crate::devices::hiperface::protocol::{Answer, Command, MaskableFrame, Request, StatusCode};
use crate::link::LinkError;
use crate::units::Moment;

/// Status codes which indicate that the request was damaged on the line. They include `LENGTH`, because the checksum
/// remains valid if a byte 00h is lost.
const LINE_ERROR_CODES: [StatusCode; 3] = [StatusCode::PARITY, StatusCode::CHECKSUM, StatusCode::LENGTH];

pub(in super::super) enum ExchangeFailure {
    /// No reply was received, except possibly the echo.
    Silence {
        /// Whether the sent bytes were received as an echo.
        echo_heard: bool,
    },
    Damage(ReplyDamage),
}

pub(in super::super) struct ReceivedAnswer {
    pub(in super::super) answer: Answer,
    pub(in super::super) sender: u8,
    pub(super) at: Moment,
}

/// Bytes received in one exchange, without the echo.
struct ReceivedBytes {
    reply: Vec<u8>,
    /// Time at which the first byte of the reply was complete.
    first_at: Moment,
    echo_heard: bool,
    damage: Option<ReplyDamage>,
}

impl Master<'_> {
    /// Performs one exchange. The outer error is final. The inner error permits another attempt.
    pub(in super::super) fn exchange_once(
        &mut self,
        request: &Request,
    ) -> Result<Result<ReceivedAnswer, ExchangeFailure>, Error> {
        if request.command() != Command::ReadTypeLabel {
            self.detect_echo()?;
        }
        self.wait_for_line()?;
        let frame = request.emit(self.station.address);
        let sent_at = self.now();
        self.station.line.mark_sent(sent_at);
        self.send(&frame, sent_at)?;
        let heard = self.receive_reply(request, &frame, sent_at)?;
        let (first_at, reply) = (heard.first_at, heard.reply.clone());
        let judgement = self.match_reply(request, heard);
        // A damaged reply to a frame with an access code may be the echo of the frame, so none of it is shown.
        let secret = judgement.is_err() && frame.is_secret();
        let shown = if secret { MaskedBytes::fully_masked(reply.len()) } else { MaskedBytes::unmasked(&reply) };
        self.line.show(first_at, shown);
        // Damaged bytes may contain a complete reply. Late or extra bytes were kept while listening, and an echo is not
        // a reply.
        if let Err(ExchangeFailure::Damage(ReplyDamage::Reply(_))) = judgement {
            self.line.skip_bytes(&reply);
        }
        Ok(judgement.map_err(|trouble| match trouble {
            ExchangeFailure::Damage(ReplyDamage::Reply(_)) if secret => {
                ExchangeFailure::Damage(ReplyDamage::Unreadable)
            }
            trouble => trouble,
        }))
    }

    /// Finds out whether the line has an echo, unless this is already known.
    pub(super) fn detect_echo(&mut self) -> Result<(), Error> {
        if self.station.line.echo == Echo::Unknown {
            self.request(&Request::ReadTypeLabel)?;
        }
        Ok(())
    }

    /// Checks for cancellation, then waits for the dead time and for silence on the line.
    pub(super) fn wait_for_line(&mut self) -> Result<(), Error> {
        let quiet = self.silence_duration();
        Ok(self.line.begin_exchange(&mut self.station.line, quiet)?)
    }

    /// Sends a frame, and traces it with its access codes masked.
    pub(super) fn send(&mut self, frame: &MaskableFrame, sent_at: Moment) -> Result<(), LinkError> {
        self.line.send(frame.bytes(), frame.to_masked(), sent_at)
    }

    /// Returns the dead time tT. It must exceed the time-out, so it is one bit longer.
    fn dead_time(&self) -> Duration {
        self.station.timing().timeout + self.station.format.baud.duration_of_bits(1)
    }

    /// Returns how long the line must be silent before it counts as free.
    pub(super) fn silence_duration(&self) -> Duration {
        self.dead_time() + self.station.line.margin
    }

    fn receive_reply(
        &mut self,
        request: &Request,
        frame: &MaskableFrame,
        sent_at: Moment,
    ) -> Result<ReceivedBytes, Error> {
        let timing = self.station.timing();
        let deadline = sent_at + timing.worst_case(request) + self.station.line.margin;
        let gap = timing.timeout + self.station.line.margin;
        let mut line = Vec::new();
        let mut first_at = sent_at;
        loop {
            let reply = self.strip_echo(&line, frame);
            if reply.is_some_and(|reply| request.reply_length(reply).is_none_or(|length| reply.len() >= length.max)) {
                break;
            }
            let begun = reply.is_some_and(|reply| !reply.is_empty());
            let until = if begun { self.now() + gap } else { deadline };
            let before = line.len();
            self.line.receive(until, &mut line)?;
            if line.len() == before {
                break;
            }
            let first = self.strip_echo(&line, frame).filter(|reply| !begun && !reply.is_empty());
            if let Some(reply) = first {
                // A converter may deliver several characters at once, so the first character was complete at an earlier
                // time.
                first_at = match self.line.ctx.wire.reply_start() {
                    Some(start) => start + timing.character,
                    None => self.now() - timing.time_of_characters(reply.len() - 1),
                };
            }
        }
        let begun = self.strip_echo(&line, frame).is_some_and(|reply| !reply.is_empty());
        let more = self.receive_during_dead_time(&mut line, frame)?;
        let intrusion = match (begun, more) {
            (_, false) => None,
            (true, true) => Some(ReplyDamage::Trailing),
            (false, true) => {
                let quiet = self.silence_duration();
                self.line.discard_late_answers(&mut self.station.line, quiet)?;
                Some(ReplyDamage::Late)
            }
        };
        Ok(self.parse_received_line(&line, request, frame, first_at, intrusion))
    }

    /// Listens during the dead time, and returns whether unexpected bytes arrived.
    fn receive_during_dead_time(&mut self, line: &mut Vec<u8>, frame: &MaskableFrame) -> Result<bool, Error> {
        let before = line.len();
        let quiet_until = self.now() + self.dead_time();
        self.line.receive(quiet_until, line)?;
        self.station.line.quiet_until = quiet_until;
        let trailing = line.len() > before;
        if trailing {
            let (quiet, echo) = (self.silence_duration(), self.station.line.echo);
            self.line.skip_bytes(echo.strip_echo(line, frame.bytes()).unwrap_or_default());
            self.line.wait_for_silence(&mut self.station.line, quiet)?;
        }
        Ok(trailing)
    }

    /// Returns the reply received so far, or `None` while the bytes may still be the echo.
    fn strip_echo<'l>(&self, line: &'l [u8], frame: &MaskableFrame) -> Option<&'l [u8]> {
        self.station.line.echo.strip_echo(line, frame.bytes())
    }

    fn parse_received_line(
        &self,
        line: &[u8],
        request: &Request,
        frame: &MaskableFrame,
        first_at: Moment,
        intrusion: Option<ReplyDamage>,
    ) -> ReceivedBytes {
        let sent = frame.bytes();
        let echo_heard = line.starts_with(sent);
        let reply = self.strip_echo(line, frame).unwrap_or_default().to_vec();
        let is_reply = |rest: &[u8]| request.parse_reply(self.station.address, rest).is_ok();
        let wrong_echo = match self.station.line.echo {
            Echo::On => !echo_heard && !line.is_empty(),
            // An echo followed by a reply also has a valid checksum. After 50h, it looks like a reply with four codes.
            Echo::Off => line.strip_prefix(sent).is_some_and(is_reply),
            Echo::Unknown => false,
        };
        let damage = if wrong_echo { Some(ReplyDamage::Echo) } else { intrusion };
        ReceivedBytes { reply, first_at, echo_heard, damage }
    }

    fn match_reply(&mut self, request: &Request, heard: ReceivedBytes) -> Result<ReceivedAnswer, ExchangeFailure> {
        if let Some(damage) = heard.damage {
            return Err(ExchangeFailure::Damage(damage));
        }
        if heard.reply.is_empty() {
            return Err(ExchangeFailure::Silence { echo_heard: heard.echo_heard });
        }
        let answer = request
            .parse_reply(self.station.address, &heard.reply)
            .map_err(|e| ExchangeFailure::Damage(ReplyDamage::Reply(e)))?;
        if let Answer::Rejected { codes, .. } = &answer
            && let Some(code) = codes.iter().find(|code| LINE_ERROR_CODES.contains(code))
        {
            // The request was correct when it was sent, so the line damaged it.
            return Err(ExchangeFailure::Damage(ReplyDamage::AtEncoder(*code)));
        }
        self.station.line.mark_replied();
        self.station.line.record_answer_start(heard.first_at);
        self.station.line.echo.record_echo(heard.echo_heard);
        let sender = heard.reply.first().copied().unwrap_or(self.station.address);
        Ok(ReceivedAnswer { answer, sender, at: heard.first_at - self.station.timing().character })
    }
}
