//! Reads the values that are saved or needed for planning.

use super::identify::{IdentifyProgress, drive_parameter, identify};
use super::{DriveIdentity, Error, Identity, Master};
use crate::devices::hiperdrive::profile::{
    DeviceState, HiperdriveProfile, Image, Positions, ProfileDrive, ProfileIdentity,
};
use crate::devices::hiperdrive::protocol::drive_parameter::POSITION;
use crate::devices::hiperdrive::protocol::{PARAMETERS, ParameterNumber};
use crate::profile::UnknownValues;

impl Identity {
    pub fn profile(&self) -> ProfileIdentity {
        let drive = |drive: &DriveIdentity| ProfileDrive {
            variant: Some(drive.variant),
            name: drive.name.clone(),
            article_number: drive.article_number.clone(),
            serial_number: drive.serial_number.clone(),
            version: drive.version.clone(),
            ..ProfileDrive::unknown_drive(drive.number)
        };
        ProfileIdentity {
            topology: Some(self.topology),
            name: self.name.clone(),
            article_number: self.article_number.clone(),
            serial_number: self.serial_number.clone(),
            version: self.version.clone(),
            drives: self.drives.iter().map(drive).collect(),
            unknown: UnknownValues::new(),
        }
    }

    /// Returns the numbers of all parameters that a device stores for itself and its connected drives.
    pub fn stored_parameters(&self) -> impl Iterator<Item = ParameterNumber> {
        let rows = || PARAMETERS.iter().filter(|row| Image::contains_row(row));
        let device = rows().filter(|row| row.number < 100).filter_map(|row| ParameterNumber::new(row.number));
        let drives = self
            .drives
            .iter()
            .flat_map(move |drive| rows().filter_map(|row| ParameterNumber::for_drive(row.number, drive.number)));
        device.chain(drives)
    }
}

/// Reads all values that can be restored. Values that the device does not report are omitted.
///
/// # Errors
/// Returns [`Error::NotHiperdrive`] for another device, or another error if the exchange fails.
pub fn save(master: &mut Master<'_>, progress: IdentifyProgress<'_>) -> Result<HiperdriveProfile, Error> {
    let identity = identify(master, progress)?;
    let image = read_image(master, identity.stored_parameters().collect(), progress)?;
    Ok(HiperdriveProfile::from_image(identity.profile(), image))
}

/// Reads all values needed for a plan: the stored values, the given additional parameters, and the drive positions.
///
/// # Errors
/// Returns [`Error::NotHiperdrive`] for another device, or another error if the exchange fails.
pub fn read_state(
    master: &mut Master<'_>,
    beside: impl IntoIterator<Item = ParameterNumber>,
    progress: IdentifyProgress<'_>,
) -> Result<(Identity, DeviceState), Error> {
    let identity = identify(master, progress)?;
    let mut numbers: Vec<ParameterNumber> = identity.stored_parameters().chain(beside).collect();
    numbers.sort();
    numbers.dedup();
    let image = read_image(master, numbers, progress)?;
    let mut positions = Positions::new();
    for drive in &identity.drives {
        match master.read_number(drive_parameter(POSITION, drive.number)?) {
            // The position has 32 bits.
            Ok(position) => {
                positions.insert(drive.number, position as i32);
            }
            Err(error) if error.is_unavailable() => {}
            Err(error) => return Err(error),
        }
    }
    let state = DeviceState { identity: identity.profile(), image, positions };
    Ok((identity, state))
}

fn read_image(
    master: &mut Master<'_>,
    numbers: Vec<ParameterNumber>,
    progress: IdentifyProgress<'_>,
) -> Result<Image, Error> {
    let total = numbers.len() as u64;
    let mut image = Image::default();
    for (done, number) in numbers.into_iter().enumerate() {
        progress(done as u64, total, number);
        match master.read_number(number) {
            Ok(value) => {
                image.values.insert(number, value);
            }
            // A missing value cannot be stored, and strings never are.
            Err(Error::NoPlace { .. } | Error::Unknown(_) | Error::Value { .. } | Error::WriteOnly { .. }) => {}
            Err(error) if error.is_unavailable() => {}
            Err(error) => return Err(error),
        }
    }
    Ok(image)
}
