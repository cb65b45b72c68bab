//! The text of a profile as a person keeps it: its entries with their places, what differs between two texts, and changes
//! put into a text so that everything else in it stays as it is written: comments, order, notation, line ends.

mod apply;
mod carry;
mod changes;
mod tree;

pub use carry::Carried;
pub(in crate::profile) use carry::{carry, lost};
pub(in crate::profile) use changes::changes;
pub use changes::{Change, Step};

pub(in crate::profile) use apply::applied;
