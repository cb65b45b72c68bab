//! Messages about adapters that apply to all buses.

mod error;
mod texts;
pub mod traced;

pub use texts::TEXTS;

pub use error::adapter_error_text;
