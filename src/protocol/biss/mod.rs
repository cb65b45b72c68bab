//! BiSS C: position data, the control frame, and what the registers of an encoder mean.
//!
//! Source: POSITAL, *Manual IXARC kit encoders with BiSS C interface* v4.6 ("the manual" below; the project's reference
//! of it where a section is named so). What the manual leaves open is marked `U` (unknown) and is either tolerated or
//! can be set.

mod control;
mod crc;
mod line;
mod single_cycle;

/// The word for this kind of device: on the command line, in profiles, and where something is kept of one.
pub const KIND: &str = "biss";

pub use control::{
    ControlError, Encoder as ControlEncoder, Event as ControlEvent, Host as ControlHost, MAX_WAIT_CYCLES, REST_CYCLES,
    Request as ControlRequest, RequestError as ControlRequestError, Step as ControlStep,
};
pub use crc::{Crc, CrcError};
pub use line::{Cycle, CycleError};
pub use single_cycle::{FrameError, Layout, LayoutError, Reading};
