//! The encoder without its connection: the effect of an OUT word, and the resulting IN word (references 2 to 5).
//!
//! ```text
//! running ── parameter, cam word ──▶ setting ── run ──▶ store, running
//!   ├── 2021xxxxh, 2020xxxxh ──▶ reading out ── normal, run ──▶ running (setting, if something was set and not stored)
//!   └── 2080000ph ──▶ cam program (the previous one is stored first if it was changed)
//! ```
//! Assumptions (`U`: not documented):
//! - Every parameterisation and every program with a write uses an EEPROM write cycle, even if no value has changed.
//! - A parameter in a mode that does not allow it is reported as unknown (84000000h).
//! - Any other word without a meaning in the mode has no effect.
//! - The mode, the zero point and an executed preset survive a power loss without being stored.
//! - The speed is a signed 25-bit number.
//! - IN is 86000000h while the content of the EEPROM is lost.

mod cams;
mod position;
mod read_out;

use std::time::Duration;

use super::config::Config;
use super::memory::{Eeprom, Memory, StoreOutcome, StoredSettings};
use super::shaft::Shaft;
use crate::devices::interbus::protocol::{
    Class, Code, Command, EncoderMode, Gear, Parameter, ProgramNumber, StartupMode, Value,
};
use crate::sim::{Motor, SimulatedFaults};
use crate::units::Moment;

#[derive(Debug)]
pub struct Encoder {
    class: Class,
    identity: Identity,
    motor: Motor,
    shaft: Shaft,
    /// Offset added to the shaft position, in disc steps.
    offset: i64,
    mode: StartupMode,
    activity: Activity,
    memory: Memory,
    eeprom: Eeprom,
    unstored: Option<StoredSettings>,
    power: bool,
    /// OUT word of the master, which stays in effect until the master changes it.
    out: u32,
    content: InWordContent,
    /// The previous IN word, which is still returned for a while after a new OUT word.
    old: PreviousInWord,
    busy_until: Moment,
    busy: Duration,
    stale: u32,
    acknowledges_selection: bool,
}

#[derive(Clone, Copy, Debug)]
struct Identity {
    serial_number: u32,
    steps_minus_one: bool,
    complement_bit: bool,
    temperature: i32,
    narrow_temperature: bool,
    operating_time: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Activity {
    Running,
    /// A parameter or cam has been set but not stored, so the position and the cam outputs are invalid.
    Setting,
    ReadingOut,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum InWordContent {
    Live,
    Word(u32),
}

/// The previous IN word, which is still returned for some cycles after the OUT word has changed. Each reading is a
/// cycle, and cycles also pass with time.
#[derive(Clone, Copy, Debug, Default)]
struct PreviousInWord {
    word: u32,
    /// Number of cycles for which the old word will still be returned.
    cycles: u32,
    until: Moment,
}

/// Reason why a word is rejected (reference 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum WordFault {
    WrongData,
    UnknownCode,
    BeyondRange,
}

/// Prefix of a word without a valid position or cam outputs.
const INVALID: u32 = 0x8000_0000;
const LOST: u32 = 0x8600_0000;
const BUSY: u32 = 0xC000_0000;
/// Prefix of an echo.
const ECHO: u32 = 0xC000_0000;

impl WordFault {
    const fn error_word(self) -> u32 {
        match self {
            WordFault::WrongData => 0x8200_0000,
            WordFault::UnknownCode => 0x8400_0000,
            WordFault::BeyondRange => 0x9800_0004,
        }
    }
}

impl Encoder {
    /// Assumed duration of a cycle in which the IN word is not read.
    const CYCLE: Duration = Duration::from_millis(5);
    /// Value of read-out 7. It is invented for the simulation.
    const SOFTWARE_VERSION: u32 = 204;

    /// Creates an encoder that has been powered for a long time. `number` is its index behind the gateway, counted from
    /// 0.
    pub(super) fn new(config: &Config, number: u8) -> Self {
        let memory = config.memory.clone();
        Encoder {
            class: config.class,
            identity: Identity {
                serial_number: Value::from_word(config.serial_number + u32::from(number)).get(),
                steps_minus_one: config.steps_minus_one,
                complement_bit: config.complement_bit,
                temperature: config.temperature(),
                narrow_temperature: config.narrow_temperature,
                operating_time: config.operating_time,
            },
            motor: Motor::with_speed(config.rpm),
            shaft: Shaft::new(config.position, config.rpm),
            offset: 0,
            mode: config.mode,
            activity: Activity::Running,
            eeprom: Eeprom::new(memory.clone(), config.stores, config.faults.save_with_power_failure()),
            memory,
            unstored: None,
            power: true,
            out: 0,
            content: InWordContent::Live,
            old: PreviousInWord::default(),
            busy_until: Moment::START,
            busy: config.busy,
            stale: config.stale,
            acknowledges_selection: config.acknowledges_selection,
        }
    }

    pub fn motor(&self) -> Motor {
        self.motor.clone()
    }

    /// Sets the shaft position in disc steps. A turn has 8192 disc steps.
    pub fn set_shaft_position(&mut self, now: Moment, place: i32) {
        self.update(now);
        self.shaft.set_position(now, place);
    }

    pub const fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Returns the settings that survive a loss of power.
    pub const fn stored(&self) -> &Memory {
        &self.eeprom.kept
    }

    pub const fn store_count(&self) -> u32 {
        self.eeprom.store_count()
    }

    /// Returns the mode reported by read-out 9.
    pub const fn startup_mode(&self) -> StartupMode {
        self.mode
    }

    /// Returns the mode that determines how the next word is interpreted.
    pub const fn mode(&self) -> EncoderMode {
        match (self.mode, self.activity) {
            (StartupMode::Cams(_), _) => EncoderMode::Cam,
            (_, Activity::Setting) => EncoderMode::Parameterisation,
            (_, Activity::ReadingOut) => EncoderMode::ReadOut,
            (StartupMode::Velocity, Activity::Running) => EncoderMode::Velocity,
            (_, Activity::Running) => EncoderMode::Position,
        }
    }

    pub const fn out_word(&self) -> u32 {
        self.out
    }

    /// Sets the encoder temperature in tenths of a degree Celsius.
    pub const fn set_temperature(&mut self, tenths: i32) {
        self.identity.temperature = tenths;
    }

    /// Replaces the simulated EEPROM faults. The number of EEPROM write cycles is kept.
    pub(super) fn set_faults(&mut self, faults: &SimulatedFaults) {
        self.eeprom.set_store_failure(faults.save_with_power_failure());
    }

    pub const fn has_power(&self) -> bool {
        self.power
    }

    /// Switches the power off. Values that have not been stored are lost.
    pub fn disconnect(&mut self) {
        self.power = false;
        self.memory = self.eeprom.kept.clone();
        (self.activity, self.unstored) = (Activity::Running, None);
        (self.content, self.old) = (InWordContent::Live, PreviousInWord::default());
    }

    /// Switches the power on again. The current OUT word takes effect as if it were new.
    pub fn connect(&mut self, now: Moment) {
        if !self.power {
            self.power = true;
            let out = std::mem::take(&mut self.out);
            self.write(now, out);
        }
    }

    /// Sets the OUT word at `now`.
    pub fn write(&mut self, now: Moment, word: u32) {
        self.update(now);
        let before = std::mem::replace(&mut self.out, word);
        if word == before || !self.power || self.class != Class::K3 {
            return;
        }
        self.old =
            PreviousInWord { word: self.in_word(now), cycles: self.stale, until: now + Self::CYCLE * self.stale };
        match Command::in_mode(word, self.mode()) {
            Ok(command) => self.apply_command(now, command, before),
            Err(_) => self.handle_illegal_word(now, word),
        }
    }

    /// Returns the IN word at `now`, or `None` if the power is off.
    pub fn read(&mut self, now: Moment) -> Option<u32> {
        self.update(now);
        if !self.power {
            return None;
        }
        let word = self.in_word(now);
        self.old.cycles = self.old.cycles.saturating_sub(1);
        Some(word)
    }

    fn apply_command(&mut self, now: Moment, command: Command, before: u32) {
        match command {
            Command::Normal if self.activity == Activity::ReadingOut => self.end_read_out(),
            // Only a rising edge of bit 31 has an effect.
            Command::Run if before >> 31 == 0 => self.run(),
            Command::Normal | Command::Run | Command::Unknown(_) => {}
            Command::Preset if self.memory.armed => {
                self.trigger_preset(now);
                (self.memory.armed, self.eeprom.kept.armed) = (false, false);
            }
            Command::Preset => {}
            Command::FrabaPreset => self.trigger_preset(now),
            Command::Set(parameter, value) => {
                let taken = self.set_parameter(parameter, value).map(|()| StoredSettings::Parameters);
                self.complete_setting(now, taken);
            }
            Command::Velocity(on) => {
                self.mode = if on { StartupMode::Velocity } else { StartupMode::K3 };
                self.content = InWordContent::Live;
            }
            Command::ReadOut(read_out) => self.read_out(now, read_out),
            Command::Cams(program) => self.select(now, program),
            Command::Activate(mask) => self.set_cams(now, |program, _| program.set_active_cams(mask)),
            Command::CamStart(cam, value) => self.set_cams(now, |program, gear| program.start(cam, value, gear)),
            Command::CamStop(cam, value) => self.set_cams(now, |program, gear| program.set_stop(cam, value, gear)),
            Command::Shift(shift) => {
                self.memory.shift = shift;
                self.set_cams(now, |_, _| Ok(()));
            }
            Command::ReadActivation | Command::ReadCamStart(_) | Command::ReadCamStop(_) | Command::ReadShift => {
                self.read_cams(command)
            }
        }
    }

    /// Handles a word that is not allowed in the current mode. If it resembles a parameter, an edge, a shift or a
    /// read-out, the corresponding error is returned.
    fn handle_illegal_word(&mut self, now: Moment, word: u32) {
        let of_cams = matches!(self.mode, StartupMode::Cams(_));
        match (word >> 29, word >> 16) {
            (0b000, _) if Code::from_word(word).get() != 0 => self.complete_setting(now, Err(WordFault::UnknownCode)),
            (0b010 | 0b011, _) if of_cams => self.complete_setting(now, Err(WordFault::UnknownCode)),
            (_, 0x2010) if of_cams => self.complete_setting(now, Err(WordFault::WrongData)),
            (_, 0x2020) if of_cams => self.show(None),
            _ => {}
        }
    }

    /// Completes a word that sets a value. The IN word is then its echo or an error.
    fn complete_setting(&mut self, now: Moment, taken: Result<StoredSettings, WordFault>) {
        let word = match taken {
            Ok(_) => self.out | ECHO,
            Err(fault) => fault.error_word(),
        };
        self.unstored = taken.ok().or(self.unstored);
        self.enter_activity(Activity::Setting, InWordContent::Word(word));
        self.busy_until = now + self.busy;
    }

    fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), WordFault> {
        let less = u32::from(self.identity.steps_minus_one);
        let (number, gear) = (value.get(), self.memory.gear);
        let geared = |steps, turns| Gear::new(steps, turns).map_err(|_| WordFault::WrongData);
        let within = || parameter.check_value(number, gear).map(Value::get).map_err(|_| WordFault::WrongData);
        match parameter {
            Parameter::Steps => self.memory.gear = geared(number + less, gear.turns())?,
            Parameter::Turns => self.memory.gear = geared(gear.total_steps(), number)?,
            Parameter::Direction => self.memory.counterclockwise = within()? == 4,
            Parameter::Preset => (self.memory.preset, self.memory.armed) = (within()?, true),
            Parameter::ZeroShift => self.memory.zero_shift = within()?,
            Parameter::Default => {
                within()?;
                let Memory { shift, programs, .. } = self.memory.clone();
                self.memory = Memory { shift, programs, ..Memory::factory_default() };
            }
        }
        Ok(())
    }

    /// Handles the rising edge of the run command, which returns the encoder to operation.
    fn run(&mut self) {
        self.store_memory();
        self.enter_activity(Activity::Running, InWordContent::Live);
    }

    fn store_memory(&mut self) {
        let Some(what) = self.unstored.take() else { return };
        match self.eeprom.store(&self.memory, what) {
            StoreOutcome::Kept => {}
            StoreOutcome::Worn => self.memory = self.eeprom.kept.clone(),
            StoreOutcome::Died => self.disconnect(),
        }
    }

    fn in_word(&self, now: Moment) -> u32 {
        let old = &self.old;
        match self.content {
            _ if old.cycles > 0 && now < old.until => old.word,
            _ if now < self.busy_until => BUSY,
            InWordContent::Word(word) => word,
            InWordContent::Live => self.running_in_word(now),
        }
    }

    /// Switches to another activity immediately, without sending a busy word first.
    const fn enter_activity(&mut self, activity: Activity, content: InWordContent) {
        (self.activity, self.content, self.busy_until) = (activity, content, Moment::START);
    }

    fn update(&mut self, now: Moment) {
        let rpm = self.motor.rpm();
        if rpm != self.shaft.rpm() {
            self.shaft.set_rpm(now, rpm);
        }
    }

    /// Selects a cam program, or position mode for `None`. If the current program was changed, it is stored first.
    fn select(&mut self, now: Moment, program: Option<ProgramNumber>) {
        self.store_memory();
        if !self.power {
            return;
        }
        self.mode = program.map_or(StartupMode::K3, StartupMode::Cams);
        if program.is_some() && self.acknowledges_selection {
            self.enter_activity(Activity::Setting, InWordContent::Word(self.out | ECHO));
            self.busy_until = now + self.busy;
        } else {
            self.enter_activity(Activity::Running, InWordContent::Live);
        }
    }
}
