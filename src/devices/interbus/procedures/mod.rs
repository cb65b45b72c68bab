//! The procedures of an INTERBUS encoder (POSITAL OCD-IB, K3): its process data are transmitted over a Modbus/TCP gateway,
//! and everything but the position over the handshake in them. Reading or setting any value replaces the position and makes
//! cam outputs invalid meanwhile; another program switches them. The reference is the project's "interbus".
//!
//! ```text
//! identify, survey, write ── master: the handshake, modes, back to the mode found ──▶ data: OUT ⇄ IN ◀── gateway
//! ```

pub mod check;
mod data;
mod error;
mod gateway;
mod handshake;
mod identify;
mod journal;
mod master;
mod reading;
mod save;
mod station;
pub mod write;

pub use data::ProcessData;
pub use error::{Awaited, Damage, Error, Exception, Implausible, RequestedItem};
pub use gateway::{Carried, Fault, Gateway, carried, fault};
pub use handshake::{Handshake, LeftState, WordReply};
pub use identify::{Identity, Status, Survey, identify, read_one, read_programs, read_status, select, survey};
pub use journal::{Excursion, Journal};
pub use master::Master;
pub use reading::{TurnPosition, WordReading};
pub use save::{SaveStep, read_item, read_state, save};
pub use station::{LinkParameters, Station};

use station::KnownState;
