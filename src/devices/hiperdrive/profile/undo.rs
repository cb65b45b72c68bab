//! Undoes a write to a device: the parameters that it changed, and instructions for items that the backup cannot
//! restore.

use super::{HiperdriveProfile, Item};
use crate::devices::hiperdrive::protocol::ParameterNumber;
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;
use crate::profile::{ChangedItem, Redo};

/// Returns a changed item as a single value. Returns nothing for the save at the end of a write, which is not a value.
pub(super) fn single_values(item: &ChangedItem) -> Vec<ChangedItem> {
    if item.item == ParameterNumber::SAVE.to_string() { Vec::new() } else { vec![item.clone()] }
}

/// Returns the instruction for an item that the backup cannot restore, or `None` if it can.
pub(super) fn redo(item: &ChangedItem) -> Option<Redo> {
    match item.item.parse::<Item>() {
        Ok(item) if item.0.drive1_number() == REFERENCE => Some(Redo::SetPosition),
        Ok(_) => None,
        Err(_) => Some(Redo::ChangeNetwork),
    }
}

impl HiperdriveProfile {
    /// Keeps only the parameters that a write has changed. The backup contains all parameters, including those that
    /// later writes have changed.
    pub(super) fn keep_parameters(&mut self, items: &[ChangedItem]) {
        let is_changed = |name: &str| items.iter().any(|item| item.item == name);
        self.image.values.retain(|number, _| is_changed(&Item(*number).to_string()));
    }
}
