//! Plans changes. Each change is checked against the rules of the device before anything is sent. All changes are
//! followed by a single save.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::{Base, DeviceState, HiperdrivePlan, Image, Item, Op, PlanError, Service};
use crate::devices::hiperdrive::protocol::drive_parameter::{
    CONTROL, DENOMINATOR, DRIVE_REQUESTED, LOWER_LIMIT, MAXIMUM_SPEED, NUMERATOR, REFERENCE, RESET, SERVICE,
    SPEED_DENOMINATOR, SPEED_NUMERATOR, TARGET, UPPER_LIMIT,
};
use crate::devices::hiperdrive::protocol::{
    DriveNumber, ParameterAccess, ParameterNumber, PositionScale, Travel, nearest_reference,
};

/// Positions of the drives in scaled steps, parameter 107.
pub type Positions = BTreeMap<DriveNumber, i32>;

/// Plans the changes that give a device the wanted values. Only differences are written, and they are saved where
/// possible. All other values stay unchanged.
///
/// The state must contain the current values of all wanted parameters. For each drive whose scale or limits change, it
/// must contain all of parameters 154 to 160. The position is checked if it is known, and the travel if the variant is
/// known.
///
/// Parameter 152 (Requested) is set first, because setting it resets the drive, and cleared last. In between, the
/// values are written drive by drive. The position scale, the speed scale and the maximum speed come first. The limits
/// follow in an order that the drive accepts at its current position, then all other values. The position in a new
/// scale is calculated.
///
/// # Errors
/// Returns a [`PlanError`] if a change is not allowed.
pub fn plan_edits(state: &DeviceState, wanted: &Image) -> Result<HiperdrivePlan, PlanError> {
    let DeviceState { image: device, positions, .. } = state;
    let after = device.with_overlay(wanted);
    let mut writes = Vec::new();
    for (&number, &new) in &wanted.values {
        let item = Item(number);
        let old = device.get(number).ok_or(PlanError::NotRead { item })?;
        if old != new {
            check_value(number, new, state.travel(number, &after))?;
            writes.push(Write { number, old, new });
        }
    }
    let mut base = device.values_of(writes.iter().map(|write| write.number));
    let mut upper_first = Vec::new();
    for drive in after.drives() {
        let touches = |numbers: &[u16]| {
            writes
                .iter()
                .any(|write| write.number.drive() == Some(drive) && numbers.contains(&write.number.drive1_number()))
        };
        if touches(&POSITION_PARAMETERS) {
            base.extend(
                device.values_of(
                    POSITION_PARAMETERS.iter().filter_map(|number| ParameterNumber::for_drive(*number, drive)),
                ),
            );
            let order = check_position_limits(device, &after, drive, positions.get(&drive).copied())?;
            upper_first.extend((order == WriteOrder::UpperFirst).then_some(drive));
        }
    }
    writes.sort_by_key(|write| {
        let upper_first = write.number.drive().is_some_and(|drive| upper_first.contains(&drive));
        write.sort_key(upper_first)
    });
    let saves = writes.iter().any(|write| write.number.row().is_some_and(|row| row.saved));
    let mut ops: Vec<Op> = writes.into_iter().map(Write::into_operation).collect();
    ops.extend(saves.then_some(Op::Service(Service::Save)));
    let values = if ops.is_empty() { BTreeMap::new() } else { base };
    Ok(HiperdrivePlan { base: Base { values, network: None }, ops })
}

/// Plans to set the current position to a value rounded to 64 steps, and to save it. Parameter 198 is written even if
/// its value stays the same, since only the write sets the position.
///
/// # Errors
/// Returns an error if the rounded position is outside the limits or the travel of the drive, or if the drive is
/// missing.
pub fn plan_set_position(state: &DeviceState, drive: DriveNumber, position: i32) -> Result<HiperdrivePlan, PlanError> {
    let device = &state.image;
    let own = |number| ParameterNumber::for_drive(number, drive);
    let known = |number| own(number).and_then(|number| Some((number, device.get(number)?)));
    let not_read = |number| {
        let number = own(number).unwrap_or(ParameterNumber::SAVE);
        PlanError::NotRead { item: Item(number) }
    };
    let (number, old) = known(REFERENCE).ok_or_else(|| not_read(REFERENCE))?;
    let (lower, upper) = device.limits(drive).ok_or_else(|| not_read(LOWER_LIMIT))?;
    // Near the end of the 32-bit range, the next multiple of 64 may not fit.
    let becomes = nearest_reference(position).map_or(i64::from(i32::MAX) + 1, i64::from);
    if !(lower..=upper).contains(&becomes) {
        return Err(PlanError::ReferenceOutside { drive, position, becomes, lower, upper });
    }
    // After a change of scale, limits beyond the travel do not limit anything.
    if let Some(row) = number.row() {
        row.check_value(number, becomes, state.travel(number, device))?;
    }
    let values = device.values_of(POSITION_PARAMETERS.into_iter().chain([REFERENCE]).filter_map(own));
    let ops = vec![Op::Write { number, old: Some(old), new: becomes }, Op::Service(Service::Save)];
    Ok(HiperdrivePlan { base: Base { values, network: None }, ops })
}

/// Plans a service. The plan is based on all values that the device stores, because the old values cannot be read after
/// the service. Only an acknowledgement is based on no values.
pub fn plan_service(device: &Image, service: Service) -> HiperdrivePlan {
    let values = match service {
        Service::Acknowledge(_) => BTreeMap::new(),
        _ => device.values.clone(),
    };
    HiperdrivePlan { base: Base { values, network: None }, ops: vec![Op::Service(service)] }
}

/// Numbers of the parameters that must match each other: position scale and limits.
const POSITION_PARAMETERS: [u16; 4] = [NUMERATOR, DENOMINATOR, LOWER_LIMIT, UPPER_LIMIT];

#[derive(Clone, Copy)]
struct Write {
    number: ParameterNumber,
    old: i64,
    new: i64,
}

#[derive(Clone, Copy, PartialEq)]
enum WriteOrder {
    LowerFirst,
    UpperFirst,
}

impl Write {
    fn into_operation(self) -> Op {
        Op::Write { number: self.number, old: Some(self.old), new: self.new }
    }

    /// Returns the sort key of a write. The write with the lowest key comes first.
    fn sort_key(self, upper_first: bool) -> (u8, Option<DriveNumber>, u8, Reverse<bool>, u16) {
        let base = self.number.drive1_number();
        let turn = match (base, self.new) {
            (DRIVE_REQUESTED, 1) => 0,
            (DRIVE_REQUESTED, _) => 2,
            _ => 1,
        };
        let group = match base {
            NUMERATOR | DENOMINATOR => 0,
            SPEED_NUMERATOR | SPEED_DENOMINATOR => 1,
            MAXIMUM_SPEED => 2,
            LOWER_LIMIT | UPPER_LIMIT => 3,
            _ => 4,
        };
        let is_first = match base {
            UPPER_LIMIT => upper_first,
            // Between the two writes, the number of steps per turn never exceeds both its old and its new value.
            DENOMINATOR => self.new > self.old,
            _ => false,
        };
        (turn, self.number.drive(), group, Reverse(is_first), base)
    }
}

/// Checks that a parameter may be written with the given value.
fn check_value(number: ParameterNumber, value: i64, travel: Travel) -> Result<(), PlanError> {
    let item = Item(number);
    let row = number.row().ok_or(PlanError::NotRead { item })?;
    match (number.drive1_number(), row.access) {
        (CONTROL..=TARGET, _) => Err(PlanError::Moves { item }),
        (SERVICE | REFERENCE | RESET, _) => Err(PlanError::Acts { item }),
        (_, ParameterAccess::Read) => Err(PlanError::ReadOnly { item }),
        _ => Ok(row.check_value(number, value, travel).map(|_| ())?),
    }
}

/// Checks that, after all writes, the limits of a drive are in order and include its position. Returns the order in
/// which the limits must be written.
fn check_position_limits(
    device: &Image,
    after: &Image,
    drive: DriveNumber,
    position: Option<i32>,
) -> Result<WriteOrder, PlanError> {
    let missing = POSITION_PARAMETERS.into_iter().filter_map(|number| ParameterNumber::for_drive(number, drive));
    for number in missing {
        device.get(number).ok_or(PlanError::NotRead { item: Item(number) })?;
    }
    // All four values are known here.
    let (Some((lower, upper)), Some(new), Some((_, old_upper))) =
        (after.limits(drive), after.scale(drive), device.limits(drive))
    else {
        return Ok(WriteOrder::LowerFirst);
    };
    if lower >= upper {
        return Err(PlanError::LimitsCrossed { drive, lower, upper });
    }
    let position = position.zip(device.scale(drive)).map(|(position, old)| rescale_position(position, old, new));
    if let Some(position) = position {
        if i32::try_from(position).is_err() {
            return Err(PlanError::PositionTooLarge { drive, position });
        }
        if !(lower..=upper).contains(&position) {
            return Err(PlanError::PositionOutside { drive, position, lower, upper });
        }
    }
    // The new lower limit would be above the old upper limit, or the drive would be outside the limits.
    let too_low = old_upper <= lower || position.is_some_and(|position| position > old_upper);
    Ok(if too_low { WriteOrder::UpperFirst } else { WriteOrder::LowerFirst })
}

/// Converts a position of a drive to another scale, which has 256 · numerator / denominator steps per turn. The result
/// is rounded down, as the drive does.
fn rescale_position(position: i32, old: PositionScale, new: PositionScale) -> i64 {
    let times = i128::from(new.numerator()) * i128::from(old.denominator());
    let by = i128::from(new.denominator()) * i128::from(old.numerator());
    let steps = (i128::from(position) * times).div_euclid(by);
    // The product is at most 2^31 · 2^32.
    i64::try_from(steps).unwrap_or(if steps < 0 { i64::MIN } else { i64::MAX })
}

#[cfg(test)]
mod tests;
