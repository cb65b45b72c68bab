//! Virtual HIPERFACE encoders, one or more on a line, with the timing, power-up states, memory and error replies
//! specified by the manual. Where the manual leaves the behaviour open (`U`), the assumption is documented.
//!
//! | file | content |
//! |---|---|
//! | `models` | the available encoders, one line each |
//! | `config` | the settings of a `sim:` link |
//! | `memory` | data fields and access codes |
//! | `shaft` | the moving shaft and its analogue signals |
//! | `electronics` | the effects of the twenty commands, without timing |
//! | `encoder` | the timing of receiving, processing, replying and power-up |
//! | `bus` | the line: characters in both directions, echo, noise, collisions |
//! | `at_adapter` | the serial line of a virtual adapter |

mod at_adapter;
mod bus;
mod config;
mod electronics;
mod encoder;
mod memory;
mod models;
mod shaft;
#[cfg(test)]
mod tests;

pub use at_adapter::AttachableEncoder;
pub use bus::Bus;
pub use config::Config;
pub use electronics::Wear;
pub use encoder::{Encoder, ResponseTimes};
pub use memory::Memory;
pub use models::{MODELS, Model};
