//! A virtual adapter that speaks the bridge protocol, with the virtual kit encoder, an SSI encoder on the same shaft and
//! a sine/cosine encoder behind it (the project's own reference, `protocol/bridge.md`). The serial line of a real adapter
//! is not there: its operations are refused as not supported.
//!
//! | file | what it is |
//! |---|---|
//! | `config` | the settings of a `sim:` link |
//! | `bus` | what one frame of BiSS or SSI carries |
//! | `stream` | samples at equal distances, in packets |
//! | `adapter` | requests and replies, byte for byte |

mod adapter;
mod bus;
mod config;
mod stream;
#[cfg(test)]
mod tests;

pub use adapter::Adapter;
pub use config::Config;
