//! Edited values of a K3 encoder or a profile, and the base values from which they started. A plan is made from the
//! differences. Nothing is written to an encoder here.
//!
//! Every edit creates a complete new state, to which undo can return. Edits are kept when the encoder is read again,
//! and all other values are updated in every state of the history. A cam program cannot be edited before it has been
//! read, because the cost of a change would be unknown. Earlier edits of such a program are kept until it is read. A
//! profile can gain values that it did not contain.
//!
//! Positions are in steps, from 0 to the measuring range minus one.

mod difference;
mod draft;
mod edit;
mod mark;
mod merge;
#[cfg(test)]
mod tests;

pub use difference::{ValueDifference, ValueId};
pub use draft::SavedEdit;
pub use edit::{Edit, EditError};
pub use mark::EditFinding;

use crate::app::history::History;
use crate::app::{EditHistoryParts, SnapshotEdits};
use crate::devices::interbus::profile::{CamNames, Image, Parameters};
use crate::devices::interbus::protocol::{Cam, CamNumber, Program, ProgramNumber, WindowShift};

/// All values that can be edited, including edits already made.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct EditedValues {
    pub image: Image,
    /// Names of programs and cams, which an encoder does not store. Two cams of a program with the same name are pulses
    /// of one track.
    pub names: CamNames,
}

/// Source of the base values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum BaseSource {
    /// An encoder. Missing values were not read and are unknown.
    #[default]
    Encoder,
    /// A profile. Missing values are not part of it.
    Profile,
}

/// Base values, edited values, and the undo history.
#[derive(Clone, Debug, Default)]
pub struct StagedEdits {
    base_source: BaseSource,
    /// Values of the encoder or profile before any edits.
    base: Option<EditedValues>,
    wanted: Option<EditedValues>,
    history: History<EditedValues>,
    /// Earlier edits of values that have not been read yet.
    waiting: Vec<SavedEdit>,
}

impl EditedValues {
    /// Creates editable values without names.
    pub fn from_image(image: Image) -> Self {
        EditedValues { image, names: CamNames::default() }
    }

    /// Returns the number of steps in the measuring range.
    pub const fn step_count(&self) -> u32 {
        self.image.parameters.steps
    }

    /// Returns the edges of a cam, or `None` if they are unknown.
    pub fn cam(&self, program: ProgramNumber, cam: CamNumber) -> Option<Cam> {
        self.image.program(program)?.cams.get(usize::from(cam.get())).copied().flatten()
    }

    pub fn is_on(&self, program: ProgramNumber, cam: CamNumber) -> bool {
        self.image.program(program).is_some_and(|own| own.is_on(cam))
    }

    pub fn name(&self, program: ProgramNumber, cam: CamNumber) -> Option<&str> {
        Some(self.names.cam(program, cam)).filter(|name| !name.is_empty())
    }
}

impl StagedEdits {
    /// Creates the edits for a profile. Values missing from the profile can be added.
    pub fn for_profile(image: Image, names: CamNames) -> Self {
        let base = EditedValues { image, names };
        StagedEdits {
            base_source: BaseSource::Profile,
            wanted: Some(base.clone()),
            base: Some(base),
            ..StagedEdits::default()
        }
    }

    /// Sets the content of a saved profile as the base. If it equals the edited values, the undo history is kept.
    /// Otherwise, another program has changed the profile, and only the edits are kept.
    pub fn adopt_saved(&mut self, image: Image, names: CamNames) {
        let now = EditedValues { image, names };
        if self.wanted.as_ref() == Some(&now) {
            self.base = Some(now);
            return;
        }
        let edits = self.draft_edits();
        self.waiting.clear();
        self.history.clear_steps();
        (self.base, self.wanted) = (Some(now.clone()), Some(now));
        self.take_draft(edits);
    }

    /// Sets the values read from the encoder as the base. Values that were not read, edits and the undo history are
    /// kept.
    pub fn refresh(&mut self, read: Image) {
        let known = self.base.take();
        let (names, image) = match &known {
            Some(known) => (known.names.clone(), merge::merge_known(&known.image, read)),
            None => (CamNames::default(), read),
        };
        self.base = known;
        self.rebase_edits(EditedValues { image, names });
    }

    pub fn refresh_parameters(&mut self, parameters: Parameters) {
        self.refresh(Image::from_parameters(parameters));
    }

    /// Adds cam programs and the window shift to the base. It has no effect before the parameters have been read.
    pub fn refresh_programs(&mut self, programs: &[(ProgramNumber, Program)], shift: Option<WindowShift>) {
        let Some(base) = &self.base else { return };
        let mut image = Image { shift, ..Image::from_parameters(base.image.parameters) };
        for (number, program) in programs {
            if let Some(own) = image.program_mut(*number) {
                *own = Some(*program);
            }
        }
        self.refresh(image);
    }

    const fn is_from_encoder(&self) -> bool {
        matches!(self.base_source, BaseSource::Encoder)
    }

    /// Replaces the base values and applies the edits to the new ones.
    fn rebase_edits(&mut self, now: EditedValues) {
        match (&self.base, &mut self.wanted) {
            (Some(before), Some(wanted)) => {
                self.history.update_all_states(wanted, |own| merge::rebase_edits(own, before, &now))
            }
            _ => self.wanted = Some(now.clone()),
        }
        self.base = Some(now);
        let waiting = std::mem::take(&mut self.waiting);
        self.take_draft(waiting);
    }

    /// Discards all values and edits, because another encoder will be used.
    pub fn clear(&mut self) {
        *self = StagedEdits { base_source: self.base_source, ..StagedEdits::default() };
    }

    /// Returns the base values, or `None` if no data was read.
    pub fn base(&self) -> Option<&EditedValues> {
        self.base.as_ref()
    }

    /// Returns the base values without names, or `None` if no data was read.
    pub fn device(&self) -> Option<&Image> {
        self.base.as_ref().map(|base| &base.image)
    }

    /// Returns the edited values, or `None` if no data was read.
    pub fn edited_values(&self) -> Option<&EditedValues> {
        self.wanted.as_ref()
    }

    /// Returns an edited program, or `None` if it has not been read or is not in the profile.
    pub fn program(&self, number: ProgramNumber) -> Option<&Program> {
        self.wanted.as_ref()?.image.program(number)
    }

    /// Applies an edit as a single undo step, and returns whether it changed a value.
    ///
    /// # Errors
    /// Returns an error with the reason if the edit is not possible. In this case, nothing has changed.
    pub fn apply_edit(&mut self, edit: &Edit) -> Result<bool, EditError> {
        let after = self.preview_edit(edit)?;
        Ok(self.apply_step(after))
    }

    /// Returns the values as an edit would change them, for display during a drag.
    ///
    /// # Errors
    /// Returns an error with the reason if the edit is not possible.
    pub fn preview_edit(&self, edit: &Edit) -> Result<EditedValues, EditError> {
        let wanted = self.wanted.as_ref().ok_or(EditError::NothingRead)?;
        edit::apply_edit(wanted, edit, self.base_source)
    }

    fn apply_step(&mut self, after: EditedValues) -> bool {
        self.wanted.as_mut().is_some_and(|wanted| self.history.apply_step(wanted, after))
    }
}

impl SnapshotEdits for StagedEdits {
    type Values = EditedValues;

    fn differences_count(&self) -> usize {
        self.differences().len()
    }

    fn is_edited(&self) -> bool {
        let (Some(base), Some(wanted)) = (&self.base, &self.wanted) else { return false };
        base.image != wanted.image || self.base_source == BaseSource::Profile && base.names != wanted.names
    }

    fn history(&self) -> &History<EditedValues> {
        &self.history
    }

    fn history_parts(&mut self) -> Option<EditHistoryParts<'_, EditedValues>> {
        Some((self.base.as_ref()?, self.wanted.as_mut()?, &mut self.history))
    }
}
