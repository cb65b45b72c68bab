//! ForwardOpen and ForwardClose, which open and close a cyclic connection. The receiver of the packets chooses their
//! connection ID. See reference 7.

use std::time::Duration;

use super::connection::{ConnectionTimeout, NetworkParameters, RequestTimeout, Transport};
use super::fields::{FieldReader, PacketError, PacketField, Structure};
use super::message::{Reply, Request, Service};
use super::path::EPath;

/// Identification of a connection and its originator. Every message about the connection repeats it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ConnectionOwner {
    /// Connection serial number. The originator chooses a different one for each connection.
    pub connection_serial: u16,
    /// Vendor ID of the originator.
    pub vendor: u16,
    /// Serial number of the originator.
    pub serial_number: u32,
}

/// A request to open a connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForwardOpen {
    /// Time-out of the request.
    pub timeout: RequestTimeout,
    /// Requested connection ID for packets to the target, or 0 to let the target choose one.
    pub to_target_id: u32,
    /// Connection ID of packets to the originator.
    pub to_originator_id: u32,
    /// Identification of the originator and the connection.
    pub owner: ConnectionOwner,
    /// Time without data after which the connection ends.
    pub connection_timeout: ConnectionTimeout,
    /// Requested interval of packets to the target, in microseconds.
    pub to_target_interval_us: u32,
    /// Network parameters of the direction to the target.
    pub to_target: NetworkParameters,
    /// Requested interval of packets to the originator, in microseconds.
    pub to_originator_interval_us: u32,
    /// Network parameters of the direction to the originator.
    pub to_originator: NetworkParameters,
    /// Transport class and trigger.
    pub transport: Transport,
    /// Path to the assemblies.
    pub path: EPath,
}

/// A successful reply to ForwardOpen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForwardOpenSuccess {
    /// Connection ID of packets to the target.
    pub to_target_id: u32,
    /// Connection ID of packets to the originator.
    pub to_originator_id: u32,
    /// Owner of the connection.
    pub owner: ConnectionOwner,
    /// Actual interval of packets to the target, in microseconds.
    pub to_target_interval_us: u32,
    /// Actual interval of packets to the originator, in microseconds.
    pub to_originator_interval_us: u32,
    /// Application data.
    pub application: Vec<u16>,
}

/// An error reply to a request that opens or closes a connection. The status of the reply gives the reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ForwardErrorReply {
    /// Owner of the connection.
    pub owner: ConnectionOwner,
    /// Number of path words that were not processed because of the error.
    pub remaining_path_words: u8,
}

/// A request to close a connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForwardClose {
    /// Time-out of the request.
    pub timeout: RequestTimeout,
    /// Owner of the connection.
    pub owner: ConnectionOwner,
    /// Path to the assemblies.
    pub path: EPath,
}

/// A successful reply to ForwardClose.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForwardCloseSuccess {
    /// Owner of the connection.
    pub owner: ConnectionOwner,
    /// Application data.
    pub application: Vec<u16>,
}

impl ConnectionOwner {
    fn take_from(fields: &mut FieldReader<'_>) -> Result<Self, PacketError> {
        Ok(ConnectionOwner { connection_serial: fields.u16()?, vendor: fields.u16()?, serial_number: fields.u32()? })
    }

    fn push_to(self, bytes: &mut Vec<u8>) {
        bytes.extend([self.connection_serial, self.vendor].into_iter().flat_map(u16::to_le_bytes));
        bytes.extend(self.serial_number.to_le_bytes());
    }
}

impl RequestTimeout {
    fn take_from(fields: &mut FieldReader<'_>) -> Result<Self, PacketError> {
        Ok(RequestTimeout { priority_and_tick: fields.u8()?, ticks: fields.u8()? })
    }
}

impl ForwardOpen {
    /// Returns the time without data after which the target ends the connection.
    pub fn target_timeout(&self) -> Duration {
        self.connection_timeout.for_interval(Duration::from_micros(self.to_target_interval_us.into()))
    }

    /// Parses the service data of the request.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the data are incomplete, are too long, or contain an invalid time-out multiplier.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::ForwardOpen, data);
        let timeout = RequestTimeout::take_from(&mut fields)?;
        let (to_target_id, to_originator_id) = (fields.u32()?, fields.u32()?);
        let owner = ConnectionOwner::take_from(&mut fields)?;
        let multiplier = fields.u8()?;
        let connection_timeout =
            ConnectionTimeout::new(multiplier).ok_or(fields.value(PacketField::TimeoutMultiplier, multiplier))?;
        // Three bytes are reserved.
        fields.take_array::<3>()?;
        let to_target_interval_us = fields.u32()?;
        let to_target = NetworkParameters::from_word(fields.u16()?);
        let to_originator_interval_us = fields.u32()?;
        let to_originator = NetworkParameters::from_word(fields.u16()?);
        let transport = Transport::from_byte(fields.u8()?);
        let path = EPath::take_from(&mut fields)?;
        fields.finish(ForwardOpen {
            timeout,
            to_target_id,
            to_originator_id,
            owner,
            connection_timeout,
            to_target_interval_us,
            to_target,
            to_originator_interval_us,
            to_originator,
            transport,
            path,
        })
    }

    /// Builds the CIP request.
    pub fn request(&self) -> Request {
        let mut data = vec![self.timeout.priority_and_tick, self.timeout.ticks];
        data.extend([self.to_target_id, self.to_originator_id].into_iter().flat_map(u32::to_le_bytes));
        self.owner.push_to(&mut data);
        data.extend([self.connection_timeout.exponent(), 0, 0, 0]);
        data.extend(self.to_target_interval_us.to_le_bytes());
        data.extend(self.to_target.to_bits().to_le_bytes());
        data.extend(self.to_originator_interval_us.to_le_bytes());
        data.extend(self.to_originator.to_bits().to_le_bytes());
        data.push(self.transport.byte());
        self.path.push_to(&mut data);
        Request::for_connection_manager(Service::FORWARD_OPEN, data)
    }
}

impl ForwardOpenSuccess {
    /// Parses the data of the reply.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the data are incomplete or too long.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::ForwardOpenReply, data);
        let (to_target_id, to_originator_id) = (fields.u32()?, fields.u32()?);
        let owner = ConnectionOwner::take_from(&mut fields)?;
        let (to_target_interval_us, to_originator_interval_us) = (fields.u32()?, fields.u32()?);
        let application = parse_application_data(&mut fields)?;
        fields.finish(ForwardOpenSuccess {
            to_target_id,
            to_originator_id,
            owner,
            to_target_interval_us,
            to_originator_interval_us,
            application,
        })
    }

    /// Returns the data of the reply.
    pub fn emit(&self) -> Vec<u8> {
        let mut data: Vec<u8> =
            [self.to_target_id, self.to_originator_id].into_iter().flat_map(u32::to_le_bytes).collect();
        self.owner.push_to(&mut data);
        data.extend(
            [self.to_target_interval_us, self.to_originator_interval_us].into_iter().flat_map(u32::to_le_bytes),
        );
        push_application(&self.application, &mut data);
        data
    }
}

impl ForwardErrorReply {
    /// Parses the data of a rejection. Many devices send none.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the data are incomplete or too long.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::Refusal, data);
        let owner = ConnectionOwner::take_from(&mut fields)?;
        let remaining_path_words = fields.u8()?;
        // One byte is reserved.
        fields.u8()?;
        fields.finish(ForwardErrorReply { owner, remaining_path_words })
    }

    /// Returns the data of the reply.
    pub fn emit(&self) -> Vec<u8> {
        let mut data = Vec::new();
        self.owner.push_to(&mut data);
        data.extend([self.remaining_path_words, 0]);
        data
    }

    /// Builds the reply to `request` with an extended status.
    pub fn reply(&self, request: &Request, extended: u16) -> Reply {
        Reply {
            extended: vec![extended],
            data: self.emit(),
            ..request.error_reply(super::status::GeneralStatus::CONNECTION)
        }
    }
}

impl ForwardClose {
    /// Parses the service data of the request.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the data are incomplete or too long.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::ForwardClose, data);
        let timeout = RequestTimeout::take_from(&mut fields)?;
        let owner = ConnectionOwner::take_from(&mut fields)?;
        let words = fields.u8()?;
        // One byte is reserved.
        fields.u8()?;
        let path = EPath::parse(fields.bytes(usize::from(words) * 2)?)?;
        fields.finish(ForwardClose { timeout, owner, path })
    }

    /// Builds the CIP request.
    pub fn request(&self) -> Request {
        let mut data = vec![self.timeout.priority_and_tick, self.timeout.ticks];
        self.owner.push_to(&mut data);
        let mut path = Vec::new();
        self.path.push_to(&mut path);
        // Only this request has a reserved byte after the length of the path.
        path.insert(1, 0);
        data.extend(path);
        Request::for_connection_manager(Service::FORWARD_CLOSE, data)
    }
}

impl ForwardCloseSuccess {
    /// Parses the data of the reply.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the data are incomplete or too long.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::ForwardCloseReply, data);
        let owner = ConnectionOwner::take_from(&mut fields)?;
        let application = parse_application_data(&mut fields)?;
        fields.finish(ForwardCloseSuccess { owner, application })
    }

    /// Returns the data of the reply.
    pub fn emit(&self) -> Vec<u8> {
        let mut data = Vec::new();
        self.owner.push_to(&mut data);
        push_application(&self.application, &mut data);
        data
    }
}

/// Parses application data: a length in words, a reserved byte, and the words.
fn parse_application_data(fields: &mut FieldReader<'_>) -> Result<Vec<u16>, PacketError> {
    let words = fields.u8()?;
    fields.u8()?;
    (0..words).map(|_| fields.u16()).collect()
}

fn push_application(words: &[u16], data: &mut Vec<u8>) {
    let words = words.get(..usize::from(u8::MAX)).unwrap_or(words);
    // There are at most 255 words.
    data.extend([words.len() as u8, 0]);
    data.extend(words.iter().flat_map(|word| word.to_le_bytes()));
}
