//! The encapsulation frame around every explicit message: command, session, status and context. See reference 7.

use super::fields::{FieldReader, PacketError, PacketField, Structure};
use super::items::{Item, ItemList};
use super::status::EncapsulationStatus;

/// The command of a frame. Unknown commands are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Command(u16);

/// An encapsulation frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Command code, repeated in the reply.
    pub command: Command,
    /// Session handle, assigned by the target in the RegisterSession reply. Before this reply, the handle is 0.
    pub session: u32,
    /// Status, always 0 in a request.
    pub status: EncapsulationStatus,
    /// Sender context, chosen by the originator and repeated in the reply.
    pub context: [u8; 8],
    /// Options, always 0.
    pub options: u32,
    /// Data after the header, at most [`Frame::MAX_DATA`] bytes. [`Frame::emit`] truncates longer data.
    pub data: Vec<u8>,
}

/// The content of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Body {
    /// No data, as in list requests, UnregisterSession and rejections.
    Empty,
    /// Data of a RegisterSession request or reply.
    Register {
        /// Protocol version, always 1.
        version: u16,
        /// Options, always 0.
        options: u16,
    },
    /// Items of a list reply.
    List(ItemList),
    /// Data of a SendRRData or SendUnitData request or reply.
    Data {
        /// Interface handle, 0 for CIP.
        interface: u32,
        /// Time-out in seconds, or 0 if CIP has its own time-out.
        timeout_s: u16,
        /// Address item and data item.
        items: ItemList,
    },
    /// Data of an unknown command.
    Other(Vec<u8>),
}

const NAMES: [(Command, &str); 8] = [
    (Command::NOP, "NOP"),
    (Command::LIST_SERVICES, "ListServices"),
    (Command::LIST_IDENTITY, "ListIdentity"),
    (Command::LIST_INTERFACES, "ListInterfaces"),
    (Command::REGISTER_SESSION, "RegisterSession"),
    (Command::UNREGISTER_SESSION, "UnRegisterSession"),
    (Command::SEND_RR_DATA, "SendRRData"),
    (Command::SEND_UNIT_DATA, "SendUnitData"),
];

impl Command {
    /// Command that does nothing.
    pub const NOP: Command = Command(0x00);
    /// Command that requests the list of services.
    pub const LIST_SERVICES: Command = Command(0x04);
    /// Command that requests the identity. It may be broadcast.
    pub const LIST_IDENTITY: Command = Command(0x63);
    /// Command that requests the list of non-CIP interfaces.
    pub const LIST_INTERFACES: Command = Command(0x64);
    /// Command that opens a session.
    pub const REGISTER_SESSION: Command = Command(0x65);
    /// Command that closes a session.
    pub const UNREGISTER_SESSION: Command = Command(0x66);
    /// Command that carries an unconnected request or reply.
    pub const SEND_RR_DATA: Command = Command(0x6F);
    /// Command that carries a message of an explicit connection.
    pub const SEND_UNIT_DATA: Command = Command(0x70);

    /// Creates a command from its code. Every value is valid.
    pub const fn new(number: u16) -> Self {
        Command(number)
    }

    /// Returns the command code.
    pub const fn code(self) -> u16 {
        self.0
    }

    /// Returns the name that ODVA uses for the command, or `None` for an unknown code.
    pub fn name(self) -> Option<&'static str> {
        NAMES.iter().find(|(command, _)| *command == self).map(|(_, name)| *name)
    }
}

impl Frame {
    /// Header length in bytes.
    pub const HEADER: usize = 24;
    /// Maximum length of the data in bytes.
    pub const MAX_DATA: usize = 65511;
    /// Version of the encapsulation protocol.
    pub const VERSION: u16 = 1;

    fn request(command: Command, context: [u8; 8], body: &Body) -> Self {
        Frame { command, session: 0, status: EncapsulationStatus::OK, context, options: 0, data: body.emit() }
    }

    /// Creates a ListIdentity request.
    pub fn list_identity(context: [u8; 8]) -> Self {
        Frame::request(Command::LIST_IDENTITY, context, &Body::Empty)
    }

    /// Creates the request that opens a session.
    pub fn register(context: [u8; 8]) -> Self {
        let body = Body::Register { version: Frame::VERSION, options: 0 };
        Frame::request(Command::REGISTER_SESSION, context, &body)
    }

    /// Creates the frame that closes a session. There is no reply.
    pub fn unregister_session(session: u32) -> Self {
        Frame { session, ..Frame::request(Command::UNREGISTER_SESSION, [0; 8], &Body::Empty) }
    }

    /// Creates a frame with an unconnected CIP message.
    pub fn unconnected_message(session: u32, context: [u8; 8], message: Vec<u8>) -> Self {
        let items = ItemList(vec![Item::Null, Item::UnconnectedData(message)]);
        Frame {
            session,
            ..Frame::request(Command::SEND_RR_DATA, context, &Body::Data { interface: 0, timeout_s: 0, items })
        }
    }

    /// Creates a reply to this frame in the same session.
    pub fn reply(&self, body: &Body) -> Self {
        Frame { status: EncapsulationStatus::OK, options: 0, data: body.emit(), ..self.clone() }
    }

    /// Creates a reply that rejects this request.
    pub fn error_reply(&self, status: EncapsulationStatus) -> Self {
        Frame { status, options: 0, data: Vec::new(), ..self.clone() }
    }

    /// Returns whether this frame is the reply to `request`. Command and context must be equal. In a session, the
    /// session handles must also be equal.
    pub fn is_reply_to(&self, request: &Frame) -> bool {
        let session = request.session == 0 || request.session == self.session;
        self.command == request.command && self.context == request.context && session
    }

    /// Returns the length of the frame that begins with these bytes, or `None` if the header is incomplete.
    ///
    /// # Errors
    /// Returns [`PacketError::Value`] if the length exceeds [`Frame::MAX_DATA`].
    pub fn total_length(bytes: &[u8]) -> Result<Option<usize>, PacketError> {
        let Some(header) = bytes.first_chunk::<{ Frame::HEADER }>() else { return Ok(None) };
        let [_, _, low, high, ..] = header;
        let length = u16::from_le_bytes([*low, *high]);
        match usize::from(length) {
            data if data <= Frame::MAX_DATA => Ok(Some(Frame::HEADER + data)),
            _ => Err(PacketError::Value { what: STRUCTURE, field: PacketField::Length, got: length.into() }),
        }
    }

    /// Parses a complete frame.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the bytes are not exactly one frame.
    pub fn parse(bytes: &[u8]) -> Result<Self, PacketError> {
        Frame::total_length(bytes)?;
        let mut fields = FieldReader::new(STRUCTURE, bytes);
        let command = Command(fields.u16()?);
        let length = fields.u16()?;
        let session = fields.u32()?;
        let status = EncapsulationStatus::new(fields.u32()?);
        let context = fields.take_array()?;
        let options = fields.u32()?;
        let data = fields.bytes(length.into())?.to_vec();
        fields.finish(Frame { command, session, status, context, options, data })
    }

    /// Returns the encoded frame.
    pub fn emit(&self) -> Vec<u8> {
        let data = self.data.get(..Frame::MAX_DATA).unwrap_or(&self.data);
        let mut bytes = Vec::with_capacity(Frame::HEADER + data.len());
        bytes.extend(self.command.0.to_le_bytes());
        // The length is at most 65511.
        bytes.extend((data.len() as u16).to_le_bytes());
        bytes.extend(self.session.to_le_bytes());
        bytes.extend(self.status.code().to_le_bytes());
        bytes.extend(self.context);
        bytes.extend(self.options.to_le_bytes());
        bytes.extend(data);
        bytes
    }

    /// Parses the data of the frame.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the data do not match the command.
    pub fn parse_body(&self) -> Result<Body, PacketError> {
        if self.data.is_empty() {
            return Ok(Body::Empty);
        }
        match self.command {
            Command::REGISTER_SESSION => {
                let mut fields = FieldReader::new(Structure::RegisterSession, &self.data);
                let body = Body::Register { version: fields.u16()?, options: fields.u16()? };
                fields.finish(body)
            }
            Command::LIST_IDENTITY | Command::LIST_SERVICES | Command::LIST_INTERFACES => {
                Ok(Body::List(ItemList::parse(&self.data)?))
            }
            Command::SEND_RR_DATA | Command::SEND_UNIT_DATA => {
                let mut fields = FieldReader::new(Structure::SendRRData, &self.data);
                let (interface, timeout_s) = (fields.u32()?, fields.u16()?);
                Ok(Body::Data { interface, timeout_s, items: ItemList::parse(fields.take_rest())? })
            }
            _ => Ok(Body::Other(self.data.clone())),
        }
    }
}

const STRUCTURE: Structure = Structure::Encapsulation;

impl Body {
    /// Returns the encoded data.
    pub fn emit(&self) -> Vec<u8> {
        match self {
            Body::Empty => Vec::new(),
            Body::Register { version, options } => [version.to_le_bytes(), options.to_le_bytes()].concat(),
            Body::List(items) => items.emit(),
            Body::Data { interface, timeout_s, items } => {
                let mut bytes = interface.to_le_bytes().to_vec();
                bytes.extend(timeout_s.to_le_bytes());
                bytes.extend(items.emit());
                bytes
            }
            Body::Other(bytes) => bytes.clone(),
        }
    }

    /// Returns the CIP message, if the data contain one.
    pub fn message(&self) -> Option<&[u8]> {
        match self {
            Body::Data { items, .. } => items.unconnected_data(),
            _ => None,
        }
    }
}
