//! A virtual adapter with the bridge protocol (the project's own reference, `protocol/bridge.md`), with a sine/cosine
//! encoder on the shaft of the devices on its buses and its serial line. Without a device at the serial line, that is
//! refused as not supported.
//!
//! | file | what it is |
//! |---|---|
//! | `attached` | what can hang on it, as it sees that |
//! | `config` | the settings of a `sim:` link that are its own |
//! | `settings` | all settings of such a link, and the adapter as they say |
//! | `shaft` | what turns where nothing hangs on BiSS |
//! | `bus` | what one frame of BiSS or SSI carries |
//! | `clocking` | clocks and how long a frame takes |
//! | `stream` | samples at equal distances, in packets |
//! | `uart` | the serial line |
//! | `adapter` | requests and replies, byte for byte |

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
pub use attached::{Attachable, Attached, BissDevice, SerialDevice, SsiDevice};
pub use settings::{entries, keys};
