//! A HIPERDRIVE in words: what its states, bits, errors and parameters are called.

mod names;

pub use names::{ErrorWords, control_bit, error, parameter, state, status_bit};
