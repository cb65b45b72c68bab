//! What the commands about profiles do with an INTERBUS encoder.

use crate::profile::interbus;
use crate::profile::{Body, Comparison, ProfileError};

/// What differs between two profiles.
pub(super) fn compare(left: &Body, right: &Body) -> Result<Comparison, ProfileError> {
    Ok(interbus::compare(&left.clone().into_interbus()?, &right.clone().into_interbus()?))
}

/// That two profiles are not of the same encoder. One without a serial number is of none.
pub(super) fn other_device(profile: &Body, device: &Body) -> Option<String> {
    let (profile, device) = (&profile.interbus()?.identity.serial_number, &device.interbus()?.identity.serial_number);
    (!profile.is_empty() && profile != device)
        .then(|| format!("The profile is of serial number {profile}, the encoder has {device}."))
}
