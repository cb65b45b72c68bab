//! Acknowledged words (reference 4), and those whose echo looks like a busy encoder (reference 6.11a).
//!
//! The echo of a word that sets cam 0, the mask, the shift or a program has code 0, as has the processing word, which
//! may contain any data, including those just sent. Such an echo counts once it has lasted longer than any processing
//! by this encoder so far; an edge of cam 0 is also read out before the program is left, since leaving stores it.

use std::time::Duration;

use super::stability::{CycleResult, STAYS_FOR, StabilityTimer};
use super::{Error, Master};
use crate::devices::interbus::procedures::error::ExpectedWord;
use crate::devices::interbus::procedures::handshake::is_echo;
use crate::devices::interbus::protocol::{Command, Reply, Value};

/// IN word of a busy encoder without further bits. The echo of cam 0's start at 0 is identical.
const BUSY: u32 = 0xC000_0000;
/// Maximum number of attempts to set an edge of cam 0. None of the attempts stores the edge.
const TRIES: u32 = 4;

impl Master<'_> {
    /// Sends an acknowledged word until its exact echo is stable.
    ///
    /// # Errors
    /// [`Error::Illegal`], with nothing sent; [`Error::Refused`], [`Error::OtherMaster`], [`Error::TimeOut`]; errors of
    /// the exchange.
    pub(in crate::devices::interbus::procedures) fn set(&mut self, command: Command) -> Result<(), Error> {
        self.resend_setting(command, 0)
    }

    /// Sends a word whose echo proves nothing. `question` reads the value back, and the word is repeated, with a longer
    /// wait each time, until the encoder has accepted it.
    ///
    /// # Errors
    /// As [`set`](Self::set); [`Error::NotTaken`] with the name `item`.
    pub(in crate::devices::interbus::procedures) fn set_and_read_out(
        &mut self,
        command: Command,
        question: Command,
        wanted: Value,
        item: impl FnOnce() -> String,
    ) -> Result<(), Error> {
        let mut reads = wanted;
        for tried in 0..TRIES {
            self.resend_setting(command, tried)?;
            reads = self.ask(question)?;
            if reads == wanted {
                return Ok(());
            }
        }
        Err(Error::NotTaken { item: item(), wanted: wanted.get(), reads: reads.get() })
    }

    fn resend_setting(&mut self, command: Command, tried: u32) -> Result<(), Error> {
        self.ensure_legal(command)?;
        self.await_no_value()?;
        self.parameterising = true;
        self.mark_program_set();
        self.wait_for_acknowledgement(command, tried, false)
    }

    /// Sends a word like [`set`](Self::set), but also accepts a missing echo while the encoder keeps running (`U`).
    pub(super) fn send_instruction(&mut self, command: Command) -> Result<(), Error> {
        self.ensure_legal(command)?;
        self.await_no_value()?;
        self.wait_for_acknowledgement(command, 0, true)
    }

    fn wait_for_acknowledgement(&mut self, command: Command, tried: u32, may_run: bool) -> Result<(), Error> {
        let (before, found) = (self.input, self.found_error);
        let holds = self.holds(command, tried);
        let patience = self.patience + holds.unwrap_or_default();
        let mut rests = StabilityTimer::new(self.recorded);
        self.until(command, ExpectedWord::Echo, patience, |CycleResult { now, word, same }| {
            let reply = Reply::parse(word);
            rests.go_on(matches!(reply, Reply::Run { .. }) || Some(word) == found, now);
            match reply {
                _ if is_echo(command, word) => {
                    holds.map_or(same.is_stable(), |holds| same.has_lasted(holds)).then_some(Ok(()))
                }
                Reply::Error(error) if word != before && Some(word) != found && same.is_stable() => {
                    Some(Err(Error::Refused { sent: command, error }))
                }
                _ if may_run && rests.is_settled() => Some(Ok(())),
                // The echo of an earlier word may still be there or arrive late, with other data than sent (manual 5.3).
                _ => None,
            }
        })
    }

    /// Returns how long an echo that looks like a busy encoder must persist, or `None` if the echo is unambiguous.
    fn holds(&self, command: Command, tried: u32) -> Option<Duration> {
        let echo = Reply::echo_of(command);
        let most = self.patience / 2;
        match echo {
            _ if echo.emit() == BUSY => Some(most),
            Reply::Busy { .. } => Some(((STAYS_FOR + self.known.processing) * (1 << tried.min(TRIES))).min(most)),
            _ => None,
        }
    }
}
