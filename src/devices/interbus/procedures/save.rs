//! Reads the values to be saved, displayed as an item, or used for a plan.

use super::identify::{
    direction_from_read_out, programs, read_cam, read_image, read_remaining_parameters, read_survey,
};
use super::write::read_parameter;
use super::{Error, Identity, Master, Survey};
use crate::devices::interbus::profile::{
    DeviceState, InterbusProfile, Item, ItemValue, ProfileIdentity, RecordedValues,
};
use crate::devices::interbus::protocol::{Command, Parameter, ProgramNumber, ReadOutNumber, ReadOutValue, StartupMode};
use crate::profile::UnknownValues;

impl Identity {
    pub fn profile(&self) -> ProfileIdentity {
        ProfileIdentity {
            serial_number: self.serial_number.clone(),
            flags: Some(self.flags),
            unknown: UnknownValues::new(),
        }
    }
}

impl Survey {
    /// Returns the values that a profile records but cannot restore.
    pub fn recorded_values(&self) -> RecordedValues {
        RecordedValues {
            software_version: Some(self.identity.software_version),
            operating_minutes: Some(self.operating_minutes),
            temperature_tenths: Some(self.temperature_tenths),
            mode: Some(self.identity.mode),
            preset_flag: Some(self.preset_flag),
            unknown: UnknownValues::new(),
        }
    }
}

/// Reads all values that can be restored. Cam programs are read only on request, since reading one switches the outputs
/// of the encoder.
///
/// # Errors
/// Returns an error if the handshake or the exchange fails.
pub fn save(
    master: &mut Master<'_>,
    with_programs: bool,
    progress: &mut dyn FnMut(u64, u64, SaveStep),
) -> Result<InterbusProfile, Error> {
    master.run_guarded(|master| {
        let survey =
            read_survey(master, &mut |done, total, read_out| progress(done, total, SaveStep::ReadOut(read_out)))?;
        let wanted: Vec<ProgramNumber> = if with_programs { ProgramNumber::all().collect() } else { Vec::new() };
        let of_program = &mut |done, total, program| progress(done, total, SaveStep::Program(program));
        let image = read_image(master, survey.parameters, &wanted, of_program)?;
        Ok(InterbusProfile::new(survey.identity.profile(), image, survey.recorded_values()))
    })
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveStep {
    ReadOut(ReadOutNumber),
    Program(ProgramNumber),
}

/// Reads the parameters and the given programs for a plan. The encoder must have been identified in the same job.
///
/// # Errors
/// Returns [`Error::Implausible`] if the steps and turns do not form a gear, or another error if the handshake or the
/// exchange fails.
pub fn read_state(
    master: &mut Master<'_>,
    identity: &Identity,
    programs: &[ProgramNumber],
    progress: &mut dyn FnMut(u64, u64, ProgramNumber),
) -> Result<DeviceState, Error> {
    identity.gear()?;
    master.run_guarded(|master| {
        let parameters = read_remaining_parameters(master, identity)?;
        let image = read_image(master, parameters, programs, progress)?;
        Ok(DeviceState { identity: identity.profile(), image })
    })
}

/// Reads one item. For an item of a cam program, the program is selected first.
///
/// # Errors
/// Returns an error if the handshake or the exchange fails.
pub fn read_item(master: &mut Master<'_>, item: Item) -> Result<ItemValue, Error> {
    master.run_guarded(|master| {
        if let Some(program) = item.program() {
            master.record_program_reads(1)?;
            master.switch_to_mode(StartupMode::Cams(program))?;
        }
        if let Some(parameter) = item.parameter() {
            let number = read_parameter(master, parameter)?;
            return Ok(match parameter {
                Parameter::Direction => ItemValue::Direction(direction_from_read_out(number)?),
                _ => ItemValue::Number(number),
            });
        }
        Ok(match item {
            Item::Shift => {
                let (_, shift) = programs(master, &[], &mut |_, _, _| {})?;
                ItemValue::Number(shift.get().into())
            }
            Item::CamMask(_) => ItemValue::Mask(master.request_value(Command::ReadActivation)?.get() as u8),
            Item::Cam(_, cam) => ItemValue::Cam(read_cam(master, cam)?),
            item => {
                let read_out =
                    if item == Item::Temperature { ReadOutNumber::TEMPERATURE } else { ReadOutNumber::OPERATING_TIME };
                let value = master.read_out(read_out)?;
                match read_out.value(value) {
                    ReadOutValue::TenthsOfDegree(tenths) => ItemValue::TenthsOfDegree(tenths),
                    ReadOutValue::Minutes(minutes) => ItemValue::Minutes(minutes),
                    _ => ItemValue::Number(value.get()),
                }
            }
        })
    })
}
