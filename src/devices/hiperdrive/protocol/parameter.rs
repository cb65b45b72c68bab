//! Parameter numbers, their CIP addresses, and the rows of the parameter table (reference, sections 4 and 7).

use std::fmt;
use std::time::Duration;

use super::process_data::Topology;
use super::scaling::{Family, PositionScale};
use super::travel::{StepLimit, Travel};
use super::value::Kind;

/// Number of a drive: 1 to 8 on a hub, or 1 on an adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DriveNumber(u8);

/// Parameter number: up to 99 for the device, 100 to 199 for drive 1, 200 to 299 for drive 2, and so on up to 899.
/// Drive n adds (n − 1) · 100 to the numbers of drive 1. The text of the manual wrongly says n · 100 (reference,
/// section 8.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ParameterNumber(u16);

/// Row of the parameter table.
#[derive(Clone, Copy, Debug)]
pub struct ParameterRow {
    /// Parameter number. For a drive parameter, this is the number for drive 1.
    pub number: u16,
    /// Name of the parameter.
    pub name: &'static str,
    /// Unit of the value, or an empty string if there is none.
    pub unit: &'static str,
    /// Type of the value.
    pub kind: Kind,
    /// Allowed access.
    pub access: ParameterAccess,
    /// Whether the value can be saved, so that it survives a power cycle.
    pub saved: bool,
    /// Whether the value is stored by the adapter or hub, even if it concerns a drive.
    pub(super) kept_by_device: bool,
    /// Allowed values.
    pub range: ParameterRange,
    /// Additional limit of the value, given by the turns of the drive. It is `None` if the turns do not limit the
    /// value.
    pub reach: Option<StepLimit>,
    /// Factory value.
    pub factory: FactoryValue,
    /// Values that take the device a long time to apply. The device replies to all other writes as fast as to a read.
    pub slow: &'static [SlowValue],
}

/// A value that delays the reply to its write until the device has applied it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlowValue {
    /// Written value.
    pub value: i64,
    /// Maximum delay on an adapter.
    pub adapter: Duration,
    /// Maximum delay on a hub.
    pub hub: Duration,
}

/// Access to a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ParameterAccess {
    /// Read only.
    Read,
    /// Read and write.
    ReadWrite,
    /// Write-only. A read returns no meaningful value.
    Write,
}

/// Allowed values of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterRange {
    /// Any value of the parameter's type.
    Any,
    /// A value between two numbers, inclusive.
    Within(i64, i64),
    /// A value between two numbers, or the third number, which has a special meaning.
    WithinOrEqual(i64, i64, i64),
    /// One of the listed values, in ascending order.
    OneOf(&'static [i64]),
}

/// Factory value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactoryValue {
    /// None, because the parameter is measured or identifies the device.
    None,
    /// The same value for all topologies.
    Number(i64),
    /// Factory values that differ between adapters and hubs.
    Topology {
        /// Factory value of an adapter.
        adapter: i64,
        /// Factory value for each drive of a hub.
        hub: i64,
    },
    /// The drive family's factory number of turns, with the sign −1 or 1 for the direction.
    Turns(i32),
    /// A value that the drive determines itself.
    Automatic,
}

/// Error for a number outside the allowed values of its parameter.
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

/// CIP class of the device parameters. The classes of drives 1 to 8 follow it.
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

    /// Returns the numbers of all drives that can be connected in this topology.
    pub fn all_in_topology(topology: Topology) -> impl Iterator<Item = DriveNumber> {
        (1..=topology.drives()).map(DriveNumber)
    }
}

impl ParameterRow {
    /// Returns whether the adapter or hub itself stores the parameter. Writing −1 or −2 to parameter 47 affects only
    /// such parameters (manual, 47).
    pub const fn is_stored_by_device(&self) -> bool {
        self.saved && self.kept_by_device
    }
}

impl ParameterNumber {
    /// Parameter 47, which saves, resets or restores all parameters.
    pub const SAVE: ParameterNumber = ParameterNumber(47);

    /// Creates a parameter number, or returns `None` if the number is 0 or above 899.
    pub const fn new(number: u16) -> Option<Self> {
        if 1 <= number && number <= 899 { Some(ParameterNumber(number)) } else { None }
    }

    /// Converts the number of a drive 1 parameter to the number for another drive. Returns `None` if the number does
    /// not belong to drive 1.
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

    /// Returns the number of the same parameter for drive 1. A device parameter keeps its number.
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

    /// Returns the attribute number of the parameter in instance 1 of its class.
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
    /// type and the travel of the drive.
    pub fn allowed_values(&self, travel: Travel) -> Option<ParameterRange> {
        let (low, high) = self.kind.limits()?;
        Some(match (self.range, self.reach.and_then(|reach| travel.max_steps(reach))) {
            (ParameterRange::Any, Some(most)) => ParameterRange::Within(low.max(-most), high.min(most)),
            (ParameterRange::Any, None) => ParameterRange::Within(low, high),
            (range, _) => range,
        })
    }

    /// Checks a value against the range of its parameter. Dependencies are left to the drive: parameter 160 must be
    /// above parameter 158, with the position, the target and parameter 198 between them.
    ///
    /// # Errors
    /// Returns [`OutOfRange`] with the allowed values if the value is out of range or the parameter is a string.
    pub fn check_value(&self, number: ParameterNumber, value: i64, travel: Travel) -> Result<i64, OutOfRange> {
        let range = self.allowed_values(travel).unwrap_or(ParameterRange::OneOf(&[]));
        if range.contains(value) { Ok(value) } else { Err(OutOfRange { number, name: self.name, value, range }) }
    }

    /// Returns how long the device may take to reply to a write of this value, or `None` for the usual reply time. If
    /// the topology is unknown, the time for a hub is returned.
    pub fn write_duration(&self, value: i64, topology: Option<Topology>) -> Option<Duration> {
        let slow = self.slow.iter().find(|slow| slow.value == value)?;
        Some(if topology == Some(Topology::Adapter) { slow.adapter } else { slow.hub })
    }

    /// Returns the factory value, assuming factory scaling. Returns `None` if the manual does not give the value or the
    /// drive determines it itself.
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
    /// Returns whether the range includes a number.
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
