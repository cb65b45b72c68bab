//! Converts edits to saved drafts and back.

use serde::{Deserialize, Serialize};

use super::{BaseSource, EditedValues, StagedEdits, edit};
use crate::devices::interbus::profile::Direction;
use crate::devices::interbus::protocol::{Cam, CamNumber, Gear, Parameter, ProgramNumber, Value, WindowShift};

/// An edit as saved in a draft. It contains only the resulting value, with numbers as in the manual.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SavedEdit {
    /// A gear, given by its steps and turns.
    Gear(u32, u32),
    /// Direction: 3 clockwise, 4 counterclockwise.
    Direction(u32),
    /// Preset in steps.
    Preset(u32),
    /// Zero shift in steps.
    ZeroShift(u32),
    /// Window shift, 0 to 25.
    Shift(u8),
    Cam(u8, u8, u32, u32),
    /// Program and number of a cam that is removed from the profile.
    NoCam(u8, u8),
    On(u8, u8, bool),
    /// Program, cam number and name of a cam. The name may be empty.
    Name(u8, u8, String),
    /// Program number and name. The name may be empty.
    ProgramName(u8, String),
}

impl StagedEdits {
    /// Returns the edits for a draft, including those whose program has not been read yet.
    pub fn draft_edits(&self) -> Vec<SavedEdit> {
        let mut kept = Vec::new();
        if let Some((base, wanted)) = self.base.as_ref().zip(self.wanted.as_ref()) {
            collect_parameter_edits(base, wanted, &mut kept);
            for program in ProgramNumber::all() {
                collect_program_edits(base, wanted, program, &mut kept);
            }
        }
        kept.extend(self.waiting.iter().cloned());
        kept
    }

    /// Applies the edits of a draft as a single undo step. Edits of a program that has not been read are kept until it
    /// is. Invalid edits are dropped.
    pub fn take_draft(&mut self, draft: impl IntoIterator<Item = SavedEdit>) {
        let Some(mut wanted) = self.wanted.clone() else {
            self.waiting.extend(draft);
            return;
        };
        for kept in draft {
            if kept.changes_unread_value(&wanted, self.base_source) {
                self.waiting.push(kept);
            } else {
                kept.apply_to(&mut wanted, self.base_source);
            }
        }
        self.apply_step(wanted);
    }

    /// Returns the programs that have edits but have not been read yet.
    pub fn pending_programs(&self) -> Vec<ProgramNumber> {
        let waits = |number: &ProgramNumber| self.waiting.iter().any(|kept| kept.program() == Some(*number));
        ProgramNumber::all().filter(waits).collect()
    }
}

fn collect_parameter_edits(base: &EditedValues, wanted: &EditedValues, kept: &mut Vec<SavedEdit>) {
    let (was, is) = (&base.image.parameters, &wanted.image.parameters);
    if (was.steps, was.revolutions) != (is.steps, is.revolutions) {
        kept.push(SavedEdit::Gear(is.steps, is.revolutions));
    }
    let changed = |parameter| is.value(parameter).filter(|value| was.value(parameter) != Some(*value));
    kept.extend(changed(Parameter::Direction).map(SavedEdit::Direction));
    kept.extend(changed(Parameter::Preset).map(SavedEdit::Preset));
    kept.extend(changed(Parameter::ZeroShift).map(SavedEdit::ZeroShift));
    let shift = wanted.image.shift.filter(|_| wanted.image.shift != base.image.shift);
    kept.extend(shift.map(|shift| SavedEdit::Shift(shift.get())));
}

fn collect_program_edits(
    base: &EditedValues,
    wanted: &EditedValues,
    program: ProgramNumber,
    kept: &mut Vec<SavedEdit>,
) {
    let number = program.get();
    let name = |names: &EditedValues| names.names.program(program).to_owned();
    if name(base) != name(wanted) {
        kept.push(SavedEdit::ProgramName(number, name(wanted)));
    }
    for cam in CamNumber::all() {
        let now = wanted.cam(program, cam);
        if now != base.cam(program, cam) {
            kept.push(match now {
                Some(Cam { start, stop }) => SavedEdit::Cam(number, cam.get(), start.get(), stop.get()),
                None => SavedEdit::NoCam(number, cam.get()),
            });
        }
        let on = wanted.is_on(program, cam);
        if on != base.is_on(program, cam) {
            kept.push(SavedEdit::On(number, cam.get(), on));
        }
        if base.name(program, cam) != wanted.name(program, cam) {
            let name = wanted.name(program, cam).unwrap_or_default();
            kept.push(SavedEdit::Name(number, cam.get(), name.to_owned()));
        }
    }
}

impl SavedEdit {
    /// Applies the edit if its numbers are valid. Values beyond the measuring range are not adjusted.
    fn apply_to(self, wanted: &mut EditedValues, ground: BaseSource) {
        let parameters = &mut wanted.image.parameters;
        match self {
            SavedEdit::Gear(steps, revolutions) => {
                if let Ok(gear) = Gear::new(steps, revolutions) {
                    (parameters.steps, parameters.revolutions) = (gear.total_steps(), gear.turns());
                }
            }
            SavedEdit::Direction(code) => {
                parameters.direction = Direction::from_code(code).unwrap_or(parameters.direction);
            }
            SavedEdit::Preset(preset) => parameters.preset = Value::new(preset).map_or(parameters.preset, Value::get),
            SavedEdit::ZeroShift(shift) => {
                parameters.zero_shift = Value::new(shift).map_or(parameters.zero_shift, Value::get)
            }
            SavedEdit::Shift(shift) => wanted.image.shift = WindowShift::new(shift).or(wanted.image.shift),
            SavedEdit::Cam(_, cam, start, stop) => {
                let edges = Value::new(start).zip(Value::new(stop)).map(|(start, stop)| Cam { start, stop });
                let own = self.program().and_then(|number| edit::program_mut(wanted, number, ground).ok());
                if let Some((own, edges)) = own.and_then(|own| own.cams.get_mut(usize::from(cam))).zip(edges) {
                    *own = Some(edges);
                }
            }
            SavedEdit::NoCam(_, cam) => {
                let own = self.program().and_then(|number| edit::program_mut(wanted, number, ground).ok());
                if let Some(own) = own.and_then(|own| own.cams.get_mut(usize::from(cam))) {
                    *own = None;
                }
            }
            SavedEdit::On(_, cam, on) => {
                let own = self.program().and_then(|number| edit::program_mut(wanted, number, ground).ok());
                if let Some((own, cam)) = own.zip(CamNumber::new(cam)) {
                    own.set_cam_enabled(cam, on);
                }
            }
            SavedEdit::Name(_, cam, ref name) => {
                let place = self.program().zip(CamNumber::new(cam));
                if let Some(((program, cam), name)) = place.zip(edit::validate_name(name).ok()) {
                    wanted.names.set_cam(program, cam, name);
                }
            }
            SavedEdit::ProgramName(_, ref name) => {
                if let Some((program, name)) = self.program().zip(edit::validate_name(name).ok()) {
                    wanted.names.set_program(program, name);
                }
            }
        }
    }

    fn program(&self) -> Option<ProgramNumber> {
        match self {
            SavedEdit::Cam(program, ..)
            | SavedEdit::NoCam(program, _)
            | SavedEdit::On(program, ..)
            | SavedEdit::Name(program, ..)
            | SavedEdit::ProgramName(program, _) => ProgramNumber::new(*program),
            SavedEdit::Gear(..)
            | SavedEdit::Direction(_)
            | SavedEdit::Preset(_)
            | SavedEdit::ZeroShift(_)
            | SavedEdit::Shift(_) => None,
        }
    }

    /// Returns whether the edit changes a value that has not been read. Names need not be read.
    fn changes_unread_value(&self, wanted: &EditedValues, ground: BaseSource) -> bool {
        ground == BaseSource::Encoder
            && match self {
                SavedEdit::Shift(_) => wanted.image.shift.is_none(),
                SavedEdit::Cam(..) | SavedEdit::NoCam(..) | SavedEdit::On(..) => {
                    self.program().is_some_and(|program| wanted.image.program(program).is_none())
                }
                SavedEdit::Gear(..) | SavedEdit::Direction(_) | SavedEdit::Preset(_) | SavedEdit::ZeroShift(_) => false,
                SavedEdit::Name(..) | SavedEdit::ProgramName(..) => false,
            }
    }
}
