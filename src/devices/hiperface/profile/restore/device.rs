//! Checks whether a profile was read from this encoder.

use super::{PlanError, RestoreOptions};
use crate::devices::hiperface::profile::HiperfaceProfile;

/// Checks that the profile was read from this encoder. An encoder without a serial number always fails the check.
///
/// # Errors
/// Returns [`PlanError::OtherDevice`] or [`PlanError::TypeMismatch`] if the profile was read from another encoder.
pub fn check_device(profile: &HiperfaceProfile, serial_number: &str, encoder_type: u8) -> Result<(), PlanError> {
    if !is_same_device(profile, serial_number) {
        return Err(PlanError::OtherDevice {
            profile: profile.identity.serial_number.clone(),
            device: serial_number.to_owned(),
        });
    }
    // Encoders of different types may have the same serial number.
    if profile.identity.encoder_type != encoder_type {
        return Err(PlanError::TypeMismatch { profile: profile.identity.encoder_type, device: encoder_type });
    }
    Ok(())
}

/// Checks that the profile was read from this encoder, unless the options allow another encoder.
///
/// # Errors
/// Returns [`PlanError::TypeMismatch`] or [`PlanError::OtherDevice`] if the encoder is not allowed.
pub fn check_allowed(
    profile: &HiperfaceProfile,
    serial_number: &str,
    encoder_type: u8,
    options: &RestoreOptions,
) -> Result<(), PlanError> {
    if !options.allow_other_type && profile.identity.encoder_type != encoder_type {
        return Err(PlanError::TypeMismatch { profile: profile.identity.encoder_type, device: encoder_type });
    }
    match check_device(profile, serial_number, encoder_type) {
        Err(error @ PlanError::OtherDevice { .. }) if !options.allow_other_device => Err(error),
        _ => Ok(()),
    }
}

fn is_same_device(profile: &HiperfaceProfile, serial_number: &str) -> bool {
    !serial_number.is_empty() && profile.identity.serial_number == serial_number
}
