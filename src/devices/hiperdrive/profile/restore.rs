//! Plans a restore. Only differences are written, followed by a single save. The reference of a drive is never written,
//! since it is valid for one machine only.

pub use crate::profile::RestoreOptions;

use super::{
    HiperdrivePlan, HiperdriveProfile, Image, Item, PlanError, Positions, ProfileDrive, ProfileIdentity, TypeMismatch,
    plan_edits,
};
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;
use crate::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber, Travel};

/// Current state of a device, as far as planning needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceState {
    /// Identity of the device.
    pub identity: ProfileIdentity,
    /// Stored values.
    pub image: Image,
    /// Positions of the drives.
    pub positions: Positions,
}

impl DeviceState {
    /// Returns the travel of the drive to which a parameter belongs, in steps of the scale in `image`.
    pub(super) fn travel(&self, number: ParameterNumber, image: &Image) -> Travel {
        let Some(drive) = number.drive() else { return Travel::UNKNOWN };
        Travel { family: find_drive(&self.identity, drive).and_then(ProfileDrive::family), scale: image.scale(drive) }
    }
}

/// Result of planning a restore.
pub type Restore = crate::profile::Restore<HiperdrivePlan, Item>;

/// Plans a restore for the ports that exist both in the profile and on the device. On another device, values that
/// depend on how a drive is mounted are omitted: the items marked by the user and the reference (parameter 198), which
/// is never written.
///
/// # Errors
/// Returns a [`PlanError`] if the restore is not possible. Nothing is written in this case.
pub fn plan_restore(
    profile: &HiperdriveProfile,
    device: &DeviceState,
    options: RestoreOptions,
) -> Result<Restore, PlanError> {
    check_allowed(profile, &device.identity, options)?;
    let mut wanted = Image::default();
    let (mut unchanged, mut missing) = (0, Vec::new());
    let (mut mounting_left, mut mounting_written) = (Vec::new(), Vec::new());
    for (&number, &to) in &profile.image.values {
        let item = Item(number);
        match device.image.get(number) {
            None => missing.push(item.to_string()),
            Some(from) if from == to => unchanged += 1,
            Some(_) if keeps_device_value(profile, &device.identity, item, options) => mounting_left.push(item),
            Some(_) => {
                if is_from_different_mounting(profile, &device.identity, item) {
                    mounting_written.push(item);
                }
                wanted.values.insert(number, to);
            }
        }
    }
    let plan = plan_edits(device, &wanted)?;
    Ok(Restore { plan, unchanged, missing, mounting_left, mounting_written })
}

/// Checks that the adapter or hub and its drives have the types and serial numbers in the profile. A profile without an
/// identity fits any device. A drive may be missing.
///
/// # Errors
/// Returns [`PlanError::TypeMismatch`], [`PlanError::OtherDevice`] or [`PlanError::OtherDrive`] for the first
/// difference.
pub fn check_device(profile: &HiperdriveProfile, device: &ProfileIdentity) -> Result<(), PlanError> {
    check_allowed(profile, device, RestoreOptions::default())
}

/// Returns the type mismatches between a profile and a device: first that of the device itself, then those of its
/// drives.
pub fn type_differences(profile: &ProfileIdentity, device: &ProfileIdentity) -> Vec<TypeMismatch> {
    let whole = profile.topology.zip(device.topology).filter(|(profile, device)| profile != device);
    let drives = profile.drives.iter().filter_map(|own| {
        let (profile, device) = own.variant.zip(find_drive(device, own.number)?.variant)?;
        (profile != device).then_some(TypeMismatch::Drive { drive: own.number, profile, device })
    });
    whole.into_iter().map(|(profile, device)| TypeMismatch::Device { profile, device }).chain(drives).collect()
}

/// Checks that the device is the one in the profile, unless the options allow another device or type.
fn check_allowed(
    profile: &HiperdriveProfile,
    device: &ProfileIdentity,
    options: RestoreOptions,
) -> Result<(), PlanError> {
    if let Some(first) = type_differences(&profile.identity, device).first().filter(|_| !options.allow_other_type) {
        return Err((*first).into());
    }
    if options.allow_other_device {
        return Ok(());
    }
    let (of_profile, of_device) = (&profile.identity.serial_number, &device.serial_number);
    if !of_profile.is_empty() && of_profile != of_device {
        return Err(PlanError::OtherDevice { profile: of_profile.clone(), device: of_device.clone() });
    }
    for own in &profile.identity.drives {
        let Some(there) = find_drive(device, own.number) else { continue };
        if !own.serial_number.is_empty() && own.serial_number != there.serial_number {
            let (profile, device) = (own.serial_number.clone(), there.serial_number.clone());
            return Err(PlanError::OtherDrive { drive: own.number, profile, device });
        }
    }
    Ok(())
}

fn keeps_device_value(
    profile: &HiperdriveProfile,
    device: &ProfileIdentity,
    item: Item,
    options: RestoreOptions,
) -> bool {
    item.0.drive1_number() == REFERENCE || !options.with_mounting && is_from_different_mounting(profile, device, item)
}

/// Returns whether an item depends on how a drive is mounted and the profile is not from this drive.
fn is_from_different_mounting(profile: &HiperdriveProfile, device: &ProfileIdentity, item: Item) -> bool {
    profile.depends_on_mounting(item) && !is_same_location(profile, device, item)
}

/// Returns whether the profile is from this device and, for a drive parameter, from this drive.
fn is_same_location(profile: &HiperdriveProfile, device: &ProfileIdentity, item: Item) -> bool {
    let types = type_differences(&profile.identity, device);
    let is_other = |own: &TypeMismatch| match own {
        TypeMismatch::Device { .. } => true,
        TypeMismatch::Drive { drive, .. } => item.0.drive() == Some(*drive),
    };
    if types.iter().any(is_other) {
        return false;
    }
    let same = |one: &str, other: &str| !one.is_empty() && one == other;
    let serial = |drive: Option<&ProfileDrive>| drive.map_or_else(String::new, |drive| drive.serial_number.clone());
    same(&profile.identity.serial_number, &device.serial_number)
        && item.0.drive().is_none_or(|drive| same(&serial(profile.drive(drive)), &serial(find_drive(device, drive))))
}

fn find_drive(device: &ProfileIdentity, number: DriveNumber) -> Option<&ProfileDrive> {
    device.drives.iter().find(|drive| drive.number == number)
}

#[cfg(test)]
mod tests;
