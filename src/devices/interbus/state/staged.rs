//! The values of a K3 encoder or a profile, and the edited ones beside them. Nothing is written to an encoder here; a
//! plan is made of the difference.
//!
//! Every edit makes another whole, which is what an undone step brings back. Edits survive a fresh reading: what the user
//! changed stays as he wants it, whatever the encoder has now, and all else follows the encoder, in the steps before too.
//! A cam program that was not read cannot be edited, since the cost of a change is not known; edits of an
//! earlier time wait until it is read. In a profile, what is not said can be said.
//!
//! Positions are steps, from 0 to one below the measuring range.

mod difference;
mod draft;
mod edit;
mod mark;
mod merge;
#[cfg(test)]
mod tests;

pub use difference::{Differs, ValueId};
pub use draft::SavedEdit;
pub use edit::{Edit, EditError};
pub use mark::Mark;

use crate::app::history::History;
use crate::app::{Stepped, SteppedParts};
use crate::devices::interbus::profile::{Image, Names, Parameters};
use crate::devices::interbus::protocol::{Cam, CamNumber, Program, ProgramNumber, WindowShift};

/// All that can be edited, as it is wanted.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Wanted {
    /// The values written to an encoder.
    pub image: Image,
    /// Names of programs and cams, which no encoder keeps. Two cams of a program with the same name are pulses on one
    /// track.
    pub names: Names,
}

/// The values that the edits are compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Ground {
    /// An encoder: what was not read is not known.
    #[default]
    Encoder,
    /// A profile: what is not in it is not said.
    Profile,
}

/// The base, the edited values, and the steps of undo and redo.
#[derive(Clone, Debug, Default)]
pub struct Staged {
    ground: Ground,
    /// The values of the encoder or the profile; both or none.
    base: Option<Wanted>,
    wanted: Option<Wanted>,
    history: History<Wanted>,
    /// Edits of an earlier time whose place was not read yet.
    waiting: Vec<SavedEdit>,
}

impl Wanted {
    /// Creates the edits without names.
    pub fn of(image: Image) -> Self {
        Wanted { image, names: Names::default() }
    }

    /// Steps of the measuring range; positions are below.
    pub const fn range(&self) -> u32 {
        self.image.parameters.steps
    }

    /// A cam's edges; `None`: nothing is known of them.
    pub fn cam(&self, program: ProgramNumber, cam: CamNumber) -> Option<Cam> {
        self.image.program(program)?.cams.get(usize::from(cam.get())).copied().flatten()
    }

    /// Returns whether a cam is active.
    pub fn is_on(&self, program: ProgramNumber, cam: CamNumber) -> bool {
        self.image.program(program).is_some_and(|own| own.is_on(cam))
    }

    pub fn name(&self, program: ProgramNumber, cam: CamNumber) -> Option<&str> {
        Some(self.names.cam(program, cam)).filter(|name| !name.is_empty())
    }
}

impl Staged {
    /// Creates the edits of a profile, which can also gain values that it does not have.
    pub fn of_profile(image: Image, names: Names) -> Self {
        let base = Wanted { image, names };
        Staged { ground: Ground::Profile, wanted: Some(base.clone()), base: Some(base), ..Staged::default() }
    }

    /// The profile says this now. Where that is what is wanted, it was saved, and the steps that led to it stay; else others
    /// wrote it, and only what was edited here stays as it is wanted.
    pub fn saved(&mut self, image: Image, names: Names) {
        let now = Wanted { image, names };
        if self.wanted.as_ref() == Some(&now) {
            self.base = Some(now);
            return;
        }
        let edits = self.edits();
        self.waiting.clear();
        self.history.forget();
        (self.base, self.wanted) = (Some(now.clone()), Some(now));
        self.take_draft(edits);
    }

    /// Takes a reading of the encoder. Values missing in it stay, and so do edits and their undo steps.
    pub fn refresh(&mut self, read: Image) {
        let known = self.base.take();
        let (names, image) = match &known {
            Some(known) => (known.names.clone(), merge::over(&known.image, read)),
            None => (Names::default(), read),
        };
        self.base = known;
        self.rebase(Wanted { image, names });
    }

    /// The parameters were read.
    pub fn refresh_parameters(&mut self, parameters: Parameters) {
        self.refresh(Image::of(parameters));
    }

    /// Cam programs were read, and the shift of the window with them. Nothing happens before the parameters were.
    pub fn refresh_programs(&mut self, programs: &[(ProgramNumber, Program)], shift: Option<WindowShift>) {
        let Some(base) = &self.base else { return };
        let mut image = Image { shift, ..Image::of(base.image.parameters) };
        for (number, program) in programs {
            if let Some(own) = image.program_mut(*number) {
                *own = Some(*program);
            }
        }
        self.refresh(image);
    }

    const fn is_encoder(&self) -> bool {
        matches!(self.ground, Ground::Encoder)
    }

    /// Takes new values of the encoder or the profile.
    fn rebase(&mut self, now: Wanted) {
        match (&self.base, &mut self.wanted) {
            (Some(before), Some(wanted)) => self.history.rebase(wanted, |own| merge::rebase(own, before, &now)),
            _ => self.wanted = Some(now.clone()),
        }
        self.base = Some(now);
        let waiting = std::mem::take(&mut self.waiting);
        self.take_draft(waiting);
    }

    /// Forgets everything: another encoder.
    pub fn clear(&mut self) {
        *self = Staged { ground: self.ground, ..Staged::default() };
    }

    /// Returns the values of the encoder or the profile; `None` if nothing was read.
    pub fn base(&self) -> Option<&Wanted> {
        self.base.as_ref()
    }

    /// Returns the values of the encoder or the profile; `None` if nothing was read.
    pub fn device(&self) -> Option<&Image> {
        self.base.as_ref().map(|base| &base.image)
    }

    /// Returns the edited values; `None` if nothing was read.
    pub fn wanted(&self) -> Option<&Wanted> {
        self.wanted.as_ref()
    }

    /// A program as it is wanted; `None`: it was not read, or the profile does not say it.
    pub fn program(&self, number: ProgramNumber) -> Option<&Program> {
        self.wanted.as_ref()?.image.program(number)
    }

    /// Changes something, as one step that can be undone. Whether anything is other than before.
    ///
    /// # Errors
    /// Why it cannot be; then nothing is changed.
    pub fn edit(&mut self, edit: &Edit) -> Result<bool, EditError> {
        let after = self.tried(edit)?;
        Ok(self.step(after))
    }

    /// Returns the values after an edit without making it: for the picture while something is dragged.
    ///
    /// # Errors
    /// Why it cannot be.
    pub fn tried(&self, edit: &Edit) -> Result<Wanted, EditError> {
        let wanted = self.wanted.as_ref().ok_or(EditError::NothingRead)?;
        edit::edited(wanted, edit, self.ground)
    }

    fn step(&mut self, after: Wanted) -> bool {
        self.wanted.as_mut().is_some_and(|wanted| self.history.step(wanted, after))
    }
}

impl Stepped for Staged {
    type Values = Wanted;

    fn differences_count(&self) -> usize {
        self.differences().len()
    }

    fn is_edited(&self) -> bool {
        let (Some(base), Some(wanted)) = (&self.base, &self.wanted) else { return false };
        base.image != wanted.image || self.ground == Ground::Profile && base.names != wanted.names
    }

    fn history(&self) -> &History<Wanted> {
        &self.history
    }

    fn parts(&mut self) -> Option<SteppedParts<'_, Wanted>> {
        Some((self.base.as_ref()?, self.wanted.as_mut()?, &mut self.history))
    }
}
