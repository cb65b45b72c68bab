//! Parameter numbers, their CIP addresses, and the rows of the parameter table (reference, sections 4 and 7).

use std::fmt;
use std::time::Duration;

use super::process_data::Topology;
use super::scaling::{Family, PositionScale};
use super::travel::{StepLimit, Travel};
use super::value::Kind;

/// Number of a drive, 1 to 8 on a hub. An adapter has only drive 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DriveNumber(u8);

/// Parameter number: up to 99 for the device, 100 to 199 for drive 1, 200 to 299 for drive 2, and so on up to 899. The
/// manual's text says n · 100 instead of (n − 1) · 100 (reference, section 8.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ParameterNumber(u16);

/// Row of the parameter table.
#[derive(Clone, Copy, Debug)]
pub struct ParameterRow {
    /// Parameter number. A drive parameter has the number for drive 1.
    pub number: u16,
    /// Name of the parameter.
    pub name: &'static str,
    /// Unit of the value, or an empty string if the value has no unit.
    pub unit: &'static str,
    /// Type of the value.
    pub kind: Kind,
    /// Allowed access.
    pub access: ParameterAccess,
    /// Whether the value survives a power cycle after it has been saved.
    pub saved: bool,
    /// Whether the adapter or hub stores the value, and not a drive.
    pub(super) kept_by_device: bool,
    /// Allowed values.
    pub range: ParameterRange,
    /// Limit given by the turns of the drive around 0, in addition to `range`. It is `None` if turns do not limit the
    /// value.
    pub reach: Option<StepLimit>,
    /// Factory value.
    pub factory: FactoryValue,
    /// Values that the device takes a long time to apply. The reply to any other written value comes as fast as the
    /// reply to a read.
    pub slow: &'static [SlowValue],
}

/// A value whose reply is sent only after the device has applied it, with the maximum time for this.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlowValue {
    /// Written value.
    pub value: i64,
    /// Maximum time for an adapter.
    pub adapter: Duration,
    /// Maximum time for a hub.
    pub hub: Duration,
}

/// Access to a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ParameterAccess {
    /// Read only.
    Read,
    /// Read and write.
    ReadWrite,
    /// Write-only access. A read returns no meaningful value.
    Write,
}

/// Allowed values of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterRange {
    /// Any value of the parameter's type.
    Any,
    /// A value between two numbers, inclusive.
    Within(i64, i64),
    /// A value between two numbers, or one further number with a special meaning.
    WithinOrEqual(i64, i64, i64),
    /// One of the listed values, smallest first.
    OneOf(&'static [i64]),
}

/// Factory value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactoryValue {
    /// No factory value, because the parameter is measured or identifies the device.
    None,
    /// The same number for every topology.
    Number(i64),
    /// Factory values that differ between adapters and hubs.
    Topology {
        /// Factory value of an adapter.
        adapter: i64,
        /// Factory value for each drive of a hub.
        hub: i64,
    },
    /// The factory number of turns of the drive family, in the direction given by the sign −1 or 1.
    Turns(i32),
    /// A value determined by the drive.
    Automatic,
}

/// A number outside the allowed values of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub struct OutOfRange {
    /// Number of the parameter.
    pub number: ParameterNumber,
    /// Name of the parameter.
    pub name: &'static str,
    /// Rejected value.
    pub value: i64,
    /// Allowed values, which are never [`ParameterRange::Any`].
    pub range: ParameterRange,
}

/// CIP class of the device parameters. The class of drive 1 follows it.
const CLASS: u16 = 0x64;

impl DriveNumber {
    /// First drive.
    pub const FIRST: DriveNumber = DriveNumber(1);

    /// Creates a drive number, or returns `None` outside the range 1 to 8.
    pub const fn new(number: u8) -> Option<Self> {
        if 1 <= number && number <= 8 { Some(DriveNumber(number)) } else { None }
    }

    /// Returns the drive number, 1 to 8.
    pub const fn get(self) -> u8 {
        self.0
    }

    /// Returns the numbers of all drives for which a topology has a port.
    pub fn all_for(topology: Topology) -> impl Iterator<Item = DriveNumber> {
        (1..=topology.drives()).map(DriveNumber)
    }
}

impl ParameterRow {
    /// Returns whether the adapter or hub stores the parameter. The values −1 and −2 of parameter 47 change only such
    /// parameters (manual, 47).
    pub const fn is_stored_by_device(&self) -> bool {
        self.saved && self.kept_by_device
    }
}

impl ParameterNumber {
    /// Parameter that saves, resets or restores all parameters.
    pub const SAVE: ParameterNumber = ParameterNumber(47);

    /// Creates a parameter number, or returns `None` for 0 and above 899.
    pub const fn new(number: u16) -> Option<Self> {
        if 1 <= number && number <= 899 { Some(ParameterNumber(number)) } else { None }
    }

    /// Converts a parameter number of drive 1 to the number for another drive, or returns `None` if the number does not
    /// belong to drive 1.
    pub const fn for_drive(number: u16, drive: DriveNumber) -> Option<Self> {
        if 100 <= number && number <= 199 { Some(ParameterNumber(number + 100 * (drive.0 as u16 - 1))) } else { None }
    }

    /// Returns the parameter number, 1 to 899.
    pub const fn get(self) -> u16 {
        self.0
    }

    /// Returns the drive to which the parameter belongs, or `None` for a device parameter.
    pub const fn drive(self) -> Option<DriveNumber> {
        DriveNumber::new((self.0 / 100) as u8)
    }

    /// Returns the number of the same parameter for drive 1, or the number itself for a device parameter.
    pub const fn drive1_number(self) -> u16 {
        if self.0 < 100 { self.0 } else { 100 + self.0 % 100 }
    }

    /// Returns the table row, or `None` if the manual does not list the parameter.
    pub fn row(self) -> Option<&'static ParameterRow> {
        super::parameters::PARAMETERS.iter().find(|row| row.number == self.drive1_number())
    }

    /// Returns the CIP class that contains the parameter.
    pub const fn class(self) -> u16 {
        CLASS + self.0 / 100
    }

    /// Returns the attribute number within instance 1 of the class.
    pub const fn attribute(self) -> u16 {
        self.drive1_number()
    }

    /// Returns the parameter number for a class and attribute, or `None` if they do not address a parameter.
    pub fn from_attribute(class: u16, attribute: u16) -> Option<Self> {
        match class.checked_sub(CLASS)? {
            0 if attribute < 100 => ParameterNumber::new(attribute),
            drive => ParameterNumber::for_drive(attribute, DriveNumber::new(u8::try_from(drive).ok()?)?),
        }
    }
}

impl fmt::Display for ParameterNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl ParameterRow {
    /// Returns the allowed values, or `None` for strings. They come from the table or, if it gives none, from the data
    /// type. The turns of the drive restrict them as far as they are known.
    pub fn allowed_values(&self, travel: Travel) -> Option<ParameterRange> {
        let (low, high) = self.kind.limits()?;
        Some(match (self.range, self.reach.and_then(|reach| travel.max_steps(reach))) {
            (ParameterRange::Any, Some(most)) => ParameterRange::Within(low.max(-most), high.min(most)),
            (ParameterRange::Any, None) => ParameterRange::Within(low, high),
            (range, _) => range,
        })
    }

    /// Checks a value against the range of a parameter. The drive itself checks dependencies between parameters:
    /// parameter 160 must be above parameter 158, and the position, the target and parameter 198 must lie between the
    /// two.
    ///
    /// # Errors
    /// Returns [`OutOfRange`] with the allowed values. Strings accept no number.
    pub fn check_value(&self, number: ParameterNumber, value: i64, travel: Travel) -> Result<i64, OutOfRange> {
        let range = self.allowed_values(travel).unwrap_or(ParameterRange::OneOf(&[]));
        if range.contains(value) { Ok(value) } else { Err(OutOfRange { number, name: self.name, value, range }) }
    }

    /// Returns how long the device may take to reply when this value is written, or `None` if the usual reply time
    /// applies. For an unknown topology, the time of a hub is returned.
    pub fn write_duration(&self, value: i64, topology: Option<Topology>) -> Option<Duration> {
        let slow = self.slow.iter().find(|slow| slow.value == value)?;
        Some(if topology == Some(Topology::Adapter) { slow.adapter } else { slow.hub })
    }

    /// Returns the factory value under factory scaling, or `None` if the manual gives no value or the drive determines
    /// it.
    pub fn factory_value(&self, topology: Topology, family: Family) -> Option<i64> {
        match self.factory {
            FactoryValue::None | FactoryValue::Automatic => None,
            FactoryValue::Number(number) => Some(number),
            FactoryValue::Topology { adapter, hub } => Some(if topology == Topology::Adapter { adapter } else { hub }),
            FactoryValue::Turns(sign) => {
                PositionScale::FACTORY.steps_of_turns(sign * family.factory_turns()).map(i64::from)
            }
        }
    }
}

impl ParameterRange {
    /// Returns whether the range contains a number.
    pub fn contains(self, value: i64) -> bool {
        match self {
            ParameterRange::Any => true,
            ParameterRange::Within(low, high) => (low..=high).contains(&value),
            ParameterRange::WithinOrEqual(low, high, also) => (low..=high).contains(&value) || value == also,
            ParameterRange::OneOf(values) => values.contains(&value),
        }
    }
}

impl fmt::Display for ParameterRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ParameterRange::Any => f.write_str("any number"),
            ParameterRange::Within(only, same) if only == same => write!(f, "only {only}"),
            ParameterRange::Within(low, high) => write!(f, "{low} to {high}"),
            ParameterRange::WithinOrEqual(low, high, also) => write!(f, "{low} to {high} or {also}"),
            ParameterRange::OneOf(values) => {
                let values: Vec<String> = values.iter().map(i64::to_string).collect();
                f.write_str(&values.join(", "))
            }
        }
    }
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let OutOfRange { number, name, value, range } = self;
        match range {
            ParameterRange::OneOf([]) => write!(f, "parameter {number} ({name}) contains text and cannot be {value}"),
            _ => write!(f, "parameter {number} ({name}) cannot be {value} (allowed: {range})"),
        }
    }
}
