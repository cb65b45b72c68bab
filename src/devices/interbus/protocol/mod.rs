//! INTERBUS: process data words of POSITAL OCD-IB encoders (ENCOM profile 71, classes K1, K2 and K3).
//!
//! Source: POSITAL, manual UME-IB ("the manual"). "Reference" is the project's reference "interbus". Facts that the
//! manual leaves open are marked `U`. Where the manual contradicts itself, reference 6 states the interpretation used.
//!
//! ```text
//! bit  31               30                      29            28..25                   24..0
//! OUT  run              set preset              manufacturer  parameter code           data
//! IN   error, invalid   parameterisation        manufacturer  parameter or error code  position, value
//! ```
//!
//! The same OUT word has different meanings in different modes. [`Command::all_meanings`] returns all of them, and
//! [`Command::in_mode`] returns the meaning in one [`EncoderMode`].

#![warn(missing_docs)]

mod cam;
mod cam_output;
mod class;
mod command;
mod compiled;
mod gear;
mod leds;
mod mode;
mod parameter;
mod read_out;
mod reply;
mod value;
#[cfg(test)]
mod vectors;
mod word_order;

/// Keyword for INTERBUS encoders on the command line, in profiles and in stored data.
pub const KIND: &str = "interbus";

/// Number of EEPROM write cycles for which the encoder is designed (reference 3).
pub const DESIGN_WRITE_CYCLES: u32 = 200;
/// Maximum number of EEPROM write cycles that the manufacturer guarantees (reference 3).
pub const GUARANTEED_WRITE_CYCLES: u32 = 500;

pub use cam::{Cam, CamNumber, Program, ProgramNumber};
pub use cam_output::{CamBit, CamOutput, CamOutputError, WindowShift};
pub use class::{Class, Interface, SingleWord, devices_with_id, id_code};
pub use command::{Command, ForbiddenCommandError};
pub use compiled::CompiledPrograms;
pub use gear::{Gear, GearError, STEPS_PER_TURN, TURNS};
pub use leds::{LEDS, LedRow, LedState, Leds};
pub use mode::EncoderMode;
pub use parameter::{OutOfRange, PARAMETERS, Parameter, ParameterRow};
pub use read_out::{Flags, READ_OUTS, ReadOutNumber, ReadOutRow, ReadOutValue, StartupMode};
pub use reply::{ErrorWord, Reply};
pub use value::{Code, Value};
pub use word_order::{INPUT, OUTPUT, UNIT, WordOrder};
