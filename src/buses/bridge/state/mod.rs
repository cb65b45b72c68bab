//! Messages of an adapter for any bus.

mod error;
mod texts;
pub mod traced;

pub use texts::TEXTS;

pub use error::adapter_error_text;
