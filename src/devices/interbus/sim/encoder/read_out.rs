//! Replies to read-out requests (references 3 and 5).

use super::{Activity, Encoder, InWordContent};
use crate::devices::interbus::protocol::{Cam, CamNumber, Command, ReadOutNumber, StartupMode, Value};
use crate::units::Moment;

const VALUE: u32 = 0xA000_0000;
const UNKNOWN: u32 = 0xA400_0000;
/// Flag of an encoder that counts turns.
const MULTITURN: u32 = 2;
/// Upper part of a simulated chip register's value, chosen arbitrarily. The lower part is the register number.
const CHIP: u32 = 0x40;

impl Encoder {
    /// Handles a read-out request (2021xxxxh).
    pub(super) fn read_out(&mut self, now: Moment, read_out: ReadOutNumber) {
        let value = self.value(now, read_out);
        self.show(value);
    }

    /// Handles a request that reads from the selected cam program (2020xxxxh).
    pub(super) fn read_cams(&mut self, command: Command) {
        let StartupMode::Cams(number) = self.mode else { return };
        let program = self.memory.program(number);
        let cam = |cam: CamNumber| program.cams.get(usize::from(cam.get())).copied().flatten();
        let edge = |number: CamNumber, edge: fn(Cam) -> Value| cam(number).map(edge).map(Value::get);
        let value = match command {
            Command::ReadActivation => Some(u32::from(program.mask)),
            Command::ReadCamStart(number) => edge(number, |cam| cam.start),
            Command::ReadCamStop(number) => edge(number, |cam| cam.stop),
            Command::ReadShift => Some(u32::from(self.memory.shift.get())),
            _ => None,
        };
        self.show(value);
    }

    /// Sends the value of a read-out, or for `None` the error for a cam, register or number that does not exist.
    pub(super) fn show(&mut self, value: Option<u32>) {
        let word = value.map_or(UNKNOWN, |value| VALUE | Value::from_word(value).get());
        self.enter_activity(Activity::ReadingOut, InWordContent::Word(word));
    }

    fn value(&self, now: Moment, read_out: ReadOutNumber) -> Option<u32> {
        let (identity, memory) = (&self.identity, &self.memory);
        let minus_one = u32::from(identity.steps_minus_one);
        if let Some(register) = read_out.register() {
            return Some(CHIP | u32::from(register));
        }
        let tens_of_minutes = u32::try_from(now.since_start().as_secs() / 600).unwrap_or(u32::MAX);
        Some(match read_out.to_u16() {
            0x0 => identity.serial_number,
            0x1 => memory.gear.total_steps() - minus_one,
            0x2 => memory.gear.turns(),
            0x3 if identity.complement_bit => memory.direction() - 3,
            0x3 => memory.direction(),
            0x4 => memory.preset,
            0x5 => memory.zero_shift,
            0x6 => u32::from(memory.armed),
            0x7 => Self::SOFTWARE_VERSION,
            0x8 => identity.operating_time.saturating_add(tens_of_minutes),
            0x9 => self.mode.emit(),
            0xA => MULTITURN | minus_one,
            0xC if identity.narrow_temperature => u32::from(identity.temperature as i16 as u16),
            0xC => identity.temperature as u32,
            _ => return None,
        })
    }
}
