//! What an adapter says and does not do, in words, whatever bus is behind it.

mod error;
mod texts;
pub mod traced;

pub use texts::TEXTS;

pub use error::adapter;
