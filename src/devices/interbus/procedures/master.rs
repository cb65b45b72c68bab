//! Host side of the handshake (reference 4). Each word is sent until it takes effect. A word that the encoder would
//! interpret differently in its current mode is never sent.

mod acknowledge;
mod modes;
mod notes;
mod stability;

use std::time::Duration;

use notes::JournalNotes;
use stability::{CycleResult, MIN_HANDSHAKE_TIMEOUT, StabilityTimer};

use super::data::ProcessData;
use super::error::{ExpectedWord, RequestedItem};
use super::handshake::{Handshake, LeftState, WordReply, is_echo};
use super::reading::{find_swapped_word, swapped_position_word};
use super::{Error, Gateway, KnownState, Station, WordReading};
use crate::devices::interbus::protocol::{
    Command, EncoderMode, Gear, ReadOutNumber, Reply, StartupMode, Value, WindowShift,
};
use crate::link::Ctx;
use crate::units::Moment;

type StepListener<'a> = Box<dyn FnMut(Handshake) + 'a>;

/// Host side of the handshake with one encoder, for the duration of one job.
pub struct Master<'a> {
    data: Box<dyn ProcessData + 'a>,
    known: &'a mut KnownState,
    patience: Duration,
    recorded: bool,
    tell: Option<StepListener<'a>>,
    /// Mode of the encoder, or `None` if it has not been read in this job.
    is: Option<StartupMode>,
    /// Whether a mode switch has not been confirmed by the encoder yet.
    unsure: bool,
    /// Whether this job has switched the encoder to another mode.
    switched: bool,
    /// Mode before this job, or `None` if it has not been read.
    found: Option<StartupMode>,
    /// Error word that the encoder was already sending before this job. It replaces the position until its cause is
    /// removed.
    found_error: Option<u32>,
    parameterising: bool,
    out: Option<Command>,
    /// Whether the last command may have been lost.
    lost: bool,
    input: u32,
    /// Time at which the encoder was last known to be in its initial state.
    rested: Option<Moment>,
    reported: Option<(u32, WordReply)>,
    notes: JournalNotes<'a>,
}

impl<'a> Master<'a> {
    /// Creates a master for one job, which reaches the encoder through the gateway.
    pub fn new(ctx: Ctx<'a>, station: &'a mut Station) -> Self {
        let (patience, recorded) = (station.link.handshake, station.recorded);
        let (gateway, known) = Gateway::new(ctx, station);
        Master { recorded, ..Master::from_parts(Box::new(gateway), known, patience) }
    }

    /// Creates a master for one job on the given process data.
    pub fn for_job(data: impl ProcessData + 'a, station: &'a mut Station) -> Self {
        let patience = station.link.handshake;
        Master::from_parts(Box::new(data), &mut station.known, patience)
    }

    fn from_parts(data: Box<dyn ProcessData + 'a>, known: &'a mut KnownState, patience: Duration) -> Self {
        Master {
            data,
            known,
            patience: patience.max(MIN_HANDSHAKE_TIMEOUT),
            recorded: false,
            tell: None,
            is: None,
            unsure: false,
            switched: false,
            found: None,
            found_error: None,
            parameterising: false,
            out: None,
            lost: false,
            input: 0,
            rested: None,
            reported: None,
            notes: JournalNotes::default(),
        }
    }

    /// Sets the callback for each step of the handshake.
    #[must_use]
    pub fn with_reporter(mut self, tell: impl FnMut(Handshake) + 'a) -> Self {
        self.tell = Some(Box::new(tell));
        self
    }

    pub fn now(&self) -> Moment {
        self.data.now()
    }

    /// Returns the last known mode, which may date from an earlier job.
    pub fn mode(&self) -> Option<StartupMode> {
        self.is.or(self.known.mode)
    }

    /// Returns the mode, or `None` if the encoder has not reported it in this job.
    pub(super) const fn reported_mode(&self) -> Option<StartupMode> {
        if self.unsure { None } else { self.is }
    }

    /// Remembers the gear of the encoder for this session.
    pub(super) fn remember_gear(&mut self, gear: Option<Gear>) {
        self.known.gear = gear;
    }

    pub(super) fn remember_serial_number(&mut self, serial_number: u32) {
        self.known.serial_number = Some(serial_number);
    }

    pub(super) fn gear(&self) -> Option<Gear> {
        self.known.gear
    }

    pub(super) fn remember_window_shift(&mut self, shift: WindowShift) {
        self.known.shift = Some(shift);
    }

    /// Reads the IN word. Nothing is sent to the encoder.
    ///
    /// # Errors
    /// Returns an error if the exchange fails.
    pub fn read_in_word(&mut self) -> Result<WordReading, Error> {
        let word = self.data.input()?;
        let KnownState { mode, gear, shift, .. } = *self.known;
        Ok(WordReading { at: self.data.now(), word, mode, gear, shift })
    }

    pub(super) fn left_state(&self) -> LeftState {
        let out = self.out.map_or(0, Command::emit);
        LeftState { out, parameterising: self.parameterising, found: self.found, is: self.is }
    }

    /// Runs `work` with cancellation ignored, so that the encoder can be returned to a safe state.
    pub(super) fn run_uncancellable<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.data.ignore_cancellation(true);
        let result = work(self);
        self.data.ignore_cancellation(before);
        result
    }

    pub(super) fn wait(&mut self, duration: Duration) -> Result<(), Error> {
        self.data.wait(duration)
    }

    /// Requests a value and waits until it is stable. The previous value must be gone first, because the two could not
    /// be told apart. Late echoes of earlier words are ignored.
    ///
    /// # Errors
    /// Returns [`Error::UnknownReadOut`] if the value does not exist, or an error of
    /// [`send_setting`](Self::send_setting).
    pub(super) fn request_value(&mut self, command: Command) -> Result<Value, Error> {
        self.wait_until_value_cleared()?;
        self.ensure_legal(command)?;
        let (before, found) = (self.input, self.found_error);
        self.repeat_until(command, ExpectedWord::Value, self.patience, |CycleResult { word, same, .. }| {
            match Reply::parse(word) {
                Reply::ReadOut(value) if same.is_stable() => Some(Ok(value)),
                Reply::UnknownReadOut(_) if same.is_stable() => Some(Err(Error::UnknownReadOut { command })),
                Reply::Error(error) if word != before && Some(word) != found && same.is_stable() => {
                    Some(Err(Error::Refused { sent: command, error }))
                }
                _ => None,
            }
        })
    }

    /// Reads a value from the encoder.
    ///
    /// # Errors
    /// Returns any error that [`request_value`](Self::request_value) returns.
    pub(super) fn read_out(&mut self, read_out: ReadOutNumber) -> Result<Value, Error> {
        let value = self.request_value(Command::ReadOut(read_out))?;
        if read_out == ReadOutNumber::SERIAL_NUMBER {
            self.note_serial_number(value.get());
        }
        Ok(value)
    }

    /// Sends 80000000h until the encoder is running.
    ///
    /// # Errors
    /// Returns [`Error::Refused`] if the encoder keeps sending an error, [`Error::TimeOut`] if it does not run, or
    /// another error if the exchange fails.
    pub(super) fn run(&mut self) -> Result<(), Error> {
        self.return_to_running(Command::Run, self.patience)?;
        self.parameterising = false;
        Ok(())
    }

    /// Sends 00000000h until the encoder is running.
    ///
    /// # Errors
    /// Returns any error that [`run`](Self::run) returns.
    pub(super) fn return_to_operation(&mut self) -> Result<(), Error> {
        self.return_to_running(Command::Normal, self.patience)
    }

    fn return_to_running(&mut self, command: Command, patience: Duration) -> Result<(), Error> {
        self.ensure_legal(command)?;
        let (mut runs, found) = (StabilityTimer::new(self.recorded), self.found_error);
        self.repeat_until(command, ExpectedWord::Run, patience, |CycleResult { now, word, same }| {
            runs.update(matches!(Reply::parse(word), Reply::Run { .. }), now);
            (runs.is_stable() || Some(word) == found && same.is_settled()).then_some(Ok(()))
        })
    }

    /// Sends 40000000h until the position equals the preset, then 00000000h. A preset works only once after it is
    /// programmed. The word is sent for a minimum time, because the old position may already equal the preset.
    ///
    /// # Errors
    /// Returns [`Error::TimeOut`] if the position does not become the preset, or an error of
    /// [`send_setting`](Self::send_setting).
    pub(super) fn trigger_preset(&mut self, is_there: impl Fn(u32) -> bool) -> Result<(), Error> {
        self.return_to_operation()?;
        self.ensure_legal(Command::Preset)?;
        let (mut sent, mut there) = (StabilityTimer::new(self.recorded), StabilityTimer::new(self.recorded));
        let fired = self.repeat_until(
            Command::Preset,
            ExpectedWord::Preset,
            self.patience,
            |CycleResult { now, word, .. }| {
                sent.update(true, now);
                there.update(matches!(Reply::parse(word), Reply::Run { value, .. } if is_there(value.get())), now);
                (sent.is_settled() && there.is_stable()).then_some(Ok(()))
            },
        );
        self.run_uncancellable(Self::return_to_operation).and(fired)
    }

    /// Sends a command in every cycle until `judge` returns a result. `judge` receives the IN word and how long it has
    /// been unchanged. The time for which the encoder is busy is also measured.
    fn repeat_until<T>(
        &mut self,
        command: Command,
        awaited: ExpectedWord,
        patience: Duration,
        mut judge: impl FnMut(CycleResult) -> Option<Result<T, Error>>,
    ) -> Result<T, Error> {
        let begun = self.data.now();
        let least = stability::min_wait_cycles(self.recorded);
        let (mut last, mut same, mut cycles) = (None, StabilityTimer::new(self.recorded), 0);
        let mut at_work = StabilityTimer::new(self.recorded);
        loop {
            let word = self.run_cycle(command)?;
            let now = self.data.now();
            cycles += 1;
            if last != Some(word) {
                same = StabilityTimer::new(self.recorded);
            }
            same.update(true, now);
            last = Some(word);
            at_work.update(matches!(Reply::parse(word), Reply::Busy { .. }) && !is_echo(command, word), now);
            self.known.processing = self.known.processing.max(at_work.stable_duration());
            if let Some(ended) = judge(CycleResult { now, word, same }) {
                return ended;
            }
            if cycles >= least && now.duration_since(begun) >= patience {
                return Err(self.timeout_error(command, awaited, word, patience));
            }
        }
    }

    fn run_cycle(&mut self, command: Command) -> Result<u32, Error> {
        let before = self.out.replace(command);
        self.input = match self.data.run_cycle(command.emit()) {
            Err(error) if is_write_refused(&error) => {
                self.out = before;
                return Err(error);
            }
            // The word may have been sent even if the write failed, because this is also the result of a missing reply.
            ended => {
                self.lost = ended.is_err();
                ended?
            }
        };
        let (out, input, reply) = (command.emit(), self.input, WordReply::from_words(command, self.input));
        // The position of a moving shaft changes in every cycle. These changes are not reported.
        if self.reported != Some((out, reply))
            && let Some(tell) = &mut self.tell
        {
            tell(Handshake { at: self.data.now(), out, command, input, reply });
        }
        self.reported = Some((out, reply));
        Ok(input)
    }

    /// Returns the IN word with swapped halves if it is plausible only that way.
    ///
    /// # Errors
    /// Returns an error if the exchange fails.
    pub(super) fn swapped_word_order(&mut self, input: u32) -> Result<Option<u32>, Error> {
        if !matches!(Reply::parse(input), Reply::Run { .. }) && self.data.output()? != Some(0) {
            return Ok(None);
        }
        Ok(find_swapped_word(input))
    }

    /// Returns the most likely reason why the expected word did not arrive.
    fn timeout_error(&mut self, command: Command, awaited: ExpectedWord, input: u32, patience: Duration) -> Error {
        let sent = command.emit();
        match self.run_uncancellable(|master| master.data.output()) {
            Ok(Some(word)) if word != sent => return Error::OtherMaster { sent, output: word },
            Err(error) => return error,
            Ok(_) => {}
        }
        let suspected = if self.is.is_none() { find_swapped_word(input) } else { swapped_position_word(input) };
        if let Some(swapped) = suspected {
            return Error::WordOrder { input, swapped };
        }
        match Reply::parse(input) {
            Reply::Error(error) => Error::Refused { sent: command, error },
            _ => Error::TimeOut { awaited, sent, input, milliseconds: patience.as_millis() as u64 },
        }
    }

    fn ensure_legal(&self, command: Command) -> Result<(), Error> {
        Ok(command.ensure_legal(self.effective_mode())?)
    }

    /// Returns the mode in which the encoder will interpret the next word. A requested read-out does not matter, since
    /// it is ended first.
    fn effective_mode(&self) -> EncoderMode {
        match self.is {
            Some(StartupMode::Cams(_)) => EncoderMode::Cam,
            // The manual does not define the effect of other words in an unknown mode.
            Some(StartupMode::Unknown(_)) => EncoderMode::ReadOut,
            _ if self.parameterising => EncoderMode::Parameterisation,
            // Only read-outs are allowed until the encoder has reported its mode.
            None => EncoderMode::ReadOut,
            Some(StartupMode::Velocity) => EncoderMode::Velocity,
            Some(_) => EncoderMode::Position,
        }
    }
}

/// Returns whether the gateway has certainly not written the word. After other exceptions, it may have been written.
fn is_write_refused(error: &Error) -> bool {
    matches!(error, Error::Exception { requested: RequestedItem::Write { .. }, exception } if !exception.is_temporary())
}
