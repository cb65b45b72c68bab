//! Device identity: the identity object (class 1) and the item of the ListIdentity reply (`P ODVA`).

use super::fields::{FieldReader, PacketError, Structure, push_short_text, text};
use super::items::SocketAddress;

/// Attributes 1 to 7 of the identity object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Vendor ID assigned by ODVA. Halstrup-Walcher is 1010.
    pub vendor: u16,
    /// Device type.
    pub device_type: u16,
    /// Product code, assigned by the manufacturer.
    pub product_code: u16,
    /// Revision of the device.
    pub revision: Revision,
    /// Status word of the device.
    pub status: u16,
    /// Serial number, unique among the devices of a vendor.
    pub serial_number: u32,
    /// Product name, up to 32 ASCII characters.
    pub product_name: String,
}

/// Major and minor revision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Revision {
    /// Major revision.
    pub major: u8,
    /// Minor revision.
    pub minor: u8,
}

/// The item with the identity of a device, type 000Ch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IdentityItem {
    /// Version of the encapsulation protocol, always 1.
    pub version: u16,
    /// Address for explicit messages.
    pub socket: SocketAddress,
    /// Identity of the device.
    pub identity: Identity,
    /// Device state, attribute 8. State 3 is operational, and 255 is unknown.
    pub state: u8,
}

impl Identity {
    /// Class code of the identity object.
    pub const CLASS: u16 = 0x01;

    /// Parses attributes 1 to 7 of a Get_Attributes_All reply. Any further attributes are ignored.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the attributes are incomplete.
    pub fn parse_all(bytes: &[u8]) -> Result<Self, PacketError> {
        Identity::take_from(&mut FieldReader::new(Structure::IdentityObject, bytes))
    }

    /// Returns attributes 1 to 7 in the format of Get_Attributes_All.
    pub fn emit_all(&self) -> Vec<u8> {
        (1..=7).filter_map(|attribute| self.attribute_bytes(attribute)).flatten().collect()
    }

    /// Returns an attribute in the format of Get_Attribute_Single, or `None` if the attribute does not exist.
    pub fn attribute_bytes(&self, number: u16) -> Option<Vec<u8>> {
        let bytes = match number {
            1 => self.vendor.to_le_bytes().to_vec(),
            2 => self.device_type.to_le_bytes().to_vec(),
            3 => self.product_code.to_le_bytes().to_vec(),
            4 => vec![self.revision.major, self.revision.minor],
            5 => self.status.to_le_bytes().to_vec(),
            6 => self.serial_number.to_le_bytes().to_vec(),
            7 => {
                let mut name = Vec::new();
                push_short_text(&mut name, &self.product_name);
                name
            }
            _ => return None,
        };
        Some(bytes)
    }

    fn take_from(fields: &mut FieldReader<'_>) -> Result<Self, PacketError> {
        Ok(Identity {
            vendor: fields.u16()?,
            device_type: fields.u16()?,
            product_code: fields.u16()?,
            revision: Revision { major: fields.u8()?, minor: fields.u8()? },
            status: fields.u16()?,
            serial_number: fields.u32()?,
            product_name: {
                let length = fields.u8()?;
                text(fields.bytes(length.into())?)
            },
        })
    }
}

impl IdentityItem {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::IdentityItem, bytes);
        let version = fields.u16()?;
        let socket = SocketAddress::parse(fields.bytes(SocketAddress::LENGTH)?)?;
        let identity = Identity::take_from(&mut fields)?;
        let state = fields.u8()?;
        fields.finish(IdentityItem { version, socket, identity, state })
    }

    pub(super) fn emit(&self) -> Vec<u8> {
        let mut bytes = self.version.to_le_bytes().to_vec();
        bytes.extend(self.socket.emit());
        bytes.extend(self.identity.emit_all());
        bytes.push(self.state);
        bytes
    }
}

impl std::fmt::Display for Revision {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}.{:03}", self.major, self.minor)
    }
}
