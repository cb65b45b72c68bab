//! The virtual K3 encoder and the Modbus/TCP gateway in front of it (INTERBUS reference): the handshake with its busy words
//! and its old echoes, the modes, eight cam programs, the EEPROM and its wear, losses of power. What the manual leaves open
//! (`U`) follows one documented choice, or a setting.
//!
//! | file | what it is |
//! |---|---|
//! | `config` | the settings of a `sim:` link |
//! | `shaft` | the turning shaft |
//! | `memory` | what is set, what of it survives a loss of power, and how often it was stored |
//! | `encoder` | what an OUT word does, and what the IN word is, at a moment |
//! | `registers` | process data as Modbus registers: who has which |
//! | `frame` | one Modbus request and its reply |
//! | `gateway` | the connections to it, byte for byte, with their faults |

mod config;
mod encoder;
mod frame;
mod gateway;
mod memory;
mod registers;
mod shaft;
#[cfg(test)]
mod tests;

pub use config::Config;
pub use encoder::Encoder;
pub use gateway::Gateway;
pub use memory::Memory;
