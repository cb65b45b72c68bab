//! Values recorded in addition to a position, each as a separate line.

use std::convert::Infallible;

use crate::analysis::history::Value;
use crate::app::Text;
use crate::app::recorder::{GroupId, Series};
use crate::units::Moment;

pub trait Watchable: Clone + PartialEq {
    /// Returns whether the values are whole numbers.
    fn is_whole(&self) -> bool;

    fn line(&self, group: GroupId) -> Series;

    /// Returns whether samples of this value continue as samples of `other`, which may be displayed in different units.
    fn can_continue_as(&self, other: &Self) -> bool {
        self == other
    }
}

/// Placeholder for devices without watched values.
impl Watchable for Infallible {
    fn is_whole(&self) -> bool {
        match *self {}
    }

    fn line(&self, _group: GroupId) -> Series {
        match *self {}
    }
}

/// A watched value, if one is currently available.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchedValue {
    pub at: Moment,
    pub value: Option<Value>,
    pub is_warned: bool,
    /// Reason why there will never be a value, if that is the case.
    pub never: Option<Text>,
}
