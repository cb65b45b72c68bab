//! Packets of a cyclic connection of class 1, over UDP (reference 7).

use super::fields::{Fields, PacketError, PacketField, Structure};
use super::items::{Item, Items};

/// A packet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IoPacket {
    /// Connection number chosen by its receiver.
    pub connection: u32,
    /// Higher by one with every packet.
    pub sequence: u32,
    /// Incremented with new data (`U`: with every packet).
    pub count: u16,
    /// Before the data, in packets that have one.
    pub header: Option<RunIdle>,
    /// Process data.
    pub data: Vec<u8>,
}

/// The header before the data, as the device's EDS defines it (`U`: a header to the target, none back).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RealTimeFormat {
    /// 32 bits.
    Header,
    /// Nothing.
    Modeless,
}

/// 32 bits before the data; unknown ones are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RunIdle(u32);

impl RunIdle {
    /// Bit 0 is set: the data are valid.
    pub const RUN: RunIdle = RunIdle(1);
    /// Bit 0 is clear: the program of the sender does not run, and its data are not valid.
    pub const IDLE: RunIdle = RunIdle(0);

    /// Parses the word.
    pub const fn of_word(word: u32) -> Self {
        RunIdle(word)
    }

    /// Returns the word to send.
    pub const fn word(self) -> u32 {
        self.0
    }

    /// Returns whether the data count.
    pub const fn runs(self) -> bool {
        self.0 & 1 == 1
    }
}

impl IoPacket {
    /// Returns the bytes that a connection's size includes besides the data: the sequence count, and the header.
    pub const fn overhead(format: RealTimeFormat) -> u16 {
        match format {
            RealTimeFormat::Header => 6,
            RealTimeFormat::Modeless => 2,
        }
    }

    /// Parses a packet. It may also contain socket addresses.
    ///
    /// # Errors
    /// [`PacketError`] if it is not a sequenced address and connected data, or incomplete.
    pub fn parse(bytes: &[u8], format: RealTimeFormat) -> Result<Self, PacketError> {
        const WHAT: Structure = Structure::CyclicPacket;
        let items = Items::parse(bytes)?;
        let (connection, sequence, data) = match items.0.as_slice() {
            [Item::SequencedAddress { connection, sequence }, Item::ConnectedData(data), ..] => {
                (*connection, *sequence, data)
            }
            // No more than fits into a UDP packet.
            other => return Err(PacketError::Value { what: WHAT, field: PacketField::Items, got: other.len() as u32 }),
        };
        let mut fields = Fields::new(WHAT, data);
        let count = fields.u16()?;
        let header = match format {
            RealTimeFormat::Header => Some(RunIdle(fields.u32()?)),
            RealTimeFormat::Modeless => None,
        };
        Ok(IoPacket { connection, sequence, count, header, data: fields.tail().to_vec() })
    }

    /// Returns its bytes.
    pub fn emit(&self) -> Vec<u8> {
        let mut data = self.count.to_le_bytes().to_vec();
        data.extend(self.header.iter().flat_map(|header| header.0.to_le_bytes()));
        data.extend(&self.data);
        let address = Item::SequencedAddress { connection: self.connection, sequence: self.sequence };
        Items(vec![address, Item::ConnectedData(data)]).emit()
    }
}
