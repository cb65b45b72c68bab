//! The mode of an encoder: read at the start of a job, changed by it, and restored at its end.

use std::time::Duration;

use super::Master;
use super::stability::CycleResult;
use crate::devices::interbus::procedures::Error;
use crate::devices::interbus::procedures::error::ExpectedWord;
use crate::devices::interbus::protocol::{Command, ReadOutNumber, Reply, StartupMode};

/// Time limit for a requested cam value to disappear after 00000000h. After that, 80000000h is sent (`U`: not
/// documented).
const VALUE_CLEAR_TIMEOUT: Duration = Duration::from_millis(300);
/// Number of additional readings of the IN word, which are needed because the first one may return an old word.
const EXTRA_READINGS: u32 = 2;
const READING_INTERVAL: Duration = Duration::from_millis(10);
/// How long the mode need not be read again after a step of a job has restored it.
const MODE_VALIDITY: Duration = Duration::from_secs(1);

impl Master<'_> {
    /// Runs `work` and then returns the encoder to its previous mode, even after an error.
    ///
    /// # Errors
    /// Returns the error of `work`, [`Error::NotRunning`] if the work cannot begin, or [`Error::ModeNotRestored`] if
    /// the mode cannot be restored.
    pub fn run_guarded<T>(&mut self, work: impl FnOnce(&mut Self) -> Result<T, Error>) -> Result<T, Error> {
        let ended = self.enter().and_then(|()| work(self));
        self.finish(ended)
    }

    /// Returns the encoder to its state before [`enter`](Self::enter), even if the work has failed.
    ///
    /// # Errors
    /// Returns the error of the work, or [`Error::ModeNotRestored`] if the state cannot be restored.
    pub(in crate::devices::interbus::procedures) fn finish<T>(&mut self, ended: Result<T, Error>) -> Result<T, Error> {
        let led = match &ended {
            // The link is lost, so nothing more can be sent.
            Err(error @ Error::Link(_)) => Err(error.clone()),
            _ => self.run_uncancellable(Self::return_to_original_mode),
        };
        let is_back = led.is_ok() || self.is_in_initial_state();
        self.record_step_end(is_back);
        let Err(why) = led else {
            self.rested = self.is_in_initial_state().then(|| self.data.now());
            return ended;
        };
        let cause = ended.err().unwrap_or(why);
        if self.is_in_initial_state() {
            return Err(cause);
        }
        Err(Error::ModeNotRestored { cause: Box::new(cause), standing: self.left_state() })
    }

    /// Ends a parameterisation, error or read-out that another program left behind, and returns the resulting mode.
    /// Values that were set but not stored are now stored, which uses one EEPROM write cycle. An error that persists is
    /// not reported, since the encoder can still be read and set.
    ///
    /// # Errors
    /// Returns [`Error::ModeNotRestored`] with the cause if the encoder cannot be returned to operation.
    pub fn end_interrupted_operation(&mut self) -> Result<StartupMode, Error> {
        let ended = self.run_uncancellable(|master| {
            master.clear_run_command()?;
            let was_set = !matches!(Reply::parse(master.input), Reply::Run { .. });
            match master.run() {
                Err(Error::Refused { error, .. }) => {
                    (master.found_error, master.parameterising) = (Some(Reply::Error(error).emit()), false);
                }
                ended => ended?,
            }
            master.return_to_operation()?;
            let mode = master.read_startup_mode()?;
            master.found = Some(mode);
            if was_set {
                master.record_interrupted_store()?;
            }
            master.resume(mode)?;
            master.return_to_original_mode()?;
            Ok(master.is.unwrap_or(mode))
        });
        self.record_step_end(ended.is_ok());
        ended.map_err(|cause: Error| Error::ModeNotRestored { cause: Box::new(cause), standing: self.left_state() })
    }

    /// Switches the encoder to a mode and checks the result.
    ///
    /// # Errors
    /// Returns [`Error::NoMode`], [`Error::NotSelectable`] or [`Error::UnknownMode`] if the switch is not possible, or
    /// another error if the handshake or the exchange fails.
    pub(in crate::devices::interbus::procedures) fn switch_to_mode(
        &mut self,
        wanted: StartupMode,
    ) -> Result<(), Error> {
        use StartupMode::{Cams, K2, K3, Unknown, Velocity};
        match (self.is, wanted) {
            (_, Unknown(_)) => Err(Error::NotSelectable { mode: wanted }),
            (Some(mode @ Unknown(_)), _) => Err(Error::UnknownMode { mode }),
            (Some(is), wanted) if is_same_operating_mode(is, wanted) => Ok(()),
            (Some(Velocity), K2 | K3) => self.send_mode_word(Command::Velocity(false), wanted),
            (_, K2 | K3) => self.send_mode_word(Command::Cams(None), wanted),
            (Some(Cams(_)), Velocity) => {
                self.switch_to_mode(K3)?;
                self.switch_to_mode(wanted)
            }
            (_, Velocity) => self.send_mode_word(Command::Velocity(true), wanted),
            (Some(Velocity), Cams(_)) => {
                self.switch_to_mode(K3)?;
                self.switch_to_mode(wanted)
            }
            (_, Cams(program)) => self.send_mode_word(Command::Cams(Some(program)), wanted),
        }
    }

    /// Keeps the current mode after the job instead of returning to the original one.
    pub(in crate::devices::interbus::procedures) fn keep_current_mode(&mut self) {
        self.found = self.is;
    }

    /// Reads the state and mode of the encoder. They determine what the words to be sent will mean.
    pub(in crate::devices::interbus::procedures) fn enter(&mut self) -> Result<(), Error> {
        let begun = self.data.now();
        let mut looks = 0;
        loop {
            self.input = self.data.input()?;
            let waited = self.data.now().duration_since(begun);
            match Reply::parse(self.input) {
                Reply::Echo { .. } | Reply::Busy { .. } if waited >= self.patience => {
                    let input = self.input;
                    return Err(match self.swapped_word_order(input)? {
                        Some(swapped) => Error::WordOrder { input, swapped },
                        None => Error::NotRunning { input },
                    });
                }
                Reply::Echo { .. } | Reply::Busy { .. } => {}
                _ if looks >= EXTRA_READINGS => break,
                _ => looks += 1,
            }
            self.data.wait(READING_INTERVAL)?;
        }
        if let Reply::Error(_) = Reply::parse(self.input) {
            self.found_error = Some(self.input);
        }
        let runs = matches!(Reply::parse(self.input), Reply::Run { .. });
        if runs && self.rested.take().is_some_and(|rested| self.data.now().duration_since(rested) < MODE_VALIDITY) {
            return Ok(());
        }
        let mode = self.read_startup_mode()?;
        self.found = Some(mode);
        self.resume(mode)?;
        let keeps = match mode {
            StartupMode::Cams(_) => Command::Run,
            StartupMode::Velocity => Command::Velocity(true),
            _ => return Ok(()),
        };
        if self.known.kept == Some(mode) || self.known.hold.is_some_and(|(held, _)| held == mode) {
            return Ok(());
        }
        // Checks whether this read-out has ended the mode, because words for cams have other effects in another mode.
        self.send_idle_word()?;
        if is_same_operating_mode(self.read_startup_mode()?, mode) {
            self.known.kept = Some(mode);
            return Ok(());
        }
        self.known.hold = Some((mode, keeps));
        self.switch_to_mode(mode)
    }

    /// Returns whether the encoder is certainly in its initial mode: the OUT word is normal operation, no command was
    /// lost, and no parameters or cams are being set.
    fn is_in_initial_state(&self) -> bool {
        let rests = matches!(self.out, None | Some(Command::Normal));
        rests && !self.lost && !self.parameterising && !self.unsure && self.is == self.found
    }

    fn read_startup_mode(&mut self) -> Result<StartupMode, Error> {
        let mode = StartupMode::parse(self.read_out(ReadOutNumber::STARTUP_MODE)?);
        (self.is, self.known.mode, self.unsure) = (Some(mode), Some(mode), false);
        Ok(mode)
    }

    /// Sends a word that changes the mode, then 00000000h, and reads the mode. If the encoder does not stay in the
    /// mode, the word that holds it there replaces 00000000h. The manual does not say which word is required (`U`).
    fn send_mode_word(&mut self, command: Command, wanted: StartupMode) -> Result<(), Error> {
        let of_cams = matches!(command, Command::Cams(_));
        let keeps = if of_cams { Command::Run } else { command };
        let known = self.known.hold.is_some_and(|(mode, _)| mode == wanted);
        let mut is = wanted;
        self.record_mode_switch(wanted)?;
        for held in [false, true].into_iter().skip(usize::from(known)) {
            (self.unsure, self.switched) = (true, true);
            self.send_mode_command(command)?;
            if of_cams {
                self.run()?;
            }
            self.known.hold = held.then_some((wanted, keeps));
            if !held {
                self.return_to_operation()?;
            }
            is = self.read_startup_mode()?;
            if is_same_operating_mode(is, wanted) {
                if !held {
                    self.known.kept = Some(wanted);
                }
                return Ok(());
            }
        }
        self.known.hold = None;
        Err(Error::NoMode { wanted, is })
    }

    /// Returns the encoder to its original mode.
    fn return_to_original_mode(&mut self) -> Result<(), Error> {
        if self.out.is_none() {
            return Ok(());
        }
        let Some(found) = self.found else {
            // Only read-outs were sent, since the encoder never reported its mode.
            self.run_cycle(Command::Normal)?;
            return Ok(());
        };
        let reply = Reply::parse(self.input);
        let stands = matches!(reply, Reply::Echo { .. } | Reply::Busy { .. })
            || matches!(reply, Reply::Error(_)) && Some(self.input) != self.found_error;
        if self.parameterising || self.unsure || stands {
            if self.out == Some(Command::Run) {
                self.clear_run_command()?;
            }
            self.run()?;
            self.return_to_operation()?;
        }
        if self.unsure {
            self.read_startup_mode()?;
        }
        // A read-out may also have ended the mode.
        if self.switched || !matches!(found, StartupMode::K2 | StartupMode::K3) {
            self.send_idle_word()?;
            self.read_startup_mode()?;
        }
        if !matches!(found, StartupMode::Unknown(_)) {
            self.switch_to_mode(found)?;
        }
        self.send_idle_word()
    }

    /// Sends 00000000h, because 80000000h takes effect only on a rising edge.
    fn clear_run_command(&mut self) -> Result<(), Error> {
        for _ in 0..EXTRA_READINGS {
            self.run_cycle(Command::Normal)?;
        }
        Ok(())
    }

    /// Sends the word that holds the mode and requests nothing.
    fn send_idle_word(&mut self) -> Result<(), Error> {
        self.wait_until_value_cleared()?;
        let word = self.idle_command();
        if self.out == Some(word) { Ok(()) } else { self.return_to_running(word, self.patience) }
    }

    fn idle_command(&self) -> Command {
        let hold = self.known.hold.filter(|(mode, _)| self.is.is_some_and(|is| is_same_operating_mode(is, *mode)));
        hold.map_or(Command::Normal, |(_, word)| word)
    }

    /// Waits until the IN word no longer contains a value, since a new value could not be told apart from the old one.
    pub(super) fn wait_until_value_cleared(&mut self) -> Result<(), Error> {
        let asks = self.out.is_some_and(is_read_command);
        let stands = matches!(Reply::parse(self.input), Reply::ReadOut(_) | Reply::UnknownReadOut(_));
        if !asks && !stands {
            return Ok(());
        }
        if self.parameterising {
            return self.clear_query_while_setting();
        }
        let word = self.idle_command();
        let of_cams = matches!(self.is, Some(StartupMode::Cams(_))) && word == Command::Normal;
        let patience = if of_cams { VALUE_CLEAR_TIMEOUT.min(self.patience) } else { self.patience };
        match self.return_to_running(word, patience) {
            Err(Error::TimeOut { .. }) if of_cams => {
                self.return_to_running(Command::Run, self.patience)?;
                self.return_to_running(word, self.patience)
            }
            ended => ended,
        }
    }

    /// Sends 00000000h until the IN word no longer contains a value. While parameters or cams are being set, 80000000h
    /// would store them. A value that persists is accepted, because it differs from the next echo.
    fn clear_query_while_setting(&mut self) -> Result<(), Error> {
        let patience = VALUE_CLEAR_TIMEOUT.min(self.patience);
        let ended =
            self.repeat_until(Command::Normal, ExpectedWord::Run, patience, |CycleResult { word, same, .. }| {
                let asks = matches!(Reply::parse(word), Reply::ReadOut(_) | Reply::UnknownReadOut(_));
                (!asks && same.is_stable()).then_some(Ok(()))
            });
        match ended {
            Err(Error::TimeOut { .. }) => Ok(()),
            ended => ended,
        }
    }
}

/// Returns whether two modes are equal. K2 and K3 count as equal, since the IN word contains the position in both.
pub(super) fn is_same_operating_mode(is: StartupMode, wanted: StartupMode) -> bool {
    let is_plain = |mode| matches!(mode, StartupMode::K2 | StartupMode::K3);
    is == wanted || is_plain(is) && is_plain(wanted)
}

fn is_read_command(command: Command) -> bool {
    matches!(
        command,
        Command::ReadOut(_)
            | Command::ReadActivation
            | Command::ReadCamStart(_)
            | Command::ReadCamStop(_)
            | Command::ReadShift
    )
}
