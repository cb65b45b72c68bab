//! Execution of a plan. First, the values on which the plan is based are read again. Then each operation is performed,
//! with an operator at the motor if required, and its result is read back. After each operation, the encoder returns to
//! operation mode.

use super::error::to_register_array;
use super::procedure::{Failure, LeftState, Operator, Outcome, ProcedureContext, ProcedureProgress, ProcedureStep};
use super::{Error, Identity, Master, ensure_standstill};
use crate::devices::biss::profile::{Bank, Base, BissPlan, BissProfile, DeviceState, Op};
use crate::devices::biss::protocol::{
    Area, Description, DeviceMode, Firmware, PositionFilter, PresetValue, ProcedureKind, RegisterAddress, Role,
};
use crate::profile::{ConfirmedPlan, Write, WriteRecord};

#[derive(Clone, Debug, Default, PartialEq)]
pub struct WrittenValues {
    pub ops: usize,
    pub written: u64,
    /// Number of registers whose new value was read back and is correct.
    pub verified: u64,
    /// Number of persistent writes that were made or may have been made.
    pub write_cycles: u64,
    pub outcomes: Vec<Outcome>,
}

impl WriteRecord for WrittenValues {
    fn operation_count(&self) -> usize {
        self.ops
    }

    fn write_cycles(&self) -> u64 {
        self.write_cycles
    }
}

pub type InterruptedWrite = crate::profile::InterruptedWrite<Op, Failure, WrittenValues, EndState>;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EndState {
    /// The step at which the write was interrupted.
    pub at: ProcedureStep,
    /// What is known about an encoder that could not be returned to operation mode. `None` means that the encoder is in
    /// operation mode with the password cleared, as after a loss of power.
    pub standing: Option<LeftState>,
}

impl InterruptedWrite {
    /// Returns the register that was written individually with an unknown result, if any. The result of a rejected or
    /// unsent write is known.
    pub fn uncertain_write(&self) -> Option<RegisterAddress> {
        match (&self.unfinished, &self.cause) {
            (Some(Op::WriteRegister { .. }), Failure::Device(Error::Cancelled | Error::Refused { .. })) => None,
            (Some(Op::WriteRegister { address, .. }), _) => Some(*address),
            _ => None,
        }
    }
}

pub struct EncoderWriter<'w, 'm> {
    guide: ProcedureContext<'w, 'm>,
    identity: &'w Identity,
    /// The step at which the last operation ended.
    at: ProcedureStep,
}

impl<'w, 'm> EncoderWriter<'w, 'm> {
    /// Creates a writer for the encoder with the given identity. `tell` is called at every step.
    ///
    /// # Errors
    /// Returns an error if the encoder has not been identified.
    pub fn new(
        master: &'w mut Master<'m>,
        identity: &'w Identity,
        operator: &'w mut dyn Operator,
        tell: &'w mut dyn FnMut(ProcedureProgress),
    ) -> Result<Self, Error> {
        let description = master.description()?;
        Ok(EncoderWriter {
            guide: ProcedureContext::new(master, description, operator, tell),
            identity,
            at: ProcedureStep::ReturnToOperation,
        })
    }
}

impl Write for EncoderWriter<'_, '_> {
    type Base = Base;
    type Op = Op;
    type Error = Failure;
    type Written = WrittenValues;
    type EndState = EndState;

    /// Checks that this encoder is the one for which the plan was made. The memory is compared as well, because two new
    /// encoders can have the same identity.
    fn confirm_base(&mut self, plan: &BissPlan) -> Result<(), Error> {
        let master = self.guide.master_mut();
        let changed = |item: &str| Err(Error::Changed { item: item.to_owned() });
        if !is_same(master, self.identity)? {
            return changed("the encoder itself");
        }
        let description = master.description()?;
        ensure_operation_mode(master, &description)?;
        let password = match description.lock() {
            Some(lock) => master.read(lock.password_at)? != 0,
            None => false,
        };
        let Base { banks, filter, preset, registers } = &plan.base;
        if filter.is_some() && read_filter(master, &description)? != *filter {
            return changed(BissProfile::FILTER);
        }
        if preset.is_some() && read_preset(master, &description)? != *preset {
            return changed(BissProfile::PRESET);
        }
        for (address, value) in registers {
            if master.read(*address)? != *value {
                return changed(&address.to_string());
            }
        }
        if !banks.is_empty() {
            ensure_standstill(master)?;
        }
        for bank in banks {
            if read_bank(master, bank.number)? != *bank {
                return changed(&format!("bank 0x{:02X}", bank.number));
            }
        }
        self.guide.set_initial_state(password);
        Ok(())
    }

    /// Performs an operation and then returns the encoder to operation mode, even after a failure. Cancelling takes
    /// effect between exchanges, unless it would leave something incomplete.
    fn apply(&mut self, op: &Op, _: &ConfirmedPlan<'_, Base, Op>, done: &mut WrittenValues) -> Result<(), Failure> {
        let guide = &mut self.guide;
        guide.begin_operation(done.outcomes.len());
        let ended = guide.execute(op);
        done.write_cycles = guide.write_cycles();
        self.at = guide.current_step();
        let led = return_to_operation(guide, ended.as_ref().err());
        count(done, op, ended?);
        // The operation is complete, but the encoder must not be left in this state.
        self.at = guide.current_step();
        Ok(led?)
    }

    fn end_state(&mut self, cause: &Failure) -> EndState {
        let mut standing = self.guide.left_state().clone();
        if matches!(cause, Failure::Device(error) if error.is_lost()) {
            standing.record_possible_power_loss();
        }
        EndState { at: self.at, standing: (!standing.is_in_operation()).then_some(standing) }
    }
}

/// Returns the encoder to operation mode if the line still works.
fn return_to_operation(guide: &mut ProcedureContext<'_, '_>, cause: Option<&Failure>) -> Result<(), Error> {
    match cause {
        Some(Failure::Device(error)) if is_link_lost(error) => Err(error.clone()),
        _ => guide.return_to_operation(),
    }
}

/// Returns whether the connection is lost and nothing more can be sent.
fn is_link_lost(error: &Error) -> bool {
    match error {
        Error::Link(_) => true,
        Error::Unclear { cause, .. } => is_link_lost(cause),
        _ => false,
    }
}

fn count(done: &mut WrittenValues, op: &Op, outcome: Outcome) {
    if !matches!(outcome, Outcome::Skipped { .. }) {
        done.ops += 1;
        done.written += op.compared_items();
        // The result of a calibration is known only from the encoder's status, as is a result that cannot be read
        // before a restart.
        let is_unverifiable =
            matches!(op, Op::Calibrate | Op::WiegandTest { .. } | Op::WriteRegister { old: None, .. });
        done.verified += if is_unverifiable { 0 } else { op.compared_items() };
    }
    done.outcomes.push(outcome);
}

fn is_same(master: &mut Master<'_>, identity: &Identity) -> Result<bool, Error> {
    let kind = &identity.kind;
    let direct = |address| RegisterAddress::direct_register(address).unwrap_or(RegisterAddress::BANK_SELECT);
    let serial = identity.description.register_with_role(Role::SerialNumber).map(|register| register.address);
    let mut wanted = vec![
        (direct(0x42), kind.profile.to_u16().to_be_bytes().to_vec()),
        (direct(0x78), kind.device_id.to_vec()),
        (direct(0x7E), kind.manufacturer.to_vec()),
    ];
    wanted.extend(serial.map(|serial| (serial, identity.serial_bytes.clone())));
    for (start, bytes) in wanted {
        if master.read_consecutive(start, bytes.len())? != bytes {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Checks that the encoder is in operation mode. In any other mode, its registers may contain values that were entered
/// but not saved.
///
/// # Errors
/// Returns [`Error::NotInOperation`] in a device mode, or another error if the exchange fails.
pub fn ensure_operation_mode(master: &mut Master<'_>, description: &Description) -> Result<(), Error> {
    match non_operational_mode(master, description)? {
        None => Ok(()),
        Some(mode) => Err(Error::NotInOperation { mode }),
    }
}

/// Returns the device mode, or `None` in operation mode and for an encoder without device modes. In a device mode,
/// registers may contain values that were never saved.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn non_operational_mode(master: &mut Master<'_>, description: &Description) -> Result<Option<DeviceMode>, Error> {
    let Some(lock) = description.lock() else { return Ok(None) };
    let mode = DeviceMode::new(master.read(lock.mode_at)?);
    Ok((mode != DeviceMode::OPERATION).then_some(mode))
}

/// Reads the state on which a plan is based: the identity, the settings and the given banks.
///
/// # Errors
/// Returns [`Error::Moving`] if banks are read while the shaft turns, [`Error::NotInOperation`] in a device mode, or
/// another error if the exchange fails.
pub fn read_state(
    master: &mut Master<'_>,
    identity: &Identity,
    banks: &[u8],
    progress: &mut dyn FnMut(u64, u8),
) -> Result<DeviceState, Error> {
    let description = &identity.description;
    ensure_operation_mode(master, description)?;
    let filter = read_filter(master, description)?;
    let preset = read_preset(master, description)?;
    if !banks.is_empty() {
        ensure_standstill(master)?;
    }
    let mut read = Vec::new();
    for (done, number) in (0..).zip(banks) {
        progress(done, *number);
        read.push(read_bank(master, *number)?);
    }
    let areas: Vec<Area> = description.areas().iter().filter(|area| area.access.is_readable()).cloned().collect();
    Ok(DeviceState { identity: identity.profile(), filter, preset, areas, banks: read })
}

/// Reads a bank. The shaft must be at standstill. If the line has damaged any data, the bank is read twice.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn read_bank(master: &mut Master<'_>, number: u8) -> Result<Bank, Error> {
    let start = RegisterAddress::in_bank(number, 0).unwrap_or(RegisterAddress::BANK_SELECT);
    let bytes = master.read_consecutive(start, Bank::SIZE)?;
    Ok(Bank { number, bytes: to_register_array(start, bytes)? })
}

/// Reads the active filter, or returns `None` if the firmware has only one.
fn read_filter(master: &mut Master<'_>, description: &Description) -> Result<Option<PositionFilter>, Error> {
    let firmware = master.station().firmware;
    let Some(register) = description.register_with_role(Role::Filter) else { return Ok(None) };
    if !has_procedure(description, firmware, ProcedureKind::FilterSelection) {
        return Ok(None);
    }
    Ok(Some(PositionFilter::from_byte(master.read(register.address)?)))
}

/// Reads the stored preset value, or returns `None` if the firmware has none.
fn read_preset(master: &mut Master<'_>, description: &Description) -> Result<Option<PresetValue>, Error> {
    let firmware = master.station().firmware;
    let place = description.procedure(ProcedureKind::Preset).and_then(|procedure| procedure.data);
    let Some(place) = place.filter(|_| has_procedure(description, firmware, ProcedureKind::Preset)) else {
        return Ok(None);
    };
    let bytes = master.read_consecutive(place, PresetValue::BYTES.into())?;
    Ok(<[u8; 6]>::try_from(bytes).ok().map(PresetValue::parse))
}

fn has_procedure(description: &Description, firmware: Option<Firmware>, kind: ProcedureKind) -> bool {
    let since = description.procedure(kind).map(|procedure| procedure.since);
    since.is_some_and(|since| firmware.is_none_or(|firmware| firmware >= since))
}
