//! Reads and writes the parameters of a virtual drive.
//!
//! Assumptions (`U`: not documented): A rejected value is stored as error 8501, as in the manual, and is a fault if the
//! drive is operational. Parameter 198 can only be written at standstill.

use super::axis::TURN;
use super::drive::Drive;
use crate::buses::ethernet_ip::protocol::GeneralStatus;
use crate::devices::hiperdrive::protocol::drive_parameter::{
    ACKNOWLEDGE, CONTROL, DRIVE_REQUESTED, LOWER_LIMIT, NEWEST_ERROR, OLDEST_ERROR, POSITION, REFERENCE, RESET, SPEED,
    SPEED_SHARE, STATUS, TARGET, TORQUE_SHARE, UPPER_LIMIT, VARIANT,
};
use crate::devices::hiperdrive::protocol::{ErrorCode, PkwError, Value, nearest_reference};
use crate::units::Moment;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterError {
    Unknown,
    ReadOnly,
    Value,
    State,
}

impl ParameterError {
    pub const fn status(self) -> GeneralStatus {
        match self {
            ParameterError::Unknown => GeneralStatus::NO_ATTRIBUTE,
            ParameterError::ReadOnly => GeneralStatus::NOT_SETTABLE,
            ParameterError::Value => GeneralStatus::INVALID_VALUE,
            ParameterError::State => GeneralStatus::STATE,
        }
    }

    pub const fn error(self) -> PkwError {
        match self {
            ParameterError::Unknown => PkwError::NO_PARAMETER,
            ParameterError::ReadOnly => PkwError::READ_ONLY,
            ParameterError::Value => PkwError::RANGE,
            ParameterError::State => PkwError::STATE,
        }
    }
}

impl Drive {
    /// Returns the value of a parameter, given its number for drive 1.
    pub(super) fn read(&mut self, now: Moment, number: u16) -> Option<Value> {
        let actual = self.actual_values(now);
        let text = |text: &str| Some(Value::Text(text.to_owned()));
        let value = match number {
            CONTROL => self.out.control.into(),
            SPEED_SHARE => self.out.speed.into(),
            TORQUE_SHARE => self.out.torque.into(),
            TARGET => self.out.target.into(),
            STATUS => actual.status.to_u16().into(),
            SPEED => actual.speed.into(),
            POSITION => actual.position.into(),
            NEWEST_ERROR..=OLDEST_ERROR => {
                self.errors.get(usize::from(number - NEWEST_ERROR)).map_or(0, |code| code.code().into())
            }
            116..=118 => 0,
            // The temperature is between −273 °C and a few hundred degrees.
            119 => self.celsius.round() as i64,
            VARIANT => self.variant.number().into(),
            121 => return text(self.variant.row().map_or("", |row| row.name)),
            122 => return text("7800.0001"),
            123 => return text("4711"),
            124 => return text("14/2024"),
            125 => return text("1.04"),
            126 => return text("24"),
            127 => return text("A25"),
            128 => return text("A20"),
            129 => return text("35"),
            ACKNOWLEDGE => self.faults.into(),
            RESET => 0,
            _ => self.memory.get(number)?,
        };
        Some(Value::Number(value))
    }

    /// Returns whether writing this value restarts the drive. This is the case when parameter 152 changes from 0 to 1,
    /// and for every write to parameter 199.
    pub(super) fn resets_drive(&self, number: u16, value: i64) -> bool {
        number == RESET || (number, value) == (DRIVE_REQUESTED, 1) && self.memory.get(DRIVE_REQUESTED) == Some(0)
    }

    /// Writes a parameter, given its number for drive 1. The caller has checked its range.
    pub(super) fn write(&mut self, now: Moment, number: u16, value: i64) -> Result<(), ParameterError> {
        self.advance_to(now);
        let mut out = self.out;
        match number {
            CONTROL => out.control = u16::try_from(value).map_err(|_| ParameterError::Value)?,
            SPEED_SHARE => out.speed = u8::try_from(value).map_err(|_| ParameterError::Value)?,
            TORQUE_SHARE => out.torque = u8::try_from(value).map_err(|_| ParameterError::Value)?,
            TARGET => out.target = i32::try_from(value).map_err(|_| ParameterError::Value)?,
            LOWER_LIMIT | UPPER_LIMIT => return self.write_limit(number, value),
            ACKNOWLEDGE => {
                self.clear_faults();
                return Ok(());
            }
            REFERENCE => return self.write_position(value),
            RESET => {
                if value == 1 {
                    self.memory.restore_factory();
                    self.invalidate_position();
                } else {
                    self.memory.handle_restart();
                }
                self.reset(now);
                return Ok(());
            }
            _ => {
                let resets = self.resets_drive(number, value);
                self.memory.set_value(number, value);
                if resets {
                    self.reset(now);
                }
                return Ok(());
            }
        }
        self.command(now, out);
        Ok(())
    }

    /// Writes a limit. The upper limit (parameter 160) must stay above the lower limit (parameter 158), with the
    /// position between them.
    fn write_limit(&mut self, number: u16, value: i64) -> Result<(), ParameterError> {
        let (low, high) = self.limits();
        let (low, high) = if number == LOWER_LIMIT { (value, high.into()) } else { (low.into(), value) };
        if low >= high || !(low..=high).contains(&self.position().into()) {
            return Err(self.state_rejection());
        }
        self.memory.set_value(number, value);
        Ok(())
    }

    /// Sets the position to the nearest multiple of 64.
    fn write_position(&mut self, value: i64) -> Result<(), ParameterError> {
        let (low, high) = self.limits();
        let inside = |position: &i32| (low..=high).contains(position);
        let position = i32::try_from(value).ok().and_then(nearest_reference).filter(inside);
        let Some(position) = position else { return Err(self.state_rejection()) };
        if !self.is_at_rest() {
            return Err(ParameterError::State);
        }
        self.offset = f64::from(position) / self.scale().steps_per_turn() * TURN - self.axis.place();
        self.memory.set_value(REFERENCE, position.into());
        Ok(())
    }

    /// Sets the position to the angle of the shaft, which is between 0 and 1 turn (manual, 198).
    pub(super) fn invalidate_position(&mut self) {
        self.offset = -(self.axis.place() / TURN).floor() * TURN;
    }

    pub(super) fn state_rejection(&mut self) -> ParameterError {
        self.enter_fault(ErrorCode::INVALID_VALUE);
        ParameterError::Value
    }
}

/// Returns an element of a string, which consists of four characters.
pub(super) fn string_element(text: &str, element: u16) -> Option<u32> {
    let bytes = text.as_bytes();
    let part = bytes.chunks(4).nth(element.into())?;
    let mut four = [0; 4];
    four.iter_mut().zip(part).for_each(|(to, from)| *to = *from);
    Some(u32::from_le_bytes(four))
}
