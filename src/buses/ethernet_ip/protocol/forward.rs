//! ForwardOpen and ForwardClose: opening and closing a cyclic connection (reference 7). The target chooses the number of
//! the packets to it, the originator of those from it.

use std::time::Duration;

use super::connection::{ConnectionTimeout, NetworkParameters, RequestTimeout, Transport};
use super::fields::{Fields, PacketError, PacketField, Structure};
use super::message::{Reply, Request, Service};
use super::path::Path;

/// Identifies a connection and its originator: the same in every message about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Owner {
    /// Chosen by the originator, another for each connection.
    pub connection_serial: u16,
    /// The originator's maker.
    pub vendor: u16,
    /// The originator's serial number.
    pub serial_number: u32,
}

/// A connection is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForwardOpen {
    /// Time-out of the request.
    pub timeout: RequestTimeout,
    /// 0: the target chooses.
    pub to_target_id: u32,
    /// Connection id of packets to the originator.
    pub to_originator_id: u32,
    /// The originator and the connection.
    pub owner: Owner,
    /// Time without data after which it ends.
    pub connection_timeout: ConnectionTimeout,
    /// Microseconds between two packets to the target.
    pub to_target_interval_us: u32,
    /// Parameters towards the target.
    pub to_target: NetworkParameters,
    /// Microseconds between two packets to the originator.
    pub to_originator_interval_us: u32,
    /// Parameters towards the originator.
    pub to_originator: NetworkParameters,
    /// When data are sent.
    pub transport: Transport,
    /// The assemblies.
    pub path: Path,
}

/// A connection has begun.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForwardOpened {
    /// Connection id of packets to the target.
    pub to_target_id: u32,
    /// Connection id of packets to the originator.
    pub to_originator_id: u32,
    /// Whose connection it is.
    pub owner: Owner,
    /// Microseconds between two packets to the target, as they are expected.
    pub to_target_interval_us: u32,
    /// Microseconds between two packets to the originator, as they will come.
    pub to_originator_interval_us: u32,
    /// Data of the application.
    pub application: Vec<u16>,
}

/// A connection was not opened, or not closed; the status of the reply tells why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ForwardRefused {
    /// Owner of the connection.
    pub owner: Owner,
    /// Words of the path that remained at the error.
    pub remaining_path_words: u8,
}

/// A connection is to end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForwardClose {
    /// Time-out of the request.
    pub timeout: RequestTimeout,
    /// Whose connection it is.
    pub owner: Owner,
    /// The assemblies.
    pub path: Path,
}

/// A connection has ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForwardClosed {
    /// Whose connection it was.
    pub owner: Owner,
    /// Data of the application.
    pub application: Vec<u16>,
}

impl Owner {
    fn take(fields: &mut Fields<'_>) -> Result<Self, PacketError> {
        Ok(Owner { connection_serial: fields.u16()?, vendor: fields.u16()?, serial_number: fields.u32()? })
    }

    fn push_to(self, bytes: &mut Vec<u8>) {
        bytes.extend([self.connection_serial, self.vendor].into_iter().flat_map(u16::to_le_bytes));
        bytes.extend(self.serial_number.to_le_bytes());
    }
}

impl RequestTimeout {
    fn take(fields: &mut Fields<'_>) -> Result<Self, PacketError> {
        Ok(RequestTimeout { priority_and_tick: fields.u8()?, ticks: fields.u8()? })
    }
}

impl ForwardOpen {
    /// Returns how long the target waits for data before it ends the connection.
    pub fn to_target_timeout(&self) -> Duration {
        self.connection_timeout.after(Duration::from_micros(self.to_target_interval_us.into()))
    }

    /// Parses the data after the path of the request.
    ///
    /// # Errors
    /// [`PacketError`] if it is incomplete, too long, or its time-out is an invalid number.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = Fields::new(Structure::ForwardOpen, data);
        let timeout = RequestTimeout::take(&mut fields)?;
        let (to_target_id, to_originator_id) = (fields.u32()?, fields.u32()?);
        let owner = Owner::take(&mut fields)?;
        let multiplier = fields.u8()?;
        let connection_timeout =
            ConnectionTimeout::new(multiplier).ok_or(fields.value(PacketField::TimeoutMultiplier, multiplier))?;
        // Reserved.
        fields.array::<3>()?;
        let to_target_interval_us = fields.u32()?;
        let to_target = NetworkParameters::of_word(fields.u16()?);
        let to_originator_interval_us = fields.u32()?;
        let to_originator = NetworkParameters::of_word(fields.u16()?);
        let transport = Transport::of_byte(fields.u8()?);
        let path = Path::take(&mut fields)?;
        fields.end(ForwardOpen {
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

    /// Returns the request.
    pub fn request(&self) -> Request {
        let mut data = vec![self.timeout.priority_and_tick, self.timeout.ticks];
        data.extend([self.to_target_id, self.to_originator_id].into_iter().flat_map(u32::to_le_bytes));
        self.owner.push_to(&mut data);
        data.extend([self.connection_timeout.number(), 0, 0, 0]);
        data.extend(self.to_target_interval_us.to_le_bytes());
        data.extend(self.to_target.word().to_le_bytes());
        data.extend(self.to_originator_interval_us.to_le_bytes());
        data.extend(self.to_originator.word().to_le_bytes());
        data.push(self.transport.byte());
        self.path.push_to(&mut data);
        Request::of_connections(Service::FORWARD_OPEN, data)
    }
}

impl ForwardOpened {
    /// Reads the data of the reply.
    ///
    /// # Errors
    /// [`PacketError`] if they are incomplete or too long.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = Fields::new(Structure::ForwardOpenReply, data);
        let (to_target_id, to_originator_id) = (fields.u32()?, fields.u32()?);
        let owner = Owner::take(&mut fields)?;
        let (to_target_interval_us, to_originator_interval_us) = (fields.u32()?, fields.u32()?);
        let application = application(&mut fields)?;
        fields.end(ForwardOpened {
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

impl ForwardRefused {
    /// Parses the data of a refusing reply.
    ///
    /// # Errors
    /// [`PacketError`] if they are incomplete or too long; many devices send none.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = Fields::new(Structure::Refusal, data);
        let owner = Owner::take(&mut fields)?;
        let remaining_path_words = fields.u8()?;
        // Reserved.
        fields.u8()?;
        fields.end(ForwardRefused { owner, remaining_path_words })
    }

    /// Returns the data of the reply.
    pub fn emit(&self) -> Vec<u8> {
        let mut data = Vec::new();
        self.owner.push_to(&mut data);
        data.extend([self.remaining_path_words, 0]);
        data
    }

    /// Returns the reply to `request` with an extended status.
    pub fn reply(&self, request: &Request, extended: u16) -> Reply {
        Reply {
            extended: vec![extended],
            data: self.emit(),
            ..request.refused(super::status::GeneralStatus::CONNECTION)
        }
    }
}

impl ForwardClose {
    /// Parses the data after the path of the request.
    ///
    /// # Errors
    /// [`PacketError`] if it is incomplete or too long.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = Fields::new(Structure::ForwardClose, data);
        let timeout = RequestTimeout::take(&mut fields)?;
        let owner = Owner::take(&mut fields)?;
        let words = fields.u8()?;
        // Reserved.
        fields.u8()?;
        let path = Path::parse(fields.bytes(usize::from(words) * 2)?)?;
        fields.end(ForwardClose { timeout, owner, path })
    }

    /// Returns the request.
    pub fn request(&self) -> Request {
        let mut data = vec![self.timeout.priority_and_tick, self.timeout.ticks];
        self.owner.push_to(&mut data);
        let mut path = Vec::new();
        self.path.push_to(&mut path);
        // Between the length of the path and the path, unlike everywhere else.
        path.insert(1, 0);
        data.extend(path);
        Request::of_connections(Service::FORWARD_CLOSE, data)
    }
}

impl ForwardClosed {
    /// Reads the data of the reply.
    ///
    /// # Errors
    /// [`PacketError`] if they are incomplete or too long.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = Fields::new(Structure::ForwardCloseReply, data);
        let owner = Owner::take(&mut fields)?;
        let application = application(&mut fields)?;
        fields.end(ForwardClosed { owner, application })
    }

    /// Returns the data of the reply.
    pub fn emit(&self) -> Vec<u8> {
        let mut data = Vec::new();
        self.owner.push_to(&mut data);
        push_application(&self.application, &mut data);
        data
    }
}

/// The length in words, a reserved byte, words.
fn application(fields: &mut Fields<'_>) -> Result<Vec<u16>, PacketError> {
    let words = fields.u8()?;
    fields.u8()?;
    (0..words).map(|_| fields.u16()).collect()
}

fn push_application(words: &[u16], data: &mut Vec<u8>) {
    let words = words.get(..usize::from(u8::MAX)).unwrap_or(words);
    // At most 255.
    data.extend([words.len() as u8, 0]);
    data.extend(words.iter().flat_map(|word| word.to_le_bytes()));
}
