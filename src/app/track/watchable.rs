//! Values that are recorded in addition to the position, each as a separate line.

use std::convert::Infallible;

use crate::analysis::history::Value;
use crate::app::Text;
use crate::app::recorder::{GroupId, Series};
use crate::units::Moment;

pub trait Watchable: Clone + PartialEq {
    fn is_whole(&self) -> bool;

    fn create_series(&self, group: GroupId) -> Series;

    /// Returns whether samples of `other` can continue this value's line. The units may differ.
    fn can_continue_as(&self, other: &Self) -> bool {
        self == other
    }
}

/// Placeholder for devices without watched values.
impl Watchable for Infallible {
    fn is_whole(&self) -> bool {
        match *self {}
    }

    fn create_series(&self, _group: GroupId) -> Series {
        match *self {}
    }
}

/// A reading of a watched value, which may be missing.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchedValue {
    pub at: Moment,
    pub value: Option<Value>,
    pub is_warned: bool,
    /// Reason why the value will never be available, if any.
    pub never: Option<Text>,
}
