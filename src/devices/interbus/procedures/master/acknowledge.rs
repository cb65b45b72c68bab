//! Acknowledges settings by their echo (reference 4), even if the echo looks like the word of a busy encoder (reference
//! 6.11a).
//!
//! The echo of a word that sets cam 0, the mask, the shift or a program has code 0. The word of a busy encoder has the
//! same code, and may also contain the data just sent. Such an echo is accepted once it has lasted longer than this
//! encoder has ever been busy. An edge of cam 0 is also read out before the program is left, because leaving the
//! program stores the edge.

use std::time::Duration;

use super::stability::{ACCEPTANCE_TIME, CycleResult, StabilityTimer};
use super::{Error, Master};
use crate::devices::interbus::procedures::error::ExpectedWord;
use crate::devices::interbus::procedures::handshake::is_echo;
use crate::devices::interbus::protocol::{Command, Reply, Value};

/// IN word of a busy encoder without data bits. The echo looks the same when the start of cam 0 is set to 0.
const BUSY: u32 = 0xC000_0000;
/// Maximum number of attempts to set an edge of cam 0. None of them stores it.
const MAX_ATTEMPTS: u32 = 4;

impl Master<'_> {
    /// Sends a setting until its exact echo is stable.
    ///
    /// # Errors
    /// Returns [`Error::Illegal`] if the word must not be sent. After sending, returns [`Error::Refused`],
    /// [`Error::OtherMaster`] or [`Error::TimeOut`], or another error if the exchange fails.
    pub(in crate::devices::interbus::procedures) fn send_setting(&mut self, command: Command) -> Result<(), Error> {
        self.try_send_setting(command, 0)
    }

    /// Sends a setting whose echo is ambiguous, then reads the value back with `question`. Both are repeated with
    /// longer waiting times until the encoder has accepted the value.
    ///
    /// # Errors
    /// Returns [`Error::NotAccepted`] with the name `item` if the value is not accepted, or an error of
    /// [`send_setting`](Self::send_setting).
    pub(in crate::devices::interbus::procedures) fn set_and_verify(
        &mut self,
        command: Command,
        question: Command,
        wanted: Value,
        item: impl FnOnce() -> String,
    ) -> Result<(), Error> {
        let mut reads = wanted;
        for tried in 0..MAX_ATTEMPTS {
            self.try_send_setting(command, tried)?;
            reads = self.request_value(question)?;
            if reads == wanted {
                return Ok(());
            }
        }
        Err(Error::NotAccepted { item: item(), wanted: wanted.get(), reads: reads.get() })
    }

    fn try_send_setting(&mut self, command: Command, tried: u32) -> Result<(), Error> {
        self.ensure_legal(command)?;
        self.wait_until_value_cleared()?;
        self.parameterising = true;
        self.mark_program_set();
        self.wait_for_acknowledgement(command, tried, false)
    }

    /// Sends a word until its echo is stable. It also counts as accepted if the encoder keeps running without an echo
    /// (`U`: not documented).
    pub(super) fn send_mode_command(&mut self, command: Command) -> Result<(), Error> {
        self.ensure_legal(command)?;
        self.wait_until_value_cleared()?;
        self.wait_for_acknowledgement(command, 0, true)
    }

    fn wait_for_acknowledgement(&mut self, command: Command, tried: u32, may_run: bool) -> Result<(), Error> {
        let (before, found) = (self.input, self.found_error);
        let holds = self.required_echo_time(command, tried);
        let patience = self.patience + holds.unwrap_or_default();
        let mut rests = StabilityTimer::new(self.recorded);
        self.repeat_until(command, ExpectedWord::Echo, patience, |CycleResult { now, word, same }| {
            let reply = Reply::parse(word);
            rests.update(matches!(reply, Reply::Run { .. }) || Some(word) == found, now);
            match reply {
                _ if is_echo(command, word) => {
                    holds.map_or(same.is_stable(), |holds| same.has_held_for(holds)).then_some(Ok(()))
                }
                Reply::Error(error) if word != before && Some(word) != found && same.is_stable() => {
                    Some(Err(Error::Refused { sent: command, error }))
                }
                _ if may_run && rests.is_settled() => Some(Ok(())),
                // An earlier word may be echoed late or still be echoed, with other data. See manual 5.3.
                _ => None,
            }
        })
    }

    /// Returns how long the echo of a command must persist, or `None` if it cannot be mistaken for the word of a busy
    /// encoder.
    fn required_echo_time(&self, command: Command, tried: u32) -> Option<Duration> {
        let echo = Reply::echo_for(command);
        let most = self.patience / 2;
        match echo {
            _ if echo.emit() == BUSY => Some(most),
            Reply::Busy { .. } => {
                Some(((ACCEPTANCE_TIME + self.known.processing) * (1 << tried.min(MAX_ATTEMPTS))).min(most))
            }
            _ => None,
        }
    }
}
