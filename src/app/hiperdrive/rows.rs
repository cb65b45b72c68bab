//! The parameters as rows of a table: what each is, what it may be, what it is from the factory, and what is wanted of it.

use super::ruler::Measure;
use super::staged::is_editable;
use super::unit::Unit;
use super::words;
use crate::app::{Text, explain};
use crate::profile::hiperdrive::Image;
use crate::protocol::hiperdrive::{DriveNumber, Family, PARAMETERS, ParameterNumber, ParameterRow, Topology, Value};

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
        let value = self.value(number).cloned().or_else(own);
        let is_editable = is_editable(kind) && (self.profile().is_none() || Image::holds(kind));
        let staged = self.staged.value(number).filter(|_| is_editable);
        let meant = match (&value, staged) {
            (_, Some(staged)) => Some(Value::Number(staged)),
            (value, None) => value.clone(),
        };
        Row {
            number,
            name: explain::hiperdrive::parameter(number),
            kind,
            shown: value.as_ref().map(|value| words::shown(number, value)).unwrap_or_default(),
            meaning: meant.and_then(|value| self.meaning(number, &value)),
            unit: words::unit(kind),
            range: kind.allowed().filter(|_| is_editable).map(explain::hiperdrive::range),
            factory: self.factory_value(number, kind).map(|own| own.to_string()).unwrap_or_default(),
            staged,
            is_edited: self.staged.differs(number).is_some(),
            changed_from: self.staged.changed_from(number),
            is_editable,
            value,
        }
    }

    /// What a parameter is from the factory, by what the device and the drive are.
    pub fn factory_value(&self, number: ParameterNumber, kind: &ParameterRow) -> Option<i64> {
        let profile = || self.profile_identity().and_then(|own| own.topology);
        let topology = self.identity().map(|own| own.topology).or_else(profile).unwrap_or(Topology::Adapter);
        let variant = number.drive().and_then(|drive| {
            let in_profile = || self.profile()?.drive(drive)?.variant;
            self.drive_identity(drive).map(|own| own.variant).or_else(in_profile)
        });
        let family = variant.and_then(|own| own.row()).map_or(Family::Short, |row| row.family);
        kind.factory_value(topology, family)
    }

    /// What a value means, where the number alone does not say it.
    fn meaning(&self, number: ParameterNumber, value: &Value) -> Option<Text> {
        let Value::Number(value) = value else { return None };
        let drive = number.drive();
        match (number.base(), drive) {
            // Places, as they are wanted to be scaled.
            (158 | 160 | 198 | 104 | 107 | 170 | 176, Some(drive)) => {
                let ruler = self.wanted_ruler(drive);
                let measure = if ruler.pitch.is_some() { Measure::Millimetres } else { Measure::Turns };
                let place = ruler.of(*value, measure)?;
                let text = Text::new("hd_entry.place").with_number("value", place, ruler.decimals(measure).min(4));
                Some(text.with_text("unit", Text::new(measure.unit())))
            }
            (154 | 156, Some(drive)) => {
                let ruler = self.wanted_ruler(drive);
                Some(Text::new("hd_meaning.steps_a_turn").with_number("steps", ruler.scale.steps_per_turn(), 3))
            }
            (106, Some(drive)) => {
                let rpm = self.speed_scale(drive).rpm(i16::try_from(*value).ok()?);
                Some(Text::new("hd_entry.rpm").with_number("rpm", rpm, 1))
            }
            _ => words::meaning(number, *value),
        }
    }
}
