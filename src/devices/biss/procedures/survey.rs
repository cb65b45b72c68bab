//! Reading the status of an encoder, or all values that can be displayed.

use super::identify::identify_and_record;
use super::registers::Registers;
use super::{Error, Identity, Master, PositionReading};
use crate::devices::biss::protocol::{
    CalibrationStatus, DecodedValue, Description, Descriptions, DeviceMode, Name, PositionFilter, PresetValue,
    ProcedureKind, RegisterAddress, Role, WiegandResult,
};

/// The status of an encoder. A value is `None` if the encoder or its firmware has no register for it.
#[derive(Clone, Debug, PartialEq)]
pub struct EncoderStatus {
    pub mode: Option<DeviceMode>,
    pub protection: Option<u8>,
    pub errors: Option<FlagRegister>,
    pub warnings: Option<FlagRegister>,
    pub celsius: Option<f64>,
    pub filter: Option<PositionFilter>,
    /// Position, or `None` if it could not be read. The position includes the error and warning bits if available.
    pub position: Option<PositionReading>,
}

impl EncoderStatus {
    /// Returns the device mode, or `None` in operation mode. In other modes, registers may show values that were never
    /// saved.
    pub fn non_operational_mode(&self) -> Option<DeviceMode> {
        self.mode.filter(|mode| *mode != DeviceMode::OPERATION)
    }
}

/// A register in which each bit is a flag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FlagRegister {
    pub raw: u64,
    /// Set bits, lowest first, with their names from the description.
    pub set: Vec<(u8, Option<Name>)>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    pub identity: Identity,
    pub status: EncoderStatus,
    pub calibration: Option<CalibrationStatus>,
    /// Result of the last Wiegand test since power-up.
    pub wiegand_last: Option<WiegandResult>,
    pub wiegand_production: Option<WiegandResult>,
    /// Result of the Wiegand test that was already saved when the encoder was powered up.
    pub wiegand_saved: Option<WiegandResult>,
    pub preset: Option<PresetValue>,
    pub registers: Registers,
    /// Described registers that the encoder does not have.
    pub missing: Vec<RegisterAddress>,
}

const STATUS: [Role; 6] = [Role::Mode, Role::Password, Role::Errors, Role::Warnings, Role::Temperature, Role::Filter];
/// Offset of the Wiegand test results from the error code register: first the last result, then the factory result and
/// the saved one.
const WIEGAND_RESULTS: u8 = 1;

/// Reads the status of an identified encoder.
///
/// # Errors
/// Returns an error if the exchange fails or the encoder has not been identified.
pub fn read_status(master: &mut Master<'_>) -> Result<EncoderStatus, Error> {
    let description = master.description()?;
    let firmware = master.station().firmware;
    let mut registers = Registers::default();
    registers.read_registers_with_roles(master, &description, firmware, &STATUS)?;
    let position = read_position_if_available(master)?;
    Ok(status_from_registers(&description, &registers, position))
}

/// Reads every register in the encoder's description, and the position.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn read_all_registers(
    master: &mut Master<'_>,
    types: &Descriptions,
    progress: &mut dyn FnMut(u64, u64, RegisterAddress),
) -> Result<Survey, Error> {
    let mut registers = Registers::default();
    let identity = identify_and_record(master, types, &mut registers)?;
    read_survey(master, identity, registers, progress)
}

/// Reads everything in the survey except the identity. `registers` holds what was read to determine the identity.
pub(super) fn read_survey(
    master: &mut Master<'_>,
    identity: Identity,
    mut registers: Registers,
    progress: &mut dyn FnMut(u64, u64, RegisterAddress),
) -> Result<Survey, Error> {
    let description = identity.description.clone();
    let missing = registers.read_described_registers(master, &description, identity.firmware, progress)?;
    let position = read_position_if_available(master)?;
    let results = |number| wiegand_result(&description, &registers, number);
    Ok(Survey {
        status: status_from_registers(&description, &registers, position),
        calibration: calibration_status(&description, &registers),
        wiegand_last: results(0),
        wiegand_production: results(1),
        wiegand_saved: results(2),
        preset: preset(&description, &registers),
        identity,
        registers,
        missing,
    })
}

/// Reads the position. Returns `None` if the frame cannot be decoded, so that the survey can continue.
fn read_position_if_available(master: &mut Master<'_>) -> Result<Option<PositionReading>, Error> {
    match master.position() {
        Ok(reading) => Ok(Some(reading)),
        Err(Error::TooWide { .. } | Error::WrongWidths { .. } | Error::Damaged { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

fn status_from_registers(
    description: &Description,
    registers: &Registers,
    position: Option<PositionReading>,
) -> EncoderStatus {
    let byte = |role| registers.number_of(description, role).and_then(|number| u8::try_from(number).ok());
    EncoderStatus {
        mode: byte(Role::Mode).map(DeviceMode::new),
        protection: byte(Role::Password),
        errors: bits(description, registers, Role::Errors),
        warnings: bits(description, registers, Role::Warnings),
        celsius: registers.quantity_of(description, Role::Temperature),
        filter: byte(Role::Filter).map(PositionFilter::from_byte),
        position,
    }
}

fn bits(description: &Description, registers: &Registers, role: Role) -> Option<FlagRegister> {
    let register = description.register_with_role(role)?;
    let bytes = registers.bytes(register)?;
    let raw = register.to_number(&bytes)?;
    let set = match register.decode(&bytes)? {
        DecodedValue::Bits(set) => set.into_iter().map(|(bit, name)| (bit, name.cloned())).collect(),
        _ => (0..64).filter(|bit| raw >> bit & 1 == 1).map(|bit| (bit, None)).collect(),
    };
    Some(FlagRegister { raw, set })
}

fn wiegand_result(description: &Description, registers: &Registers, number: u8) -> Option<WiegandResult> {
    let error = description.procedure(ProcedureKind::WiegandTest)?.data?;
    let bytes = registers.run(error.offset_by(WIEGAND_RESULTS + 4 * number)?, 4)?;
    bytes.try_into().ok().map(WiegandResult::parse)
}

fn preset(description: &Description, registers: &Registers) -> Option<PresetValue> {
    let bytes = registers.run(description.procedure(ProcedureKind::Preset)?.data?, 6)?;
    bytes.try_into().ok().map(PresetValue::parse)
}

fn calibration_status(description: &Description, registers: &Registers) -> Option<CalibrationStatus> {
    registers.get(description.procedure(ProcedureKind::Calibration)?.status).map(CalibrationStatus::from_byte)
}
