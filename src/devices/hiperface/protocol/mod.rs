//! The HIPERFACE parameter channel: frames, commands, status codes, data fields, labels and timing.
//!
//! Source: SICK 8010701 *HIPERFACE® – Beschreibung / Description* ("the manual"). `U` (unknown) marks facts that the
//! manual leaves open and that are treated tolerantly. `P` marks facts from other public sources.
//!
//! ```text
//! request : ADDR CMD [args…] CHK        reply : ADDR CMD [data…] CHK
//! ```
//! A frame ends with silence. `CHK` is the XOR of all preceding bytes. Bit 7 of `CMD` is the error bit of a reply.

#![warn(missing_docs)]

mod address;
mod command;
mod data_field;
mod describe;
mod encoder_type;
mod extended_label;
mod frame;
mod line_settings;
mod position;
mod reply;
mod request;
mod status;
mod timing;
mod type_label;
#[cfg(test)]
mod vectors;

/// Name of this kind of device on the command line, in profiles and in stored data.
pub const KIND: &str = "hiperface";

pub use address::{BROADCAST, DeviceAddress};
pub use command::{COMMANDS, Command, CommandRow};
pub use data_field::{
    AccessCode, AccessCodeNumber, DataFieldStatus, EXTENDED_LABEL_FIELD, FieldSize, FreeMemory, MAX_TRANSFER,
};
pub use describe::{Arguments, FrameDetail, describe_frame};
pub use encoder_type::{EncoderType, EncoderTypes, GeometryEntry, TypeTableError};
pub use extended_label::{ExtendedLabel, LabelError, LabelParameter, LabelPart};
pub use frame::{Frame, FrameError, checksum};
pub use line_settings::{BAUDS, LineSettings};
pub use position::{Geometry, Position, STEPS_PER_PERIOD, nearest_in_phase};
pub use reply::{Answer, Reply, ReplyError, ReplyLength};
pub use request::{MaskableFrame, Request, RequestError};
pub use status::{StatusClass, StatusCode};
pub use timing::Timing;
pub use type_label::{SerialLabel, TypeLabel};
