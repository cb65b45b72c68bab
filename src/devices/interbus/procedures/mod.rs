//! Procedures for an INTERBUS encoder (POSITAL OCD-IB, K3) behind a Modbus/TCP gateway. All values except the position
//! are transferred by a handshake in the process data. Reading or setting a value interrupts the position and makes the
//! cam outputs invalid. Selecting another cam program switches the outputs. "Reference" is the project's reference
//! "interbus".
//!
//! ```text
//! identify, survey, write ── master: the handshake, modes, back to the previous mode ──▶ data: OUT ⇄ IN ◀── gateway
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
pub use error::{Error, Exception, ExpectedWord, ImplausibleValue, ReplyDamage, RequestedItem};
pub use gateway::{FrameWord, Gateway, GatewayFault, find_fault, word_in_frame};
pub use handshake::{Handshake, LeftState, WordReply};
pub use identify::{
    Identity, Status, Survey, identify, read_all_values, read_programs, read_single_value, read_status, select,
};
pub use journal::{Journal, ModeSwitch};
pub use master::Master;
pub use reading::{TurnPosition, WordReading};
pub use save::{SaveStep, read_item, read_state, save};
pub use station::{LinkParameters, Station};

use station::KnownState;
