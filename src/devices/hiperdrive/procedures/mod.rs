//! Procedures for HIPERDRIVE drives behind an EtherNet/IP adapter or hub. Parameters are read and written with explicit
//! messages, and drives are moved over the cyclic connection. Reading changes nothing. "Reference" is the project's
//! reference "hiperdrive".
//!
//! ```text
//! identify, survey, status, network, check, write ── master: session, request ⇄ reply ──▶ a stream of bytes (TCP)
//! motion requests ── dead_man (one per drive): control words ── cyclic: packets, counts ──▶ datagrams (UDP)
//! ```

pub mod check;
pub mod cyclic;
pub mod dead_man;
mod discover;
mod error;
mod identify;
mod limits;
mod master;
mod network;
mod rules;
mod save;
mod station;
mod temperature;
pub mod write;

pub use discover::{DiscoveredDevice, discover};
pub use error::{Error, ErrorReply, LateReplyError, ReplyDamage, RequestedItem, WrongLength};
pub use identify::{
    DriveIdentity, DriveReading, DriveStatus, Identity, Status, Survey, identify, position, read_status, read_survey,
};
pub use limits::{DisplayedLimits, DriveLimits};
pub use master::{Master, OpenedConnection};
pub use network::{Network, network, settings};
pub use rules::{GROUPS, MotionLimitParameters, read_rule_group, read_rules};
pub use save::{read_state, save};
pub use station::{LinkParameters, Station};
pub use temperature::{PolledSample, Temperature, TemperatureReading, temperature};
