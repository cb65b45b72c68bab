//! Values that were written but not saved, with the saved values of their parameters. They are stored because a device
//! does not give access to its saved values, and an interrupted set-up may be from the day before.

use std::collections::BTreeMap;

use super::unit::HiperdriveDevice;
use crate::devices::hiperdrive::profile::{HiperdrivePlan, Op, Service, written_values};
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;
use crate::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber, Value};

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct UnsavedChanges {
    /// Saved values of the parameters written since the last save, by number.
    before: BTreeMap<u16, i64>,
    /// How often this program has set the position of each drive.
    set: BTreeMap<DriveNumber, u32>,
    sets: Vec<DriveNumber>,
}

impl UnsavedChanges {
    /// Records that a plan is about to be executed. From then on, its parameters may differ from the saved values.
    pub(super) fn begin_plan(&mut self, plan: &HiperdrivePlan) {
        let changes_all = |op: &Op| matches!(op, Op::Service(Service::Factory | Service::Recall));
        let base = plan.base.image();
        let writes = written_values(plan);
        let touched: Vec<ParameterNumber> = match plan.ops.iter().any(changes_all) {
            true => base.values.keys().copied().collect(),
            false => writes.values.keys().copied().collect(),
        };
        for number in touched {
            if let Some(before) = base.get(number) {
                self.before.entry(number.get()).or_insert(before);
            }
        }
        let reference = |number: &ParameterNumber| number.drive().filter(|_| number.drive1_number() == REFERENCE);
        self.sets = writes.values.keys().filter_map(reference).collect();
    }

    pub(super) fn finish_plan(&mut self, plan: &HiperdrivePlan) {
        self.interrupt_plan(true);
        let saves = |op: &Op| matches!(op, Op::Service(Service::Save | Service::FactoryAll));
        if plan.ops.iter().any(saves) {
            self.before.clear();
        }
    }

    /// Records that a plan was interrupted. `begun` is set if part of it was or may have been written.
    pub(super) fn interrupt_plan(&mut self, begun: bool) {
        for drive in std::mem::take(&mut self.sets) {
            *self.set.entry(drive).or_default() += u32::from(begun);
        }
    }

    /// Compares a reading of all parameters with the saved values. Parameters that are equal again are no longer
    /// listed.
    pub(super) fn read(&mut self, now: &BTreeMap<ParameterNumber, Value>) {
        let is_as_saved = |number: u16, before: i64| {
            ParameterNumber::new(number).is_some_and(|number| now.get(&number) == Some(&Value::Number(before)))
        };
        self.before.retain(|number, before| !is_as_saved(*number, *before));
    }

    /// Returns the saved values of overwritten parameters by number, for storage.
    pub(super) const fn saved_values(&self) -> &BTreeMap<u16, i64> {
        &self.before
    }

    pub(super) fn add_saved_values(&mut self, earlier: &BTreeMap<u16, i64>) {
        for (number, before) in earlier {
            self.before.entry(*number).or_insert(*before);
        }
    }

    /// Returns the saved values of a drive's overwritten parameters, by number for drive 1.
    fn for_drive(&self, drive: DriveNumber) -> BTreeMap<u16, i64> {
        let own = |(number, before): (&u16, &i64)| {
            let number = ParameterNumber::new(*number).filter(|number| number.drive() == Some(drive))?;
            Some((number.drive1_number(), *before))
        };
        self.before.iter().filter_map(own).collect()
    }
}

impl HiperdriveDevice {
    /// Returns the saved values of a drive's overwritten parameters, by number for drive 1.
    pub(super) fn unsaved_values(&self, drive: DriveNumber) -> BTreeMap<u16, i64> {
        self.unsaved.for_drive(drive)
    }

    pub(super) fn position_set_count(&self, drive: DriveNumber) -> u32 {
        self.unsaved.set.get(&drive).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperdrive::profile::{
        DeviceState, Image, Positions, ProfileIdentity, plan_edits, plan_service,
    };

    fn image(values: &[(u16, i64)]) -> Image {
        let number = |(number, value): &(u16, i64)| (ParameterNumber::new(*number).unwrap(), *value);
        Image { values: values.iter().map(number).collect() }
    }

    fn values(image: &Image) -> BTreeMap<ParameterNumber, Value> {
        image.values.iter().map(|(number, value)| (*number, Value::Number(*value))).collect()
    }

    /// Overwritten saved values are remembered until the next save, even after a restart of the program (issue 21.6 h).
    #[test]
    fn remembers_saved_values_until_next_save() {
        let three = DriveNumber::new(3).unwrap();
        let (factory, mut now) = (image(&[(24, 0), (366, 350)]), image(&[(24, 0), (366, 350)]));
        let mut own = UnsavedChanges::default();
        for speed in [300, 200] {
            let (identity, positions) = (ProfileIdentity::default(), Positions::new());
            let state = DeviceState { identity, image: now.clone(), positions };
            let plan = plan_edits(&state, &image(&[(366, speed)])).unwrap().without_save();
            own.begin_plan(&plan);
            own.finish_plan(&plan);
            now = now.with_overlay(&image(&[(366, speed)]));
            own.read(&values(&now));
        }
        assert_eq!(own.for_drive(three), BTreeMap::from([(166, 350)]));
        assert!(own.for_drive(DriveNumber::FIRST).is_empty());
        let mut later = UnsavedChanges::default();
        later.add_saved_values(own.saved_values());
        assert_eq!(later.for_drive(three), BTreeMap::from([(166, 350)]));
        // The device has lost its supply, or the values were written back.
        later.read(&values(&factory));
        assert!(later.for_drive(three).is_empty());
        let plan = plan_service(&now, Service::Save);
        own.begin_plan(&plan);
        own.finish_plan(&plan);
        assert!(own.for_drive(three).is_empty());
    }
}
