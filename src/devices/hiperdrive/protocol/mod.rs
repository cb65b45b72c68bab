//! HIPERDRIVE: small positioning drives of halstrup-walcher, one on an EtherNet/IP adapter or up to eight on a hub.
//! This module defines control and status words, the state machine, process data, parameter words, parameters, scaling,
//! switches and LEDs.
//!
//! The source is manual 004 of the drive, called "the manual" here. "The reference" is this project's reference on
//! HIPERDRIVE. `D` marks derived facts, and `U` marks assumptions that the manual does not confirm. Where the manual
//! contradicts itself, section 8 of the reference gives the interpretation used.

#![warn(missing_docs)]

mod control_word;
pub mod drive_parameter;
mod error_code;
mod leds;
mod parameter;
mod parameters;
mod pkw;
mod process_data;
mod recipe;
mod scaling;
mod state;
mod status_word;
mod switches;
mod travel;
mod value;
mod variant;
#[cfg(test)]
mod vectors;

/// Name of this kind of device on the command line, in profiles and in stored files.
pub const KIND: &str = "hiperdrive";
/// Vendor ID of halstrup-walcher, assigned by ODVA.
pub const VENDOR: u16 = 1010;
/// Assembly instances of the cyclic connection: configuration, output to the drives, input from the drives.
pub const ASSEMBLIES: [u16; 3] = [104, 100, 101];

pub use control_word::{ControlBit, ControlWord, Direction, MotionStart, ReservedBitsError, RunEnd};
pub use error_code::{ERROR_CODES, ErrorCode, ErrorCodeRow};
pub use leds::{
    BUS_LEDS, DriveLedState, LedRow, LedSubject, NetworkLed, NetworkLedRow, NetworkLedState, PORT_LEDS, PortLedRow,
    PortLedState,
};
pub use parameter::{
    DriveNumber, FactoryValue, OutOfRange, ParameterAccess, ParameterNumber, ParameterRange, ParameterRow, SlowValue,
};
pub use parameters::{PARAMETERS, STORE_TIME};
pub use pkw::{Answer, Pkw, PkwError, Task};
pub use process_data::{
    ActualValues, ByteOrder, InputImage, Layout, OutputData, OutputImage, Percent, ProcessImageError, Setpoint,
    Topology,
};
pub use recipe::{ACKNOWLEDGE, ENABLE, Step, UNLOCK};
pub use scaling::{
    Family, Length, PositionScale, ScaleError, SpeedScale, effective_torque, nearest_reference, to_turns_and_steps,
};
pub use state::{State, TRANSITIONS, Transition, Trigger};
pub use status_word::{StatusBit, StatusWord};
pub use switches::AddressSwitch;
pub use travel::{StepLimit, Travel};
pub use value::{Kind, Value, ValueError, nominal_value};
pub use variant::{VARIANTS, Variant, VariantRow};
