//! Planning single changes and guided procedures. The rules of the encoder are checked before anything is sent.

use std::collections::{BTreeMap, BTreeSet};

use super::restore::{check_preset_width, store_operations};
use super::{
    Bank, Base, BissPlan, BissProfile, DeviceState, Op, PlanError, PresetParts, RegisterChange, RegisterRange,
    plan_data_areas,
};
use crate::devices::biss::protocol::{
    Area, Description, Firmware, PositionFilter, PresetValue, Procedure, ProcedureKind, RegisterAddress,
};

/// Oldest firmware that can preset singleturn and multiturn separately (manual 6.7).
const PRESET_PARTS_SINCE: Firmware = Firmware::new(1, 6, 0);

/// The kind of motor that turns the shaft during a procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorSource {
    /// A motor that does not depend on this encoder: a separate motor, a drive in open-loop control, or one with
    /// another feedback device.
    Other,
    /// A drive that closes its loop on this encoder. The encoder provides no position during the procedure.
    ThisEncoder,
}

/// The steps after an encoder has been mounted on a motor, in the order in which they are performed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MountingSteps {
    /// Whether to calibrate the singleturn position.
    pub calibrate: bool,
    /// Whether to save the result of the Wiegand test. `None` skips the test.
    pub wiegand: Option<bool>,
    /// Preset value for the current shaft position, and the parts of the position to set.
    pub preset: Option<(PresetValue, PresetParts)>,
    /// Profile from which the data areas are written, if any.
    pub data: Option<Box<BissProfile>>,
}

impl MountingSteps {
    /// Returns whether any of the steps needs a motor.
    pub fn needs_motor(&self) -> bool {
        self.calibrate || self.wiegand.is_some()
    }

    /// Checks that no step needs a motor, or that the motor does not depend on this encoder.
    ///
    /// # Errors
    /// Returns [`PlanError::DrivenByThisEncoder`] if the required motor depends on this encoder.
    pub fn check_motor(&self, motor: MotorSource) -> Result<(), PlanError> {
        if self.needs_motor() && motor == MotorSource::ThisEncoder {
            return Err(PlanError::DrivenByThisEncoder);
        }
        Ok(())
    }
}

/// How a register has to be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RegisterKind<'d> {
    /// The register is part of a data area, which is opened and saved as a whole.
    Data(&'d Area),
    /// The register is written individually.
    Register,
}

/// Returns how a register has to be written.
///
/// # Errors
/// Returns [`PlanError::ReadOnly`], or [`PlanError::Guarded`] for a register that only procedures may write.
pub fn register_kind(description: &Description, address: RegisterAddress) -> Result<RegisterKind<'_>, PlanError> {
    if is_protected_register(description, address) {
        return Err(PlanError::Guarded { address });
    }
    if description.access_at(address).is_some_and(|access| !access.is_writable()) {
        return Err(PlanError::ReadOnly { address });
    }
    let area = description.area_at(address).filter(|area| area.open.is_some());
    Ok(area.map_or(RegisterKind::Register, RegisterKind::Data))
}

/// Returns whether a register may only be written by a procedure, or holds the device mode or the password. Registers
/// of a data area are never protected.
fn is_protected_register(description: &Description, address: RegisterAddress) -> bool {
    let locks = description.lock().is_some_and(|lock| [lock.password_at, lock.mode_at].contains(&address));
    let leads = |procedure: &Procedure| {
        let preset = procedure.data.filter(|_| procedure.kind == ProcedureKind::Preset);
        let value = preset.and_then(|start| RegisterRange::new(start, PresetValue::BYTES));
        procedure.command == address || value.is_some_and(|range| range.contains(address))
    };
    locks || description.procedures().iter().any(leads)
}

/// Returns the encoder's procedure of the given kind.
///
/// # Errors
/// Returns [`PlanError::NoProcedure`] or [`PlanError::FirmwareTooOld`] if the encoder does not have the procedure.
pub fn find_procedure(
    description: &Description,
    firmware: Option<Firmware>,
    kind: ProcedureKind,
) -> Result<&Procedure, PlanError> {
    let name = || description.name().to_owned();
    let procedure = description.procedure(kind).ok_or_else(|| PlanError::NoProcedure { kind, description: name() })?;
    match firmware {
        Some(found) if found < procedure.since => {
            Err(PlanError::FirmwareTooOld { kind, needed: procedure.since, found })
        }
        _ => Ok(procedure),
    }
}

/// Plans to write the given bytes. If a register occurs more than once, its last value applies. Edits that change
/// nothing are omitted. `banks` and `registers` contain the current values of all edited registers, or `None` if a
/// register cannot be read.
///
/// # Errors
/// Returns a [`PlanError`] if an edit is not allowed.
pub fn plan_edits(
    description: &Description,
    banks: &[Bank],
    registers: &[(RegisterAddress, Option<u8>)],
    edits: &[(RegisterRange, Vec<u8>)],
) -> Result<BissPlan, PlanError> {
    let mut wanted: BTreeMap<RegisterAddress, u8> = BTreeMap::new();
    for (range, bytes) in edits {
        if usize::from(range.count()) != bytes.len() {
            return Err(PlanError::ByteCount { range: *range, count: bytes.len() });
        }
        wanted.extend(range.addresses().zip(bytes.iter().copied()));
    }
    let mut base = Base::default();
    let mut singles = Vec::new();
    let mut areas: Vec<(&Area, Vec<RegisterChange>)> = Vec::new();
    let mut touched = BTreeSet::new();
    for (address, new) in wanted {
        match register_kind(description, address)? {
            RegisterKind::Register => {
                let old = registers.iter().find(|(own, _)| *own == address).and_then(|(_, old)| *old);
                if old != Some(new) {
                    base.registers.extend(old.map(|old| (address, old)));
                    singles.push(Op::WriteRegister {
                        address,
                        old,
                        new,
                        cycles: write_cycles(description, address, new),
                    });
                }
            }
            RegisterKind::Data(area) => {
                let bank = banks.iter().find(|bank| Some(bank.number) == address.bank());
                let bank = bank.ok_or(PlanError::NoBank { bank: address.bank().unwrap_or_default() })?;
                let old = bank.registers().find(|(own, _)| *own == address).map_or(new, |(_, old)| old);
                if old == new {
                    continue;
                }
                touched.insert(bank.number);
                let change = RegisterChange { address, old, new };
                match areas.iter_mut().find(|(own, _)| *own == area) {
                    Some((_, changes)) => changes.push(change),
                    None => areas.push((area, vec![change])),
                }
            }
        }
    }
    base.banks.extend(banks.iter().filter(|bank| touched.contains(&bank.number)));
    let mut ops: Vec<Op> = areas.into_iter().flat_map(|(area, changes)| store_operations(area, changes)).collect();
    ops.extend(singles);
    Ok(BissPlan { base, ops })
}

/// Returns the number of persistent writes caused by writing a value. A register without a description is assumed to
/// cause one.
fn write_cycles(description: &Description, address: RegisterAddress, value: u8) -> u8 {
    description.register_at(address).map_or(1, |register| u8::from(register.costs_write_cycle(value)))
}

/// Plans to select a filter. The plan is empty if this filter is already active.
///
/// # Errors
/// Returns an error if the filter does not exist or the encoder offers no choice.
pub fn plan_filter(description: &Description, device: &DeviceState, to: PositionFilter) -> Result<BissPlan, PlanError> {
    let from = require_setting(description, device, ProcedureKind::FilterSelection, device.filter)?;
    if let PositionFilter::Unknown(code) = to {
        return Err(PlanError::UnknownFilter { code });
    }
    let base = Base { filter: Some(from), ..Base::default() };
    Ok(BissPlan { base, ops: if from == to { vec![] } else { vec![Op::SelectFilter { from, to }] } })
}

/// Plans to store a preset value, unless it is already stored. With `parts`, these parts of the shaft position are then
/// set to the stored value.
///
/// # Errors
/// Returns an error if the value is too wide, the encoder has no preset, or the given parts cannot be preset
/// separately.
pub fn plan_preset(
    description: &Description,
    device: &DeviceState,
    value: Option<PresetValue>,
    parts: Option<PresetParts>,
) -> Result<BissPlan, PlanError> {
    let kind = ProcedureKind::Preset;
    let from = require_setting(description, device, kind, device.preset)?;
    if let (Some(PresetParts::Singleturn | PresetParts::Multiturn), Some(found)) = (parts, device.identity.firmware)
        && found < PRESET_PARTS_SINCE
    {
        return Err(PlanError::FirmwareTooOld { kind, needed: PRESET_PARTS_SINCE, found });
    }
    let to = value.unwrap_or(from);
    check_preset_width(to, &device.identity)?;
    let mut ops = Vec::new();
    if to != from {
        ops.push(Op::StorePreset { from, to });
    }
    ops.extend(parts.map(|parts| Op::FirePreset { parts, value: to }));
    Ok(BissPlan { base: Base { preset: Some(from), ..Base::default() }, ops })
}

/// Plans the guided procedures after an encoder has been mounted on a motor.
///
/// # Errors
/// Returns a [`PlanError`] if a step is not possible, for example because it needs a motor and the motor depends on
/// this encoder.
pub fn plan_mounting(
    description: &Description,
    device: &DeviceState,
    run: &MountingSteps,
    motor: MotorSource,
) -> Result<BissPlan, PlanError> {
    let firmware = device.identity.firmware;
    run.check_motor(motor)?;
    let mut plan = BissPlan { base: Base::default(), ops: Vec::new() };
    if run.calibrate {
        find_procedure(description, firmware, ProcedureKind::Calibration)?;
        if let Some(filter) = device.filter.filter(|filter| *filter != PositionFilter::Balanced) {
            return Err(PlanError::NotBalanced { code: filter.byte() });
        }
        plan.base.filter = device.filter;
        plan.ops.push(Op::Calibrate);
    }
    if let Some(save) = run.wiegand {
        find_procedure(description, firmware, ProcedureKind::WiegandTest)?;
        plan.ops.push(Op::WiegandTest { save });
    }
    if let Some((value, parts)) = run.preset {
        let preset = plan_preset(description, device, Some(value), Some(parts))?;
        plan.base.preset = preset.base.preset;
        plan.ops.extend(preset.ops);
    }
    if let Some(profile) = &run.data {
        let data = plan_data_areas(profile, device)?.plan;
        plan.base.banks = data.base.banks;
        plan.ops.extend(data.ops);
    }
    Ok(plan)
}

/// Returns a setting of the encoder, or an error if the encoder does not have it.
fn require_setting<T: Copy>(
    description: &Description,
    device: &DeviceState,
    kind: ProcedureKind,
    setting: Option<T>,
) -> Result<T, PlanError> {
    find_procedure(description, device.identity.firmware, kind)?;
    setting.ok_or_else(|| PlanError::NoProcedure { kind, description: description.name().to_owned() })
}

#[cfg(test)]
mod tests;
