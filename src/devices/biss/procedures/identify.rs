//! Identification of an encoder by the direct registers that all BiSS C encoders have, its description, and its data
//! sheet, which defines the frame.

use std::sync::Arc;

use super::error::to_register_array;
use super::registers::Registers;
use super::widths::find_frame_layout;
use super::{Error, Master, Station, Transport};
use crate::bits::ByteOrder;
use crate::buses::bridge::protocol::Hello;
use crate::devices::biss::profile::ProfileIdentity;
use crate::devices::biss::protocol::{
    Description, Descriptions, Eds, EdsBank, EdsError, Firmware, Identity as Kind, IdentityMismatch, Layout, ProfileId,
    RegisterAddress, Role, eds_layout,
};
use crate::profile::UnknownValues;

#[derive(Clone, Debug, PartialEq)]
pub struct Identity {
    pub kind: Kind,
    /// Serial number in decimal. The bytes are assumed to be big-endian, which is not documented (`U`). Empty if the
    /// encoder has no register for the serial number.
    pub serial_number: String,
    /// Bytes of the serial number as received.
    pub serial_bytes: Vec<u8>,
    /// Firmware version, or `None` if the encoder has no registers for the version.
    pub firmware: Option<Firmware>,
    pub description: Arc<Description>,
    /// Difference from the closest description, which is of another device from the same manufacturer. `None` if there
    /// is no such description.
    pub mismatch: Option<IdentityMismatch>,
    /// Data sheet, or `None` if the encoder has none or its profile is not supported.
    pub data_sheet: Option<DataSheet>,
    pub layout: Layout,
    pub source: FrameSource,
    /// Adapter through which the encoder is connected, if any.
    pub adapter: Option<Hello>,
    /// Byte order of register numbers over the configuration pin.
    pub order: Option<ByteOrder>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameSource {
    DataSheet,
    Description,
    Given,
    /// The layout matches the checksums of frames received while the shaft turned. The multiturn width remains unknown.
    Checksum,
    Assumed,
}

impl FrameSource {
    /// Returns whether this source provides the multiturn width.
    pub const fn is_known(self) -> bool {
        match self {
            FrameSource::DataSheet | FrameSource::Description | FrameSource::Given => true,
            FrameSource::Checksum | FrameSource::Assumed => false,
        }
    }
}

/// The data sheet, which consists of two register banks.
#[derive(Clone, Debug, PartialEq)]
pub struct DataSheet {
    pub common: DataSheetBank,
    pub encoder: DataSheetBank,
    /// Frame layout according to both banks, or the reason why it is invalid.
    pub layout: Result<Layout, EdsError>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct DataSheetBank {
    pub bank: u8,
    /// Register values as received.
    pub bytes: [u8; 64],
    /// Parsed content, if the checksum is correct.
    pub eds: Result<Eds, EdsError>,
}

impl Identity {
    pub fn profile(&self) -> ProfileIdentity {
        ProfileIdentity {
            serial_number: self.serial_number.clone(),
            profile_id: self.kind.profile,
            device_id: self.kind.device_id,
            manufacturer: self.kind.manufacturer,
            firmware: self.firmware,
            description: self.description.name().to_owned(),
            multiturn_bits: self.multiturn_bits(),
            singleturn_bits: self.singleturn_bits(),
            unknown: UnknownValues::new(),
        }
    }

    /// Returns the width of the multiturn position in bits, if known.
    pub fn multiturn_bits(&self) -> Option<u8> {
        self.is_layout_source_known().then_some(self.layout.multiturn_bits())
    }

    /// Returns the width of the singleturn position in bits, if known.
    pub fn singleturn_bits(&self) -> Option<u8> {
        self.is_layout_source_known().then_some(self.layout.singleturn_bits())
    }

    fn is_layout_source_known(&self) -> bool {
        self.source.is_known()
    }
}

/// Offset in the common bank of the register that holds the number of the encoder bank.
const ENCODER_BANK: usize = 0x14;

/// Identifies the encoder and its frame layout, and stores the result in the session's [`Station`].
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn identify(master: &mut Master<'_>, types: &Descriptions) -> Result<Identity, Error> {
    identify_and_record(master, types, &mut Registers::default())
}

/// Identifies the encoder like [`identify`], and stores all values read in `registers`.
pub(super) fn identify_and_record(
    master: &mut Master<'_>,
    types: &Descriptions,
    registers: &mut Registers,
) -> Result<Identity, Error> {
    let kind = read_type_identity(master, registers)?;
    let description = types.find(&kind).cloned().map(Arc::new).ok_or_else(|| Error::NoDescription(kind.clone()))?;
    registers.read_registers_with_roles(master, &description, None, &[Role::SerialNumber, Role::Firmware])?;
    let serial_bytes = description
        .register_with_role(Role::SerialNumber)
        .and_then(|register| registers.bytes(register))
        .unwrap_or_default();
    let serial_number =
        registers.number_of(&description, Role::SerialNumber).map(|number| number.to_string()).unwrap_or_default();
    let firmware = firmware_from_registers(&description, registers);
    let data_sheet = read_data_sheet(master, kind.profile, registers)?;
    let sheet_layout = data_sheet.as_ref().and_then(|sheet| sheet.layout.clone().ok());
    let station: &mut Station = master.station();
    station.description = Some(description.clone());
    station.firmware = firmware;
    let source = match (&sheet_layout, description.layout()) {
        (Some(_), _) => FrameSource::DataSheet,
        (None, Some(_)) => FrameSource::Description,
        (None, None) if station.given.is_some() => FrameSource::Given,
        (None, None) => FrameSource::Assumed,
    };
    if station.given.is_some() && source != FrameSource::Given {
        tracing::warn!("mt, st and crc of the link are not used: the encoder tells its frame itself");
    }
    station.layout = sheet_layout.or_else(|| station.given.clone().filter(|_| source == FrameSource::Given));
    let source = if source == FrameSource::Assumed { detect_frame_source(master)? } else { source };
    let station = master.station();
    station.source = Some(source);
    station.identified = Some((kind.clone(), serial_number.clone()));
    Ok(Identity {
        mismatch: closest_mismatch(types, &kind).filter(|_| description.identity().is_none()),
        layout: station.frame_layout(),
        adapter: station.adapter.identity().cloned(),
        order: station.order,
        kind,
        serial_number,
        serial_bytes,
        firmware,
        description,
        data_sheet,
        source,
    })
}

/// Determines an unknown frame layout. The layout of the kit encoder is used if its checksum matches. Otherwise, a
/// matching layout is searched for. Over the configuration pin, which transmits no frames, the kit encoder's layout is
/// assumed.
fn detect_frame_source(master: &mut Master<'_>) -> Result<FrameSource, Error> {
    if master.station().transport == Transport::ConfigPin {
        return Ok(FrameSource::Assumed);
    }
    match master.position() {
        Err(Error::WrongWidths { .. }) => {}
        Ok(_) | Err(Error::Damaged { .. }) => return Ok(FrameSource::Assumed),
        Err(error) => return Err(error),
    }
    match find_frame_layout(master) {
        Ok(layout) => {
            master.station().layout = Some(layout);
            Ok(FrameSource::Checksum)
        }
        Err(Error::WidthsUnknown { .. }) => Ok(FrameSource::Assumed),
        Err(error) => Err(error),
    }
}

fn read_type_identity(master: &mut Master<'_>, registers: &mut Registers) -> Result<Kind, Error> {
    let profile = registers.read(master, RegisterAddress::PROFILE, 2)?;
    let device = registers.read(master, RegisterAddress::DEVICE_ID, 8)?;
    let profile: [u8; 2] = to_register_array(RegisterAddress::PROFILE, profile)?;
    let device: [u8; 8] = to_register_array(RegisterAddress::DEVICE_ID, device)?;
    let [d0, d1, d2, d3, d4, d5, m0, m1] = device;
    Ok(Kind {
        profile: ProfileId::new(u16::from_be_bytes(profile)),
        manufacturer: [m0, m1],
        device_id: [d0, d1, d2, d3, d4, d5],
    })
}

/// Returns how the identity differs from the first description for the same manufacturer and profile.
fn closest_mismatch(types: &Descriptions, kind: &Kind) -> Option<IdentityMismatch> {
    let is_near = |own: &Kind| own.manufacturer == kind.manufacturer && own.profile == kind.profile;
    types
        .iter()
        .filter(|description| description.identity().is_some_and(is_near))
        .find_map(|near| near.check_identity(kind).err())
}

fn firmware_from_registers(description: &Description, registers: &Registers) -> Option<Firmware> {
    let bytes = registers.bytes(description.register_with_role(Role::Firmware)?)?;
    match bytes.as_slice() {
        [major, minor, patch] => Some(Firmware::new(*major, *minor, *patch)),
        _ => None,
    }
}

/// Reads both banks of the data sheet. Returns `None` if the encoder's profile is not supported.
fn read_data_sheet(
    master: &mut Master<'_>,
    profile: ProfileId,
    registers: &mut Registers,
) -> Result<Option<DataSheet>, Error> {
    if !profile.is_standard_encoder_profile() {
        return Ok(None);
    }
    let first = registers.read(master, RegisterAddress::EDS_BANK, 1)?.first().copied().unwrap_or(0);
    let Some(common) = read_data_sheet_bank(master, EdsBank::Common, first, registers)? else { return Ok(None) };
    let second = common.bytes.get(ENCODER_BANK).copied().unwrap_or(0);
    let Some(encoder) = read_data_sheet_bank(master, EdsBank::Encoder, second, registers)? else { return Ok(None) };
    let layout = match (&common.eds, &encoder.eds) {
        (Ok(common), Ok(encoder)) => eds_layout(common, encoder),
        (Err(error), _) | (_, Err(error)) => Err(*error),
    };
    Ok(Some(DataSheet { common, encoder, layout }))
}

/// Reads a bank of the data sheet, or returns `None` if the encoder does not have the bank.
fn read_data_sheet_bank(
    master: &mut Master<'_>,
    which: EdsBank,
    bank: u8,
    registers: &mut Registers,
) -> Result<Option<DataSheetBank>, Error> {
    let bytes = match registers.read(master, RegisterAddress::bank_start(bank), RegisterAddress::BANK_SIZE) {
        Ok(bytes) => bytes,
        Err(Error::NoSuchRegister { .. }) => return Ok(None),
        Err(error) => return Err(error),
    };
    let Ok(bytes) = <[u8; 64]>::try_from(bytes) else { return Ok(None) };
    Ok(Some(DataSheetBank { bank, bytes, eds: Eds::parse(which, bytes) }))
}
