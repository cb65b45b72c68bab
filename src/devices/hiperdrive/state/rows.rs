//! Rows of the parameter table: value, allowed range, factory setting and edit of each parameter.

use super::format;
use super::ruler::PositionUnit;
use super::staged::is_editable;
use super::unit::HiperdriveDevice;
use crate::app::Text;
use crate::app::number::required_decimals;
use crate::devices::hiperdrive::profile::Image;
use crate::devices::hiperdrive::protocol::drive_parameter::{
    CONTROL, DENOMINATOR, LOWER_LIMIT, NEWEST_ERROR, NUMERATOR, OLDEST_ERROR, POSITION, REFERENCE, SPEED, SPEED_SHARE,
    STATUS, TARGET, TORQUE_SHARE, UPPER_LIMIT,
};
use crate::devices::hiperdrive::protocol::{
    DriveNumber, Family, PARAMETERS, ParameterAccess, ParameterNumber, ParameterRow, Topology, Travel, Value,
};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain as explained;

#[derive(Clone, Debug)]
pub struct Row {
    pub number: ParameterNumber,
    pub name: Text,
    /// Row in the parameter table of the manual.
    pub kind: &'static ParameterRow,
    /// Value of the parameter, or `None` if it has not been read or is not in the profile.
    pub value: Option<Value>,
    /// Value as shown in the table, or an empty string if there is none.
    pub shown: String,
    /// Meaning of the value, unless the number is self-explanatory.
    pub meaning: Option<Text>,
    /// Unit, if any.
    pub unit: Option<Text>,
    /// Allowed range, or `None` for strings.
    pub range: Option<Text>,
    /// Travel of the drive, in steps of the edited scale.
    pub travel: Travel,
    /// Factory setting, or an empty string if unknown.
    pub factory: String,
    /// Edited value, or `None` if the parameter has not been edited or cannot be edited.
    pub staged: Option<i64>,
    pub is_edited: bool,
    /// Value from the previous reading, or `None` if it is still the same.
    pub previous_value: Option<i64>,
    /// Whether the parameter has a value that can be edited.
    pub is_editable: bool,
}

impl Row {
    /// Returns the reason why the parameter has no value that can be edited, or `None` if it has one.
    pub fn not_editable_reason(&self) -> Option<Text> {
        let id = match self.kind.access {
            _ if self.is_editable => return None,
            ParameterAccess::Read => "hd_entry.only_read",
            ParameterAccess::ReadWrite | ParameterAccess::Write => "hd_entry.not_a_value",
        };
        Some(TEXTS.text(id).with("number", self.number).with_text("name", self.name.clone()))
    }
}

impl HiperdriveDevice {
    /// Returns the parameters of a drive, or of the device: all that were read, or all that a profile can contain.
    pub fn rows(&self, of: Option<DriveNumber>) -> Vec<Row> {
        let number = |row: &ParameterRow| match of {
            Some(drive) => ParameterNumber::for_drive(row.number, drive),
            None => ParameterNumber::new(row.number).filter(|number| number.drive().is_none()),
        };
        let rows = PARAMETERS.iter().filter_map(|row| Some((number(row)?, row)));
        rows.filter(|(number, kind)| self.has_parameter(*number, kind))
            .map(|(number, kind)| self.row(number, kind))
            .collect()
    }

    fn has_parameter(&self, number: ParameterNumber, kind: &ParameterRow) -> bool {
        match self.profile() {
            Some(_) => Image::contains_row(kind),
            None => self.value(number).is_some(),
        }
    }

    fn row(&self, number: ParameterNumber, kind: &'static ParameterRow) -> Row {
        let own = || self.staged.base().and_then(|image| image.get(number)).map(Value::Number);
        let value = self.cyclic_value(number).or_else(|| self.value(number).cloned()).or_else(own);
        let travel = self.travel(number);
        let is_editable = is_editable(kind) && (self.profile().is_none() || Image::contains_row(kind));
        let staged = self.staged.value(number).filter(|_| is_editable);
        let meant = match (&value, staged) {
            (_, Some(staged)) => Some(Value::Number(staged)),
            (value, None) => value.clone(),
        };
        Row {
            number,
            name: explained::parameter_name_text(number),
            kind,
            shown: value.as_ref().map(|value| format::value_text(number, value)).unwrap_or_default(),
            meaning: meant.and_then(|value| self.value_meaning(number, &value)),
            unit: format::unit(kind),
            range: kind.allowed_values(travel).filter(|_| is_editable).map(explained::range_text),
            travel,
            factory: self.factory_value(number, kind).map(|own| own.to_string()).unwrap_or_default(),
            staged,
            is_edited: self.staged.difference_of(number).is_some(),
            previous_value: self.staged.previous_value(number),
            is_editable,
            value,
        }
    }

    /// Returns a control or status word, a measurement or an error from the cyclic data of a drive, if available.
    /// Cyclic data are newer than the last reading.
    fn cyclic_value(&self, number: ParameterNumber) -> Option<Value> {
        let drive = number.drive()?;
        let value = match number.drive1_number() {
            CONTROL => self.moves.last_setpoint(drive)?.control.to_u16().into(),
            SPEED_SHARE => self.moves.last_setpoint(drive)?.speed.get().into(),
            TORQUE_SHARE => self.moves.last_setpoint(drive)?.torque.get().into(),
            TARGET => self.moves.last_setpoint(drive)?.target.into(),
            STATUS => self.actual_values(drive)?.status.to_u16().into(),
            SPEED => self.actual_values(drive)?.speed.into(),
            POSITION => self.actual_values(drive)?.position.into(),
            base @ NEWEST_ERROR..=OLDEST_ERROR => {
                self.drive_status(drive)?.buffer.get(usize::from(base - NEWEST_ERROR))?.code().into()
            }
            _ => return None,
        };
        Some(Value::Number(value))
    }

    pub fn factory_value(&self, number: ParameterNumber, kind: &ParameterRow) -> Option<i64> {
        let profile = || self.profile_identity().and_then(|own| own.topology);
        let topology = self.identity().map(|own| own.topology).or_else(profile).unwrap_or(Topology::Adapter);
        let family = number.drive().and_then(|drive| self.family(drive)).unwrap_or(Family::Short);
        kind.factory_value(topology, family)
    }

    fn family(&self, drive: DriveNumber) -> Option<Family> {
        let in_profile = || self.profile()?.drive(drive)?.variant;
        let variant = self.drive_identity(drive).map(|own| own.variant).or_else(in_profile)?;
        variant.row().map(|row| row.family)
    }

    /// Returns the travel of the drive to which a parameter belongs, in steps of the edited scale.
    fn travel(&self, number: ParameterNumber) -> Travel {
        number.drive().map_or(Travel::UNKNOWN, |drive| Travel {
            family: self.family(drive),
            scale: Some(self.edited_ruler(drive).scale),
        })
    }

    /// Describes what a value means. Returns `None` if the number is self-explanatory.
    fn value_meaning(&self, number: ParameterNumber, value: &Value) -> Option<Text> {
        let value = match value {
            Value::Number(value) => value,
            Value::Text(text) => return format::nominal_value(number, text),
        };
        let drive = number.drive();
        match (number.drive1_number(), drive) {
            // Positions are shown in the edited scale.
            (LOWER_LIMIT | UPPER_LIMIT | REFERENCE | TARGET | POSITION | 170 | 176, Some(drive)) => {
                let ruler = self.edited_ruler(drive);
                let measure = if ruler.pitch.is_some() { PositionUnit::Millimetres } else { PositionUnit::Turns };
                let place = ruler.from_steps(*value, measure)?;
                let text = TEXTS.text("hd_entry.place").with_number(
                    "value",
                    place,
                    required_decimals(place, ruler.decimal_places(measure).min(4)),
                );
                Some(text.with_text("unit", TEXTS.text(measure.unit())))
            }
            (NUMERATOR | DENOMINATOR, Some(drive)) => {
                let steps = self.edited_ruler(drive).scale.steps_per_turn();
                Some(TEXTS.text("hd_meaning.steps_a_turn").with_number("steps", steps, required_decimals(steps, 3)))
            }
            (SPEED, Some(drive)) => {
                let rpm = self.speed_scale(drive).rpm(i16::try_from(*value).ok()?);
                Some(TEXTS.text("hd_entry.rpm").with_number("rpm", rpm, 1))
            }
            _ => format::value_meaning(number, *value),
        }
    }
}
