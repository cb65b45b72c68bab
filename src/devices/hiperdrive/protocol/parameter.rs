//! How parameters are numbered, where CIP has them, and what a row of their table says (reference 4 and 7).

use std::fmt;
use std::time::Duration;

use super::process_data::Topology;
use super::scaling::{Family, PositionScale};
use super::travel::{Reach, Travel};
use super::value::Kind;

/// A drive of a hub: 1 to 8. An adapter has drive 1 alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DriveNumber(u8);

/// A parameter's own number: up to 99 of the device, 100 to 199 of drive 1, 200 to 299 of drive 2, and so on to 899. The
/// manual's text says n · 100 where it is (n − 1) · 100 (reference 8.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ParameterNumber(u16);

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct ParameterRow {
    /// Its number, of drive 1 where it is a drive's.
    pub number: u16,
    /// What it is.
    pub name: &'static str,
    /// Of its number; empty where it has none.
    pub unit: &'static str,
    /// What its value is.
    pub kind: Kind,
    /// What may be done with it.
    pub access: Access,
    /// It survives the supply, after a save where it was written.
    pub saved: bool,
    /// The adapter or hub holds it, and not a drive.
    pub(super) kept_by_device: bool,
    /// What it may be.
    pub range: Range,
    /// How far from 0 it may be in turns of the drive, beside its range; `None` where turns do not bound it.
    pub reach: Option<Reach>,
    /// What it is from the factory.
    pub factory: Factory,
    /// Values that take the device long when they are set; of all others a reply takes as long as of a read.
    pub slow: &'static [SlowSet],
}

/// A value whose set is answered when it is done, and how long that may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlowSet {
    /// What is written.
    pub value: i64,
    /// With an adapter.
    pub adapter: Duration,
    /// With a hub.
    pub hub: Duration,
}

/// What may be done with a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// It is read.
    Read,
    /// It is read and written.
    ReadWrite,
    /// It is written: reading it says nothing.
    Write,
}

/// What a parameter may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Whatever its kind holds.
    Any,
    /// Between two numbers, both included.
    Within(i64, i64),
    /// Between two numbers, or a further one that means something of its own.
    WithinOr(i64, i64, i64),
    /// One of these, the least first.
    OneOf(&'static [i64]),
}

/// What a parameter is from the factory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Factory {
    /// Nothing: it is measured, or says what the device is.
    None,
    /// A number.
    Number(i64),
    /// One number with an adapter, another with a hub.
    Topology {
        /// Of a single drive.
        adapter: i64,
        /// Of each drive of a hub.
        hub: i64,
    },
    /// So many times the drive's turns either way: −1 or 1.
    Turns(i32),
    /// The drive finds it out.
    Automatic,
}

/// A number beyond what a parameter may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub struct OutOfRange {
    /// The parameter's own number.
    pub number: ParameterNumber,
    /// What it is.
    pub name: &'static str,
    /// As given.
    pub value: i64,
    /// What it may be; never [`Range::Any`].
    pub range: Range,
}

/// The class of parameters of the device; of drive 1 it is the next one.
const CLASS: u16 = 0x64;

impl DriveNumber {
    /// The first.
    pub const FIRST: DriveNumber = DriveNumber(1);

    /// `None` beyond 1 to 8.
    pub const fn new(number: u8) -> Option<Self> {
        if 1 <= number && number <= 8 { Some(DriveNumber(number)) } else { None }
    }

    /// Its number.
    pub const fn get(self) -> u8 {
        self.0
    }

    /// All that a topology has a place for.
    pub fn of(topology: Topology) -> impl Iterator<Item = DriveNumber> {
        (1..=topology.drives()).map(DriveNumber)
    }
}

impl ParameterRow {
    /// It is kept by the adapter or hub itself: 47 = −1 and −2 change these, and no others (manual, 47).
    pub const fn is_kept_by_device(&self) -> bool {
        self.saved && self.kept_by_device
    }
}

impl ParameterNumber {
    /// The parameter with which everything is saved, reset or led back.
    pub const SAVE: ParameterNumber = ParameterNumber(47);

    /// `None` for 0 and above 899.
    pub const fn new(number: u16) -> Option<Self> {
        if 1 <= number && number <= 899 { Some(ParameterNumber(number)) } else { None }
    }

    /// A number of drive 1 as it is of another drive; `None` where it is the device's, or no drive 1's.
    pub const fn of_drive(number: u16, drive: DriveNumber) -> Option<Self> {
        if 100 <= number && number <= 199 { Some(ParameterNumber(number + 100 * (drive.0 as u16 - 1))) } else { None }
    }

    /// Its own number.
    pub const fn get(self) -> u16 {
        self.0
    }

    /// Whose it is; `None` for the device's.
    pub const fn drive(self) -> Option<DriveNumber> {
        DriveNumber::new((self.0 / 100) as u8)
    }

    /// The number of the same parameter of drive 1, or of the device.
    pub const fn base(self) -> u16 {
        if self.0 < 100 { self.0 } else { 100 + self.0 % 100 }
    }

    /// Its row; `None` where the manual has none.
    pub fn row(self) -> Option<&'static ParameterRow> {
        super::parameters::PARAMETERS.iter().find(|row| row.number == self.base())
    }

    /// The class in which CIP has it.
    pub const fn class(self) -> u16 {
        CLASS + self.0 / 100
    }

    /// The attribute of instance 1 of its class.
    pub const fn attribute(self) -> u16 {
        self.base()
    }

    /// By class and attribute; `None` for what is no parameter's.
    pub fn of_attribute(class: u16, attribute: u16) -> Option<Self> {
        match class.checked_sub(CLASS)? {
            0 if attribute < 100 => ParameterNumber::new(attribute),
            drive => ParameterNumber::of_drive(attribute, DriveNumber::new(u8::try_from(drive).ok()?)?),
        }
    }
}

impl fmt::Display for ParameterNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl ParameterRow {
    /// What it may be, with the limits of its kind where there are no others, and no more turns than the drive has as far as
    /// those are known; `None` for texts.
    pub fn allowed(&self, travel: Travel) -> Option<Range> {
        let (low, high) = self.kind.limits()?;
        Some(match (self.range, self.reach.and_then(|reach| travel.steps(reach))) {
            (Range::Any, Some(most)) => Range::Within(low.max(-most), high.min(most)),
            (Range::Any, None) => Range::Within(low, high),
            (range, _) => range,
        })
    }

    /// That it may be this number. What depends on other parameters the drive checks itself: 160 is above 158, position,
    /// target and 198 lie between them.
    ///
    /// # Errors
    /// [`OutOfRange`] with what it may be. A text may be no number.
    pub fn check(&self, number: ParameterNumber, value: i64, travel: Travel) -> Result<i64, OutOfRange> {
        let range = self.allowed(travel).unwrap_or(Range::OneOf(&[]));
        if range.holds(value) { Ok(value) } else { Err(OutOfRange { number, name: self.name, value, range }) }
    }

    /// How long the device may take to answer when this value is set; `None` where that is no longer than any other reply. As
    /// long as with a hub where it is not known which device it is.
    pub fn takes(&self, value: i64, topology: Option<Topology>) -> Option<Duration> {
        let slow = self.slow.iter().find(|slow| slow.value == value)?;
        Some(if topology == Some(Topology::Adapter) { slow.adapter } else { slow.hub })
    }

    /// What it is from the factory, with factory scaling; `None` where nothing is said, or the drive finds it out.
    pub fn factory_value(&self, topology: Topology, family: Family) -> Option<i64> {
        match self.factory {
            Factory::None | Factory::Automatic => None,
            Factory::Number(number) => Some(number),
            Factory::Topology { adapter, hub } => Some(if topology == Topology::Adapter { adapter } else { hub }),
            Factory::Turns(sign) => PositionScale::FACTORY.steps_of_turns(sign * family.factory_turns()).map(i64::from),
        }
    }
}

impl Range {
    /// Whether a number is in it.
    pub fn holds(self, value: i64) -> bool {
        match self {
            Range::Any => true,
            Range::Within(low, high) => (low..=high).contains(&value),
            Range::WithinOr(low, high, also) => (low..=high).contains(&value) || value == also,
            Range::OneOf(values) => values.contains(&value),
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Range::Any => f.write_str("any number"),
            Range::Within(only, same) if only == same => write!(f, "{only} alone"),
            Range::Within(low, high) => write!(f, "{low} to {high}"),
            Range::WithinOr(low, high, also) => write!(f, "{low} to {high} or {also}"),
            Range::OneOf(values) => {
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
            Range::OneOf([]) => write!(f, "parameter {number} ({name}) is a text and cannot be {value}"),
            _ => write!(f, "parameter {number} ({name}) cannot be {value}: it may be {range}"),
        }
    }
}
