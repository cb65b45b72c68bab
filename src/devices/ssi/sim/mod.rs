//! The virtual SSI encoder: the words that it sends at each shaft position, and its simulated faults. The virtual
//! adapter clocks the words and turns the shaft.
//!
//! | file | content |
//! |---|---|
//! | `encoder` | frames with the position of the encoder |
//! | `injected_fault` | error bits, and words that report a fault |
//! | `at_adapter` | the settings of a `sim:` link |

mod at_adapter;
mod encoder;
mod injected_fault;
#[cfg(test)]
mod tests;

pub use at_adapter::{AttachableEncoder, DEFAULT_ENCODER, Settings};
pub use encoder::Encoder;
