//! What an adapter says and does not do, in words, whatever bus is behind it.

mod error;
pub mod traced;

pub use error::adapter;
