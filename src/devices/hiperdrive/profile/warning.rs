//! Warnings about a plan before its execution.

use super::network::SWITCH;
use super::{HiperdrivePlan, Image, Item, written_values};
use crate::devices::hiperdrive::protocol::drive_parameter::{
    DRIVE_REQUESTED, NO_TIMEOUT, RS485_ADDRESS, RS485_BAUD, RS485_COMPLETE, TIMEOUT,
};
use crate::devices::hiperdrive::protocol::{AddressSwitch, DriveNumber, ParameterNumber, PositionScale};

/// A side effect of a plan that the user is warned about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Warning {
    /// The scale changes, so that the same limits stand for different positions in turns (reference, section 3,
    /// *Scaling moves soft limits*).
    LimitsMove {
        /// Number of the drive.
        drive: DriveNumber,
        /// Current lower and upper limits, in turns.
        now: (f64, f64),
        /// Lower and upper limits after the plan, in turns.
        then: (f64, f64),
    },
    /// The change takes effect at the next reset (47 = −4 or a supply cycle).
    AfterReset(Item),
    /// The time-out is disabled (186 = 255), so this program will refuse to move the drive.
    NoTimeout(DriveNumber),
    /// Parameter 152 (Requested) becomes 0, so that the drive can no longer be moved over the bus.
    NotRequested(DriveNumber),
    /// The address switch of the device overrides the setting.
    SwitchDecides(AddressSwitch),
}

/// Returns all warnings of a plan.
pub fn plan_warnings(plan: &HiperdrivePlan) -> Vec<Warning> {
    let (now, written) = (plan.base.image(), written_values(plan));
    let then = now.with_overlay(&written);
    let mut warnings: Vec<Warning> =
        then.drives().into_iter().filter_map(|drive| moved_limits_warning(&now, &then, drive)).collect();
    for (&number, &new) in &written.values {
        warnings.extend(match (number.drive1_number(), number.drive(), new) {
            (DRIVE_REQUESTED, Some(drive), 0) => Some(Warning::NotRequested(drive)),
            (TIMEOUT, Some(drive), NO_TIMEOUT) => Some(Warning::NoTimeout(drive)),
            (RS485_ADDRESS | RS485_BAUD | RS485_COMPLETE, ..) => Some(Warning::AfterReset(Item(number))),
            _ => None,
        });
    }
    let switch = plan.base.network.as_ref().and(ParameterNumber::new(SWITCH)).and_then(|number| now.get(number));
    let switch = switch.and_then(|digits| AddressSwitch::parse(u8::try_from(digits).ok()?));
    warnings.extend(switch.filter(|switch| *switch != AddressSwitch::Object).map(Warning::SwitchDecides));
    warnings
}

/// Returns a warning if a new scale moves the limits of a drive by more than one step.
fn moved_limits_warning(now: &Image, then: &Image, drive: DriveNumber) -> Option<Warning> {
    let (before, after) = (now.scale(drive)?, then.scale(drive)?);
    if before == after {
        return None;
    }
    let turns = |image: &Image, scale: PositionScale| {
        // Limits have 32 bits, so the conversion is exact.
        let turns = |steps: i64| steps as f64 / scale.steps_per_turn();
        image.limits(drive).map(|(lower, upper)| (turns(lower), turns(upper)))
    };
    let (now, then) = (turns(now, before)?, turns(then, after)?);
    let step = 1.0 / before.steps_per_turn().min(after.steps_per_turn());
    let is_elsewhere = |now: f64, then: f64| (now - then).abs() > step;
    (is_elsewhere(now.0, then.0) || is_elsewhere(now.1, then.1)).then_some(Warning::LimitsMove { drive, now, then })
}
