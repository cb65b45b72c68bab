//! The virtual BiSS C kit encoder: registers, banks, device modes, guided procedures with their durations and failures,
//! the flash and its wear, restarts, and the lines to the encoder. Where the manual leaves a rule open (`U`), the
//! assumption is documented.
//!
//! | file | purpose |
//! |---|---|
//! | `config` | settings of a `sim:` link |
//! | `shaft` | the turning shaft |
//! | `motor` | the motor that turns the shaft |
//! | `flash` | non-volatile memory and its write count |
//! | `calibration`, `wiegand` | the two procedures that need a turning motor |
//! | `entry` | the three procedures that enter and save a value: data, filter, preset |
//! | `encoder` | registers, modes, restarts: the effect of each read and write over time |
//! | `ubicom` | the line to the configuration pin, byte by byte |
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

pub use at_adapter::AttachableEncoder;
pub use config::Config;
pub use encoder::Encoder;
pub use flash::Flash;
pub use ubicom::UbicomPort;
