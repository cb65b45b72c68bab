//! The values of an adapter, a hub or a profile, and the user's edits of them. The differences are the basis of a plan.
//! This module writes nothing to a device.
//!
//! Every edit creates a complete new state that undo and redo can return to. A new reading updates all these states,
//! but keeps their edited values. Values that were not read cannot be edited, and earlier edits of them wait until they
//! are read. A profile can gain values that it did not have.

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

/// Source of the values that edits are compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum BaseSource {
    /// The device. A missing value has not been read.
    #[default]
    Device,
    /// A profile. A missing value is not part of it.
    Profile,
}

/// The original values, the edited values, and the undo history.
#[derive(Clone, Debug, Default)]
pub struct StagedEdits {
    base_source: BaseSource,
    /// Original values from the device or the profile. They are present whenever the edited values are.
    base: Option<Image>,
    wanted: Option<Image>,
    earlier: Option<Image>,
    history: History<Image>,
    /// Stored edits of parameters that have not been read yet.
    waiting: Vec<SavedEdit>,
    /// Families of those drives whose variants are known.
    families: Families,
}

pub(super) type Families = BTreeMap<DriveNumber, Family>;

/// An edit as stored: the parameter number and the edited value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SavedEdit(pub u16, pub Option<i64>);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValueDifference {
    pub number: ParameterNumber,
    /// Original value, or `None` if it is not in the profile.
    pub from: Option<i64>,
    /// Edited value, or `None` if the parameter is removed from the profile.
    pub to: Option<i64>,
}

/// Returns whether a parameter can be edited as a value. This is the case for stored parameters, and for those of the
/// keys on the drive, which are not stored. The position (198) is set separately.
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

    /// Sets the drive families, whose travel limits the positions entered later.
    pub(super) fn set_families(&mut self, families: Families) {
        self.families = families;
    }

    /// Adopts the new content of the profile file. If it equals the edited values, it was saved here, and the undo
    /// history is kept. Otherwise, another program has written it, and only values edited here stay edited.
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

    /// Adopts a complete reading of the device. Edits and the undo history are kept.
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

    /// Adopts a reading of some parameters. Has no effect before the first complete reading.
    pub fn refresh_partially(&mut self, read: &Image) {
        if let Some(base) = &self.base {
            self.refresh(base.with_overlay(read));
        }
    }

    const fn is_device(&self) -> bool {
        matches!(self.base_source, BaseSource::Device)
    }

    /// Discards all values and edits before another device is used.
    pub fn clear(&mut self) {
        *self = StagedEdits { base_source: self.base_source, ..StagedEdits::default() };
    }

    /// Returns the original values from the device or the profile, or `None` if nothing was read.
    pub fn base(&self) -> Option<&Image> {
        self.base.as_ref()
    }

    /// Returns the edited values, or `None` if nothing was read.
    pub fn edited_values(&self) -> Option<&Image> {
        self.wanted.as_ref()
    }

    /// Returns the edited value of a parameter, or `None` if the value is unknown.
    pub fn value(&self, number: ParameterNumber) -> Option<i64> {
        self.wanted.as_ref()?.get(number)
    }

    /// Returns the value before the last reading, or `None` if that reading did not change it.
    pub fn previous_value(&self, number: ParameterNumber) -> Option<i64> {
        let was = self.earlier.as_ref()?.get(number)?;
        (self.base.as_ref()?.get(number)? != was).then_some(was)
    }

    /// Returns the original and the edited value of a parameter, or `None` if they are equal.
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

    /// Returns the edited values that differ from the original ones, as the basis of a plan.
    pub fn changed_values(&self) -> Image {
        let wanted = |differs: ValueDifference| Some((differs.number, differs.to?));
        Image { values: self.differences().into_iter().filter_map(wanted).collect() }
    }

    /// Applies an edit as a single undo step. Returns whether anything changed.
    ///
    /// # Errors
    /// Returns an error with the reason if the edit is not possible. In this case, nothing has changed.
    pub fn apply_edit(&mut self, edit: &Edit) -> Result<bool, EditError> {
        let after = self.preview_edit(edit)?;
        Ok(self.apply_step(after))
    }

    /// Returns the values that an edit would lead to, as a preview.
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

    /// Returns the edits to save as a draft, including those of parameters that have not been read yet.
    pub fn saved_edits(&self) -> Vec<SavedEdit> {
        let edited = self.differences().into_iter().map(|own| SavedEdit(own.number.get(), own.to));
        edited.chain(self.waiting.iter().copied()).collect()
    }

    /// Adopts the edits in a draft as a single undo step. Edits of parameters that have not been read wait until then.
    /// Invalid edits are dropped.
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

/// Transfers edits from the original values `before` to the new original values `now`.
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
