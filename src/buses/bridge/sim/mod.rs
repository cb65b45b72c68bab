//! A virtual adapter for the bridge protocol (the project's own reference, `protocol/bridge.md`), with a sine/cosine
//! encoder on the shaft of the attached devices. Without a device on the serial line, requests for the line are refused
//! as not supported.
//!
//! | file | content |
//! |---|---|
//! | `attached` | devices that can be attached, as the adapter sees them |
//! | `config` | the adapter's own settings in a `sim:` link |
//! | `settings` | all settings of such a link, and the adapter built from them |
//! | `shaft` | the shaft if no device is attached to BiSS |
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
pub use settings::{entries, keys};
