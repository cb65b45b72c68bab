//! A virtual adapter for the bridge protocol. It has a sine/cosine encoder on the shaft of the attached devices, and
//! rejects requests to the serial line as not supported if no device is connected there. See the project's reference
//! `protocol/bridge.md`.
//!
//! | file | content |
//! |---|---|
//! | `attached` | interface of the devices that can be attached |
//! | `config` | settings of the adapter in a `sim:` link |
//! | `settings` | all settings of a link, and the adapter built from them |
//! | `shaft` | the shaft if BiSS has no device |
//! | `bus` | the bits of one BiSS or SSI frame |
//! | `clocking` | clock frequencies and frame durations |
//! | `stream` | equidistant samples in packets |
//! | `uart` | the serial line |
//! | `adapter` | requests and replies, byte by byte |

mod adapter;
mod attached;
mod bus;
mod clocking;
mod config;
mod settings;
mod shaft;
mod stream;
#[cfg(test)]
pub(crate) mod tests;
mod uart;

pub use adapter::Adapter;
pub use attached::{AttachableKind, AttachedDevice, BissDevice, SerialDevice, SsiDevice};
pub use settings::{all_setting_names, entries};
