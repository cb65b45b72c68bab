//! Reads the parameters that limit the motion of a drive, either all at once or group by group.

use super::identify::drive_parameter;
use super::{Error, Master};
use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::devices::hiperdrive::protocol::drive_parameter::{
    DENOMINATOR, DRIVE_REQUESTED, LOWER_LIMIT, NUMERATOR, REFERENCE, TIMEOUT, UPPER_LIMIT,
};

/// Parameters that limit the motion of a drive. A parameter that was not read is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MotionLimitParameters {
    /// Parameter 152 (Requested). Only a requested drive can move.
    pub requested: Option<i64>,
    /// Numerator and denominator of the position scale, parameters 154 and 156.
    pub scale: Option<(i64, i64)>,
    /// Lower and upper limit in scaled steps, parameters 158 and 160.
    pub limits: Option<(i64, i64)>,
    /// RS-485 time-out, parameter 186.
    pub timeout: Option<i64>,
    /// Reference (parameter 198), the position number assigned to a location of the axis. A change of the reference
    /// shifts every position.
    pub reference: Option<i64>,
}

impl MotionLimitParameters {
    /// Creates the value from parameters, which `read` returns by their numbers for drive 1.
    pub fn from_parameters(read: impl Fn(u16) -> Option<i64>) -> Self {
        MotionLimitParameters {
            requested: read(DRIVE_REQUESTED),
            scale: read(NUMERATOR).zip(read(DENOMINATOR)),
            limits: read(LOWER_LIMIT).zip(read(UPPER_LIMIT)),
            timeout: read(TIMEOUT),
            reference: read(REFERENCE),
        }
    }
}

/// Reads the parameters that limit a drive's motion.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn read_rules(master: &mut Master<'_>, drive: DriveNumber) -> Result<MotionLimitParameters, Error> {
    let mut values = Vec::new();
    for base in [DRIVE_REQUESTED, NUMERATOR, DENOMINATOR, LOWER_LIMIT, UPPER_LIMIT, TIMEOUT, REFERENCE] {
        match master.read_number(drive_parameter(base, drive)?) {
            Ok(value) => values.push((base, value)),
            Err(error) if error.is_unavailable() => {}
            Err(error) => return Err(error),
        }
    }
    Ok(MotionLimitParameters::from_parameters(|wanted| {
        values.iter().find(|(base, _)| *base == wanted).map(|(_, value)| *value)
    }))
}

/// Number of groups in which the limit parameters of a drive are read again. Related parameters are in the same group.
pub const GROUPS: usize = 4;

/// Reads one group of the limit parameters of a drive again.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn read_rule_group(
    master: &mut Master<'_>,
    drive: DriveNumber,
    known: MotionLimitParameters,
    group: usize,
) -> Result<MotionLimitParameters, Error> {
    let mut read = |base| match master.read_number(drive_parameter(base, drive)?) {
        Ok(value) => Ok(Some(value)),
        Err(error) if error.is_unavailable() => Ok(None),
        Err(error) => Err(error),
    };
    Ok(match group % GROUPS {
        0 => MotionLimitParameters { requested: read(DRIVE_REQUESTED)?, ..known },
        1 => MotionLimitParameters { timeout: read(TIMEOUT)?, ..known },
        2 => MotionLimitParameters { scale: read(NUMERATOR)?.zip(read(DENOMINATOR)?), ..known },
        _ => MotionLimitParameters {
            limits: read(LOWER_LIMIT)?.zip(read(UPPER_LIMIT)?),
            reference: read(REFERENCE)?,
            ..known
        },
    })
}
