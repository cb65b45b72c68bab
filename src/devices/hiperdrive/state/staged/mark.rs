//! Findings about the edited values, with the parameters they concern.

use super::{StagedEdits, travel};
use crate::devices::hiperdrive::profile::Image;
use crate::devices::hiperdrive::protocol::drive_parameter::{
    DENOMINATOR, LOWER_LIMIT, NO_TIMEOUT, NUMERATOR, TIMEOUT, UPPER_LIMIT,
};
use crate::devices::hiperdrive::protocol::{DriveNumber, OutOfRange, ParameterNumber, PositionScale, Travel};
use crate::devices::hiperdrive::state::ruler::Ruler;

/// A finding about edited values that the user should check, for example that a new scale moves the limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EditFinding {
    /// A value from a profile or a stored edit is not allowed.
    OutOfRange(OutOfRange),
    /// The upper limit is not greater than the lower limit.
    Crossed { drive: DriveNumber, lower: i64, upper: i64 },
    /// The drive is outside its edited limits and would therefore reject them.
    Outside { drive: DriveNumber, position: i64, lower: i64, upper: i64 },
    /// The scale was changed without the numeric limits, so that these now stand for other positions.
    LimitsMove { drive: DriveNumber, lower: (f64, f64), upper: (f64, f64) },
    /// Parameter 186 (time-out) is 255, so the drive does not stop when the connection is lost. This program will
    /// refuse to move it.
    NoTimeout { drive: DriveNumber },
}

impl EditFinding {
    pub fn parameters(&self) -> Vec<ParameterNumber> {
        let of = |drive, numbers: &[u16]| {
            numbers.iter().filter_map(|own| ParameterNumber::for_drive(*own, drive)).collect::<Vec<_>>()
        };
        match self {
            EditFinding::OutOfRange(error) => vec![error.number],
            EditFinding::Crossed { drive, .. } | EditFinding::Outside { drive, .. } => {
                of(*drive, &[LOWER_LIMIT, UPPER_LIMIT])
            }
            EditFinding::LimitsMove { drive, .. } => of(*drive, &[NUMERATOR, DENOMINATOR, LOWER_LIMIT, UPPER_LIMIT]),
            EditFinding::NoTimeout { drive } => of(*drive, &[TIMEOUT]),
        }
    }
}

impl StagedEdits {
    /// Returns all findings about the edited values. `position` returns the position of a drive in steps of its current
    /// scale.
    pub fn findings(&self, position: impl Fn(DriveNumber) -> Option<i64>) -> Vec<EditFinding> {
        let Some((base, wanted)) = self.base.as_ref().zip(self.wanted.as_ref()) else { return Vec::new() };
        let mut of_drives = Vec::new();
        for drive in wanted.drives() {
            collect_drive_findings(base, wanted, drive, position(drive), &mut of_drives);
        }
        let moved: Vec<ParameterNumber> = of_drives
            .iter()
            .filter(|mark| matches!(mark, EditFinding::LimitsMove { .. }))
            .flat_map(EditFinding::parameters)
            .collect();
        let check = |(number, value): (&ParameterNumber, &i64)| {
            // Limits that moved with the scale are already reported, in turns.
            let moves = moved.contains(number);
            let travel = if moves { Travel::UNKNOWN } else { travel(*number, wanted, &self.families) };
            number.row()?.check_value(*number, *value, travel).err()
        };
        let mut marks: Vec<EditFinding> = wanted.values.iter().filter_map(check).map(EditFinding::OutOfRange).collect();
        marks.extend(of_drives);
        marks
    }
}

fn collect_drive_findings(
    base: &Image,
    wanted: &Image,
    drive: DriveNumber,
    position: Option<i64>,
    marks: &mut Vec<EditFinding>,
) {
    let now = base.scale(drive).unwrap_or(PositionScale::FACTORY);
    let scale = wanted.scale(drive).unwrap_or(now);
    if let Some((lower, upper)) = wanted.limits(drive) {
        let position = position.map(|own| Ruler { scale: now, pitch: None }.rescale_position(own, scale));
        if lower >= upper {
            marks.push(EditFinding::Crossed { drive, lower, upper });
        } else if let Some(position) = position.filter(|own| !(lower..=upper).contains(own)) {
            marks.push(EditFinding::Outside { drive, position, lower, upper });
        }
        if scale != now && base.limits(drive) == Some((lower, upper)) {
            let turns = |steps: i64| (steps as f64 / now.steps_per_turn(), steps as f64 / scale.steps_per_turn());
            marks.push(EditFinding::LimitsMove { drive, lower: turns(lower), upper: turns(upper) });
        }
    }
    if wanted.for_drive(drive, TIMEOUT) == Some(NO_TIMEOUT) {
        marks.push(EditFinding::NoTimeout { drive });
    }
}
