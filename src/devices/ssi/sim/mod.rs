//! The virtual SSI encoder: the words it sends at a position of its shaft, and its injected faults. The adapter clocks them
//! out and turns the shaft.
//!
//! | file | what it is |
//! |---|---|
//! | `encoder` | a frame with the encoder's position in it |
//! | `injected_fault` | error bits, and words that stand for a fault |
//! | `at_adapter` | the settings of a `sim:` link |

mod at_adapter;
mod encoder;
mod injected_fault;
#[cfg(test)]
mod tests;

pub use at_adapter::{AtAdapter, DELIVERED, Settings};
pub use encoder::Encoder;
