//! Reads the identity, the settings and all other values of an encoder (references 3 and 5).

use super::error::ImplausibleValue;
use super::{Error, Master, WordReading};
use crate::devices::interbus::profile::{Direction, Image, Parameters};
use crate::devices::interbus::protocol::{
    Cam, CamNumber, Command, ErrorWord, Flags, Gear, Program, ProgramNumber, READ_OUTS, ReadOutNumber, ReadOutValue,
    Reply, StartupMode, Value, WindowShift,
};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Serial number in decimal.
    pub serial_number: String,
    /// Number of steps over all programmed turns, as reported by the encoder. Use [`gear`](Self::gear) to interpret it.
    pub steps: u32,
    /// Number of turns after which the position repeats.
    pub revolutions: u32,
    pub direction: Direction,
    pub software_version: u32,
    pub mode: StartupMode,
    pub flags: Flags,
}

impl Identity {
    /// Returns the gear with these steps and turns. Older encoders, which are recognised by their flags, report one
    /// step less than the total. The manual does not explain why (`U`).
    ///
    /// # Errors
    /// Returns [`ImplausibleValue::Gear`] if the steps and turns do not form a gear.
    pub fn gear(&self) -> Result<Gear, ImplausibleValue> {
        gear(self.steps, self.revolutions, self.flags)
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Survey {
    pub identity: Identity,
    pub parameters: Parameters,
    /// Preset flag as reported by the encoder.
    pub preset_flag: u32,
    /// Operating time in minutes.
    pub operating_minutes: u32,
    /// Temperature in tenths of a degree Celsius.
    pub temperature_tenths: i32,
    values: Vec<(ReadOutNumber, Value)>,
}

impl Survey {
    /// Returns all read-outs with their values as received.
    pub fn read_outs(&self) -> impl Iterator<Item = (ReadOutNumber, Value)> {
        self.values.iter().copied()
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Status {
    pub reading: WordReading,
    /// The error that the encoder reports instead of a position.
    pub error: Option<ErrorWord>,
    pub mode: StartupMode,
    pub flags: Flags,
    /// Operating time in minutes.
    pub operating_minutes: u32,
    /// Temperature in tenths of a degree Celsius.
    pub temperature_tenths: i32,
}

/// Reads the identity of the encoder.
///
/// # Errors
/// Returns [`Error::Implausible`] if the direction is invalid, or another error if the handshake or the exchange fails.
/// An invalid gear is not an error here. See [`Identity::gear`].
pub fn identify(master: &mut Master<'_>) -> Result<Identity, Error> {
    master.run_guarded(|master| read_identity(master, &mut Vec::new()))
}

/// Reads everything that can be read without selecting a cam program.
///
/// # Errors
/// Returns any error that [`identify`] returns.
pub fn read_all_values(
    master: &mut Master<'_>,
    progress: &mut dyn FnMut(u64, u64, ReadOutNumber),
) -> Result<Survey, Error> {
    master.run_guarded(|master| read_survey(master, progress))
}

/// Reads the status of the encoder.
///
/// # Errors
/// Returns any error that [`identify`] returns.
pub fn read_status(master: &mut Master<'_>) -> Result<Status, Error> {
    // This is the word that a machine receives, since nothing has been requested yet.
    let mut reading = master.read_in_word()?;
    let error = match reading.reply() {
        Reply::Error(error) => Some(error),
        _ => None,
    };
    master.run_guarded(|master| {
        let identity = read_identity(master, &mut Vec::new())?;
        let DeviceMeasurements { minutes, tenths } = read_measurements(master)?;
        (reading.mode, reading.gear) = (Some(identity.mode), identity.gear().ok());
        let Identity { mode, flags, .. } = identity;
        Ok(Status { reading, error, mode, flags, operating_minutes: minutes, temperature_tenths: tenths })
    })
}

/// Reads a single read-out or OPC chip register.
///
/// # Errors
/// Returns [`Error::UnknownReadOut`] if the read-out does not exist, or an error of [`identify`].
pub fn read_single_value(master: &mut Master<'_>, read_out: ReadOutNumber) -> Result<Value, Error> {
    master.run_guarded(|master| master.read_out(read_out))
}

/// Reads cam programs and the window shift. The outputs of the encoder switch to each program while it is read.
///
/// # Errors
/// Returns [`Error::NoMode`] if a program cannot be selected, or another error if the handshake or the exchange fails.
pub fn read_programs(
    master: &mut Master<'_>,
    wanted: &[ProgramNumber],
    progress: &mut dyn FnMut(u64, u64, ProgramNumber),
) -> Result<(Vec<(ProgramNumber, Program)>, WindowShift), Error> {
    master.run_guarded(|master| programs(master, wanted, progress))
}

/// Switches the encoder to a mode. It stays in this mode after the job.
///
/// # Errors
/// Returns [`Error::NoMode`] or [`Error::NotSelectable`] if the encoder does not enter the mode, or another error if
/// the handshake or the exchange fails.
pub fn select(master: &mut Master<'_>, mode: StartupMode) -> Result<StartupMode, Error> {
    master.run_guarded(|master| {
        master.switch_to_mode(mode)?;
        master.keep_current_mode();
        Ok(master.mode().unwrap_or(mode))
    })
}

pub(super) fn read_identity(
    master: &mut Master<'_>,
    values: &mut Vec<(ReadOutNumber, Value)>,
) -> Result<Identity, Error> {
    let mut read = |number: u16| {
        let read_out = ReadOutNumber::new(number);
        let value = master.read_out(read_out)?;
        values.push((read_out, value));
        Ok::<u32, Error>(value.get())
    };
    let [serial, steps, revolutions, direction] = [read(0)?, read(1)?, read(2)?, read(3)?];
    let [software_version, flags] = [read(7)?, read(0xA)?];
    let mode = read_mode(master)?;
    values.push((ReadOutNumber::STARTUP_MODE, Value::from_word(mode.emit())));
    let identity = Identity {
        serial_number: serial.to_string(),
        steps,
        revolutions,
        direction: direction_from_read_out(direction)?,
        software_version,
        mode,
        flags: Flags::new(Value::from_word(flags)),
    };
    master.remember_gear(identity.gear().ok());
    master.remember_serial_number(serial);
    Ok(identity)
}

pub(super) fn read_survey(
    master: &mut Master<'_>,
    progress: &mut dyn FnMut(u64, u64, ReadOutNumber),
) -> Result<Survey, Error> {
    let total = READ_OUTS.len() as u64;
    let mut values = Vec::new();
    progress(0, total, ReadOutNumber::SERIAL_NUMBER);
    let identity = read_identity(master, &mut values)?;
    for row in &READ_OUTS {
        if values.iter().all(|(read_out, _)| *read_out != row.read_out) {
            progress(values.len() as u64, total, row.read_out);
            values.push((row.read_out, master.read_out(row.read_out)?));
        }
    }
    let value = |number: u16| {
        let found = values.iter().find(|(read_out, _)| read_out.to_u16() == number);
        found.map_or(Value::default(), |(_, value)| *value)
    };
    let parameters = Parameters {
        steps: identity.steps,
        revolutions: identity.revolutions,
        direction: identity.direction,
        preset: value(4).get(),
        zero_shift: value(5).get(),
    };
    Ok(Survey {
        parameters,
        preset_flag: value(6).get(),
        operating_minutes: operating_time_minutes(value(8)),
        temperature_tenths: temperature_tenths(value(0xC)),
        identity,
        values,
    })
}

fn read_mode(master: &mut Master<'_>) -> Result<StartupMode, Error> {
    match master.reported_mode() {
        Some(mode) => Ok(mode),
        None => Ok(StartupMode::parse(master.read_out(ReadOutNumber::STARTUP_MODE)?)),
    }
}

/// Reads the gear again, in case the steps or turns have changed.
pub(super) fn refresh_gear(master: &mut Master<'_>) -> Result<(), Error> {
    let mut read = |number: u16| master.read_out(ReadOutNumber::new(number));
    let [steps, revolutions, flags] = [read(1)?, read(2)?, read(0xA)?];
    master.remember_gear(gear(steps.get(), revolutions.get(), Flags::new(flags)).ok());
    Ok(())
}

fn gear(steps: u32, revolutions: u32, flags: Flags) -> Result<Gear, ImplausibleValue> {
    Ok(Gear::new(steps.saturating_add(u32::from(flags.steps_minus_one())), revolutions)?)
}

/// Reads the position parameters that are not part of the identity. The identity must have been read in the same job.
pub(super) fn read_remaining_parameters(master: &mut Master<'_>, identity: &Identity) -> Result<Parameters, Error> {
    let Identity { steps, revolutions, direction, .. } = *identity;
    let mut read = |number: u16| Ok::<u32, Error>(master.read_out(ReadOutNumber::new(number))?.get());
    let [preset, zero_shift] = [read(4)?, read(5)?];
    Ok(Parameters { steps, revolutions, direction, preset, zero_shift })
}

pub(super) fn read_parameters(master: &mut Master<'_>) -> Result<Parameters, Error> {
    let mut read = |number: u16| Ok::<u32, Error>(master.read_out(ReadOutNumber::new(number))?.get());
    let [steps, revolutions, direction] = [read(1)?, read(2)?, read(3)?];
    let [preset, zero_shift] = [read(4)?, read(5)?];
    Ok(Parameters { steps, revolutions, direction: direction_from_read_out(direction)?, preset, zero_shift })
}

/// Reads all values that can be restored, including the given programs.
pub(super) fn read_image(
    master: &mut Master<'_>,
    parameters: Parameters,
    wanted: &[ProgramNumber],
    progress: &mut dyn FnMut(u64, u64, ProgramNumber),
) -> Result<Image, Error> {
    let mut image = Image::from_parameters(parameters);
    if wanted.is_empty() {
        return Ok(image);
    }
    let (read, shift) = programs(master, wanted, progress)?;
    image.shift = Some(shift);
    for (number, program) in read {
        if let Some(place) = image.program_mut(number) {
            *place = Some(program);
        }
    }
    Ok(image)
}

pub(super) fn programs(
    master: &mut Master<'_>,
    wanted: &[ProgramNumber],
    progress: &mut dyn FnMut(u64, u64, ProgramNumber),
) -> Result<(Vec<(ProgramNumber, Program)>, WindowShift), Error> {
    let selects_first = wanted.is_empty() && !matches!(master.mode(), Some(StartupMode::Cams(_)));
    master.record_program_reads(wanted.len() + usize::from(selects_first))?;
    let total = wanted.len() as u64;
    let mut read = Vec::new();
    for (done, number) in (0..).zip(wanted) {
        progress(done, total, *number);
        master.switch_to_mode(StartupMode::Cams(*number))?;
        read.push((*number, read_program(master)?));
    }
    if selects_first {
        // The shift can be read in any program, so the first one is selected.
        if let Some(first) = ProgramNumber::new(1) {
            master.switch_to_mode(StartupMode::Cams(first))?;
        }
    }
    Ok((read, read_shift(master)?))
}

pub(super) fn read_program(master: &mut Master<'_>) -> Result<Program, Error> {
    // There are eight cams, so the upper byte is 0. See reference 6.9.
    let mask = master.request_value(Command::ReadActivation)?.get() as u8;
    let mut program = Program { mask, ..Program::default() };
    for (cam, place) in CamNumber::all().zip(&mut program.cams) {
        *place = Some(read_cam(master, cam)?);
    }
    Ok(program)
}

pub(super) fn read_cam(master: &mut Master<'_>, cam: CamNumber) -> Result<Cam, Error> {
    let start = master.request_value(Command::ReadCamStart(cam))?;
    Ok(Cam { start, stop: master.request_value(Command::ReadCamStop(cam))? })
}

/// Reads the window shift. A cam program must be selected.
pub(super) fn read_shift(master: &mut Master<'_>) -> Result<WindowShift, Error> {
    let value = master.request_value(Command::ReadShift)?.get();
    let read = Command::ReadShift.emit();
    let shift = u8::try_from(value).ok().and_then(WindowShift::new).ok_or(ImplausibleValue::Value { read, value })?;
    master.remember_window_shift(shift);
    Ok(shift)
}

pub(super) struct DeviceMeasurements {
    pub(super) minutes: u32,
    pub(super) tenths: i32,
}

pub(super) fn read_measurements(master: &mut Master<'_>) -> Result<DeviceMeasurements, Error> {
    let minutes = operating_time_minutes(master.read_out(ReadOutNumber::OPERATING_TIME)?);
    Ok(DeviceMeasurements { minutes, tenths: temperature_tenths(master.read_out(ReadOutNumber::TEMPERATURE)?) })
}

fn operating_time_minutes(value: Value) -> u32 {
    match ReadOutNumber::OPERATING_TIME.value(value) {
        ReadOutValue::Minutes(minutes) => minutes,
        _ => value.get(),
    }
}

fn temperature_tenths(value: Value) -> i32 {
    match ReadOutNumber::TEMPERATURE.value(value) {
        ReadOutValue::TenthsOfDegree(tenths) => tenths,
        // The value has only 25 bits, so the conversion is exact.
        _ => value.get() as i32,
    }
}

/// Returns the direction for a read-out value: either the parameter value, or a flag of 0 or 1, as the manual describes
/// it (`U`).
pub(super) fn direction_from_read_out(code: u32) -> Result<Direction, ImplausibleValue> {
    let flag = match code {
        0 => Some(Direction::Clockwise),
        1 => Some(Direction::Counterclockwise),
        code => Direction::from_code(code),
    };
    flag.ok_or(ImplausibleValue::Direction(code))
}
