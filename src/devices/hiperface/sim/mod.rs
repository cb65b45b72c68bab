//! The virtual HIPERFACE encoder: one or several of them on a line, with the timing, the power-up states, the memory and
//! the error replies of the manual. Where the manual leaves a rule open (`U`), one documented choice is followed.
//!
//! | file | what it is |
//! |---|---|
//! | `models` | the encoders there are, a line each |
//! | `config` | the settings of a `sim:` link |
//! | `memory` | data fields and access codes |
//! | `shaft` | the moving shaft and its analogue signals |
//! | `electronics` | the twenty commands: what they do, without time |
//! | `encoder` | hearing, processing, talking, power-up: when it happens |
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

pub use at_adapter::AtAdapter;
pub use bus::Bus;
pub use config::Config;
pub use electronics::Wear;
pub use encoder::{Encoder, Pace};
pub use memory::Memory;
pub use models::{MODELS, Model};
