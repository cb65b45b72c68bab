//! Reads the identity of an encoder and all values that can be restored.

use super::{Error, Identity, Master, PolledSample, ReadPolicy, Survey, read_survey};
use crate::devices::hiperface::profile::{FieldImage, HiperfaceProfile, Interface, ProfileIdentity, RecordedValues};
use crate::devices::hiperface::protocol::EncoderTypes;
use crate::profile::UnknownValues;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SaveOptions {
    /// Whether a field with an unknown access code causes an error.
    pub complete: bool,
}

/// Reads all values of the encoder. Every value except the position is read twice, because an XOR checksum alone is not
/// sufficient protection for data that may be stored for years.
///
/// # Errors
/// Returns an error if the exchange fails, or if a field cannot be read and [`complete`](SaveOptions::complete) is set.
pub fn save(
    master: &mut Master<'_>,
    types: &EncoderTypes,
    options: SaveOptions,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<HiperfaceProfile, Error> {
    master.run_double_checked(|master| save_once(master, types, options, progress))
}

fn save_once(
    master: &mut Master<'_>,
    types: &EncoderTypes,
    options: SaveOptions,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<HiperfaceProfile, Error> {
    let Survey { identity, fields, counter, position, .. } =
        read_survey(master, types, progress, ReadPolicy::Complete)?;
    if let Some(locked) = fields.iter().find(|field| field.bytes.is_none())
        && options.complete
    {
        return Err(Error::CodeUnknown { field: locked.number, number: locked.status.code() });
    }
    let position = match position {
        Some(PolledSample::Position(reading)) => Some(reading.raw),
        Some(PolledSample::NoPosition { .. } | PolledSample::Watched(_)) | None => None,
    };
    Ok(create_profile(&identity, fields, RecordedValues { position, counter, ..RecordedValues::default() }))
}

pub fn create_profile(identity: &Identity, fields: Vec<FieldImage>, recorded: RecordedValues) -> HiperfaceProfile {
    let mut profile = HiperfaceProfile {
        identity: ProfileIdentity {
            serial_number: identity.serial.serial_number.clone(),
            encoder_type: identity.label.encoder_type,
            encoder_name: identity.name.clone(),
            firmware_version: identity.serial.firmware_version.clone(),
            firmware_date: identity.serial.firmware_date.clone(),
            eeprom_bytes: u32::try_from(identity.label.eeprom_bytes()).unwrap_or(u32::MAX),
            options: identity.label.options,
            extended_label: identity.extended_label.clone(),
            unknown: UnknownValues::new(),
        },
        interface: Interface {
            address: identity.address,
            settings: identity.label.settings,
            unknown: UnknownValues::new(),
        },
        recorded,
        mounting: Vec::new(),
        fields,
        created: Vec::new(),
        unknown_in_fields: Vec::new(),
    };
    profile.mark_mounting_dependent_values();
    profile
}
