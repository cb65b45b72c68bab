//! Virtual drives behind an adapter or a hub (reference of HIPERDRIVE): the effects of process data and parameters, and the
//! EtherNet/IP target in front of them, in virtual time. What the manual leaves open (`U`) follows one documented choice.
//!
//! | file | what it is |
//! |---|---|
//! | `axis` | the spindle: speed and place, millisecond by millisecond, with what holds it |
//! | `memory` | parameters that can be written, and what of them survives the supply |
//! | `drive` | a drive: its state, its motion, its faults |
//! | `parameters` | what reading and writing a drive's parameters does |
//! | `write_fault` | writes that are refused, or cut off in the middle |
//! | `station` | the drives together: process data, save and reset, the lost master |
//! | `words` | answers to parameter words |
//! | `config` | the settings of a `sim:` link |
//! | `target` | frames and packets of EtherNet/IP in front of a station |

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

pub use axis::{Defect, SpindleLoad};
pub use config::Config;
pub use drive::Drive;
pub use parameters::Refused;
pub use station::{Setup, Station};
pub use target::{Figures, Target};
pub use write_fault::WriteFault;
