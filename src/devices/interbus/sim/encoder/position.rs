//! The position that an encoder derives from its shaft, and the other IN words of a running encoder (references 1, 3
//! and 5).

use super::{Encoder, LOST};
use crate::devices::interbus::protocol::{CamOutput, Class, SingleWord, StartupMode, Value};
use crate::devices::interbus::sim::memory::DISC_POSITIONS;
use crate::units::Moment;

impl Encoder {
    /// Sets the position to the preset. A preset that is beyond the range after a change of the gear wraps.
    pub(super) fn trigger_preset(&mut self, now: Moment) {
        let gear = self.memory.gear;
        let (steps, range) = (u64::from(gear.total_steps()), u64::from(gear.total_disc_steps()));
        let zero_shift = u64::from(self.memory.zero_shift) % steps;
        let wanted = (u64::from(self.memory.preset) + steps - zero_shift) % steps;
        // This is the first disc step that has the wanted position.
        let place = (wanted * range).div_ceil(steps);
        self.offset = place as i64 - self.position_in_direction(now);
    }

    /// Returns the shaft position in the configured counting direction.
    fn position_in_direction(&self, now: Moment) -> i64 {
        let place = self.shaft.position_at(now);
        if self.memory.counterclockwise { -place } else { place }
    }

    /// Returns the position in steps.
    fn position(&self, now: Moment) -> Value {
        let gear = self.memory.gear;
        let place = (self.position_in_direction(now) + self.offset).rem_euclid(i64::from(gear.total_disc_steps()));
        // The disc position is below the range, which has at most 26 bits.
        let position = u64::from(gear.position(place as u32).get()) + u64::from(self.memory.zero_shift);
        Value::from_word((position % u64::from(gear.total_steps())) as u32)
    }

    /// Returns the IN word of a running encoder.
    pub(super) fn running_in_word(&self, now: Moment) -> u32 {
        let position = self.position(now);
        match (self.class, self.mode) {
            (Class::K1, _) => {
                // A K1 encoder sends 12 of the 13 bits of a turn.
                let place = self.position_in_direction(now).rem_euclid(i64::from(DISC_POSITIONS)) >> 1;
                SingleWord::parse_k1(place as u16 & 0x0FFF).emit()
            }
            (Class::K2, _) => SingleWord::parse_k2(position.get()).emit(),
            (Class::K3, _) if self.eeprom.lost => LOST,
            (Class::K3, StartupMode::Velocity) => {
                let rpm = self.shaft.rpm().round() as i32;
                let rpm = if self.memory.counterclockwise { -rpm } else { rpm };
                Value::from_word(rpm as u32).get()
            }
            (Class::K3, StartupMode::Cams(program)) => {
                let outputs = self.memory.program(program).outputs(position);
                CamOutput::at_position(position, outputs, self.memory.shift).emit()
            }
            (Class::K3, _) => position.get(),
        }
    }
}
