//! CIP requests and replies (reference 7).

use super::fields::{FieldReader, PacketError, PacketField, Structure};
use super::path::{EPath, LogicalKind};
use super::status::GeneralStatus;

/// The service of a request. Unknown services are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Service(u8);

/// A CIP request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// Requested service.
    pub service: Service,
    /// Path to the object.
    pub path: EPath,
    /// Service data.
    pub data: Vec<u8>,
}

/// A CIP reply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reply {
    /// Service of the request.
    pub service: Service,
    /// General status.
    pub status: GeneralStatus,
    /// Extended status words, at most 255. The service defines their meaning.
    pub extended: Vec<u16>,
    /// Reply data.
    pub data: Vec<u8>,
}

const NAMES: [(Service, &str); 5] = [
    (Service::GET_ALL, "Get_Attributes_All"),
    (Service::SET_ALL, "Set_Attributes_All"),
    (Service::RESET, "Reset"),
    (Service::GET, "Get_Attribute_Single"),
    (Service::SET, "Set_Attribute_Single"),
];
const CONNECTION_NAMES: [(Service, &str); 4] = [
    (Service::FORWARD_OPEN, "ForwardOpen"),
    (Service::FORWARD_CLOSE, "ForwardClose"),
    (Service(0x52), "Unconnected_Send"),
    (Service(0x5B), "Large_ForwardOpen"),
];

/// Object classes that many devices have.
const CLASSES: [(u16, &str); 6] = [
    (0x01, "identity"),
    (0x02, "message router"),
    (0x04, "assembly"),
    (Request::CONNECTION_MANAGER, "connection manager"),
    (0xF5, "TCP/IP interface"),
    (0xF6, "Ethernet link"),
];

/// Returns the name of a class, or `None` if the class is unknown or vendor-specific.
pub fn class_name(class: u16) -> Option<&'static str> {
    CLASSES.iter().find(|(number, _)| *number == class).map(|(_, name)| *name)
}

impl Service {
    /// Service that reads all attributes.
    pub const GET_ALL: Service = Service(0x01);
    /// Service that sets all attributes.
    pub const SET_ALL: Service = Service(0x02);
    /// Service that resets the device.
    pub const RESET: Service = Service(0x05);
    /// Service that reads one attribute.
    pub const GET: Service = Service(0x0E);
    /// Service that sets one attribute.
    pub const SET: Service = Service(0x10);
    /// Service that closes a connection, provided by the connection manager.
    pub const FORWARD_CLOSE: Service = Service(0x4E);
    /// Service that opens a connection, provided by the connection manager.
    pub const FORWARD_OPEN: Service = Service(0x54);

    const REPLY_BIT: u8 = 0x80;

    /// Returns the service with the given code. Returns `None` for codes from 80h on, which belong to replies.
    pub const fn new(code: u8) -> Option<Self> {
        if code < Service::REPLY_BIT { Some(Service(code)) } else { None }
    }

    /// Returns the code of the service in a request.
    pub const fn code(self) -> u8 {
        self.0
    }

    /// Returns the name used by ODVA. From 4Bh on, the meaning of a code depends on the class. In this range, only the
    /// services of the connection manager are known.
    pub fn name(self, class: Option<u16>) -> Option<&'static str> {
        let connections = class.is_none_or(|class| class == Request::CONNECTION_MANAGER).then_some(&CONNECTION_NAMES);
        let names = NAMES.iter().chain(connections.into_iter().flatten());
        names.into_iter().find(|(service, _)| *service == self).map(|(_, name)| *name)
    }
}

impl Request {
    /// Class code of the connection manager.
    pub const CONNECTION_MANAGER: u16 = 0x06;

    /// Creates a request to read an attribute.
    pub fn get(class: u16, instance: u16, attribute: u16) -> Self {
        Request { service: Service::GET, path: EPath::to_attribute(class, instance, attribute), data: Vec::new() }
    }

    /// Creates a request to set an attribute.
    pub fn set_attribute(class: u16, instance: u16, attribute: u16, data: Vec<u8>) -> Self {
        Request { service: Service::SET, path: EPath::to_attribute(class, instance, attribute), data }
    }

    /// Creates a request to read all attributes of an object.
    pub fn get_all(class: u16, instance: u16) -> Self {
        Request { service: Service::GET_ALL, path: EPath::to_instance(class, instance), data: Vec::new() }
    }

    pub(super) fn for_connection_manager(service: Service, data: Vec<u8>) -> Self {
        Request { service, path: EPath::to_instance(Request::CONNECTION_MANAGER, 1), data }
    }

    /// Returns the class to which the request is addressed.
    pub fn class_id(&self) -> Option<u16> {
        self.path.first_value(LogicalKind::Class)
    }

    /// Parses a request.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the bytes are a reply or the path is incomplete.
    pub fn parse(bytes: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::CipRequest, bytes);
        let code = fields.u8()?;
        let service = Service::new(code).ok_or(fields.value(PacketField::Service, code))?;
        let path = EPath::take_from(&mut fields)?;
        Ok(Request { service, path, data: fields.take_rest().to_vec() })
    }

    /// Returns the encoded request.
    pub fn emit(&self) -> Vec<u8> {
        let mut bytes = vec![self.service.0];
        self.path.push_to(&mut bytes);
        bytes.extend(&self.data);
        bytes
    }

    /// Creates a successful reply.
    pub fn success_reply(&self, data: Vec<u8>) -> Reply {
        Reply { service: self.service, status: GeneralStatus::OK, extended: Vec::new(), data }
    }

    /// Creates a reply that rejects this request.
    pub fn error_reply(&self, status: GeneralStatus) -> Reply {
        Reply { service: self.service, status, extended: Vec::new(), data: Vec::new() }
    }
}

impl Reply {
    /// Parses a reply.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the bytes are a request or are incomplete.
    pub fn parse(bytes: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::CipReply, bytes);
        let code = fields.u8()?;
        let service = code.checked_sub(Service::REPLY_BIT).ok_or(fields.value(PacketField::Service, code))?;
        // The second byte is reserved.
        fields.u8()?;
        let status = GeneralStatus::new(fields.u8()?);
        let words = fields.u8()?;
        let extended = (0..words).map(|_| fields.u16()).collect::<Result<_, _>>()?;
        Ok(Reply { service: Service(service), status, extended, data: fields.take_rest().to_vec() })
    }

    /// Returns the encoded reply, with at most 255 words of extended status.
    pub fn emit(&self) -> Vec<u8> {
        let extended = self.extended.get(..usize::from(u8::MAX)).unwrap_or(&self.extended);
        // There are at most 255 words.
        let mut bytes = vec![self.service.0 | Service::REPLY_BIT, 0, self.status.code(), extended.len() as u8];
        bytes.extend(extended.iter().flat_map(|word| word.to_le_bytes()));
        bytes.extend(&self.data);
        bytes
    }
}
