//! Identification of the encoder.

use super::{Error, Master, read_range};
use crate::devices::hiperface::profile::HiperfaceProfile;
use crate::devices::hiperface::protocol::{
    AccessCodeNumber, Command, EXTENDED_LABEL_FIELD, EncoderTypes, ExtendedLabel, FreeMemory, Geometry, LineSettings,
    Reply, Request, SerialLabel, StatusCode, TypeLabel,
};

#[derive(Clone, Debug, PartialEq)]
pub struct Identity {
    pub address: u8,
    /// Type label (52h).
    pub label: TypeLabel,
    /// Serial number and firmware (56h), with empty strings if the encoder does not support the command.
    pub serial: SerialLabel,
    /// Free memory (4Eh), or `None` if the encoder does not support the command.
    pub memory: Option<FreeMemory>,
    pub name: String,
    /// Periods and turns, which are specified by the user, the extended label or the table of encoder types.
    pub geometry: Option<Geometry>,
    /// Whether the encoder is a kit without a bearing, whose code tracks are aligned with 63h, or `None` if unknown.
    pub kit: Option<bool>,
    /// Content of data field FFh, if the encoder has this field.
    pub extended_label: Option<Vec<u8>>,
}

impl Identity {
    pub fn extended_label(&self) -> Option<ExtendedLabel> {
        self.extended_label.as_deref().and_then(|bytes| ExtendedLabel::parse(bytes).ok())
    }
}

/// Returns the identity as stored in a profile. The free memory is not included.
pub fn recorded_identity(profile: &HiperfaceProfile, types: &EncoderTypes) -> Identity {
    let own = &profile.identity;
    let label = TypeLabel {
        settings: profile.interface.settings,
        encoder_type: own.encoder_type,
        eeprom_units: u8::try_from(own.eeprom_bytes / 16).unwrap_or(u8::MAX),
        options: own.options,
    };
    let serial = SerialLabel {
        serial_number: own.serial_number.clone(),
        firmware_version: own.firmware_version.clone(),
        firmware_date: own.firmware_date.clone(),
    };
    let extended = own.extended_label.as_deref().and_then(|bytes| ExtendedLabel::parse(bytes).ok());
    let row = types.find(own.encoder_type);
    Identity {
        address: profile.interface.address,
        label,
        serial,
        memory: None,
        name: own.encoder_name.clone(),
        geometry: extended.and_then(|label| label.geometry).or_else(|| row.and_then(|row| row.geometry)),
        kit: row.filter(|_| own.encoder_type != TypeLabel::EXTENDED).map(|row| row.kit),
        extended_label: own.extended_label.clone(),
    }
}

/// Reads the type label, the serial number, the free memory and, for type code FFh, the extended label.
///
/// # Errors
/// Returns an error if the exchange fails or the encoder rejects a request. A rejection of 56h or 4Eh is not an error,
/// because some types do not support these commands.
pub fn identify(master: &mut Master<'_>, types: &EncoderTypes) -> Result<Identity, Error> {
    let label = read_type_label(master)?;
    let serial = read_serial(master)?;
    let memory = match optional_value(master.request_confirmed(&Request::FreeMemory))? {
        Some(Reply::FreeMemory(memory)) => Some(memory),
        _ => None,
    };
    let extended_label = match label.encoder_type {
        TypeLabel::EXTENDED => optional_value(read_extended_label(master))?,
        _ => None,
    };
    let extended = extended_label.as_deref().and_then(|bytes| ExtendedLabel::parse(bytes).ok());
    let row = types.find(label.encoder_type);
    let name = match (&extended, row) {
        (Some(extended), _) if !extended.designation.is_empty() => extended.designation.clone(),
        (_, Some(row)) => row.name.clone(),
        (_, None) => "unknown type".to_owned(),
    };
    let geometry = master.station().geometry;
    let geometry =
        geometry.or_else(|| extended.and_then(|label| label.geometry)).or_else(|| row.and_then(|row| row.geometry));
    let kit = row.filter(|_| label.encoder_type != TypeLabel::EXTENDED).map(|row| row.kit);
    let address = read_address(master)?;
    master.station().identified = Some((label.encoder_type, serial.serial_number.clone()));
    Ok(Identity { address, label, serial, memory, name, geometry, kit, extended_label })
}

pub(super) fn read_type_label(master: &mut Master<'_>) -> Result<TypeLabel, Error> {
    match master.request_confirmed(&Request::ReadTypeLabel)? {
        Reply::TypeLabel(label) => Ok(label),
        other => Err(Error::unexpected_reply(Command::ReadTypeLabel, &other)),
    }
}

/// Reads the serial number and the firmware version. Returns empty strings if the encoder does not support the command.
///
/// # Errors
/// Returns an error if the exchange fails or the encoder rejects the request.
pub(super) fn read_serial(master: &mut Master<'_>) -> Result<SerialLabel, Error> {
    Ok(match optional_value(master.request_confirmed(&Request::ReadSerial))? {
        Some(Reply::Serial(serial)) => serial,
        _ => {
            SerialLabel { serial_number: String::new(), firmware_version: String::new(), firmware_date: String::new() }
        }
    })
}

pub fn read_settings(master: &mut Master<'_>) -> Result<LineSettings, Error> {
    Ok(read_type_label(master)?.settings)
}

/// Reads the encoder's own address. The request uses the session's address, which may be the broadcast address.
///
/// # Errors
/// Returns an error if the exchange fails or the encoder rejects the request.
pub fn read_address(master: &mut Master<'_>) -> Result<u8, Error> {
    master.request_timed(&Request::ReadTypeLabel).map(|timed| timed.sender)
}

/// Reads the complete data field FFh: its size with command 4Ch, and its content with command 4Ah and code 0.
///
/// # Errors
/// Returns an error if the exchange fails or the encoder has no extended label.
pub fn read_extended_label(master: &mut Master<'_>) -> Result<Vec<u8>, Error> {
    let status = super::read_field_status(master, EXTENDED_LABEL_FIELD)?;
    let code = master.station().codes.get(AccessCodeNumber::ZERO);
    read_range(master, EXTENDED_LABEL_FIELD, 0, status.size().bytes(), code)
}

/// Reads the complete status queue, in the encoder's order.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn read_status(master: &mut Master<'_>) -> Result<Vec<StatusCode>, Error> {
    master.collect_codes()?;
    Ok(master.station().take_undisplayed_codes())
}

/// Returns `None` if the encoder does not support the command. Any other error is returned as an error.
fn optional_value<T>(result: Result<T, Error>) -> Result<Option<T>, Error> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(error)
            if error.is_rejection(StatusCode::UNKNOWN_COMMAND) || error.is_rejection(StatusCode::NO_SUCH_FIELD) =>
        {
            Ok(None)
        }
        Err(error) => Err(error),
    }
}
