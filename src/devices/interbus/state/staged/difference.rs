//! Compares the edited values with the encoder or profile.

use super::{EditedValues, StagedEdits};
use crate::devices::interbus::profile::Edge;
use crate::devices::interbus::protocol::{CamNumber, Parameter, ProgramNumber};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ValueId {
    Parameter(Parameter),
    Shift,
    Edge(ProgramNumber, CamNumber, Edge),
    /// Whether a cam is active: 1 or 0.
    On(ProgramNumber, CamNumber),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValueDifference {
    pub place: ValueId,
    /// Base value, or `None` if the profile does not contain it.
    pub from: Option<u32>,
    /// Edited value, or `None` if the edit removes it from the profile.
    pub to: Option<u32>,
}

/// Parameters that are settings, in the order of the manual.
const SETTINGS: [Parameter; 5] =
    [Parameter::Steps, Parameter::Turns, Parameter::Direction, Parameter::Preset, Parameter::ZeroShift];

impl ValueId {
    /// Returns all values: the parameters, then the window shift, then the cams of each program.
    pub fn all() -> impl Iterator<Item = ValueId> {
        let cams = ProgramNumber::all().flat_map(|program| CamNumber::all().map(move |cam| (program, cam)));
        let cams = cams.flat_map(|(program, cam)| {
            [
                ValueId::Edge(program, cam, Edge::Start),
                ValueId::Edge(program, cam, Edge::Stop),
                ValueId::On(program, cam),
            ]
        });
        SETTINGS.into_iter().map(ValueId::Parameter).chain([ValueId::Shift]).chain(cams)
    }
}

impl EditedValues {
    /// Returns a value, or `None` if it is unknown.
    pub fn value(&self, place: ValueId) -> Option<u32> {
        match place {
            ValueId::Parameter(parameter) => self.image.parameters.value(parameter),
            ValueId::Shift => self.image.shift.map(|shift| u32::from(shift.get())),
            ValueId::Edge(program, cam, edge) => self.cam(program, cam).map(|own| match edge {
                Edge::Start => own.start.get(),
                Edge::Stop => own.stop.get(),
            }),
            ValueId::On(program, cam) => self.image.program(program).map(|_| u32::from(self.is_on(program, cam))),
        }
    }
}

impl StagedEdits {
    /// Returns how an edited value differs from its base, or `None` if it was not edited.
    pub fn difference_of(&self, place: ValueId) -> Option<ValueDifference> {
        let (base, wanted) = self.base.as_ref().zip(self.wanted.as_ref())?;
        let (from, to) = (base.value(place), wanted.value(place));
        (from != to).then_some(ValueDifference { place, from, to })
    }

    /// Returns the differences of all edited values except names.
    pub fn differences(&self) -> Vec<ValueDifference> {
        ValueId::all().filter_map(|place| self.difference_of(place)).collect()
    }

    /// Returns whether a cam was edited, not counting its name. Adding an inactive cam to a profile does not count as
    /// an edit.
    pub fn is_edited(&self, program: ProgramNumber, cam: CamNumber) -> bool {
        let Some((base, wanted)) = self.base.as_ref().zip(self.wanted.as_ref()) else { return false };
        base.cam(program, cam) != wanted.cam(program, cam) || base.is_on(program, cam) != wanted.is_on(program, cam)
    }

    /// Returns whether a program was edited. For a profile, this includes its names.
    pub fn is_program_edited(&self, program: ProgramNumber) -> bool {
        let Some((base, wanted)) = self.base.as_ref().zip(self.wanted.as_ref()) else { return false };
        let is_renamed = base.names.program(program) != wanted.names.program(program)
            || CamNumber::all().any(|cam| base.name(program, cam) != wanted.name(program, cam));
        base.image.program(program) != wanted.image.program(program) || is_renamed && !self.is_from_encoder()
    }

    pub fn count(&self) -> usize {
        self.differences().len()
    }
}
