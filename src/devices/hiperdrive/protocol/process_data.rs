//! Process data: what goes to the drives with every packet, and what comes back (reference 2).

use super::control_word::{ControlWord, Refused};
use super::pkw::Pkw;
use super::status_word::StatusWord;
use crate::parameter::Words;

/// Which byte of a number comes first. The manual does not say it (reference 8.11): the low one, unless a device is seen to
/// do otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ByteOrder {
    /// As everywhere in CIP.
    #[default]
    Little,
    /// The high byte first.
    Big,
}

impl ByteOrder {
    /// As links spell it.
    pub const WORDS: Words<ByteOrder> = Words(&[("little", ByteOrder::Little), ("big", ByteOrder::Big)]);
}

/// What stands behind an IP address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Topology {
    /// One drive.
    Adapter,
    /// Up to four.
    Hub4,
    /// Up to eight.
    Hub8,
}

/// What process data look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Layout {
    /// How many drives have a place.
    pub topology: Topology,
    /// Eight bytes of parameter words behind the drives.
    pub pkw: bool,
    /// Of every number.
    pub order: ByteOrder,
}

/// A percentage of a parameter's value: 0 to 100.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Percent(u8);

/// What a host wants of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Setpoint {
    /// STW.
    pub control: ControlWord,
    /// Of the greatest speed (parameter 166). With 0 nothing begins.
    pub speed: Percent,
    /// Of the nominal torque, in steps of 25 %. With 0 nothing begins.
    pub torque: Percent,
    /// In steps as scaled.
    pub target: i32,
}

/// What a drive is sent: a set-point, or anything else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutData {
    /// STW.
    pub control: u16,
    /// Percent.
    pub speed: u8,
    /// Percent.
    pub torque: u8,
    /// In steps as scaled.
    pub target: i32,
}

/// What a drive says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Actual {
    /// ZSW.
    pub status: StatusWord,
    /// As parameters 162 and 164 scale it: tenths of rpm from the factory.
    pub speed: i16,
    /// In steps as scaled.
    pub position: i32,
}

/// All that goes to the drives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutImage {
    /// As many as the layout has.
    pub drives: Vec<OutData>,
    /// Where the layout has it.
    pub pkw: Option<Pkw>,
}

/// All that comes back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InImage {
    /// As many as the layout has.
    pub drives: Vec<Actual>,
    /// Where the layout has it.
    pub pkw: Option<Pkw>,
}

/// Bytes that are no image of a layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{got} bytes of process data where {expected} were expected")]
pub struct ImageError {
    /// The layout's.
    pub expected: usize,
    /// How many there were.
    pub got: usize,
}

/// Bytes of a drive, and of the parameter words.
const PLACE: usize = 8;

impl ByteOrder {
    pub(super) const fn u16(self, bytes: [u8; 2]) -> u16 {
        match self {
            ByteOrder::Little => u16::from_le_bytes(bytes),
            ByteOrder::Big => u16::from_be_bytes(bytes),
        }
    }

    pub(super) const fn u32(self, bytes: [u8; 4]) -> u32 {
        match self {
            ByteOrder::Little => u32::from_le_bytes(bytes),
            ByteOrder::Big => u32::from_be_bytes(bytes),
        }
    }

    pub(super) const fn of_u16(self, number: u16) -> [u8; 2] {
        match self {
            ByteOrder::Little => number.to_le_bytes(),
            ByteOrder::Big => number.to_be_bytes(),
        }
    }

    pub(super) const fn of_u32(self, number: u32) -> [u8; 4] {
        match self {
            ByteOrder::Little => number.to_le_bytes(),
            ByteOrder::Big => number.to_be_bytes(),
        }
    }
}

impl Topology {
    /// All of them.
    pub const ALL: [Topology; 3] = [Topology::Adapter, Topology::Hub4, Topology::Hub8];

    /// Places for drives.
    pub const fn drives(self) -> u8 {
        match self {
            Topology::Adapter => 1,
            Topology::Hub4 => 4,
            Topology::Hub8 => 8,
        }
    }

    /// As parameter 13 spells it.
    pub const fn category(self) -> &'static str {
        match self {
            Topology::Adapter => "HIPERDRIVE SINGLE",
            Topology::Hub4 => "HIPERDRIVE HUB-4",
            Topology::Hub8 => "HIPERDRIVE HUB-8",
        }
    }

    /// By what parameter 13 says.
    pub fn of_category(category: &str) -> Option<Self> {
        Topology::ALL.into_iter().find(|topology| topology.category() == category.trim())
    }
}

impl Layout {
    /// Bytes each way: 8 a drive, 8 of parameter words.
    pub const fn length(self) -> usize {
        PLACE * (self.topology.drives() as usize + self.pkw as usize)
    }

    /// Every layout that has so many bytes, in the order that is assumed.
    pub fn of_length(length: usize) -> impl Iterator<Item = Layout> {
        let all = Topology::ALL
            .into_iter()
            .flat_map(|topology| [true, false].map(|pkw| Layout { topology, pkw, order: ByteOrder::default() }));
        all.filter(move |layout| layout.length() == length)
    }

    /// The places of the drives, and the parameter words.
    fn places(self, bytes: &[u8]) -> Result<(Vec<[u8; PLACE]>, Option<Pkw>), ImageError> {
        let (places, rest) = bytes.as_chunks::<PLACE>();
        if !rest.is_empty() || bytes.len() != self.length() {
            return Err(ImageError { expected: self.length(), got: bytes.len() });
        }
        match places.split_last() {
            Some((last, first)) if self.pkw => Ok((first.to_vec(), Some(Pkw::parse(*last, self.order)))),
            _ => Ok((places.to_vec(), None)),
        }
    }

    /// The image of places; those that are missing are zero, those that are too many are left off.
    fn image(self, places: impl Iterator<Item = [u8; PLACE]>, pkw: Option<Pkw>) -> Vec<u8> {
        let drives = usize::from(self.topology.drives());
        let words = self.pkw.then(|| pkw.unwrap_or_default().emit(self.order));
        places.chain(std::iter::repeat([0; PLACE])).take(drives).chain(words).flatten().collect()
    }
}

impl Percent {
    /// Nothing of it.
    pub const NONE: Percent = Percent(0);
    /// All of it.
    pub const FULL: Percent = Percent(100);

    /// `None` above 100.
    pub const fn new(percent: u8) -> Option<Self> {
        if percent <= 100 { Some(Percent(percent)) } else { None }
    }

    /// Its number.
    pub const fn get(self) -> u8 {
        self.0
    }
}

impl Setpoint {
    /// What follows speed mode and opens every connection: ready, nothing to move with, and the target where the drive
    /// stands, so that no stale one is left.
    pub const fn standing(actual: Actual) -> Self {
        let none = Percent::NONE;
        Setpoint { control: ControlWord::READY, speed: none, torque: none, target: actual.position }
    }
}

impl From<Setpoint> for OutData {
    fn from(setpoint: Setpoint) -> Self {
        let Setpoint { control, speed, torque, target } = setpoint;
        OutData { control: control.word(), speed: speed.0, torque: torque.0, target }
    }
}

impl OutData {
    /// The control word in it.
    ///
    /// # Errors
    /// [`Refused`] with reserved bits.
    pub const fn control(&self) -> Result<ControlWord, Refused> {
        ControlWord::parse(self.control)
    }

    fn parse(bytes: [u8; PLACE], order: ByteOrder) -> Self {
        let [c0, c1, speed, torque, target @ ..] = bytes;
        OutData { control: order.u16([c0, c1]), speed, torque, target: order.u32(target).cast_signed() }
    }

    fn emit(&self, order: ByteOrder) -> [u8; PLACE] {
        let [c0, c1] = order.of_u16(self.control);
        let [a, b, c, d] = order.of_u32(self.target.cast_unsigned());
        [c0, c1, self.speed, self.torque, a, b, c, d]
    }
}

impl Actual {
    fn parse(bytes: [u8; PLACE], order: ByteOrder) -> Self {
        let [z0, z1, s0, s1, position @ ..] = bytes;
        Actual {
            status: StatusWord::new(order.u16([z0, z1])),
            speed: order.u16([s0, s1]).cast_signed(),
            position: order.u32(position).cast_signed(),
        }
    }

    fn emit(&self, order: ByteOrder) -> [u8; PLACE] {
        let [z0, z1] = order.of_u16(self.status.word());
        let [s0, s1] = order.of_u16(self.speed.cast_unsigned());
        let [a, b, c, d] = order.of_u32(self.position.cast_unsigned());
        [z0, z1, s0, s1, a, b, c, d]
    }
}

impl OutImage {
    /// Reads an image.
    ///
    /// # Errors
    /// [`ImageError`] where the length is not the layout's.
    pub fn parse(bytes: &[u8], layout: Layout) -> Result<Self, ImageError> {
        let (places, pkw) = layout.places(bytes)?;
        let drives = places.into_iter().map(|place| OutData::parse(place, layout.order)).collect();
        Ok(OutImage { drives, pkw })
    }

    /// Its bytes. Drives that are missing are left alone (zero); those that have no place are left off.
    pub fn emit(&self, layout: Layout) -> Vec<u8> {
        layout.image(self.drives.iter().map(|drive| drive.emit(layout.order)), self.pkw)
    }
}

impl InImage {
    /// Reads an image.
    ///
    /// # Errors
    /// [`ImageError`] where the length is not the layout's.
    pub fn parse(bytes: &[u8], layout: Layout) -> Result<Self, ImageError> {
        let (places, pkw) = layout.places(bytes)?;
        let drives = places.into_iter().map(|place| Actual::parse(place, layout.order)).collect();
        Ok(InImage { drives, pkw })
    }

    /// Its bytes. Drives that are missing are zero; those that have no place are left off.
    pub fn emit(&self, layout: Layout) -> Vec<u8> {
        layout.image(self.drives.iter().map(|drive| drive.emit(layout.order)), self.pkw)
    }
}
