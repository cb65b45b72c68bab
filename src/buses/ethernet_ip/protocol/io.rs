//! Cyclic packets of a class 1 connection over UDP (reference 7).

use super::fields::{FieldReader, PacketError, PacketField, Structure};
use super::items::{Item, ItemList};

/// A cyclic packet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IoPacket {
    /// Connection ID, chosen by the receiver.
    pub connection: u32,
    /// Sequence number, incremented with every packet.
    pub sequence: u32,
    /// Data sequence count, incremented with new data. Incrementing it with every packet is an assumption (`U`).
    pub count: u16,
    /// Run/idle header, if the format has one.
    pub header: Option<RunIdleHeader>,
    /// Process data.
    pub data: Vec<u8>,
}

/// Format of the header before the data, as defined by the EDS of the device. Only packets to the target are assumed to
/// have a header (`U`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RealTimeFormat {
    /// The 32-bit run/idle header.
    Header,
    /// No header.
    Modeless,
}

/// The 32-bit run/idle header. Unknown bits are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RunIdleHeader(u32);

impl RunIdleHeader {
    /// Header with bit 0 set: the data are valid.
    pub const RUN: RunIdleHeader = RunIdleHeader(1);
    /// Header with bit 0 clear: the application of the sender is not running, and the data are not valid.
    pub const IDLE: RunIdleHeader = RunIdleHeader(0);

    /// Creates the header from a received word.
    pub const fn from_word(word: u32) -> Self {
        RunIdleHeader(word)
    }

    /// Returns the encoded word.
    pub const fn to_bits(self) -> u32 {
        self.0
    }

    /// Returns whether the data are valid.
    pub const fn is_running(self) -> bool {
        self.0 & 1 == 1
    }
}

impl IoPacket {
    /// Returns the number of bytes for the sequence count and the header. A connection size includes them.
    pub const fn size_overhead(format: RealTimeFormat) -> u16 {
        match format {
            RealTimeFormat::Header => 6,
            RealTimeFormat::Modeless => 2,
        }
    }

    /// Parses a packet. It may also contain socket addresses.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the packet is incomplete or does not consist of a sequenced address and connected
    /// data.
    pub fn parse(bytes: &[u8], format: RealTimeFormat) -> Result<Self, PacketError> {
        const STRUCTURE: Structure = Structure::CyclicPacket;
        let items = ItemList::parse(bytes)?;
        let (connection, sequence, data) = match items.0.as_slice() {
            [Item::SequencedAddress { connection, sequence }, Item::ConnectedData(data), ..] => {
                (*connection, *sequence, data)
            }
            // A UDP packet contains few enough items for this cast.
            other => {
                return Err(PacketError::Value { what: STRUCTURE, field: PacketField::Items, got: other.len() as u32 });
            }
        };
        let mut fields = FieldReader::new(STRUCTURE, data);
        let count = fields.u16()?;
        let header = match format {
            RealTimeFormat::Header => Some(RunIdleHeader(fields.u32()?)),
            RealTimeFormat::Modeless => None,
        };
        Ok(IoPacket { connection, sequence, count, header, data: fields.take_rest().to_vec() })
    }

    /// Returns the encoded packet.
    pub fn emit(&self) -> Vec<u8> {
        let mut data = self.count.to_le_bytes().to_vec();
        data.extend(self.header.iter().flat_map(|header| header.0.to_le_bytes()));
        data.extend(&self.data);
        let address = Item::SequencedAddress { connection: self.connection, sequence: self.sequence };
        ItemList(vec![address, Item::ConnectedData(data)]).emit()
    }
}
