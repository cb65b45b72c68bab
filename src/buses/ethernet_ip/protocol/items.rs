//! Common packet format: a list of items, each with its type and length (reference 7).

use core::net::Ipv4Addr;

use super::fields::{FieldReader, PacketError, Structure};
use super::identity::IdentityItem;

/// A list of items. Each address item precedes its data item.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ItemList(pub Vec<Item>);

/// An item of a packet. Unknown types are preserved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Item {
    /// 0000h: the address of an unconnected message.
    Null,
    /// 000Ch: the identity of a device.
    Identity(IdentityItem),
    /// 00A1h: the address of a message of an explicit connection.
    ConnectedAddress(u32),
    /// 00B1h: data of a connection.
    ConnectedData(Vec<u8>),
    /// 00B2h: a CIP message outside of any connection.
    UnconnectedData(Vec<u8>),
    /// 8000h: the address for data from the originator to the target.
    SocketToTarget(SocketAddress),
    /// 8001h: the address for data from the target to the originator.
    SocketToOriginator(SocketAddress),
    /// 8002h: the address of cyclic data.
    SequencedAddress {
        /// Connection ID, chosen by the receiver.
        connection: u32,
        /// Sequence number, incremented with every packet. This includes packets with unchanged data.
        sequence: u32,
    },
    /// An item of unknown type.
    Unknown {
        /// Type code.
        kind: u16,
        /// Data as received.
        data: Vec<u8>,
    },
}

/// A socket address in network byte order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SocketAddress {
    /// Address family, 2 for IPv4.
    pub family: u16,
    /// Port number.
    pub port: u16,
    /// IPv4 address. 0.0.0.0 means the sender of the frame.
    pub address: Ipv4Addr,
}

const NULL: u16 = 0x0000;
const IDENTITY: u16 = 0x000C;
const CONNECTED_ADDRESS: u16 = 0x00A1;
const CONNECTED_DATA: u16 = 0x00B1;
const UNCONNECTED_DATA: u16 = 0x00B2;
const SOCKET_TO_TARGET: u16 = 0x8000;
const SOCKET_TO_ORIGINATOR: u16 = 0x8001;
const SEQUENCED_ADDRESS: u16 = 0x8002;

impl ItemList {
    /// Parses a list that occupies all of `bytes`.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if an item is incomplete or has the wrong length for its type, or if bytes remain.
    pub fn parse(bytes: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::Items, bytes);
        let count = fields.u16()?;
        let mut items = Vec::new();
        for _ in 0..count {
            let (kind, length) = (fields.u16()?, fields.u16()?);
            items.push(Item::parse(kind, fields.bytes(length.into())?)?);
        }
        fields.finish(ItemList(items))
    }

    /// Returns the encoded list. Items longer than 65535 bytes are truncated.
    pub fn emit(&self) -> Vec<u8> {
        let most = usize::from(u16::MAX);
        // A frame has fewer items than the maximum count.
        let mut bytes = (self.0.len().min(most) as u16).to_le_bytes().to_vec();
        for item in self.0.iter().take(most) {
            let (kind, data) = item.emit();
            let data = data.get(..most).unwrap_or(&data);
            bytes.extend(kind.to_le_bytes());
            bytes.extend((data.len() as u16).to_le_bytes());
            bytes.extend(data);
        }
        bytes
    }

    /// Returns the unconnected CIP message, if the list contains one.
    pub fn unconnected_data(&self) -> Option<&[u8]> {
        self.0.iter().find_map(|item| match item {
            Item::UnconnectedData(data) => Some(data.as_slice()),
            _ => None,
        })
    }

    /// Returns the socket address for data to the target.
    pub fn socket_to_target(&self) -> Option<SocketAddress> {
        self.0.iter().find_map(|item| match item {
            Item::SocketToTarget(address) => Some(*address),
            _ => None,
        })
    }

    /// Returns the socket address for data to the originator.
    pub fn socket_to_originator(&self) -> Option<SocketAddress> {
        self.0.iter().find_map(|item| match item {
            Item::SocketToOriginator(address) => Some(*address),
            _ => None,
        })
    }

    /// Returns the identity item, if the list contains one.
    pub fn identity(&self) -> Option<&IdentityItem> {
        self.0.iter().find_map(|item| match item {
            Item::Identity(identity) => Some(identity),
            _ => None,
        })
    }
}

impl Item {
    fn parse(kind: u16, data: &[u8]) -> Result<Self, PacketError> {
        let item = match kind {
            NULL => FieldReader::new(Structure::NullAddress, data).finish(Item::Null)?,
            IDENTITY => Item::Identity(IdentityItem::parse(data)?),
            CONNECTED_ADDRESS => {
                let mut fields = FieldReader::new(Structure::ConnectedAddress, data);
                let connection = fields.u32()?;
                fields.finish(Item::ConnectedAddress(connection))?
            }
            CONNECTED_DATA => Item::ConnectedData(data.to_vec()),
            UNCONNECTED_DATA => Item::UnconnectedData(data.to_vec()),
            SOCKET_TO_TARGET => Item::SocketToTarget(SocketAddress::parse(data)?),
            SOCKET_TO_ORIGINATOR => Item::SocketToOriginator(SocketAddress::parse(data)?),
            SEQUENCED_ADDRESS => {
                let mut fields = FieldReader::new(Structure::SequencedAddress, data);
                let item = Item::SequencedAddress { connection: fields.u32()?, sequence: fields.u32()? };
                fields.finish(item)?
            }
            _ => Item::Unknown { kind, data: data.to_vec() },
        };
        Ok(item)
    }

    fn emit(&self) -> (u16, Vec<u8>) {
        match self {
            Item::Null => (NULL, Vec::new()),
            Item::Identity(identity) => (IDENTITY, identity.emit()),
            Item::ConnectedAddress(connection) => (CONNECTED_ADDRESS, connection.to_le_bytes().to_vec()),
            Item::ConnectedData(data) => (CONNECTED_DATA, data.clone()),
            Item::UnconnectedData(data) => (UNCONNECTED_DATA, data.clone()),
            Item::SocketToTarget(address) => (SOCKET_TO_TARGET, address.emit().to_vec()),
            Item::SocketToOriginator(address) => (SOCKET_TO_ORIGINATOR, address.emit().to_vec()),
            Item::SequencedAddress { connection, sequence } => {
                (SEQUENCED_ADDRESS, [connection.to_le_bytes(), sequence.to_le_bytes()].concat())
            }
            Item::Unknown { kind, data } => (*kind, data.clone()),
        }
    }
}

impl SocketAddress {
    /// Address family of IPv4.
    pub const INTERNET: u16 = 2;
    pub(super) const LENGTH: usize = 16;

    /// Creates an IPv4 socket address.
    pub const fn new(address: Ipv4Addr, port: u16) -> Self {
        SocketAddress { family: SocketAddress::INTERNET, port, address }
    }

    /// Parses 16 bytes. The last eight are ignored.
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::SocketAddress, bytes);
        let family = u16::from_be_bytes(fields.take_array()?);
        let port = u16::from_be_bytes(fields.take_array()?);
        let address = Ipv4Addr::from(fields.take_array::<4>()?);
        fields.take_array::<8>()?;
        fields.finish(SocketAddress { family, port, address })
    }

    pub(super) fn emit(&self) -> [u8; SocketAddress::LENGTH] {
        let [f0, f1] = self.family.to_be_bytes();
        let [p0, p1] = self.port.to_be_bytes();
        let [a, b, c, d] = self.address.octets();
        [f0, f1, p0, p1, a, b, c, d, 0, 0, 0, 0, 0, 0, 0, 0]
    }
}
