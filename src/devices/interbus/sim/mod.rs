//! A virtual K3 encoder behind a Modbus/TCP gateway. It simulates the handshake with busy words and late echoes, the
//! modes, eight cam programs, EEPROM wear and power loss. Assumptions where the manual leaves a fact open (`U`) are
//! documented or configurable. See the INTERBUS reference.
//!
//! | file | content |
//! |---|---|
//! | `config` | the settings of a `sim:` link |
//! | `shaft` | the turning shaft |
//! | `memory` | settings, their storage and the number of EEPROM write cycles |
//! | `encoder` | the effect of an OUT word and the resulting IN word |
//! | `registers` | process data as Modbus registers |
//! | `frame` | a Modbus request and its reply |
//! | `gateway` | the connections of clients, with simulated faults |

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
