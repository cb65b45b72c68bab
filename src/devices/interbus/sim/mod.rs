//! The virtual K3 encoder and the Modbus/TCP gateway in front of it (INTERBUS reference): the handshake with busy words
//! and old echoes, the modes, eight cam programs, the EEPROM and its wear, and losses of power. Where the manual is
//! silent (`U`), the assumption made is documented or can be set.
//!
//! | file | content |
//! |---|---|
//! | `config` | the settings of a `sim:` link |
//! | `shaft` | the turning shaft |
//! | `memory` | stored settings, which of them survive a loss of power, and the number of store cycles |
//! | `encoder` | the effect of an OUT word, and the IN word, at a moment |
//! | `registers` | process data as Modbus registers |
//! | `frame` | a Modbus request and its reply |
//! | `gateway` | the connections of clients, byte by byte, with injected faults |

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
