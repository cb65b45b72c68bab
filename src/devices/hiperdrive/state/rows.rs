//! The parameters as rows of a table: what each is, what it may be, what it is from the factory, and what is wanted of it.

use super::ruler::Measure;
use super::staged::is_editable;
use super::unit::Unit;
use super::words;
use crate::app::Text;
use crate::app::number::decimals_of;
use crate::devices::hiperdrive::profile::Image;
use crate::devices::hiperdrive::protocol::{
    Access, DriveNumber, Family, PARAMETERS, ParameterNumber, ParameterRow, Topology, Travel, Value,
};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain as explained;

/// A parameter as a row of the table.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its own number.
    pub number: ParameterNumber,
    /// What it is called.
    pub name: Text,
    /// What the manual says of it.
    pub kind: &'static ParameterRow,
    /// As it was read; `None` where it was not, or a profile does not say it.
    pub value: Option<Value>,
    /// The same as it is written in a table; empty where there is none.
    pub shown: String,
    /// What that means, where the number alone does not say it.
    pub meaning: Option<Text>,
    /// Its unit; `None` where it has none.
    pub unit: Option<Text>,
    /// What it may be; `None` of texts.
    pub range: Option<Text>,
    /// How far its drive turns, in steps as they are wanted to be scaled.
    pub travel: Travel,
    /// What it is from the factory; empty where nothing is said of it.
    pub factory: String,
    /// What is wanted of it; `None` where it cannot be edited, or nothing is.
    pub staged: Option<i64>,
    /// It is wanted otherwise than it is.
    pub is_edited: bool,
    /// What it was before it was read the last time, where that was something else.
    pub changed_from: Option<i64>,
    /// It can be edited as a value.
    pub is_editable: bool,
}

impl Row {
    /// Why it cannot be edited as a value; `None` where it can.
    pub fn why_not_editable(&self) -> Option<Text> {
        let id = match self.kind.access {
            _ if self.is_editable => return None,
            Access::Read => "hd_entry.only_read",
            Access::ReadWrite | Access::Write => "hd_entry.not_a_value",
        };
        Some(TEXTS.text(id).with("number", self.number).with_text("name", self.name.clone()))
    }
}

impl Unit {
    /// The parameters of a drive, or of the device: those that were read, or of a profile those that it can say.
    pub fn rows(&self, of: Option<DriveNumber>) -> Vec<Row> {
        let number = |row: &ParameterRow| match of {
            Some(drive) => ParameterNumber::of_drive(row.number, drive),
            None => ParameterNumber::new(row.number).filter(|number| number.drive().is_none()),
        };
        let rows = PARAMETERS.iter().filter_map(|row| Some((number(row)?, row)));
        rows.filter(|(number, kind)| self.has(*number, kind)).map(|(number, kind)| self.row(number, kind)).collect()
    }

    fn has(&self, number: ParameterNumber, kind: &ParameterRow) -> bool {
        match self.profile() {
            Some(_) => Image::holds(kind),
            None => self.value(number).is_some(),
        }
    }

    fn row(&self, number: ParameterNumber, kind: &'static ParameterRow) -> Row {
        let own = || self.staged.base().and_then(|image| image.get(number)).map(Value::Number);
        let value = self.said_since(number).or_else(|| self.value(number).cloned()).or_else(own);
        let travel = self.travel(number);
        let is_editable = is_editable(kind) && (self.profile().is_none() || Image::holds(kind));
        let staged = self.staged.value(number).filter(|_| is_editable);
        let meant = match (&value, staged) {
            (_, Some(staged)) => Some(Value::Number(staged)),
            (value, None) => value.clone(),
        };
        Row {
            number,
            name: explained::parameter(number),
            kind,
            shown: value.as_ref().map(|value| words::shown(number, value)).unwrap_or_default(),
            meaning: meant.and_then(|value| self.meaning(number, &value)),
            unit: words::unit(kind),
            range: kind.allowed(travel).filter(|_| is_editable).map(explained::range),
            travel,
            factory: self.factory_value(number, kind).map(|own| own.to_string()).unwrap_or_default(),
            staged,
            is_edited: self.staged.differs(number).is_some(),
            changed_from: self.staged.changed_from(number),
            is_editable,
            value,
        }
    }

    /// What a drive has been sent and has said since everything was read: its words, what it measures, its errors.
    fn said_since(&self, number: ParameterNumber) -> Option<Value> {
        let drive = number.drive()?;
        let value = match number.base() {
            101 => self.moves.sent(drive)?.control.word().into(),
            102 => self.moves.sent(drive)?.speed.get().into(),
            103 => self.moves.sent(drive)?.torque.get().into(),
            104 => self.moves.sent(drive)?.target.into(),
            105 => self.actual(drive)?.status.word().into(),
            106 => self.actual(drive)?.speed.into(),
            107 => self.actual(drive)?.position.into(),
            base @ 108..=115 => self.drive_status(drive)?.buffer.get(usize::from(base - 108))?.code().into(),
            _ => return None,
        };
        Some(Value::Number(value))
    }

    /// What a parameter is from the factory, by what the device and the drive are.
    pub fn factory_value(&self, number: ParameterNumber, kind: &ParameterRow) -> Option<i64> {
        let profile = || self.profile_identity().and_then(|own| own.topology);
        let topology = self.identity().map(|own| own.topology).or_else(profile).unwrap_or(Topology::Adapter);
        let family = number.drive().and_then(|drive| self.family(drive)).unwrap_or(Family::Short);
        kind.factory_value(topology, family)
    }

    /// What a drive is one of, as far as its variant is known.
    fn family(&self, drive: DriveNumber) -> Option<Family> {
        let in_profile = || self.profile()?.drive(drive)?.variant;
        let variant = self.drive_identity(drive).map(|own| own.variant).or_else(in_profile)?;
        variant.row().map(|row| row.family)
    }

    /// How far the drive of a parameter turns, in steps as they are wanted to be scaled.
    fn travel(&self, number: ParameterNumber) -> Travel {
        number.drive().map_or(Travel::UNKNOWN, |drive| Travel {
            family: self.family(drive),
            scale: Some(self.wanted_ruler(drive).scale),
        })
    }

    /// What a value means, where the number alone does not say it.
    fn meaning(&self, number: ParameterNumber, value: &Value) -> Option<Text> {
        let value = match value {
            Value::Number(value) => value,
            Value::Text(text) => return words::nominal(number, text),
        };
        let drive = number.drive();
        match (number.base(), drive) {
            // Places, as they are wanted to be scaled.
            (158 | 160 | 198 | 104 | 107 | 170 | 176, Some(drive)) => {
                let ruler = self.wanted_ruler(drive);
                let measure = if ruler.pitch.is_some() { Measure::Millimetres } else { Measure::Turns };
                let place = ruler.of(*value, measure)?;
                let text = TEXTS.text("hd_entry.place").with_number(
                    "value",
                    place,
                    decimals_of(place, ruler.decimals(measure).min(4)),
                );
                Some(text.with_text("unit", TEXTS.text(measure.unit())))
            }
            (154 | 156, Some(drive)) => {
                let steps = self.wanted_ruler(drive).scale.steps_per_turn();
                Some(TEXTS.text("hd_meaning.steps_a_turn").with_number("steps", steps, decimals_of(steps, 3)))
            }
            (106, Some(drive)) => {
                let rpm = self.speed_scale(drive).rpm(i16::try_from(*value).ok()?);
                Some(TEXTS.text("hd_entry.rpm").with_number("rpm", rpm, 1))
            }
            _ => words::meaning(number, *value),
        }
    }
}
