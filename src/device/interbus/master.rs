//! The host's side of the handshake (reference 4): words are sent, and each is waited for until it has had its effect.
//! What may be sent is what the encoder takes for what it is in its mode; anything else is refused here.

mod modes;

use std::time::Duration;

use super::data::ProcessData;
use super::error::{Asked, Awaited, Meddled};
use super::handshake::{Handshake, Says, Standing, is_echo};
use super::reading::{swapped, swapped_unexplained};
use super::{Error, Gateway, Known, Reading, Station};
use crate::link::Ctx;
use crate::protocol::interbus::{Command, Gear, Mode, ReadOut, Reply, StartupMode, Value, WindowShift};
use crate::units::Moment;

/// An echo or a value stands when it came in so many cycles, one after the other (reference 4).
const STANDS: u32 = 2;
/// A reply that is lost can take all the patience: an answer has so many cycles at least, old words among them.
const LEAST: u32 = 10;
/// A word that may be the answer to the one before stands after so many.
const STAYS: u32 = 20;
/// The words of an encoder at work, without anything beside it: also the echo of cam 0's start at 0.
const BUSY: u32 = 0xC000_0000;

/// Who hears each step.
type Teller<'a> = Box<dyn FnMut(Handshake) + 'a>;

/// The host's side of the process data of one encoder, for one job.
pub struct Master<'a> {
    data: Box<dyn ProcessData + 'a>,
    known: &'a mut Known,
    patience: Duration,
    tell: Option<Teller<'a>>,
    /// What it does, as it said in this job.
    is: Option<StartupMode>,
    /// It was sent into another mode and has not said yet that it is there.
    unsure: bool,
    /// It was sent into other modes in this job.
    switched: bool,
    /// What it did before this job.
    found: Option<StartupMode>,
    /// The error that it had already: it sends no position anyway.
    found_error: Option<u32>,
    /// Parameters or cams are being set.
    parameterising: bool,
    /// What was sent last in this job.
    out: Option<Command>,
    /// Whether it got there is not known.
    lost: bool,
    /// What came last.
    input: u32,
    /// The echoes of all that was set in this job.
    echoes: Vec<u32>,
    told: Option<(u32, Says)>,
}

impl<'a> Master<'a> {
    /// A master over a station's gateway, for one job.
    pub fn new(ctx: Ctx<'a>, station: &'a mut Station) -> Self {
        let patience = station.handshake;
        let (gateway, known) = Gateway::new(ctx, station);
        Master::with(Box::new(gateway), known, patience)
    }

    /// A master over other process data, for one job.
    pub fn over(data: impl ProcessData + 'a, station: &'a mut Station) -> Self {
        let patience = station.handshake;
        Master::with(Box::new(data), &mut station.known, patience)
    }

    fn with(data: Box<dyn ProcessData + 'a>, known: &'a mut Known, patience: Duration) -> Self {
        Master {
            data,
            known,
            patience,
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
            echoes: Vec::new(),
            told: None,
        }
    }

    /// Tells each step of the handshake to `tell`.
    #[must_use]
    pub fn telling(mut self, tell: impl FnMut(Handshake) + 'a) -> Self {
        self.tell = Some(Box::new(tell));
        self
    }

    /// Now.
    pub fn now(&self) -> Moment {
        self.data.now()
    }

    /// What the encoder does, as it said last.
    pub fn mode(&self) -> Option<StartupMode> {
        self.is.or(self.known.mode)
    }

    /// The gear that is in force from now on, as far as this session knows.
    pub(super) fn learn_gear(&mut self, gear: Option<Gear>) {
        self.known.gear = gear;
    }

    /// The gear that was read last.
    pub(super) fn gear(&self) -> Option<Gear> {
        self.known.gear
    }

    pub(super) fn learn_shift(&mut self, shift: WindowShift) {
        self.known.shift = Some(shift);
    }

    /// Reads the IN word; nothing is sent to the encoder.
    ///
    /// # Errors
    /// The way to it.
    pub fn reading(&mut self) -> Result<Reading, Error> {
        let word = self.data.input()?;
        let Known { mode, gear, shift, .. } = *self.known;
        Ok(Reading { at: self.data.now(), word, mode, gear, shift })
    }

    /// In which state the encoder may be.
    pub(super) fn standing(&self) -> Standing {
        let out = self.out.map_or(0, Command::emit);
        Standing { out, parameterising: self.parameterising, found: self.found, is: self.is }
    }

    /// Does what leads back to a safe state: in it, a wish to end is not heard.
    pub(super) fn shielded<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.data.shield(true);
        let result = work(self);
        self.data.shield(before);
        result
    }

    /// Waits; ends early when the user wishes.
    pub(super) fn wait(&mut self, duration: Duration) -> Result<(), Error> {
        self.data.wait(duration)
    }

    /// Sends a word that is acknowledged, until its exact echo stands.
    ///
    /// # Errors
    /// [`Error::Illegal`], and nothing is sent; [`Error::Refused`], [`Error::OtherMaster`], [`Error::TimeOut`]; the way.
    pub(super) fn set(&mut self, command: Command) -> Result<(), Error> {
        self.ensure_legal(command)?;
        self.leave_value()?;
        self.parameterising = true;
        self.acknowledged(command, false)
    }

    /// As [`set`](Self::set), for a word that an encoder may also take without a word, and go on (`U`).
    fn tell_to(&mut self, command: Command) -> Result<(), Error> {
        self.ensure_legal(command)?;
        self.leave_value()?;
        self.acknowledged(command, true)
    }

    fn acknowledged(&mut self, command: Command, may_run: bool) -> Result<(), Error> {
        let before = self.input;
        let echo = Reply::echo_of(command).emit();
        let stands = if echo == BUSY { STAYS } else { STANDS };
        self.echoes.push(echo);
        let known = self.echoes.clone();
        let mut runs = 0;
        self.until(command, Awaited::Echo, |word, same| {
            let reply = Reply::parse(word);
            runs = if matches!(reply, Reply::Run { .. }) { runs + 1 } else { 0 };
            match reply {
                _ if is_echo(command, word) => (same >= stands).then_some(Ok(())),
                Reply::Error(error) if word != before && same >= STANDS => {
                    Some(Err(Error::Refused { sent: command, error }))
                }
                Reply::Echo { .. } if word != before && !known.contains(&word) && same >= STAYS => {
                    Some(Err(Error::OtherMaster { sent: command.emit(), seen: Meddled::Input(word) }))
                }
                Reply::Run { .. } if may_run && runs >= STAYS => Some(Ok(())),
                _ => None,
            }
        })
    }

    /// Asks for a value, and waits until it stands. The value of another question is gone by then: they look the same.
    ///
    /// # Errors
    /// As [`set`](Self::set); [`Error::UnknownReadOut`].
    pub(super) fn ask(&mut self, command: Command) -> Result<Value, Error> {
        self.leave_value()?;
        self.ensure_legal(command)?;
        let (before, echoes) = (self.input, self.echoes.clone());
        self.until(command, Awaited::Value, |word, same| match Reply::parse(word) {
            Reply::ReadOut(value) if same >= STANDS => Some(Ok(value)),
            Reply::UnknownReadOut(_) if same >= STANDS => Some(Err(Error::UnknownReadOut { command })),
            Reply::Error(error) if word != before && same >= STANDS => {
                Some(Err(Error::Refused { sent: command, error }))
            }
            Reply::Echo { .. } if !echoes.contains(&word) && same >= STAYS => {
                Some(Err(Error::OtherMaster { sent: command.emit(), seen: Meddled::Input(word) }))
            }
            _ => None,
        })
    }

    /// Reads something out.
    ///
    /// # Errors
    /// As [`set`](Self::set); [`Error::UnknownReadOut`].
    pub(super) fn read_out(&mut self, read_out: ReadOut) -> Result<Value, Error> {
        self.ask(Command::ReadOut(read_out))
    }

    /// `80000000`, until the encoder runs.
    ///
    /// # Errors
    /// [`Error::Refused`] where an error stays; [`Error::TimeOut`]; the way.
    pub(super) fn run(&mut self) -> Result<(), Error> {
        self.running(Command::Run, self.patience)?;
        self.parameterising = false;
        Ok(())
    }

    /// `00000000`, until the encoder runs.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub(super) fn normal(&mut self) -> Result<(), Error> {
        self.running(Command::Normal, self.patience)
    }

    fn running(&mut self, command: Command, patience: Duration) -> Result<(), Error> {
        self.ensure_legal(command)?;
        let (whole, mut runs, found) = (self.patience, 0, self.found_error);
        self.patience = patience;
        let ended = self.until(command, Awaited::Run, |word, same| {
            runs = if matches!(Reply::parse(word), Reply::Run { .. }) { runs + 1 } else { 0 };
            (runs >= STANDS || Some(word) == found && same >= STAYS).then_some(Ok(()))
        });
        self.patience = whole;
        ended
    }

    /// Sends `40000000` until the position is the preset, and takes it back. Once for each preset that was set.
    ///
    /// # Errors
    /// [`Error::TimeOut`] where the position does not become that; otherwise as [`set`](Self::set).
    pub(super) fn fire(&mut self, is_there: impl Fn(u32) -> bool) -> Result<(), Error> {
        self.normal()?;
        self.ensure_legal(Command::Preset)?;
        let mut stands = 0;
        let fired = self.until(Command::Preset, Awaited::Preset, |word, _| {
            let there = matches!(Reply::parse(word), Reply::Run { value, .. } if is_there(value.get()));
            stands = if there { stands + 1 } else { 0 };
            (stands >= STANDS).then_some(Ok(()))
        });
        self.shielded(Self::normal).and(fired)
    }

    /// Sends `out` cycle by cycle, until `judge` has something to say of the IN word and in how many cycles it came.
    fn until<T>(
        &mut self,
        command: Command,
        awaited: Awaited,
        mut judge: impl FnMut(u32, u32) -> Option<Result<T, Error>>,
    ) -> Result<T, Error> {
        let begun = self.data.now();
        let (mut last, mut same, mut cycles) = (None, 0, 0);
        loop {
            let word = self.cycle(command)?;
            cycles += 1;
            same = if last == Some(word) { same + 1 } else { 1 };
            last = Some(word);
            if let Some(ended) = judge(word, same) {
                return ended;
            }
            if cycles >= LEAST && self.data.now().since(begun) >= self.patience {
                return Err(self.too_late(command, awaited, word));
            }
        }
    }

    fn cycle(&mut self, command: Command) -> Result<u32, Error> {
        let before = self.out.replace(command);
        self.input = match self.data.cycle(command.emit()) {
            Err(error @ Error::Exception { asked: Asked::Write { .. }, .. }) => {
                self.out = before;
                return Err(error);
            }
            // It may be there also where writing it fails.
            ended => {
                self.lost = ended.is_err();
                ended?
            }
        };
        let (out, input, says) = (command.emit(), self.input, Says::of(command, self.input));
        // The position of a shaft that turns is not told again and again.
        if self.told != Some((out, says))
            && let Some(tell) = &mut self.tell
        {
            tell(Handshake { at: self.data.now(), out, command, input, says });
        }
        self.told = Some((out, says));
        Ok(input)
    }

    /// What an IN word would be with its halves exchanged, where nothing else explains it: OUT asks for nothing.
    ///
    /// # Errors
    /// The way to the encoder.
    pub(super) fn suspected_order(&mut self, input: u32) -> Result<Option<u32>, Error> {
        if !matches!(Reply::parse(input), Reply::Run { .. }) && self.data.output()? != Some(0) {
            return Ok(None);
        }
        Ok(swapped_unexplained(input))
    }

    /// Why nothing came, as far as that can be seen.
    fn too_late(&mut self, command: Command, awaited: Awaited, input: u32) -> Error {
        let sent = command.emit();
        match self.shielded(|master| master.data.output()) {
            Ok(Some(word)) if word != sent => return Error::OtherMaster { sent, seen: Meddled::Output(word) },
            Err(error) => return error,
            Ok(_) => {}
        }
        let suspected = if self.is.is_none() { swapped_unexplained(input) } else { swapped(input) };
        if let Some(swapped) = suspected {
            return Error::WordOrder { input, swapped };
        }
        match Reply::parse(input) {
            Reply::Error(error) => Error::Refused { sent: command, error },
            _ => Error::TimeOut { awaited, sent, input, milliseconds: self.patience.as_millis() as u64 },
        }
    }

    fn ensure_legal(&self, command: Command) -> Result<(), Error> {
        Ok(command.ensure_legal(self.taken_in())?)
    }

    /// The mode in which the encoder takes a word; what is read out is left before any other is sent.
    fn taken_in(&self) -> Mode {
        match self.is {
            Some(StartupMode::Cams(_)) => Mode::Cam,
            _ if self.parameterising => Mode::Parameterisation,
            // Nothing but reading out may be done before it has said what it does.
            None => Mode::ReadOut,
            Some(StartupMode::Velocity) => Mode::Velocity,
            Some(_) => Mode::Position,
        }
    }
}
