//! The text of a profile as edited by a user: its entries with their positions, the differences between two texts, and
//! changes to a text that leave the rest as written: comments, order, notation, line ends.

mod apply;
mod carry;
mod changes;
mod tree;

pub use carry::Carried;
pub(in crate::profile) use carry::{carry, lost};
pub(in crate::profile) use changes::changes;
pub use changes::{Change, Step};

pub(in crate::profile) use apply::applied;
