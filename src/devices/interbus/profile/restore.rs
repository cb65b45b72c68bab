//! Plans a restore. Only differences are written, in as few EEPROM write cycles as possible. Values that depend on the
//! mounting of another encoder are left out. A preset is stored but never executed.

pub use crate::profile::RestoreOptions;

use super::{Image, InterbusPlan, InterbusProfile, Item, PlanError, ProfileIdentity, TypeMismatch, plan_edits};
use crate::devices::interbus::protocol::{Flags, OutOfRange, ProgramNumber};

/// The current state of an encoder, for which a restore is planned.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceState {
    /// Identity of the encoder.
    pub identity: ProfileIdentity,
    /// EEPROM content, with at least the programs listed by [`programs_to_read`]. It contains the window shift if any
    /// program was read.
    pub image: Image,
}

/// Result of planning a restore.
pub type Restore = crate::profile::Restore<InterbusPlan, Item>;

/// Returns the programs that must be read before a restore of this profile can be planned. The window shift is read
/// with a program. If the profile contains only the shift, the first program is read.
pub fn programs_to_read(profile: &InterbusProfile) -> Vec<ProgramNumber> {
    let of_cams = profile.image.known_programs().map(|(number, _)| number);
    let all: Vec<ProgramNumber> = of_cams.collect();
    match profile.image.shift {
        Some(_) if all.is_empty() => ProgramNumber::all().take(1).collect(),
        _ => all,
    }
}

/// Plans a restore without writing anything.
///
/// # Errors
/// Returns a [`PlanError`] if the encoder does not match the profile or a value is invalid.
pub fn plan_restore(
    profile: &InterbusProfile,
    device: &DeviceState,
    options: RestoreOptions,
) -> Result<Restore, PlanError> {
    check_allowed(profile, &device.identity, options)?;
    let is_other = !is_same_device(profile, &device.identity);
    let mut wanted = Image::from_parameters(device.image.parameters);
    let (mut unchanged, mut missing) = (0, Vec::new());
    let (mut mounting_left, mut mounting_written) = (Vec::new(), Vec::new());
    for item in profile.items() {
        let (Some(to), Some(from)) = (profile.image.get_value(item), device.image.get_value(item)) else {
            missing.push(item.to_string());
            continue;
        };
        if to == from {
            unchanged += 1;
        } else if is_other && profile.depends_on_mounting(item) {
            if options.with_mounting { &mut mounting_written } else { &mut mounting_left }.push(item);
        }
        wanted.set_value(item, if mounting_left.last() == Some(&item) { from } else { to });
    }
    let plan = plan_edits(&device.image, &wanted).map_err(|error| match error {
        PlanError::OutOfRange(refused) => match Item::from_parameter(refused.parameter) {
            Some(item) if mounting_left.contains(&item) => {
                let OutOfRange { value, low, high, .. } = refused;
                PlanError::MountingLeft { item, value, low, high }
            }
            _ => PlanError::OutOfRange(refused),
        },
        other => other,
    })?;
    Ok(Restore { plan, unchanged, missing, mounting_left, mounting_written })
}

/// Checks that an encoder matches the profile. A profile without a serial number matches any encoder.
///
/// # Errors
/// Returns [`PlanError::TypeMismatch`] or [`PlanError::OtherDevice`] if the encoder does not match.
pub fn check_device(profile: &InterbusProfile, device: &ProfileIdentity) -> Result<(), PlanError> {
    check_allowed(profile, device, RestoreOptions::default())
}

/// Returns the types of a profile and an encoder if they differ, or `None` if they are equal or one is unknown.
pub fn other_type(profile: &ProfileIdentity, device: &ProfileIdentity) -> Option<TypeMismatch> {
    let (profile, device) = profile.flags.zip(device.flags)?;
    let what = |flags: Flags| (flags.counts_turns(), flags.steps_minus_one());
    (what(profile) != what(device)).then_some(TypeMismatch { profile, device })
}

/// Checks that an encoder matches the profile, unless the options allow the mismatch.
///
/// # Errors
/// Returns an error from [`check_device`] if the encoder does not match.
pub fn check_allowed(
    profile: &InterbusProfile,
    device: &ProfileIdentity,
    options: RestoreOptions,
) -> Result<(), PlanError> {
    if let Some(error) = other_type(&profile.identity, device).filter(|_| !options.allow_other_type) {
        return Err(error.into());
    }
    let is_of_none = profile.identity.serial_number.is_empty();
    if options.allow_other_device || is_of_none || has_same_serial_number(profile, device) {
        return Ok(());
    }
    Err(PlanError::OtherDevice {
        profile: profile.identity.serial_number.clone(),
        device: device.serial_number.clone(),
    })
}

fn is_same_device(profile: &InterbusProfile, device: &ProfileIdentity) -> bool {
    has_same_serial_number(profile, device) && other_type(&profile.identity, device).is_none()
}

fn has_same_serial_number(profile: &InterbusProfile, device: &ProfileIdentity) -> bool {
    !device.serial_number.is_empty() && profile.identity.serial_number == device.serial_number
}

#[cfg(test)]
mod tests;
