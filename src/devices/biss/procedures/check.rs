//! The device check, which compares an encoder with its description and its data sheet, tests the line, and gives a
//! verdict for each item. It writes nothing except the bank selection.

use super::survey::{EncoderStatus, FlagRegister, read_all_registers};
use super::{Error, Identity, Master, PositionReading, Survey, Transport};
use crate::analysis::check;
use crate::devices::biss::protocol::{
    Descriptions, DeviceMode, Eds, EdsError, EdsValue, Firmware, IdentityMismatch, Name, RegisterAddress, WiegandResult,
};

pub use crate::analysis::check::{CycleCount, MemoryWear, Verdict};

pub type BissStepResult = check::StepResult<CheckStep, CheckFinding>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckStep {
    Identity,
    /// Checks errors, warnings, device mode and password.
    Status,
    /// Checks the position with its error and warning bits.
    Position,
    /// Checks the data sheet's checksums and frame layout.
    DataSheet,
    /// Compares temperature and supply with the limits in the data sheet.
    Limits,
    Wiegand,
    /// Counts position readings and damaged frames or replies.
    Readings,
    Wear,
}

#[derive(Clone, Debug, PartialEq)]
pub enum CheckFinding {
    Name(String),
    SerialNumber(String),
    Firmware(Firmware),
    /// No description matches the encoder exactly.
    Mismatch(IdentityMismatch),
    Error(u8, Option<Name>),
    Warning(u8, Option<Name>),
    /// The encoder or its firmware has no registers for errors and warnings.
    NotReported,
    Mode(DeviceMode),
    Open,
    Position(PositionReading),
    ErrorBit,
    WarningBit,
    NoPosition,
    SumsFit,
    /// A bank of the data sheet is invalid, or the two banks do not match.
    Sheet(EdsError),
    /// The encoder has no data sheet, or its profile is not supported.
    NoSheet,
    /// The data sheet and the description define different multiturn and singleturn widths.
    FrameMismatch {
        sheet: (u8, u8),
        description: (u8, u8),
    },
    /// Temperature in degrees Celsius and the limits in the data sheet.
    Temperature {
        celsius: f64,
        low: i32,
        high: i32,
    },
    /// Supply voltage in millivolts and the limits in the data sheet. The adapter measured the voltage at switch-on.
    Supply {
        millivolt: u16,
        low: u32,
        high: u32,
    },
    /// Current in milliamperes, as measured by the adapter, and the limit in the data sheet.
    Current {
        milliampere: u16,
        high: u32,
    },
    Wiegand(WiegandResult),
    /// No Wiegand test result is saved in the encoder.
    NotTested,
    /// Number of position readings and of damaged frames or replies.
    Readings {
        requested: u32,
        damaged: u64,
    },
    /// Number of recorded write cycles, and the limit of the flash.
    Wear {
        /// Minimum number of write cycles used so far.
        seen: CycleCount,
        limit: u64,
    },
}

/// Number of position readings used to assess the line.
const READINGS: u32 = 50;

/// Runs the check, which stops early only if the line fails. `wear` is called as soon as the encoder has been
/// identified.
///
/// # Errors
/// Returns an error if the exchange fails or the job is cancelled.
pub fn check_encoder(
    master: &mut Master<'_>,
    types: &Descriptions,
    wear: impl FnOnce(&Identity) -> MemoryWear,
    progress: &mut dyn FnMut(u64, u64, RegisterAddress),
) -> Result<Vec<BissStepResult>, Error> {
    let survey = read_all_registers(master, types, progress)?;
    let mut lines = vec![
        identity(&survey.identity),
        status(&survey.status),
        position(survey.status.position),
        data_sheet(&survey.identity),
    ];
    lines.extend(limits(&survey, master.station().supply.and_then(|supply| supply.measured)));
    lines.extend(check_wiegand_result(&survey));
    if survey.status.position.is_some() {
        lines.push(check_readings(master)?);
    }
    lines.extend(wear_result(wear(&survey.identity)));
    Ok(lines)
}

fn identity(identity: &Identity) -> BissStepResult {
    let mut findings = vec![(Verdict::Good, CheckFinding::Name(identity.description.name().to_owned()))];
    if !identity.serial_number.is_empty() {
        findings.push((Verdict::Good, CheckFinding::SerialNumber(identity.serial_number.clone())));
    }
    findings.extend(identity.firmware.map(|firmware| (Verdict::Good, CheckFinding::Firmware(firmware))));
    findings.extend(identity.mismatch.clone().map(|mismatch| (Verdict::Attention, CheckFinding::Mismatch(mismatch))));
    BissStepResult::new(CheckStep::Identity, findings)
}

fn status(status: &EncoderStatus) -> BissStepResult {
    let set = |bits: &Option<FlagRegister>| bits.iter().flat_map(|bits| bits.set.clone()).collect::<Vec<_>>();
    let mut findings: Vec<(Verdict, CheckFinding)> =
        set(&status.errors).into_iter().map(|(bit, name)| (Verdict::Bad, CheckFinding::Error(bit, name))).collect();
    let warnings = set(&status.warnings).into_iter();
    findings.extend(warnings.map(|(bit, name)| (Verdict::Attention, CheckFinding::Warning(bit, name))));
    if status.errors.is_none() && status.warnings.is_none() {
        findings.push((Verdict::Attention, CheckFinding::NotReported));
    }
    let mode = status.mode.filter(|mode| *mode != DeviceMode::OPERATION);
    findings.extend(mode.map(|mode| (Verdict::Attention, CheckFinding::Mode(mode))));
    if status.protection.is_some_and(|password| password != 0) {
        findings.push((Verdict::Attention, CheckFinding::Open));
    }
    BissStepResult::new(CheckStep::Status, findings)
}

fn position(reading: Option<PositionReading>) -> BissStepResult {
    let Some(reading) = reading else {
        return BissStepResult::new(CheckStep::Position, vec![(Verdict::Bad, CheckFinding::NoPosition)]);
    };
    let mut findings = vec![(Verdict::Good, CheckFinding::Position(reading))];
    if reading.error == Some(true) {
        findings.push((Verdict::Bad, CheckFinding::ErrorBit));
    }
    if reading.warning == Some(true) {
        findings.push((Verdict::Attention, CheckFinding::WarningBit));
    }
    BissStepResult::new(CheckStep::Position, findings)
}

fn data_sheet(identity: &Identity) -> BissStepResult {
    let Some(sheet) = &identity.data_sheet else {
        return BissStepResult::new(CheckStep::DataSheet, vec![(Verdict::Attention, CheckFinding::NoSheet)]);
    };
    let wrong = [&sheet.common, &sheet.encoder].into_iter().filter_map(|bank| bank.eds.err());
    let mut findings: Vec<(Verdict, CheckFinding)> =
        wrong.map(|error| (Verdict::Bad, CheckFinding::Sheet(error))).collect();
    if findings.is_empty() {
        findings.push((Verdict::Good, CheckFinding::SumsFit));
        match &sheet.layout {
            Err(error) => findings.push((Verdict::Bad, CheckFinding::Sheet(*error))),
            Ok(sheet_layout) => {
                let widths = |layout: &crate::devices::biss::protocol::Layout| {
                    (layout.multiturn_bits(), layout.singleturn_bits())
                };
                let described = identity.description.layout().map(widths).filter(|own| *own != widths(sheet_layout));
                let other = described
                    .map(|description| CheckFinding::FrameMismatch { sheet: widths(sheet_layout), description });
                findings.extend(other.map(|finding| (Verdict::Attention, finding)));
            }
        }
    }
    BissStepResult::new(CheckStep::DataSheet, findings)
}

/// Offsets of the limits within the encoder bank of the data sheet.
mod offset {
    pub(super) const MIN_TEMPERATURE: u8 = 0x30;
    pub(super) const MAX_TEMPERATURE: u8 = 0x32;
    pub(super) const MIN_VOLTAGE: u8 = 0x34;
    pub(super) const MAX_VOLTAGE: u8 = 0x36;
    pub(super) const MAX_CURRENT: u8 = 0x38;
}

/// Compares measured values with the limits in the data sheet. Returns `None` if there is no value to compare.
fn limits(survey: &Survey, supply: Option<(u16, u16)>) -> Option<BissStepResult> {
    let sheet = survey.identity.data_sheet.as_ref()?.encoder.eds.as_ref().ok()?;
    let judge = |fits: bool| if fits { Verdict::Good } else { Verdict::Attention };
    let mut findings = Vec::new();
    let celsius = |at| value(sheet, at).and_then(EdsValue::to_celsius);
    if let (Some(celsius), Some(low), Some(high)) =
        (survey.status.celsius, celsius(offset::MIN_TEMPERATURE), celsius(offset::MAX_TEMPERATURE))
    {
        let fits = (f64::from(low)..=f64::from(high)).contains(&celsius);
        findings.push((judge(fits), CheckFinding::Temperature { celsius, low, high }));
    }
    let number = |at| match value(sheet, at) {
        Some(EdsValue::Number(number, _)) => Some(number),
        _ => None,
    };
    if let (Some((millivolt, milliampere)), Some(low), Some(high), Some(most)) =
        (supply, number(offset::MIN_VOLTAGE), number(offset::MAX_VOLTAGE), number(offset::MAX_CURRENT))
    {
        let fits = (low..=high).contains(&millivolt.into());
        findings.push((judge(fits), CheckFinding::Supply { millivolt, low, high }));
        findings.push((judge(u32::from(milliampere) <= most), CheckFinding::Current { milliampere, high: most }));
    }
    (!findings.is_empty()).then(|| BissStepResult::new(CheckStep::Limits, findings))
}

fn value(sheet: &Eds, offset: u8) -> Option<EdsValue> {
    sheet.values().find(|(field, _)| field.offset == offset).map(|(_, value)| value)
}

/// Checks the saved result of the Wiegand test. Returns `None` if the encoder has no such result.
fn check_wiegand_result(survey: &Survey) -> Option<BissStepResult> {
    let saved = survey.wiegand_saved?;
    let finding = match saved.emit() {
        // The encoder is in its factory state. This is not an error, but there is no evidence that the sensor works.
        [0, 0, 0, 0] => (Verdict::Skipped, CheckFinding::NotTested),
        _ if saved.is_passed() => (Verdict::Good, CheckFinding::Wiegand(saved)),
        _ => (Verdict::Bad, CheckFinding::Wiegand(saved)),
    };
    Some(BissStepResult::new(CheckStep::Wiegand, vec![finding]))
}

/// Reads the position repeatedly. A failed reading counts as damaged.
fn check_readings(master: &mut Master<'_>) -> Result<BissStepResult, Error> {
    let before = master.station().line.damaged;
    let told_by_line = master.station().transport == Transport::ConfigPin;
    let mut damaged = 0;
    for _ in 0..READINGS {
        match master.position() {
            Ok(reading) => damaged += u64::from(reading.crc_errors),
            // Each damaged attempt has already been counted.
            Err(Error::Damaged { .. }) if told_by_line => {}
            Err(Error::Damaged { .. } | Error::WrongWidths { .. } | Error::TooWide { .. }) => damaged += 1,
            Err(error) => return Err(error),
        }
    }
    if told_by_line {
        damaged += master.station().line.damaged - before;
    }
    let verdict = if damaged == 0 { Verdict::Good } else { Verdict::Attention };
    Ok(BissStepResult::new(
        CheckStep::Readings,
        vec![(verdict, CheckFinding::Readings { requested: READINGS, damaged })],
    ))
}

fn wear_result(wear: MemoryWear) -> Option<BissStepResult> {
    let (verdict, seen) = wear.verdict()?;
    Some(BissStepResult::new(CheckStep::Wear, vec![(verdict, CheckFinding::Wear { seen, limit: wear.limit })]))
}
