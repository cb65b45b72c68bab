//! A virtual adapter that speaks the bridge protocol, with the virtual kit encoder, an SSI encoder on the same shaft and
//! a sine/cosine encoder behind it (the project's own reference, `protocol/bridge.md`). Where it is asked for, there is a
//! HIPERFACE encoder at its serial line; else that is refused as not supported.
//!
//! | file | what it is |
//! |---|---|
//! | `config` | the settings of a `sim:` link |
//! | `bus` | what one frame of BiSS or SSI carries |
//! | `trouble` | error bits that speak, and words that stand for a fault |
//! | `clocking` | clocks and how long a frame takes |
//! | `stream` | samples at equal distances, in packets |
//! | `uart` | the serial line |
//! | `adapter` | requests and replies, byte for byte |

mod adapter;
mod bus;
mod clocking;
mod config;
mod stream;
#[cfg(test)]
mod tests;
mod trouble;
mod uart;

pub use adapter::Adapter;
pub use config::{Config, DELIVERED, SsiEncoder};
