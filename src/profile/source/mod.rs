//! Source text of a profile edited by a user: entries with their locations, differences between two texts, and changes
//! that preserve comments, order, notation and line endings.

mod apply;
mod carry;
mod changes;
mod tree;

pub use carry::Carried;
pub(in crate::profile) use carry::{carry, lost};
pub(in crate::profile) use changes::changes;
pub use changes::{Change, Step};

pub(in crate::profile) use apply::apply_all;
