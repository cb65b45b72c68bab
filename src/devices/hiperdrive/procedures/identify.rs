//! Reads the identity, the status, and everything else that can be read, without setting anything. See section 4 of the
//! reference.

use std::collections::BTreeMap;

use super::network::{Network, network};
use super::{Error, Master, WrongLength};
use crate::devices::hiperdrive::protocol::drive_parameter::{
    ACKNOWLEDGE, DRIVE_REQUESTED, NEWEST_ERROR, OLDEST_ERROR, POSITION, SPEED, STATUS, VARIANT,
};
use crate::devices::hiperdrive::protocol::{
    ActualValues, DriveNumber, ErrorCode, PARAMETERS, ParameterAccess, ParameterNumber, StatusBit, StatusWord,
    Topology, Value, Variant,
};
use crate::units::Moment;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    pub topology: Topology,
    /// Product category, parameter 13.
    pub category: String,
    /// Product name, parameter 15.
    pub name: String,
    /// Article number, parameter 16.
    pub article_number: String,
    /// Serial number, parameter 17.
    pub serial_number: String,
    /// Production date (parameter 18), as week and year.
    pub production_date: String,
    /// Software version, parameter 19.
    pub version: String,
    pub drives: Vec<DriveIdentity>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DriveIdentity {
    pub number: DriveNumber,
    /// Variant of the drive, parameter 120.
    pub variant: Variant,
    /// Name of the drive, parameter 121.
    pub name: String,
    /// Article number of the drive, parameter 122.
    pub article_number: String,
    /// Serial number of the drive, parameter 123.
    pub serial_number: String,
    /// Software version of the drive, parameter 125.
    pub version: String,
    /// Whether parameter 152 (Requested) is 1.
    pub requested: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Survey {
    pub identity: Identity,
    pub network: Network,
    /// All parameters of the device and its drives, except those that the device refuses to read.
    pub values: BTreeMap<ParameterNumber, Value>,
    /// Numeric parameters whose length does not match their type. They are not included in `values`.
    pub wrong_lengths: Vec<WrongLength>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Status {
    pub drives: Vec<DriveStatus>,
    /// Control supply voltage in tenths of a volt, parameter 9.
    pub supply_tenths: i64,
    /// Device temperature in degrees Celsius, parameter 11.
    pub temperature: i64,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DriveStatus {
    pub number: DriveNumber,
    /// Status word, parameter 105.
    pub status: StatusWord,
    /// Errors stored in parameters 108 to 115, newest first. After power-up, they may be old (reference, section 4).
    pub buffer: Vec<ErrorCode>,
    /// Drive error word, motion status and communication error, parameters 116 to 118. The value 0 stands for no error,
    /// and FFFFh for no drive.
    pub words: [u16; 3],
    /// Number of faults since the last acknowledgement, parameter 197.
    pub faults: u8,
    /// Drive temperature in degrees Celsius, parameter 119.
    pub temperature: i64,
    /// Whether parameter 152 (Requested) is not 0.
    pub requested: bool,
}

impl DriveStatus {
    /// Returns how many of the newest entries in the error buffer are current errors, which is at least one during a
    /// fault. The other entries are old, because the buffer survives a power cycle.
    pub fn present_error_count(&self) -> usize {
        usize::from(self.faults).max(usize::from(self.status.is_set(StatusBit::Fault)))
    }
}

/// Callback that receives the number of parameters read so far, their total number, and the next parameter.
pub(super) type IdentifyProgress<'t> = &'t mut dyn FnMut(u64, u64, ParameterNumber);

struct ProgressSteps<'t> {
    done: u64,
    total: u64,
    progress: IdentifyProgress<'t>,
}

impl ProgressSteps<'_> {
    fn next(&mut self, number: ParameterNumber) -> ParameterNumber {
        (self.progress)(self.done, self.total, number);
        self.done += 1;
        number
    }

    fn advance(&mut self, count: u64) {
        self.done += count;
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveReading {
    pub at: Moment,
    pub drive: DriveNumber,
    /// Status, speed and position, parameters 105 to 107.
    pub actual: ActualValues,
}

impl Identity {
    pub fn drive(&self, number: DriveNumber) -> Option<&DriveIdentity> {
        self.drives.iter().find(|drive| drive.number == number)
    }

    /// Returns the identity of a drive by number.
    ///
    /// # Errors
    /// Returns [`Error::NoPlace`] if the device has no such port, or [`Error::NoDrive`] if the port is empty.
    pub fn drive_identity(&self, drive: DriveNumber) -> Result<&DriveIdentity, Error> {
        let topology = self.topology;
        let is_place = drive.get() <= topology.drives();
        let missing = if is_place { Error::NoDrive { drive } } else { Error::NoPlace { drive, topology } };
        self.drive(drive).ok_or(missing)
    }
}

/// Reads the identity of a device.
///
/// # Errors
/// Returns [`Error::NotHiperdrive`] for another device, or another error if the device rejects a request or the
/// exchange fails.
pub fn identify(master: &mut Master<'_>, progress: IdentifyProgress<'_>) -> Result<Identity, Error> {
    // Number of parameters of a drive, and of the device.
    const DRIVE: u64 = 6;
    const DEVICE: u64 = 5;
    let category = read_category(master)?;
    let topology = Topology::from_category(&category).ok_or(Error::NotHiperdrive { product: category.clone() })?;
    let mut steps = ProgressSteps { done: 0, total: DRIVE * u64::from(topology.drives()) + DEVICE, progress };
    let mut drives = Vec::new();
    for number in DriveNumber::all_in_topology(topology) {
        let variant = master.read_number(steps.next(drive_parameter(VARIANT, number)?))?;
        let variant = Variant::new(u16::try_from(variant).unwrap_or(Variant::OTHER.number()));
        if variant == Variant::NONE {
            steps.advance(DRIVE - 1);
            continue;
        }
        let mut text = |base| {
            steps.next(drive_parameter(base, number)?);
            read_drive_text(master, base, number)
        };
        let (name, article_number, serial_number, version) = (text(121)?, text(122)?, text(123)?, text(125)?);
        steps.next(drive_parameter(DRIVE_REQUESTED, number)?);
        let requested = is_requested(master, number)?;
        drives.push(DriveIdentity { number, variant, name, article_number, serial_number, version, requested });
    }
    master.set_topology(topology);
    let mut text = |number| master.read_text(steps.next(device_parameter(number)?));
    let (name, article_number, production_date, version) = (text(15)?, text(16)?, text(18)?, text(19)?);
    let serial_number = master.read_number(steps.next(device_parameter(17)?))?.to_string();
    master.remember_device(&category, &serial_number);
    Ok(Identity { topology, category, name, article_number, serial_number, production_date, version, drives })
}

/// Reads a string from a drive. Returns an empty string if the drive does not provide it, for example because the drive
/// is not requested (`U`: not documented).
pub(super) fn read_drive_text(master: &mut Master<'_>, base: u16, drive: DriveNumber) -> Result<String, Error> {
    match master.read_text(drive_parameter(base, drive)?) {
        Err(error) if error.is_unavailable() => Ok(String::new()),
        ended => ended,
    }
}

/// Reads the category of the device.
fn read_category(master: &mut Master<'_>) -> Result<String, Error> {
    match master.read_text(device_parameter(13)?) {
        Err(Error::Refused { .. }) => {
            let product = master.read_identity_object()?.product_name;
            Err(Error::NotHiperdrive { product })
        }
        ended => ended,
    }
}

/// Reads the identity and all readable parameters of a device.
///
/// # Errors
/// Returns an error from [`identify`] if the identity or the status cannot be read.
pub fn read_survey(master: &mut Master<'_>, progress: IdentifyProgress<'_>) -> Result<Survey, Error> {
    let identity = identify(master, progress)?;
    let numbers: Vec<ParameterNumber> = readable_parameters(&identity).collect();
    let total = numbers.len() as u64;
    let (mut values, mut wrong_lengths) = (BTreeMap::new(), Vec::new());
    for (done, number) in numbers.into_iter().enumerate() {
        progress(done as u64, total, number);
        match master.read(number) {
            Ok(value) => {
                values.insert(number, value);
            }
            Err(Error::Length(error)) => wrong_lengths.push(error),
            Err(error) if error.is_unavailable() => {}
            Err(error) => return Err(error),
        }
    }
    let network = network(master)?;
    Ok(Survey { identity, network, values, wrong_lengths })
}

fn readable_parameters(identity: &Identity) -> impl Iterator<Item = ParameterNumber> {
    let rows = || PARAMETERS.iter().filter(|row| row.access != ParameterAccess::Write);
    let device = rows().filter(|row| row.number < 100).filter_map(|row| ParameterNumber::new(row.number));
    let drives = identity
        .drives
        .iter()
        .flat_map(move |drive| rows().filter_map(|row| ParameterNumber::for_drive(row.number, drive.number)));
    device.chain(drives)
}

/// Number of parameters read for the status of a drive.
const STATUS_PARAMETERS: u64 = 15;

/// Reads the errors and states of all drives.
///
/// # Errors
/// Returns an error from [`identify`] if the status cannot be read.
pub fn read_status(master: &mut Master<'_>, progress: IdentifyProgress<'_>) -> Result<Status, Error> {
    let topology = read_topology(master)?;
    // For each port, one read determines whether a drive is present. The remaining reads are for its status.
    let mut steps =
        ProgressSteps { done: 0, total: (1 + STATUS_PARAMETERS) * u64::from(topology.drives()) + 2, progress };
    let mut drives = Vec::new();
    for number in DriveNumber::all_in_topology(topology) {
        if master.read_number(steps.next(drive_parameter(VARIANT, number)?))? == i64::from(Variant::NONE.number()) {
            steps.advance(STATUS_PARAMETERS);
        } else {
            drives.push(read_drive_status(master, number, &mut steps)?);
        }
    }
    let mut device = |number| master.read_number(steps.next(device_parameter(number)?));
    let (supply_tenths, temperature) = (device(9)?, device(11)?);
    Ok(Status { drives, supply_tenths, temperature })
}

pub(super) fn drive_status(master: &mut Master<'_>, number: DriveNumber) -> Result<DriveStatus, Error> {
    read_drive_status(
        master,
        number,
        &mut ProgressSteps { done: 0, total: STATUS_PARAMETERS, progress: &mut |_, _, _| {} },
    )
}

fn read_drive_status(
    master: &mut Master<'_>,
    number: DriveNumber,
    steps: &mut ProgressSteps<'_>,
) -> Result<DriveStatus, Error> {
    let mut read = |base| master.read_number(steps.next(drive_parameter(base, number)?));
    // These parameters have 16 bits.
    let mut word = |base| Ok::<_, Error>(read(base)? as u16);
    let mut buffer = Vec::new();
    for error in NEWEST_ERROR..=OLDEST_ERROR {
        let code = word(error)?;
        buffer.extend((code != 0).then_some(ErrorCode::new(code)));
    }
    let status = StatusWord::new(word(STATUS)?);
    let words = [word(116)?, word(117)?, word(118)?];
    Ok(DriveStatus {
        number,
        status,
        buffer,
        words,
        faults: u8::try_from(read(ACKNOWLEDGE)?).unwrap_or(u8::MAX),
        temperature: read(119)?,
        requested: read(DRIVE_REQUESTED)? != 0,
    })
}

/// Reads the status, speed and position of a drive (parameters 105 to 107).
///
/// # Errors
/// Returns [`Error::NoPlace`] or [`Error::NoDrive`] if the drive does not exist, or another error if the exchange
/// fails.
pub fn position(master: &mut Master<'_>, drive: DriveNumber) -> Result<DriveReading, Error> {
    let status = StatusWord::new(read_word(master, STATUS, drive)?);
    // Both casts match the types of the parameters.
    let speed = master.read_number(drive_parameter(SPEED, drive)?)? as i16;
    let position = master.read_number(drive_parameter(POSITION, drive)?)? as i32;
    Ok(DriveReading { at: master.now(), drive, actual: ActualValues { status, speed, position } })
}

/// Returns the device type, reading it once per session.
pub(super) fn read_topology(master: &mut Master<'_>) -> Result<Topology, Error> {
    if let Some(topology) = master.station().topology() {
        return Ok(topology);
    }
    let category = read_category(master)?;
    let topology = Topology::from_category(&category).ok_or(Error::NotHiperdrive { product: category })?;
    master.set_topology(topology);
    Ok(topology)
}

fn is_requested(master: &mut Master<'_>, drive: DriveNumber) -> Result<bool, Error> {
    Ok(master.read_number(drive_parameter(DRIVE_REQUESTED, drive)?)? != 0)
}

fn read_word(master: &mut Master<'_>, base: u16, drive: DriveNumber) -> Result<u16, Error> {
    Ok(master.read_number(drive_parameter(base, drive)?)? as u16)
}

pub(super) fn device_parameter(number: u16) -> Result<ParameterNumber, Error> {
    ParameterNumber::new(number).ok_or(Error::NoNumber(number))
}

/// Converts the number of a drive 1 parameter to the number for another drive.
pub(super) fn drive_parameter(base: u16, drive: DriveNumber) -> Result<ParameterNumber, Error> {
    ParameterNumber::for_drive(base, drive).ok_or(Error::NoNumber(base))
}
