//! What can be asked of a BiSS encoder, and what comes of it.

use std::fmt;

use super::Identity;
use crate::bits::hex_compact;
use crate::device::biss::{Error, PositionReading, Status, Survey};
use crate::profile::biss::{Bank, BissProfile, RegisterRange};
use crate::protocol::biss::{Area, KIND, RegisterAddress};
use crate::store::{DeviceKey, StoreError};

/// What a session with a BiSS encoder does.
#[derive(Debug)]
pub enum BissJob {
    /// Everything there is to see: for a window, after connecting.
    Survey,
    /// Who is there.
    Identify,
    /// Mode, errors, warnings, temperature, filter.
    Status,
    /// The position, once.
    Position,
    /// Registers that follow each other; those of an area of data only at standstill.
    Read(RegisterRange),
    /// All direct registers, 40h…7Fh.
    ReadDirect,
    /// All registers of a bank.
    ReadBank(u8),
    /// All registers of an area of data; at standstill.
    ReadArea(Area),
    /// Everything that can be restored; at standstill.
    Save,
}

/// Registers as they were read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadRegisters {
    /// The first.
    pub start: RegisterAddress,
    /// Their values, in the order of their addresses.
    pub bytes: Vec<u8>,
}

/// What a BiSS encoder says on the way, or the program about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remark {
    /// Frames with a wrong checksum that belong to no reading.
    CrcErrors(u32),
    /// Descriptions of the user's own that cannot be used.
    Descriptions(Vec<StoreError>),
}

/// The step that a BiSS job is at. Its text is the command line's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Doing {
    /// A register is read.
    Register(RegisterAddress),
    /// A bank is read.
    Bank(u8),
}

impl fmt::Display for Doing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Doing::Register(address) => write!(f, "{address}"),
            Doing::Bank(bank) => write!(f, "bank:0x{bank:02X}"),
        }
    }
}

/// What a BiSS job gives.
#[derive(Debug)]
#[expect(missing_docs, reason = "each is the result of the job of that name")]
pub enum BissOutput {
    Surveyed(Box<Survey>),
    Identity(Box<Identity>),
    Status(Box<Status>),
    Position(PositionReading),
    Registers(ReadRegisters),
    Area(Vec<Bank>),
    Saved(Box<BissProfile>),
}

/// Why a job ended early.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// The device.
    #[error(transparent)]
    Device(#[from] Error),
}

/// How backups and the logbook know an encoder: serial numbers are unique within what one manufacturer calls a device.
pub fn device_key(identity: &Identity, is_virtual: bool) -> DeviceKey {
    let (manufacturer, device) = (hex_compact(&identity.kind.manufacturer), hex_compact(&identity.kind.device_id));
    DeviceKey {
        kind: KIND.to_owned(),
        device_type: format!("{manufacturer}-{device}"),
        serial_number: identity.serial_number.clone(),
        is_virtual,
    }
}
