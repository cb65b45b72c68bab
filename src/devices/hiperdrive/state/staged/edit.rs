//! The edits: what each makes of what is wanted, and why it may not be.

use super::{Families, Ground, is_editable, travel};
use crate::devices::hiperdrive::profile::Image;
use crate::devices::hiperdrive::protocol::drive_parameter::{DENOMINATOR, LOWER, NUMERATOR, UPPER};
use crate::devices::hiperdrive::protocol::{DriveNumber, OutOfRange, ParameterNumber, PositionScale};
use crate::devices::hiperdrive::state::ruler::Ruler;

/// A change. Each is one step, however much it changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edit {
    Set(ParameterNumber, i64),
    /// A parameter stays as it is, or as the profile says.
    Revert(ParameterNumber),
    /// The profile is to say nothing about a parameter.
    Leave(ParameterNumber),
    /// Both limits of a drive at once, where one after the other would not go.
    Limits {
        /// Whose.
        drive: DriveNumber,
        /// In steps as they are wanted to be scaled.
        lower: i64,
        /// Likewise.
        upper: i64,
    },
    /// Another scale of a drive's positions.
    Scale {
        /// Whose.
        drive: DriveNumber,
        /// Steps a turn.
        scale: PositionScale,
        /// How its limits change.
        limits: LimitsStay,
    },
}

/// How limits change when the size of a step does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitsStay {
    /// They stay where they are: their numbers become other ones.
    InPlace,
    /// Their numbers stay: they lie elsewhere.
    AsNumbers,
}

/// Why something cannot be changed. Nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// Nothing is known of the device.
    #[error("nothing has been read yet")]
    NothingRead,
    /// The manual has no such parameter.
    #[error("there is no parameter {0}")]
    Unknown(ParameterNumber),
    /// Nothing is known of this one.
    #[error("parameter {0} has not been read")]
    NotRead(ParameterNumber),
    /// It can only be read, or does something and keeps nothing.
    #[error("parameter {0} is not set as a value")]
    NotAValue(ParameterNumber),
    /// Beyond what it may be.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// The upper limit has to be above the lower one.
    #[error("the lower limit {lower} is not below the upper limit {upper}")]
    Crossed {
        /// As given.
        lower: i64,
        /// As given.
        upper: i64,
    },
}

/// Returns the values after an edit.
pub(super) fn edited(
    (base, wanted): (&Image, &Image),
    edit: &Edit,
    ground: Ground,
    families: &Families,
) -> Result<Image, EditError> {
    let mut after = wanted.clone();
    match *edit {
        Edit::Set(number, value) => set(&mut after, number, value, ground, families)?,
        Edit::Revert(number) => {
            match base.get(number) {
                Some(value) => after.values.insert(number, value),
                None => after.values.remove(&number),
            };
        }
        Edit::Leave(number) if ground == Ground::Profile => {
            after.values.remove(&number);
        }
        Edit::Leave(number) => return Err(EditError::NotAValue(number)),
        Edit::Limits { drive, lower, upper } => {
            if lower >= upper {
                return Err(EditError::Crossed { lower, upper });
            }
            put(&mut after, drive, [(LOWER, lower), (UPPER, upper)], ground, families)?;
        }
        Edit::Scale { drive, scale, limits } => {
            let before = wanted.scale(drive).unwrap_or(PositionScale::FACTORY);
            let parts = [(NUMERATOR, i64::from(scale.numerator())), (DENOMINATOR, i64::from(scale.denominator()))];
            put(&mut after, drive, parts, ground, families)?;
            if let (LimitsStay::InPlace, Some((lower, upper))) = (limits, wanted.limits(drive)) {
                let ruler = Ruler { scale: before, pitch: None };
                let moved = [(LOWER, ruler.rescaled(lower, scale)), (UPPER, ruler.rescaled(upper, scale))];
                put(&mut after, drive, moved, ground, families)?;
            }
        }
    }
    Ok(after)
}

fn put<const N: usize>(
    after: &mut Image,
    drive: DriveNumber,
    values: [(u16, i64); N],
    ground: Ground,
    families: &Families,
) -> Result<(), EditError> {
    for (number, value) in values {
        if let Some(number) = ParameterNumber::of_drive(number, drive) {
            set(after, number, value, ground, families)?;
        }
    }
    Ok(())
}

fn set(
    after: &mut Image,
    number: ParameterNumber,
    value: i64,
    ground: Ground,
    families: &Families,
) -> Result<(), EditError> {
    let row = number.row().ok_or(EditError::Unknown(number))?;
    if !is_editable(row) || ground == Ground::Profile && !Image::holds(row) {
        return Err(EditError::NotAValue(number));
    }
    if ground == Ground::Device && after.get(number).is_none() {
        return Err(EditError::NotRead(number));
    }
    let value = row.check(number, value, travel(number, after, families))?;
    after.values.insert(number, value);
    Ok(())
}
