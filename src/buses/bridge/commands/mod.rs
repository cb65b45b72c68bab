//! The virtual adapter, served by `simulate`.

use crate::buses::bridge::sim::Adapter;
use crate::cli::simulate::Simulated;
use crate::units::{CharacterFormat, Moment};

impl Simulated for Adapter {
    /// Over USB there is nothing to set.
    fn format(&self, _now: Moment) -> Option<CharacterFormat> {
        None
    }
}
