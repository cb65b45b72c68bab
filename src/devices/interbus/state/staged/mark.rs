//! Problems with the edited values.

use super::EditedValues;
use crate::devices::interbus::profile::Edge;
use crate::devices::interbus::protocol::{Cam, CamNumber, GearError, ProgramNumber};

/// A problem with the edited values that the user should check, such as cams beyond a measuring range that has become
/// shorter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EditFinding {
    Gear(GearError),
    Preset {
        last: u32,
    },
    /// An active cam has an edge beyond the measuring range.
    Beyond {
        program: ProgramNumber,
        cam: CamNumber,
        /// The edge beyond the range, or the start if both are.
        edge: Edge,
        last: u32,
    },
    /// Two active cams with the same name overlap, which the pulses of one track should not do. The encoder allows it.
    Clash {
        program: ProgramNumber,
        first: CamNumber,
        second: CamNumber,
        /// First position at which both cams are on.
        at: u32,
    },
}

impl EditFinding {
    pub fn refers_to(&self, number: ProgramNumber, own: CamNumber) -> bool {
        match *self {
            EditFinding::Beyond { program, cam, .. } => (program, cam) == (number, own),
            EditFinding::Clash { program, first, second, .. } => program == number && (first == own || second == own),
            EditFinding::Gear(_) | EditFinding::Preset { .. } => false,
        }
    }

    pub const fn program(&self) -> Option<ProgramNumber> {
        match self {
            EditFinding::Beyond { program, .. } | EditFinding::Clash { program, .. } => Some(*program),
            EditFinding::Gear(_) | EditFinding::Preset { .. } => None,
        }
    }
}

impl EditedValues {
    pub fn findings(&self) -> Vec<EditFinding> {
        let parameters = &self.image.parameters;
        let mut marks: Vec<EditFinding> = parameters.gear().err().map(EditFinding::Gear).into_iter().collect();
        let last = self.step_count().saturating_sub(1);
        if parameters.preset > last {
            marks.push(EditFinding::Preset { last });
        }
        for program in ProgramNumber::all() {
            self.mark_program(program, last, &mut marks);
        }
        marks
    }

    fn mark_program(&self, program: ProgramNumber, last: u32, marks: &mut Vec<EditFinding>) {
        let on = |cam: &CamNumber| self.is_on(program, *cam);
        for number in CamNumber::all().filter(on) {
            let Some(cam) = self.cam(program, number) else { continue };
            let beyond = [(Edge::Start, cam.start), (Edge::Stop, cam.stop)];
            if let Some((edge, _)) = beyond.into_iter().find(|(_, position)| position.get() > last) {
                marks.push(EditFinding::Beyond { program, cam: number, edge, last });
            }
            let Some(track) = self.name(program, number) else { continue };
            for other in CamNumber::all().filter(on).filter(|other| *other > number) {
                let is_same = self.name(program, other).is_some_and(|name| is_same_track_name(name, track));
                let both =
                    self.cam(program, other).filter(|_| is_same).and_then(|other| first_common_position(cam, other));
                if let Some(at) = both {
                    marks.push(EditFinding::Clash { program, first: number, second: other, at });
                }
            }
        }
    }
}

/// Returns whether two names are equal, ignoring case and leading or trailing blanks.
pub(super) fn is_same_track_name(one: &str, other: &str) -> bool {
    one.trim().to_lowercase() == other.trim().to_lowercase()
}

/// Returns the first position at which both cams are on. This is always the start of one of the two.
fn first_common_position(one: Cam, other: Cam) -> Option<u32> {
    let wrapped = one.wraps_around() && other.wraps_around();
    let begins = [one.start, other.start].into_iter().filter(|at| one.is_on(*at) && other.is_on(*at));
    if wrapped { Some(0) } else { begins.map(|at| at.get()).min() }
}
