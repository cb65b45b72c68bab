//! BiSS C: position data, the control frame, and the meaning of an encoder's registers.
//!
//! Source: POSITAL, *Manual IXARC kit encoders with BiSS C interface* v4.6, called "the manual" below. "The reference"
//! is the project's summary of the manual for implementers. Facts that the manual leaves open are marked `U` (unknown).
//! They are either tolerated or configurable.

#![warn(missing_docs)]

mod address;
mod control;
mod crc;
mod description;
mod eds;
mod line;
mod position_word;
mod procedure;
mod single_cycle;
mod status;
mod widths;

/// Name of this device type on the command line, in profiles, and in stored data.
pub const KIND: &str = "biss";

pub use address::{AddressError, RegisterAddress};
pub use control::{
    ControlError, Encoder as ControlEncoder, Event as ControlEvent, Host as ControlHost, MAX_WAIT_CYCLES, REST_CYCLES,
    Request as ControlRequest, RequestError as ControlRequestError, Step as ControlStep,
};
pub use crc::{Crc, CrcError};
pub use description::{
    Access, Area, DecodedValue, Description, DescriptionError, DescriptionErrorKind, Descriptions, Identity,
    IdentityMismatch, Lock, Name, Procedure, Register, Role, UniqueItem, ValueDecoding,
};
pub use eds::{Eds, EdsBank, EdsError, EdsField, EdsValue, StatusBitMeaning, layout as eds_layout};
pub use line::{BissCycle, CycleError};
pub use procedure::{
    CalibrationCommand, CalibrationStatus, DataCommand, DataStatus, FilterCommand, FilterStatus, PresetCommand,
    PresetStatus, PresetValue, ProcedureKind, PulseVoltage, WiegandCommand, WiegandResult, WiegandStatus,
};
pub use single_cycle::{FrameError, Layout, LayoutError, PositionData};
pub use status::{DeviceMode, ErrorRegister, Firmware, PositionFilter, ProfileId, Temperature, WarningRegister};
pub use widths::detect_data_bits;
