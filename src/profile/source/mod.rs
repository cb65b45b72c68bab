//! The source text of a profile edited by a user: where its entries are, how two texts differ, and how to change one.
//! Comments, order, notation and line endings are preserved.

mod apply;
mod carry;
mod changes;
mod tree;

pub use carry::UpdatedText;
pub(in crate::profile) use carry::{carry_changes, lost_comments};
pub(in crate::profile) use changes::find_changes;
pub use changes::{Change, PathStep};

pub(in crate::profile) use apply::apply_all;
