//! The virtual kit encoder with BiSS C: registers, banks, device modes, the guided procedures with their durations and
//! failures, the flash and its wear, restarts; and the lines to it. Where the manual leaves a rule open (`U`), one
//! documented choice is followed.
//!
//! | file | what it is |
//! |---|---|
//! | `config` | the settings of a `sim:` link |
//! | `shaft` | the turning shaft |
//! | `motor` | what turns it |
//! | `flash` | what survives a loss of power, and how often it was written |
//! | `calibration`, `wiegand` | the two procedures that need a turning motor |
//! | `entry` | the three that enter and save something: data, filter, preset |
//! | `encoder` | registers, modes, restarts: what a read or a write does at a moment |
//! | `ubicom` | the line of the configuration pin, byte for byte |
//! | `at_adapter` | the bus behind a virtual adapter |

mod at_adapter;
mod calibration;
mod config;
mod encoder;
mod entry;
mod flash;
mod motor;
mod shaft;
#[cfg(test)]
mod tests;
mod ubicom;
mod wiegand;

pub use at_adapter::AtAdapter;
pub use config::Config;
pub use encoder::Encoder;
pub use flash::Flash;
pub use ubicom::Port;
