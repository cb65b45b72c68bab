//! Writable parameters: their current values, and the values that survive a power cycle.

use std::collections::BTreeMap;

use crate::devices::hiperdrive::protocol::drive_parameter::{REFERENCE, RS485_COMPLETE};
use crate::devices::hiperdrive::protocol::{Family, PARAMETERS, ParameterRow, Topology};

#[derive(Clone, Debug)]
pub(super) struct Memory {
    factory: BTreeMap<u16, i64>,
    now: BTreeMap<u16, i64>,
    kept: BTreeMap<u16, i64>,
}

/// Value of parameter 192 in milliseconds. A real drive determines it by itself; this value is assumed.
const COMPLETE_TIME_MS: i64 = 5;

impl Memory {
    /// Creates the memory of a virtual device with factory settings. It holds the parameters for which `holds` returns
    /// `true`.
    pub(super) fn new(topology: Topology, family: Family, holds: fn(&ParameterRow) -> bool) -> Self {
        let value = |row: &ParameterRow| {
            let found = (row.number == RS485_COMPLETE).then_some(COMPLETE_TIME_MS);
            row.factory_value(topology, family).or(found).map(|value| (row.number, value))
        };
        let factory: BTreeMap<u16, i64> = PARAMETERS.iter().filter(|row| holds(row)).filter_map(value).collect();
        Memory { now: factory.clone(), kept: factory.clone(), factory }
    }

    /// Returns the value of a parameter, or `None` if this memory does not hold it.
    pub(super) fn get(&self, number: u16) -> Option<i64> {
        self.now.get(&number).copied()
    }

    pub(super) fn set_value(&mut self, number: u16, value: i64) {
        if let Some(held) = self.now.get_mut(&number) {
            *held = value;
        }
    }

    pub(super) fn preset(&mut self, number: u16, value: i64) {
        self.set_value(number, value);
        self.save();
    }

    pub(super) fn save(&mut self) {
        self.kept.extend(self.now.iter().filter(|(number, _)| is_saved(**number)));
    }

    /// Saves only the first half of the values, as if the supply failed during the save.
    pub(super) fn save_partially(&mut self) {
        let saved: Vec<(u16, i64)> = self.now.iter().map(|(n, v)| (*n, *v)).filter(|(n, _)| is_saved(*n)).collect();
        let half = saved.len() / 2;
        self.kept.extend(saved.into_iter().take(half));
    }

    /// Restores the saved values after a power failure or a reset. Values that are never saved return to their factory
    /// settings. The set position is kept, since a reset does not affect it (manual, 198).
    pub(super) fn handle_restart(&mut self) {
        let reference = self.get(REFERENCE);
        self.now = self.kept.clone();
        reference.into_iter().for_each(|position| self.set_value(REFERENCE, position));
    }

    /// Handles 47 = −2, which recalls the saved values, but only those that the adapter or hub itself stores.
    pub(super) fn restore_saved(&mut self) {
        copy_device_parameters(&self.kept, &mut self.now);
    }

    /// Handles 47 = −1, which restores factory settings without saving them, but only for values that the adapter or
    /// hub itself stores.
    pub(super) fn reset_device_values(&mut self) {
        copy_device_parameters(&self.factory, &mut self.now);
    }

    /// Restores all factory settings without saving them.
    pub(super) fn restore_factory(&mut self) {
        self.now = self.factory.clone();
    }
}

fn copy_device_parameters(from: &BTreeMap<u16, i64>, to: &mut BTreeMap<u16, i64>) {
    let own = |number: &u16| PARAMETERS.iter().any(|row| row.number == *number && row.is_stored_by_device());
    to.extend(from.iter().filter(|(number, _)| own(number)));
}

fn is_saved(number: u16) -> bool {
    PARAMETERS.iter().any(|row| row.number == number && row.saved)
}
