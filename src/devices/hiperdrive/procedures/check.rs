//! Device check: examines an adapter or a hub with its drives, and gives a verdict on each finding. It sets no value
//! and moves no drive.

use std::fmt;
use std::time::Duration;

use super::identify::{device_parameter, drive_parameter, drive_status, identify};
use super::limits::stops_on_timeout;
use super::network::network;
use super::{DriveIdentity, DriveStatus, Error, Identity, Master, Network};
use crate::analysis::check;
use crate::buses::ethernet_ip::protocol::AddressSource;
use crate::devices::hiperdrive::protocol::drive_parameter::{
    DENOMINATOR, LOWER_LIMIT, NUMERATOR, POSITION, TIMEOUT, UPPER_LIMIT,
};
use crate::devices::hiperdrive::protocol::{
    AddressSwitch, DriveNumber, ErrorCode, ParameterNumber, PositionScale, State, StatusBit, StepLimit, Topology,
    Travel, Variant,
};

pub use crate::analysis::check::Verdict;

pub type HiperdriveStepResult = check::StepResult<CheckStep, CheckFinding>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckStep {
    Messages,
    Device,
    Supply,
    Temperature,
    Address,
    /// State of the memory (parameter 47): it must be intact, with no save in progress.
    Memory,
    Drives,
    Request(DriveNumber),
    /// RS-485 link to a drive.
    Line(DriveNumber),
    /// RS-485 time-out, after which a drive that receives no more data stops.
    Timeout(DriveNumber),
    /// State and errors of a drive.
    Errors(DriveNumber),
    DriveTemperature(DriveNumber),
    Range(DriveNumber),
}

impl fmt::Display for CheckStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of_drive =
            |f: &mut fmt::Formatter<'_>, what, drive: &DriveNumber| write!(f, "drive {}: {what}", drive.get());
        match self {
            CheckStep::Messages => f.write_str("messages"),
            CheckStep::Device => f.write_str("device"),
            CheckStep::Supply => f.write_str("supply"),
            CheckStep::Temperature => f.write_str("temperature"),
            CheckStep::Address => f.write_str("address"),
            CheckStep::Memory => f.write_str("memory"),
            CheckStep::Drives => f.write_str("drives"),
            CheckStep::Request(drive) => of_drive(f, "requested", drive),
            CheckStep::Line(drive) => of_drive(f, "RS-485", drive),
            CheckStep::Timeout(drive) => of_drive(f, "time-out", drive),
            CheckStep::Errors(drive) => of_drive(f, "state and errors", drive),
            CheckStep::DriveTemperature(drive) => of_drive(f, "temperature", drive),
            CheckStep::Range(drive) => of_drive(f, "scaling and limits", drive),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum CheckFinding {
    /// Reply times measured over a number of readings.
    Replies {
        requested: u32,
        /// Longest reply time in milliseconds.
        slowest_ms: u64,
        /// Number of frames received after their time limit.
        late: u64,
    },
    Category(String),
    SerialNumber(String),
    Version(String),
    /// Supply voltage in tenths of a volt.
    Supply(i64),
    /// Temperature in degrees Celsius.
    Temperature(i64),
    Switch(AddressSwitch),
    UnknownSwitch(i64),
    /// Source of the address when the switches are at 0.
    Source(AddressSource),
    /// The memory is intact, and no save is in progress.
    Saved,
    /// Parameter 47 is not 0, because the memory is faulty or the device is busy.
    NotSaved(i64),
    Drive {
        number: DriveNumber,
        variant: Variant,
        serial_number: String,
    },
    NoDrives,
    /// Parameter 152 (Requested) of the drive is 1.
    Requested,
    /// Parameter 152 (Requested) of the drive is 0.
    NotRequested,
    /// Switch S3 of a hub must be at 0 for drives to move. It cannot be read and must be checked by the user.
    LookAtS3,
    /// The RS-485 link has no errors: parameter 118 is 0.
    LineGood,
    /// Error of the RS-485 link (parameter 118), or FFFFh if there is no drive.
    LineWord(u16),
    /// RS-485 time-out in tenths of a second, parameter 186.
    Timeout(i64),
    /// Parameter 186 is not a valid time, so the drive continues to move when communication is lost.
    NoTimeout,
    State(State),
    /// The status word is implausible. Perhaps the process data use the other byte order.
    StrayStatus(u16),
    /// Drive error word, parameter 116, which is not 0.
    DriveWord(u16),
    /// Motion status, parameter 117, which is not 0.
    MotionWord(u16),
    /// The error buffer of the drive contains an error.
    Error(ErrorCode),
    /// Number of faults since the last acknowledgement.
    Faults(u8),
    /// Position scale and limits of a drive.
    Range {
        /// Numerator of the position scale, parameter 154.
        numerator: i64,
        /// Denominator of the position scale, parameter 156.
        denominator: i64,
        /// Lower limit in scaled steps, parameter 158.
        lower: i64,
        /// Upper limit in scaled steps, parameter 160.
        upper: i64,
    },
    /// Numerator and denominator do not form a valid scale.
    BadScale {
        /// Numerator of the position scale, parameter 154.
        numerator: i64,
        /// Denominator of the position scale, parameter 156.
        denominator: i64,
    },
    /// The upper limit is not greater than the lower limit.
    LimitsCrossed {
        /// Lower limit in scaled steps, parameter 158.
        lower: i64,
        /// Upper limit in scaled steps, parameter 160.
        upper: i64,
    },
    /// A limit is beyond the travel of the drive.
    BeyondTravel {
        /// Limit in scaled steps, parameter 158 or 160.
        limit: i64,
        turns: f64,
        most: i32,
    },
    Within(i64),
    Outside {
        position: i64,
        /// Lower limit in scaled steps, parameter 158.
        lower: i64,
        /// Upper limit in scaled steps, parameter 160.
        upper: i64,
    },
}

/// Number of readings over which the reply time is measured.
const READING_COUNT: u32 = 20;
/// Allowed supply voltage in tenths of a volt: 24 V with a tolerance of −15 % to +20 %. The tolerance is not documented
/// (`U`).
const SUPPLY_RANGE: std::ops::RangeInclusive<i64> = 204..=288;
/// Allowed temperature of a device or a drive in degrees Celsius. The manual contradicts itself here (`U`; reference,
/// section 8.9).
const TEMPERATURE_RANGE: std::ops::RangeInclusive<i64> = -10..=70;

/// Runs all checks. A problem found by one check does not end the others.
///
/// # Errors
/// Returns [`Error::NotHiperdrive`] for another device, or another error if the exchange fails.
pub fn check_device(
    master: &mut Master<'_>,
    progress: &mut dyn FnMut(u64, u64, CheckStep),
) -> Result<Vec<HiperdriveStepResult>, Error> {
    let mut lines = Vec::new();
    progress(0, 1, CheckStep::Messages);
    let identity = identify(master, &mut |_, _, _| {})?;
    lines.push(check_messages(master)?);
    lines.push(device(&identity));
    lines.push(HiperdriveStepResult::new(
        CheckStep::Supply,
        vec![in_range(master.read_number(device_parameter(9)?)?, &SUPPLY_RANGE, CheckFinding::Supply)],
    ));
    let celsius = master.read_number(device_parameter(11)?)?;
    lines.push(HiperdriveStepResult::new(
        CheckStep::Temperature,
        vec![in_range(celsius, &TEMPERATURE_RANGE, CheckFinding::Temperature)],
    ));
    lines.push(HiperdriveStepResult::new(CheckStep::Address, address(&network(master)?)));
    let saved = match master.read_number(ParameterNumber::SAVE)? {
        0 => (Verdict::Good, CheckFinding::Saved),
        other => (Verdict::Attention, CheckFinding::NotSaved(other)),
    };
    lines.push(HiperdriveStepResult::new(CheckStep::Memory, vec![saved]));
    lines.push(HiperdriveStepResult::new(CheckStep::Drives, drives(&identity)));
    let total = identity.drives.len() as u64 + 1;
    for (at, drive) in identity.drives.iter().enumerate() {
        progress(at as u64 + 1, total, CheckStep::Errors(drive.number));
        lines.extend(check_drive(master, &identity, drive)?);
    }
    Ok(lines)
}

fn in_range(value: i64, range: &std::ops::RangeInclusive<i64>, of: fn(i64) -> CheckFinding) -> (Verdict, CheckFinding) {
    (if range.contains(&value) { Verdict::Good } else { Verdict::Attention }, of(value))
}

fn check_messages(master: &mut Master<'_>) -> Result<HiperdriveStepResult, Error> {
    let mut slowest = Duration::ZERO;
    for _ in 0..READING_COUNT {
        let begun = master.now();
        master.read_number(device_parameter(9)?)?;
        slowest = slowest.max(master.now().duration_since(begun));
    }
    let late = master.station().late_reply_count();
    let verdict = if late == 0 { Verdict::Good } else { Verdict::Attention };
    let replies = CheckFinding::Replies { requested: READING_COUNT, slowest_ms: slowest.as_millis() as u64, late };
    Ok(HiperdriveStepResult::new(CheckStep::Messages, vec![(verdict, replies)]))
}

fn device(identity: &Identity) -> HiperdriveStepResult {
    let findings = [
        CheckFinding::Category(identity.category.clone()),
        CheckFinding::SerialNumber(identity.serial_number.clone()),
        CheckFinding::Version(identity.version.clone()),
    ];
    HiperdriveStepResult::new(CheckStep::Device, findings.into_iter().map(|finding| (Verdict::Good, finding)).collect())
}

fn address(network: &Network) -> Vec<(Verdict, CheckFinding)> {
    let Some(switch) = network.address_switch() else {
        return vec![(Verdict::Attention, CheckFinding::UnknownSwitch(network.switch))];
    };
    let mut findings = vec![(Verdict::Good, CheckFinding::Switch(switch))];
    if switch == AddressSwitch::Object {
        findings.extend(network.control.map(|control| (Verdict::Good, CheckFinding::Source(control.source()))));
    }
    findings
}

fn drives(identity: &Identity) -> Vec<(Verdict, CheckFinding)> {
    if identity.drives.is_empty() {
        return vec![(Verdict::Bad, CheckFinding::NoDrives)];
    }
    let found = |drive: &DriveIdentity| {
        let DriveIdentity { number, variant, serial_number, .. } = drive;
        (
            Verdict::Good,
            CheckFinding::Drive { number: *number, variant: *variant, serial_number: serial_number.clone() },
        )
    };
    identity.drives.iter().map(found).collect()
}

fn check_drive(
    master: &mut Master<'_>,
    identity: &Identity,
    drive: &DriveIdentity,
) -> Result<Vec<HiperdriveStepResult>, Error> {
    let number = drive.number;
    let status = drive_status(master, number)?;
    let mut request = match drive.requested {
        true => vec![(Verdict::Good, CheckFinding::Requested)],
        false => vec![(Verdict::Attention, CheckFinding::NotRequested)],
    };
    request.extend((identity.topology != Topology::Adapter).then_some((Verdict::Good, CheckFinding::LookAtS3)));
    let [_, _, communication] = status.words;
    let rs485 = match communication {
        0 => (Verdict::Good, CheckFinding::LineGood),
        other => (Verdict::Bad, CheckFinding::LineWord(other)),
    };
    let timeout = match master.read_number(drive_parameter(TIMEOUT, number)?)? {
        tenths if stops_on_timeout(tenths) => (Verdict::Good, CheckFinding::Timeout(tenths)),
        _ => (Verdict::Bad, CheckFinding::NoTimeout),
    };
    let temperature = in_range(status.temperature, &TEMPERATURE_RANGE, CheckFinding::Temperature);
    Ok(vec![
        HiperdriveStepResult::new(CheckStep::Request(number), request),
        HiperdriveStepResult::new(CheckStep::Line(number), vec![rs485]),
        HiperdriveStepResult::new(CheckStep::Timeout(number), vec![timeout]),
        HiperdriveStepResult::new(CheckStep::Errors(number), error_findings(&status)),
        HiperdriveStepResult::new(CheckStep::DriveTemperature(number), vec![temperature]),
        HiperdriveStepResult::new(CheckStep::Range(number), check_range(master, drive)?),
    ])
}

fn error_findings(status: &DriveStatus) -> Vec<(Verdict, CheckFinding)> {
    let DriveStatus { status: word, words: [drive, motion, _], buffer, faults, .. } = status;
    let mut findings = Vec::new();
    if word.is_plausible() {
        let state = word.state();
        let is_bad = matches!(state, State::Fault | State::Locked) || word.is_set(StatusBit::Fault);
        findings.push((if is_bad { Verdict::Bad } else { Verdict::Good }, CheckFinding::State(state)));
    } else {
        findings.push((Verdict::Attention, CheckFinding::StrayStatus(word.to_u16())));
    }
    findings.extend((*drive != 0).then_some((Verdict::Attention, CheckFinding::DriveWord(*drive))));
    findings.extend((*motion != 0).then_some((Verdict::Attention, CheckFinding::MotionWord(*motion))));
    // Entries of the error buffer may be old. They are relevant only if faults have been counted.
    let of_buffer = if *faults == 0 { Verdict::Good } else { Verdict::Attention };
    findings.extend(buffer.iter().map(|code| (of_buffer, CheckFinding::Error(*code))));
    findings.extend((*faults != 0).then_some((Verdict::Attention, CheckFinding::Faults(*faults))));
    findings
}

fn check_range(master: &mut Master<'_>, drive: &DriveIdentity) -> Result<Vec<(Verdict, CheckFinding)>, Error> {
    let mut read = |base| master.read_number(drive_parameter(base, drive.number)?);
    let (numerator, denominator) = (read(NUMERATOR)?, read(DENOMINATOR)?);
    let (lower, upper, position) = (read(LOWER_LIMIT)?, read(UPPER_LIMIT)?, read(POSITION)?);
    let mut findings = vec![(Verdict::Good, CheckFinding::Range { numerator, denominator, lower, upper })];
    if upper <= lower {
        findings.push((Verdict::Bad, CheckFinding::LimitsCrossed { lower, upper }));
    }
    findings.push(match (lower..=upper).contains(&position) {
        true => (Verdict::Good, CheckFinding::Within(position)),
        false => (Verdict::Bad, CheckFinding::Outside { position, lower, upper }),
    });
    let scale = u16::try_from(numerator).ok().zip(u16::try_from(denominator).ok());
    match scale.and_then(|(numerator, denominator)| PositionScale::new(numerator, denominator).ok()) {
        None => findings.push((Verdict::Bad, CheckFinding::BadScale { numerator, denominator })),
        Some(scale) => {
            let family = drive.variant.row().map(|row| row.family);
            let travel = Travel { family, scale: Some(scale) };
            if let Some((family, steps)) = family.zip(travel.max_steps(StepLimit::Position)) {
                let beyond = [lower, upper].into_iter().filter(|limit| limit.abs() > steps);
                findings.extend(beyond.map(|limit| {
                    let (turns, most) = (limit as f64 / scale.steps_per_turn(), family.max_turns());
                    (Verdict::Bad, CheckFinding::BeyondTravel { limit, turns, most })
                }));
            }
        }
    }
    Ok(findings)
}
