//! Edits of parameter values, and the reasons for rejecting them.

use super::{BaseSource, Families, is_editable, travel};
use crate::devices::hiperdrive::profile::Image;
use crate::devices::hiperdrive::protocol::drive_parameter::{DENOMINATOR, LOWER_LIMIT, NUMERATOR, UPPER_LIMIT};
use crate::devices::hiperdrive::protocol::{DriveNumber, OutOfRange, ParameterNumber, PositionScale};
use crate::devices::hiperdrive::state::ruler::Ruler;

/// An edit. However much it changes, it is a single undo step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edit {
    Set(ParameterNumber, i64),
    /// Reverts a parameter to its original value from the device or the profile.
    Revert(ParameterNumber),
    Leave(ParameterNumber),
    /// Sets both limits of a drive at once, where setting one after the other would be rejected.
    Limits {
        drive: DriveNumber,
        /// Lower limit in steps of the edited scale.
        lower: i64,
        upper: i64,
    },
    Scale {
        drive: DriveNumber,
        /// New position scale.
        scale: PositionScale,
        limits: LimitsPolicy,
    },
}

/// What happens to the limits when the size of a step changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitsPolicy {
    InPlace,
    AsNumbers,
}

/// Reason for rejecting an edit. Nothing has changed in this case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// No values of the device have been read.
    #[error("nothing has been read yet")]
    NothingRead,
    /// The manual does not list a parameter with this number.
    #[error("parameter {0} does not exist")]
    Unknown(ParameterNumber),
    /// The value of this parameter has not been read.
    #[error("parameter {0} has not been read")]
    NotRead(ParameterNumber),
    /// The parameter is read-only, or it triggers an action and has no stored value.
    #[error("parameter {0} is an action and cannot be set as a value")]
    NotAValue(ParameterNumber),
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// The upper limit would not be greater than the lower limit.
    #[error("the lower limit {lower} is not below the upper limit {upper}")]
    Crossed { lower: i64, upper: i64 },
}

pub(super) fn apply_edit(
    (base, wanted): (&Image, &Image),
    edit: &Edit,
    ground: BaseSource,
    families: &Families,
) -> Result<Image, EditError> {
    let mut after = wanted.clone();
    match *edit {
        Edit::Set(number, value) => set_value(&mut after, number, value, ground, families)?,
        Edit::Revert(number) => {
            match base.get(number) {
                Some(value) => after.values.insert(number, value),
                None => after.values.remove(&number),
            };
        }
        Edit::Leave(number) if ground == BaseSource::Profile => {
            after.values.remove(&number);
        }
        Edit::Leave(number) => return Err(EditError::NotAValue(number)),
        Edit::Limits { drive, lower, upper } => {
            if lower >= upper {
                return Err(EditError::Crossed { lower, upper });
            }
            set_drive_values(&mut after, drive, [(LOWER_LIMIT, lower), (UPPER_LIMIT, upper)], ground, families)?;
        }
        Edit::Scale { drive, scale, limits } => {
            let before = wanted.scale(drive).unwrap_or(PositionScale::FACTORY);
            let parts = [(NUMERATOR, i64::from(scale.numerator())), (DENOMINATOR, i64::from(scale.denominator()))];
            set_drive_values(&mut after, drive, parts, ground, families)?;
            if let (LimitsPolicy::InPlace, Some((lower, upper))) = (limits, wanted.limits(drive)) {
                let ruler = Ruler { scale: before, pitch: None };
                let moved = [
                    (LOWER_LIMIT, ruler.rescale_position(lower, scale)),
                    (UPPER_LIMIT, ruler.rescale_position(upper, scale)),
                ];
                set_drive_values(&mut after, drive, moved, ground, families)?;
            }
        }
    }
    Ok(after)
}

fn set_drive_values<const N: usize>(
    after: &mut Image,
    drive: DriveNumber,
    values: [(u16, i64); N],
    ground: BaseSource,
    families: &Families,
) -> Result<(), EditError> {
    for (number, value) in values {
        if let Some(number) = ParameterNumber::for_drive(number, drive) {
            set_value(after, number, value, ground, families)?;
        }
    }
    Ok(())
}

fn set_value(
    after: &mut Image,
    number: ParameterNumber,
    value: i64,
    ground: BaseSource,
    families: &Families,
) -> Result<(), EditError> {
    let row = number.row().ok_or(EditError::Unknown(number))?;
    if !is_editable(row) || ground == BaseSource::Profile && !Image::contains_row(row) {
        return Err(EditError::NotAValue(number));
    }
    if ground == BaseSource::Device && after.get(number).is_none() {
        return Err(EditError::NotRead(number));
    }
    let value = row.check_value(number, value, travel(number, after, families))?;
    after.values.insert(number, value);
    Ok(())
}
