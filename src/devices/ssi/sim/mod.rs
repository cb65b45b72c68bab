//! The virtual SSI encoder: the words that it sends with its shaft at a place, and what goes wrong with it. What clocks
//! them out and what turns the shaft are an adapter's matter.
//!
//! | file | what it is |
//! |---|---|
//! | `encoder` | a frame with the encoder's position in it |
//! | `trouble` | error bits that speak, and words that stand for a fault |
//! | `at_adapter` | the settings of a `sim:` link |

mod at_adapter;
mod encoder;
mod injected_fault;
#[cfg(test)]
mod tests;

pub use at_adapter::{AtAdapter, DELIVERED, Settings};
pub use encoder::Encoder;
