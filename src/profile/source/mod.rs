//! Source text of a profile that a user has edited: entries with their locations, differences between two texts, and
//! changes. Comments, order, notation and line endings are preserved.

mod apply;
mod carry;
mod changes;
mod tree;

pub use carry::Carried;
pub(in crate::profile) use carry::{carry, lost};
pub(in crate::profile) use changes::changes;
pub use changes::{Change, Step};

pub(in crate::profile) use apply::apply_all;
