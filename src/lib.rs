//! encoder-studio: configure position encoders and small drives at a desk. ARCHITECTURE.md describes the house.

pub mod bits;
pub mod protocol;
pub mod sim;
pub mod store;
pub mod units;
