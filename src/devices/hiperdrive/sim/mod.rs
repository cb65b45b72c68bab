//! Virtual drives behind an adapter or a hub (HIPERDRIVE reference). They respond to process data and parameters
//! through an EtherNet/IP target, in virtual time. Assumptions are documented where the manual does not define the
//! behaviour (`U`).
//!
//! | file | content |
//! |---|---|
//! | `axis` | the spindle: speed and position in steps of one millisecond, and obstacles |
//! | `memory` | writable parameters, and which of them survive a power cycle |
//! | `drive` | a drive: its state, motion and faults |
//! | `parameters` | reading and writing the parameters of a drive |
//! | `write_fault` | writes that are rejected or interrupted |
//! | `station` | the drives together: process data, save and reset, loss of the master |
//! | `words` | answers to parameter words |
//! | `config` | the settings of a `sim:` link |
//! | `target` | EtherNet/IP frames and packets in front of a station |

mod axis;
mod config;
mod drive;
mod memory;
mod parameters;
mod station;
mod target;
#[cfg(test)]
mod tests;
mod words;
mod write_fault;

pub use axis::{DriveDefect, SpindleLoad};
pub use config::Config;
pub use drive::Drive;
pub use parameters::ParameterError;
pub use station::{Station, StationConfig};
pub use target::{Target, TrafficCounters};
pub use write_fault::WriteFault;
