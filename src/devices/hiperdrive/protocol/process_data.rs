//! Process data: the cyclic data sent to the drives and received from them (reference, section 2).

use super::control_word::{ControlWord, ReservedBitsError};
use super::pkw::Pkw;
use super::status_word::StatusWord;
use crate::parameter::Keywords;

/// Byte order of numbers in the process data. The manual does not specify it (reference, section 8.11). Little-endian
/// is assumed unless a device proves to differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ByteOrder {
    /// Low byte first, as throughout CIP.
    #[default]
    Little,
    /// High byte first.
    Big,
}

impl ByteOrder {
    /// Names of the byte orders in link URLs.
    pub const KEYWORDS: Keywords<ByteOrder> = Keywords(&[("little", ByteOrder::Little), ("big", ByteOrder::Big)]);
}

/// Type of the device, which determines the number of drive ports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Topology {
    /// Adapter with one drive.
    Adapter,
    /// Hub with up to four drives.
    Hub4,
    /// Hub with up to eight drives.
    Hub8,
}

/// Layout of the process data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Layout {
    /// Type of the device, which determines the number of drive ports.
    pub topology: Topology,
    /// Whether eight bytes of parameter words follow the drive data.
    pub pkw: bool,
    /// Byte order of all numbers.
    pub order: ByteOrder,
}

/// Percentage from 0 to 100.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Percent(u8);

/// Setpoint for a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Setpoint {
    /// Control word (STW).
    pub control: ControlWord,
    /// Speed in percent of the maximum speed (parameter 166). At 0 %, no motion starts.
    pub speed: Percent,
    /// Torque in percent of the nominal torque, in steps of 25 %. At 0 %, no motion starts.
    pub torque: Percent,
    /// Target in scaled steps.
    pub target: i32,
}

/// Output data for a drive: a setpoint or arbitrary bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutputData {
    /// Control word (STW).
    pub control: u16,
    /// Speed in percent.
    pub speed: u8,
    /// Torque in percent.
    pub torque: u8,
    /// Target in scaled steps.
    pub target: i32,
}

/// Input data from a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ActualValues {
    /// Status word (ZSW).
    pub status: StatusWord,
    /// Speed, scaled with parameters 162 and 164. The factory scale gives tenths of rpm.
    pub speed: i16,
    /// Position in scaled steps.
    pub position: i32,
}

/// Process data sent to all drives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputImage {
    /// Output data for each drive in the layout.
    pub drives: Vec<OutputData>,
    /// Parameter words, if the layout has them.
    pub pkw: Option<Pkw>,
}

/// Process data received from all drives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputImage {
    /// Input data from each drive in the layout.
    pub drives: Vec<ActualValues>,
    /// Parameter words, if the layout has them.
    pub pkw: Option<Pkw>,
}

/// Error for process data whose length does not match the layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{got} bytes of process data instead of {expected}")]
pub struct ProcessImageError {
    /// Length required by the layout, in bytes.
    pub expected: usize,
    /// Actual length in bytes.
    pub got: usize,
}

/// Number of data bytes per drive. The parameter words have the same length.
const BYTES_PER_DRIVE: usize = 8;

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

    pub(super) const fn encode_u16(self, number: u16) -> [u8; 2] {
        match self {
            ByteOrder::Little => number.to_le_bytes(),
            ByteOrder::Big => number.to_be_bytes(),
        }
    }

    pub(super) const fn encode_u32(self, number: u32) -> [u8; 4] {
        match self {
            ByteOrder::Little => number.to_le_bytes(),
            ByteOrder::Big => number.to_be_bytes(),
        }
    }
}

impl Topology {
    /// All topologies.
    pub const ALL: [Topology; 3] = [Topology::Adapter, Topology::Hub4, Topology::Hub8];

    /// Returns the number of drive ports.
    pub const fn drives(self) -> u8 {
        match self {
            Topology::Adapter => 1,
            Topology::Hub4 => 4,
            Topology::Hub8 => 8,
        }
    }

    /// Returns the value of parameter 13 that stands for this topology.
    pub const fn category(self) -> &'static str {
        match self {
            Topology::Adapter => "HIPERDRIVE SINGLE",
            Topology::Hub4 => "HIPERDRIVE HUB-4",
            Topology::Hub8 => "HIPERDRIVE HUB-8",
        }
    }

    /// Returns the topology that a value of parameter 13 stands for.
    pub fn from_category(category: &str) -> Option<Self> {
        Topology::ALL.into_iter().find(|topology| topology.category() == category.trim())
    }
}

impl Layout {
    /// Returns the number of bytes in each direction: 8 per drive, plus 8 if there are parameter words.
    pub const fn byte_length(self) -> usize {
        BYTES_PER_DRIVE * (self.topology.drives() as usize + self.pkw as usize)
    }

    /// Returns all layouts with this length, most likely first.
    pub fn all_with_length(length: usize) -> impl Iterator<Item = Layout> {
        let all = Topology::ALL
            .into_iter()
            .flat_map(|topology| [true, false].map(|pkw| Layout { topology, pkw, order: ByteOrder::default() }));
        all.filter(move |layout| layout.byte_length() == length)
    }

    /// Splits process data into the data of each drive and the parameter words.
    fn split_drives(self, bytes: &[u8]) -> Result<(Vec<[u8; BYTES_PER_DRIVE]>, Option<Pkw>), ProcessImageError> {
        let (places, rest) = bytes.as_chunks::<BYTES_PER_DRIVE>();
        if !rest.is_empty() || bytes.len() != self.byte_length() {
            return Err(ProcessImageError { expected: self.byte_length(), got: bytes.len() });
        }
        match places.split_last() {
            Some((last, first)) if self.pkw => Ok((first.to_vec(), Some(Pkw::parse(*last, self.order)))),
            _ => Ok((places.to_vec(), None)),
        }
    }

    /// Builds process data from the data of the drives. Missing drives are filled with zeros, and surplus drives are
    /// dropped.
    fn image(self, places: impl Iterator<Item = [u8; BYTES_PER_DRIVE]>, pkw: Option<Pkw>) -> Vec<u8> {
        let drives = usize::from(self.topology.drives());
        let words = self.pkw.then(|| pkw.unwrap_or_default().emit(self.order));
        places.chain(std::iter::repeat([0; BYTES_PER_DRIVE])).take(drives).chain(words).flatten().collect()
    }
}

impl Percent {
    /// A percentage of 0 %, the minimum.
    pub const NONE: Percent = Percent(0);
    /// A percentage of 100 %, the maximum.
    pub const FULL: Percent = Percent(100);

    /// Creates a percentage, or returns `None` above 100.
    pub const fn new(percent: u8) -> Option<Self> {
        if percent <= 100 { Some(Percent(percent)) } else { None }
    }

    /// Returns the percentage, 0 to 100.
    pub const fn get(self) -> u8 {
        self.0
    }
}

impl Setpoint {
    /// Returns a setpoint that holds the drive in the ready state, with zero speed and torque. Every connection begins
    /// with it, and it follows speed mode. The target is the actual position, so that no stale target remains.
    pub const fn holding(actual: ActualValues) -> Self {
        let none = Percent::NONE;
        Setpoint { control: ControlWord::READY, speed: none, torque: none, target: actual.position }
    }
}

impl From<Setpoint> for OutputData {
    fn from(setpoint: Setpoint) -> Self {
        let Setpoint { control, speed, torque, target } = setpoint;
        OutputData { control: control.to_u16(), speed: speed.0, torque: torque.0, target }
    }
}

impl OutputData {
    /// Returns the control word.
    ///
    /// # Errors
    /// Returns [`ReservedBitsError`] if a reserved bit is set.
    pub const fn control_word(&self) -> Result<ControlWord, ReservedBitsError> {
        ControlWord::parse(self.control)
    }

    fn parse(bytes: [u8; BYTES_PER_DRIVE], order: ByteOrder) -> Self {
        let [c0, c1, speed, torque, target @ ..] = bytes;
        OutputData { control: order.u16([c0, c1]), speed, torque, target: order.u32(target).cast_signed() }
    }

    fn emit(&self, order: ByteOrder) -> [u8; BYTES_PER_DRIVE] {
        let [c0, c1] = order.encode_u16(self.control);
        let [a, b, c, d] = order.encode_u32(self.target.cast_unsigned());
        [c0, c1, self.speed, self.torque, a, b, c, d]
    }
}

impl ActualValues {
    fn parse(bytes: [u8; BYTES_PER_DRIVE], order: ByteOrder) -> Self {
        let [z0, z1, s0, s1, position @ ..] = bytes;
        ActualValues {
            status: StatusWord::new(order.u16([z0, z1])),
            speed: order.u16([s0, s1]).cast_signed(),
            position: order.u32(position).cast_signed(),
        }
    }

    fn emit(&self, order: ByteOrder) -> [u8; BYTES_PER_DRIVE] {
        let [z0, z1] = order.encode_u16(self.status.to_u16());
        let [s0, s1] = order.encode_u16(self.speed.cast_unsigned());
        let [a, b, c, d] = order.encode_u32(self.position.cast_unsigned());
        [z0, z1, s0, s1, a, b, c, d]
    }
}

impl OutputImage {
    /// Parses process data.
    ///
    /// # Errors
    /// Returns [`ProcessImageError`] if the length does not match the layout.
    pub fn parse(bytes: &[u8], layout: Layout) -> Result<Self, ProcessImageError> {
        let (places, pkw) = layout.split_drives(bytes)?;
        let drives = places.into_iter().map(|place| OutputData::parse(place, layout.order)).collect();
        Ok(OutputImage { drives, pkw })
    }

    /// Encodes process data. Missing drives are filled with zeros, which do not request control. Surplus drives are
    /// dropped.
    pub fn emit(&self, layout: Layout) -> Vec<u8> {
        layout.image(self.drives.iter().map(|drive| drive.emit(layout.order)), self.pkw)
    }
}

impl InputImage {
    /// Parses process data.
    ///
    /// # Errors
    /// Returns [`ProcessImageError`] if the length does not match the layout.
    pub fn parse(bytes: &[u8], layout: Layout) -> Result<Self, ProcessImageError> {
        let (places, pkw) = layout.split_drives(bytes)?;
        let drives = places.into_iter().map(|place| ActualValues::parse(place, layout.order)).collect();
        Ok(InputImage { drives, pkw })
    }

    /// Encodes process data. Missing drives are filled with zeros, and surplus drives are dropped.
    pub fn emit(&self, layout: Layout) -> Vec<u8> {
        layout.image(self.drives.iter().map(|drive| drive.emit(layout.order)), self.pkw)
    }
}
