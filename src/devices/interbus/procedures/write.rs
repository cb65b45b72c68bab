//! Executes a plan. First, the values on which it is based are read again. Then each operation is executed and
//! verified, and finally the encoder returns to its previous mode.

use std::time::Duration;

pub use crate::profile::WrittenChanges;

use super::error::ImplausibleValue;
use super::handshake::LeftState;
use super::identify::{
    direction_from_read_out, programs, read_cam, read_parameters, read_program, read_shift, refresh_gear,
};
use super::{Error, Identity, Master};
use crate::devices::interbus::profile::{
    Base, CamChange, Edge, InterbusPlan, Item, Op, ParameterChange, ProgramChange,
};
use crate::devices::interbus::protocol::{
    Command, Gear, PARAMETERS, Parameter, ParameterRow, ReadOutNumber, Reply, StartupMode, Value,
};
use crate::profile::{ConfirmedPlan, Write};

pub type InterruptedWrite = crate::profile::InterruptedWrite<Op, Error, WrittenChanges, EndState>;

/// The state of an encoder after a write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EndState {
    /// The encoder is running in its previous mode.
    AsFound,
    /// The encoder could not be returned to its original mode.
    Unknown(LeftState),
}

/// How long the shaft must be at standstill before a preset.
const STANDSTILL_TIME: Duration = Duration::from_millis(300);
/// Interval between two position readings at standstill.
const READING_INTERVAL: Duration = Duration::from_millis(20);

pub struct EncoderWriter<'w, 'm> {
    pub master: Master<'m>,
    pub identity: &'w Identity,
}

impl Write for EncoderWriter<'_, '_> {
    type Base = Base;
    type Op = Op;
    type Error = Error;
    type Written = WrittenChanges;
    type EndState = EndState;

    fn confirm_base(&mut self, plan: &InterbusPlan) -> Result<(), Error> {
        let Self { master, identity } = self;
        master.run_guarded(|master| confirm_identity(master, plan, identity))
    }

    fn begin(&mut self) -> Result<(), Error> {
        self.master.enter()
    }

    fn apply(&mut self, op: &Op, _: &ConfirmedPlan<'_, Base, Op>, done: &mut WrittenChanges) -> Result<(), Error> {
        execute(&mut self.master, op, done)?;
        done.count_operation(op.change_count());
        Ok(())
    }

    fn return_to_safe_state(
        &mut self,
        _: &ConfirmedPlan<'_, Base, Op>,
        ended: Result<(), Error>,
        _: &mut WrittenChanges,
    ) -> Result<(), Error> {
        self.master.finish(ended)
    }

    fn end_state(&mut self, cause: &Error) -> EndState {
        match cause {
            Error::ModeNotRestored { standing, .. } => EndState::Unknown(*standing),
            _ => EndState::AsFound,
        }
    }
}

fn confirm_identity(master: &mut Master<'_>, plan: &InterbusPlan, identity: &Identity) -> Result<(), Error> {
    let changed = |item: String| Err(Error::Changed { item });
    if master.read_out(ReadOutNumber::SERIAL_NUMBER)?.get().to_string() != identity.serial_number {
        return changed("the encoder itself".to_owned());
    }
    if let Some(before) = plan.base.parameters {
        let now = read_parameters(master)?;
        let differs = |row: &&ParameterRow| now.value(row.parameter) != before.value(row.parameter);
        if let Some(row) = PARAMETERS.iter().find(differs) {
            return changed(row.name.to_owned());
        }
    }
    master.record_program_reads(plan.base.programs.len())?;
    for (number, program) in &plan.base.programs {
        master.switch_to_mode(StartupMode::Cams(*number))?;
        if read_program(master)? != *program {
            return changed(format!("cam program {}", number.get()));
        }
    }
    if let Some(shift) = plan.base.shift
        && programs(master, &[], &mut |_, _, _| {})?.1 != shift
    {
        return changed(Item::Shift.to_string());
    }
    if plan.ops.iter().any(|op| matches!(op, Op::FirePreset { .. })) {
        refresh_gear(master)?;
        ensure_standstill(master)?;
    }
    Ok(())
}

fn execute(master: &mut Master<'_>, op: &Op, done: &mut WrittenChanges) -> Result<(), Error> {
    match op {
        Op::Parameterise(changes) => parameterise(master, changes, done)?,
        Op::Program(change) => program(master, change, done)?,
        Op::FirePreset { value } => {
            trigger_preset(master, *value)?;
            done.verified += 1;
        }
        Op::Default => {
            master.switch_to_mode(StartupMode::K3)?;
            done.write_cycles += 1;
            master.send_setting(Command::Set(Parameter::Default, Value::default()))?;
            master.run()?;
            master.return_to_operation()?;
            // The factory settings have another gear, which has not been read yet.
            refresh_gear(master)?;
        }
    }
    Ok(())
}

/// Sets all changed parameters in a single parameterisation, which 80000000h then stores.
fn parameterise(master: &mut Master<'_>, changes: &[ParameterChange], done: &mut WrittenChanges) -> Result<(), Error> {
    master.switch_to_mode(StartupMode::K3)?;
    done.write_cycles += 1;
    for change in changes {
        let code = u32::from(change.parameter.row().code) << Value::BITS;
        let value = Value::new(change.to).ok_or(ImplausibleValue::Value { read: code, value: change.to })?;
        master.send_setting(Command::Set(change.parameter, value))?;
    }
    master.run()?;
    master.return_to_operation()?;
    for change in changes {
        let item = || change.parameter.name().to_owned();
        let reads = read_back(master, change.parameter)?;
        check_value(item, change.to, reads)?;
        done.verified += 1;
    }
    let of_gear = |change: &ParameterChange| matches!(change.parameter, Parameter::Steps | Parameter::Turns);
    if changes.iter().any(of_gear) { refresh_gear(master) } else { Ok(()) }
}

/// Reads a parameter back. The direction is converted to its parameter value.
fn read_back(master: &mut Master<'_>, parameter: Parameter) -> Result<u32, Error> {
    let value = read_parameter(master, parameter)?;
    match parameter {
        Parameter::Direction => Ok(direction_from_read_out(value)?.code()),
        _ => Ok(value),
    }
}

/// Reads a parameter. The factory settings cannot be read, so [`Parameter::Default`] returns 0.
pub(super) fn read_parameter(master: &mut Master<'_>, parameter: Parameter) -> Result<u32, Error> {
    let number = match parameter {
        Parameter::Steps => 1,
        Parameter::Turns => 2,
        Parameter::Direction => 3,
        Parameter::Preset => 4,
        Parameter::ZeroShift => 5,
        Parameter::Default => return Ok(0),
    };
    Ok(master.read_out(ReadOutNumber::new(number))?.get())
}

fn check_value(item: impl FnOnce() -> String, wanted: u32, reads: u32) -> Result<(), Error> {
    if reads == wanted { Ok(()) } else { Err(Error::NotAccepted { item: item(), wanted, reads }) }
}

/// Selects a cam program and changes it. The changes are stored with 80000000h, then read back.
fn program(master: &mut Master<'_>, change: &ProgramChange, done: &mut WrittenChanges) -> Result<(), Error> {
    let number = change.program;
    master.switch_to_mode(StartupMode::Cams(number))?;
    done.write_cycles += 1;
    for CamChange { cam, edge, to, .. } in &change.cams {
        let (command, question) = match edge {
            Edge::Start => (Command::CamStart(*cam, *to), Command::ReadCamStart(*cam)),
            Edge::Stop => (Command::CamStop(*cam, *to), Command::ReadCamStop(*cam)),
        };
        match Reply::echo_for(command) {
            Reply::Busy { .. } => {
                master.set_and_verify(command, question, *to, || format!("{} {edge}", Item::Cam(number, *cam)))?;
            }
            _ => master.send_setting(command)?,
        }
    }
    if let Some((_, to)) = change.mask {
        master.send_setting(Command::Activate(to.into()))?;
    }
    if let Some((_, to)) = change.shift {
        master.send_setting(Command::Shift(to))?;
    }
    master.run()?;
    let mut cams: Vec<&CamChange> = change.cams.iter().collect();
    while let Some(first) = cams.first().copied() {
        let reads = read_cam(master, first.cam)?;
        for own in cams.extract_if(.., |own| own.cam == first.cam) {
            let item = || format!("{} {}", Item::Cam(number, own.cam), own.edge);
            check_value(item, own.to.get(), own.edge.position_in(reads).get())?;
        }
        done.verified += 1;
    }
    if let Some((_, to)) = change.mask {
        let reads = master.request_value(Command::ReadActivation)?.get();
        check_value(|| Item::CamMask(number).to_string(), to.into(), reads)?;
        done.verified += 1;
    }
    if let Some((_, to)) = change.shift {
        check_value(|| Item::Shift.to_string(), to.get().into(), read_shift(master)?.get().into())?;
        done.verified += 1;
    }
    Ok(())
}

/// Sets the current position to the preset value, which must have been programmed before.
fn trigger_preset(master: &mut Master<'_>, value: u32) -> Result<(), Error> {
    ensure_standstill(master)?;
    let gear = master.gear();
    // A deviation of one step is tolerated.
    master.trigger_preset(|position| shortest_distance(position, value, gear) <= 1)
}

/// Checks that the shaft is at standstill by reading its position for a short time. Position output continues
/// afterwards.
///
/// # Errors
/// Returns [`Error::Moving`] if the shaft moves, [`Error::NotRunning`] if there is no position, or another error if the
/// handshake or the exchange fails.
fn ensure_standstill(master: &mut Master<'_>) -> Result<(), Error> {
    master.switch_to_mode(StartupMode::K3)?;
    master.return_to_operation()?;
    let gear = master.gear();
    let until = master.now() + STANDSTILL_TIME;
    let mut first = None;
    while master.now() < until {
        let reading = master.read_in_word()?;
        let Some(position) = reading.position() else {
            let input = reading.word;
            return Err(Error::NotRunning { input });
        };
        let from = *first.get_or_insert(position);
        if !is_near(position, from, gear) {
            return Err(Error::Moving { from, to: position });
        }
        master.wait(READING_INTERVAL)?;
    }
    Ok(())
}

/// Returns whether two positions are close enough for a shaft at standstill. They may differ by one step or, with many
/// steps per turn, by a thousandth of a turn.
fn is_near(position: u32, other: u32, gear: Option<Gear>) -> bool {
    let most = gear.map_or(1, |gear| (gear.total_steps() / gear.turns() / 1000).max(1));
    shortest_distance(position, other, gear) <= most
}

/// Returns the shorter of the two distances between positions in the measuring range, in steps.
fn shortest_distance(position: u32, other: u32, gear: Option<Gear>) -> u32 {
    let apart = position.abs_diff(other);
    gear.map_or(apart, |gear| apart.min(gear.total_steps().saturating_sub(apart)))
}
