//! Values of an adapter or a hub (or a profile of one), and the edited values. The difference between them is the basis
//! of a plan. This module does not write anything to a device.
//!
//! Every edit creates a complete new state, to which undo can return. Edits survive a new reading. In all states of the
//! history, edited values are kept, and all other values are updated from the device. Values that were not read cannot
//! be edited, and earlier edits of them wait until they are read. A profile can gain values that it did not have.

mod edit;
mod mark;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub use edit::{Edit, EditError, LimitsPolicy};
pub use mark::EditFinding;

use crate::app::history::History;
use crate::app::{EditHistoryParts, SnapshotEdits};
use crate::devices::hiperdrive::profile::Image;
use crate::devices::hiperdrive::protocol::{
    DriveNumber, Family, ParameterAccess, ParameterNumber, ParameterRow, Travel,
};

/// Source of the values with which the edited values are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum BaseSource {
    /// The device. A value that was not read is unknown.
    #[default]
    Device,
    /// A profile. A missing value is not in the profile.
    Profile,
}

/// The base values, the edited values, and the undo and redo history.
#[derive(Clone, Debug, Default)]
pub struct StagedEdits {
    base_source: BaseSource,
    /// Values of the device or the profile. They are present if and only if the edited values are.
    base: Option<Image>,
    wanted: Option<Image>,
    earlier: Option<Image>,
    history: History<Image>,
    /// Earlier edits of parameters that have not been read yet.
    waiting: Vec<SavedEdit>,
    /// Families of the drives, if their variants are known.
    families: Families,
}

pub(super) type Families = BTreeMap<DriveNumber, Family>;

/// A stored edit, with the parameter's own number and the edited value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SavedEdit(pub u16, pub Option<i64>);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValueDifference {
    pub number: ParameterNumber,
    /// Current value, or `None` if it is not in the profile.
    pub from: Option<i64>,
    /// Edited value, or `None` if the parameter is to be removed from the profile.
    pub to: Option<i64>,
}

/// Returns whether a parameter can be edited as a value. This applies to the stored parameters and to the steps of the
/// keys on the drive, which are not stored. Setting the position (198) is a separate change.
pub fn is_editable(row: &ParameterRow) -> bool {
    let is_of_keys = matches!(row.number, 170..=182);
    row.access == ParameterAccess::ReadWrite && row.number != 198 && (Image::contains_row(row) || is_of_keys)
}

impl StagedEdits {
    /// Creates the edits of a profile, to which missing values can be added.
    pub fn for_profile(image: Image) -> Self {
        StagedEdits {
            base_source: BaseSource::Profile,
            wanted: Some(image.clone()),
            base: Some(image),
            ..StagedEdits::default()
        }
    }

    /// Sets the families of the drives. Their travel limits later entries of positions.
    pub(super) fn set_families(&mut self, families: Families) {
        self.families = families;
    }

    /// Adopts the new content of the profile. If it equals the edited values, the profile was saved, and the undo
    /// history is kept. Otherwise, another program has written it, and only values that were edited here remain edited.
    pub fn adopt_saved(&mut self, image: Image) {
        if self.wanted.as_ref() == Some(&image) {
            self.base = Some(image);
            return;
        }
        let edits = self.saved_edits();
        self.waiting.clear();
        self.history.clear_steps();
        (self.base, self.wanted) = (Some(image.clone()), Some(image));
        self.take_draft(edits);
    }

    /// Adopts a full reading of the device. Edits and their undo history are kept.
    pub fn refresh(&mut self, now: Image) {
        match (&self.base, &mut self.wanted) {
            (Some(before), Some(wanted)) => {
                self.history.update_all_states(wanted, |own| rebase_edits(own, before, &now))
            }
            _ => self.wanted = Some(now.clone()),
        }
        self.earlier = self.base.replace(now);
        let waiting = std::mem::take(&mut self.waiting);
        self.take_draft(waiting);
    }

    /// Adopts a reading of some parameters and keeps the others. Has no effect before a full reading.
    pub fn refresh_partially(&mut self, read: &Image) {
        if let Some(base) = &self.base {
            self.refresh(base.overlaid_with(read));
        }
    }

    const fn is_device(&self) -> bool {
        matches!(self.base_source, BaseSource::Device)
    }

    /// Discards all values and edits before another device is used.
    pub fn clear(&mut self) {
        *self = StagedEdits { base_source: self.base_source, ..StagedEdits::default() };
    }

    /// Returns the values of the device or the profile, or `None` if no data was read.
    pub fn base(&self) -> Option<&Image> {
        self.base.as_ref()
    }

    /// Returns the edited values, or `None` if no data was read.
    pub fn edited_values(&self) -> Option<&Image> {
        self.wanted.as_ref()
    }

    /// Returns the edited value of a parameter, or `None` if the value is unknown.
    pub fn value(&self, number: ParameterNumber) -> Option<i64> {
        self.wanted.as_ref()?.get(number)
    }

    /// Returns the previous value of a parameter, or `None` if the last reading did not change it.
    pub fn changed_from(&self, number: ParameterNumber) -> Option<i64> {
        let was = self.earlier.as_ref()?.get(number)?;
        (self.base.as_ref()?.get(number)? != was).then_some(was)
    }

    /// Returns how the edited value of a parameter differs, or `None` if it does not.
    pub fn difference_of(&self, number: ParameterNumber) -> Option<ValueDifference> {
        let (base, wanted) = self.base.as_ref().zip(self.wanted.as_ref())?;
        let (from, to) = (base.get(number), wanted.get(number));
        (from != to).then_some(ValueDifference { number, from, to })
    }

    pub fn differences(&self) -> Vec<ValueDifference> {
        let Some((base, wanted)) = self.base.as_ref().zip(self.wanted.as_ref()) else { return Vec::new() };
        let numbers: std::collections::BTreeSet<_> = base.values.keys().chain(wanted.values.keys()).copied().collect();
        numbers.into_iter().filter_map(|number| self.difference_of(number)).collect()
    }

    /// Returns the edited values that differ from the device, as the basis of a plan.
    pub fn changed_values(&self) -> Image {
        let wanted = |differs: ValueDifference| Some((differs.number, differs.to?));
        Image { values: self.differences().into_iter().filter_map(wanted).collect() }
    }

    /// Makes an edit as a single undo step. Returns whether anything changed.
    ///
    /// # Errors
    /// Returns an error with the reason if the edit is not possible. In this case, nothing has changed.
    pub fn apply_edit(&mut self, edit: &Edit) -> Result<bool, EditError> {
        let after = self.preview_edit(edit)?;
        Ok(self.apply_step(after))
    }

    /// Returns the values that an edit would produce, for a preview. The edit is not made.
    ///
    /// # Errors
    /// Returns an error with the reason if the edit is not possible.
    pub fn preview_edit(&self, edit: &Edit) -> Result<Image, EditError> {
        let (base, wanted) = self.base.as_ref().zip(self.wanted.as_ref()).ok_or(EditError::NothingRead)?;
        edit::apply_edit((base, wanted), edit, self.base_source, &self.families)
    }

    fn apply_step(&mut self, after: Image) -> bool {
        self.wanted.as_mut().is_some_and(|wanted| self.history.apply_step(wanted, after))
    }

    /// Returns the edits to save as a draft, including the edits of parameters that have not been read yet.
    pub fn saved_edits(&self) -> Vec<SavedEdit> {
        let edited = self.differences().into_iter().map(|own| SavedEdit(own.number.get(), own.to));
        edited.chain(self.waiting.iter().copied()).collect()
    }

    /// Adopts the edits of a draft as a single undo step. Edits of parameters that were not read are deferred. Invalid
    /// edits are dropped.
    pub fn take_draft(&mut self, draft: impl IntoIterator<Item = SavedEdit>) {
        let Some(mut wanted) = self.wanted.clone() else {
            self.waiting.extend(draft);
            return;
        };
        for SavedEdit(number, value) in draft {
            let Some((number, row)) = ParameterNumber::new(number).and_then(|own| Some((own, own.row()?))) else {
                continue;
            };
            let is_read = wanted.get(number).is_some() || !self.is_device();
            match value {
                _ if !is_editable(row) => {}
                Some(value) if is_read => {
                    // Invalid values stay as entered and are marked.
                    wanted.values.insert(number, value);
                }
                Some(_) => self.waiting.push(SavedEdit(number.get(), value)),
                None if !self.is_device() => {
                    wanted.values.remove(&number);
                }
                None => {}
            }
        }
        self.apply_step(wanted);
    }
}

impl SnapshotEdits for StagedEdits {
    type Values = Image;

    fn differences_count(&self) -> usize {
        self.differences().len()
    }

    fn is_edited(&self) -> bool {
        self.base != self.wanted
    }

    fn history(&self) -> &History<Image> {
        &self.history
    }

    fn history_parts(&mut self) -> Option<EditHistoryParts<'_, Image>> {
        Some((self.base.as_ref()?, self.wanted.as_mut()?, &mut self.history))
    }
}

fn travel(number: ParameterNumber, image: &Image, families: &Families) -> Travel {
    let Some(drive) = number.drive() else { return Travel::UNKNOWN };
    Travel { family: families.get(&drive).copied(), scale: image.scale(drive) }
}

/// Moves edits from the base `before` to the base `now`.
fn rebase_edits(own: &mut Image, before: &Image, now: &Image) {
    let mut rebased = now.clone();
    for (number, value) in &own.values {
        // An edit of a parameter that no longer exists is dropped.
        if before.get(*number) != Some(*value) && now.get(*number).is_some() {
            rebased.values.insert(*number, *value);
        }
    }
    *own = rebased;
}
