//! Planning a restore. Only differences are written, with as few persistent writes as possible. Values that are only
//! valid for another encoder on its motor are not written. A preset value is stored, but the position is not set.

pub use crate::profile::RestoreOptions;

use super::other_type::{TypeMismatch, other_type};
use super::{Bank, Base, BissPlan, BissProfile, Op, ProfileIdentity, RegisterChange, RegisterRange};
use crate::devices::biss::protocol::{Area, Firmware, PositionFilter, PresetValue, ProcedureKind, RegisterAddress};

/// The current state of an encoder, as far as a plan needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceState {
    /// Identity of the encoder.
    pub identity: ProfileIdentity,
    /// Active filter, or `None` if the encoder offers no choice.
    pub filter: Option<PositionFilter>,
    /// Stored preset value, or `None` if the encoder has none.
    pub preset: Option<PresetValue>,
    /// Data areas of the encoder.
    pub areas: Vec<Area>,
    /// Banks that were read. They include at least those returned by [`required_banks`].
    pub banks: Vec<Bank>,
}

/// The result of planning a restore.
pub type Restore = crate::profile::Restore<BissPlan, RegisterRange>;

/// Reason why a change cannot be planned.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// The profile was read from an encoder with a different serial number.
    #[error("the profile is for serial number {profile:?}, but the encoder has {device:?}")]
    OtherDevice {
        /// Serial number in the profile.
        profile: String,
        /// Serial number of the encoder.
        device: String,
    },
    /// The profile was read from an encoder of a different type.
    #[error(transparent)]
    TypeMismatch(#[from] TypeMismatch),
    /// The bank does not belong to a data area of the encoder, or cannot be written.
    #[error("bank 0x{bank:02X} is not a writable bank of user data")]
    NoBank {
        /// Number of the bank.
        bank: u8,
    },
    /// The preset value is wider than the position.
    #[error("the preset value {value} needs more than the {bits} {part} bits that the encoder has")]
    PresetTooWide {
        /// Part of the position that is too narrow: `singleturn` or `multiturn`.
        part: &'static str,
        /// Requested preset value.
        value: u32,
        /// Width of that part in bits.
        bits: u8,
    },
    /// There is no filter with this code.
    #[error("0x{code:02X} is not a valid filter")]
    UnknownFilter {
        /// Requested filter code.
        code: u8,
    },
    /// The description of the encoder does not contain the procedure.
    #[error("\"{description}\" has no such procedure")]
    NoProcedure {
        /// Requested procedure.
        kind: ProcedureKind,
        /// Name of the description.
        description: String,
    },
    /// The firmware of the encoder is too old for the procedure.
    #[error("firmware {needed} is required, but the encoder has {found}")]
    FirmwareTooOld {
        /// Requested procedure.
        kind: ProcedureKind,
        /// Oldest firmware that supports the procedure.
        needed: Firmware,
        /// Firmware of the encoder.
        found: Firmware,
    },
    /// The register is read-only.
    #[error("register {address} can only be read")]
    ReadOnly {
        /// Address of the register.
        address: RegisterAddress,
    },
    /// Only a procedure may write the register.
    #[error("register {address} can be written only by the procedures")]
    Guarded {
        /// Address of the register.
        address: RegisterAddress,
    },
    /// The number of bytes does not match the size of the range.
    #[error("{range} cannot be written with {count} bytes")]
    ByteCount {
        /// Range to be written.
        range: RegisterRange,
        /// Number of bytes that were specified.
        count: usize,
    },
    /// The calibration requires the balanced filter, but another filter is active.
    #[error("the calibration requires the balanced filter, but the filter is 0x{code:02X}")]
    NotBalanced {
        /// Code of the active filter.
        code: u8,
    },
    /// The drive of the motor closes its loop on this encoder, but the encoder provides no position during the
    /// procedure.
    #[error("the motor is controlled with this encoder's position, which is not available during the procedure")]
    DrivenByThisEncoder,
}

/// Returns the banks that must be read before a restore of the given profile can be planned.
pub fn required_banks(profile: &BissProfile, areas: &[Area]) -> Vec<u8> {
    let there = |bank: &u8| areas.iter().any(|area| area.contains(*bank));
    profile.banks().map(|bank| bank.number).filter(there).collect()
}

/// Plans a restore without writing anything.
///
/// # Errors
/// Returns a [`PlanError`] if the restore is not allowed.
pub fn plan_restore(
    profile: &BissProfile,
    device: &DeviceState,
    options: RestoreOptions,
) -> Result<Restore, PlanError> {
    check_allowed(profile, &device.identity, options)?;
    let same_device = is_same_device(profile, &device.identity);
    let mounting = if same_device { MountingPolicy::Own } else { MountingPolicy::for_other_device(options) };
    let mut planner = Planner::new(profile, device, mounting);
    planner.data()?;
    planner.filter()?;
    planner.preset()?;
    Ok(planner.finish())
}

/// Plans to write only the data areas of a profile, to an encoder that is being mounted. The plan includes values that
/// are only valid on this motor.
///
/// # Errors
/// Returns a [`PlanError`] if the data areas cannot be written.
pub fn plan_data_areas(profile: &BissProfile, device: &DeviceState) -> Result<Restore, PlanError> {
    let mut planner = Planner::new(profile, device, MountingPolicy::Own);
    planner.data()?;
    Ok(planner.finish())
}

/// Checks that a profile was read from this encoder. The check always fails for an encoder without a serial number.
///
/// # Errors
/// Returns [`PlanError::TypeMismatch`] or [`PlanError::OtherDevice`] if the profile was read from another encoder.
pub fn check_device(profile: &BissProfile, device: &ProfileIdentity) -> Result<(), PlanError> {
    check_allowed(profile, device, RestoreOptions::default())
}

/// Checks that a profile was read from this encoder, unless the options allow another encoder. A different type must be
/// allowed separately from a different serial number, because its registers may have different meanings.
///
/// # Errors
/// Returns [`PlanError::TypeMismatch`] or [`PlanError::OtherDevice`] if the encoder is not allowed.
pub fn check_allowed(
    profile: &BissProfile,
    device: &ProfileIdentity,
    options: RestoreOptions,
) -> Result<(), PlanError> {
    if let Some(error) = other_type(&profile.identity, device).filter(|_| !options.allow_other_type) {
        return Err(error.into());
    }
    if options.allow_other_device || has_same_serial_number(profile, device) {
        return Ok(());
    }
    Err(PlanError::OtherDevice {
        profile: profile.identity.serial_number.clone(),
        device: device.serial_number.clone(),
    })
}

fn is_same_device(profile: &BissProfile, device: &ProfileIdentity) -> bool {
    has_same_serial_number(profile, device) && other_type(&profile.identity, device).is_none()
}

fn has_same_serial_number(profile: &BissProfile, device: &ProfileIdentity) -> bool {
    !device.serial_number.is_empty() && profile.identity.serial_number == device.serial_number
}

/// Checks that a preset value fits the position.
///
/// # Errors
/// Returns [`PlanError::PresetTooWide`] if the value does not fit.
pub(super) fn check_preset_width(value: PresetValue, identity: &ProfileIdentity) -> Result<(), PlanError> {
    let parts = [
        ("singleturn", value.singleturn(), identity.singleturn_bits),
        ("multiturn", value.multiturn(), identity.multiturn_bits),
    ];
    for (part, value, bits) in parts {
        if let Some(bits) = bits.filter(|bits| u64::from(value).checked_shr((*bits).into()).unwrap_or(0) != 0) {
            return Err(PlanError::PresetTooWide { part, value, bits });
        }
    }
    Ok(())
}

/// How to treat values that are only valid for one encoder on its motor.
#[derive(Clone, Copy, PartialEq, Eq)]
enum MountingPolicy {
    /// The values belong to this encoder.
    Own,
    /// The values belong to another encoder and are skipped.
    Leave,
    /// The values belong to another encoder, but the user has asked to write them.
    Write,
}

impl MountingPolicy {
    fn for_other_device(options: RestoreOptions) -> Self {
        if options.with_mounting { MountingPolicy::Write } else { MountingPolicy::Leave }
    }
}

struct Planner<'a> {
    profile: &'a BissProfile,
    device: &'a DeviceState,
    mounting: MountingPolicy,
    base: Base,
    ops: Vec<Op>,
    unchanged: u64,
    missing: Vec<String>,
    left: Vec<RegisterAddress>,
    mounting_written: Vec<RegisterAddress>,
}

impl<'a> Planner<'a> {
    fn new(profile: &'a BissProfile, device: &'a DeviceState, mounting: MountingPolicy) -> Self {
        Planner {
            profile,
            device,
            mounting,
            base: Base::default(),
            ops: Vec::new(),
            unchanged: 0,
            missing: Vec::new(),
            left: Vec::new(),
            mounting_written: Vec::new(),
        }
    }

    /// Plans to write all differences in the data areas, with a single save for each area.
    fn data(&mut self) -> Result<(), PlanError> {
        let mut areas: Vec<(&Area, Vec<RegisterChange>)> = Vec::new();
        for wanted in self.profile.banks() {
            let bank = wanted.number;
            let area = self.device.areas.iter().find(|area| area.contains(bank));
            let area = area.ok_or(PlanError::NoBank { bank })?;
            let now = self.device.banks.iter().find(|own| own.number == bank).ok_or(PlanError::NoBank { bank })?;
            let changes = self.register_changes(now, &wanted);
            if changes.is_empty() {
                continue;
            }
            if !area.access.is_writable() {
                return Err(PlanError::NoBank { bank });
            }
            self.base.banks.push(*now);
            match areas.iter_mut().find(|(own, _)| *own == area) {
                Some((_, registers)) => registers.extend(changes),
                None => areas.push((area, changes)),
            }
        }
        self.ops.extend(areas.into_iter().flat_map(|(area, registers)| store_operations(area, registers)));
        Ok(())
    }

    /// Returns a change for each register of a bank that differs and may be written.
    fn register_changes(&mut self, now: &Bank, wanted: &Bank) -> Vec<RegisterChange> {
        let mut changes = Vec::new();
        for ((address, old), (_, new)) in now.registers().zip(wanted.registers()) {
            if old == new {
                self.unchanged += 1;
            } else if self.mounting == MountingPolicy::Leave && self.profile.depends_on_mounting(address) {
                self.left.push(address);
            } else {
                if self.mounting == MountingPolicy::Write && self.profile.depends_on_mounting(address) {
                    self.mounting_written.push(address);
                }
                changes.push(RegisterChange { address, old, new });
            }
        }
        changes
    }

    fn filter(&mut self) -> Result<(), PlanError> {
        match (self.profile.filter, self.device.filter) {
            (None, _) => {}
            (Some(_), None) => self.missing.push(BissProfile::FILTER.to_owned()),
            (Some(to), Some(from)) if to == from => self.unchanged += 1,
            (Some(PositionFilter::Unknown(code)), Some(_)) => return Err(PlanError::UnknownFilter { code }),
            (Some(to), Some(from)) => {
                self.base.filter = Some(from);
                self.ops.push(Op::SelectFilter { from, to });
            }
        }
        Ok(())
    }

    fn preset(&mut self) -> Result<(), PlanError> {
        let wanted = self.profile.preset.as_ref().map(|preset| preset.value);
        match (wanted, self.device.preset) {
            (None, _) => {}
            (Some(_), None) => self.missing.push(BissProfile::PRESET.to_owned()),
            (Some(to), Some(from)) if to == from => self.unchanged += to.emit().len() as u64,
            (Some(_), Some(_)) if self.mounting == MountingPolicy::Leave => self.left.extend(preset_addresses()),
            (Some(to), Some(from)) => {
                check_preset_width(to, &self.device.identity)?;
                if self.mounting == MountingPolicy::Write {
                    self.mounting_written.extend(preset_addresses());
                }
                self.base.preset = Some(from);
                self.ops.push(Op::StorePreset { from, to });
            }
        }
        Ok(())
    }

    fn finish(mut self) -> Restore {
        self.left.sort_unstable();
        self.mounting_written.sort_unstable();
        Restore {
            plan: BissPlan { base: self.base, ops: self.ops },
            unchanged: self.unchanged,
            missing: self.missing,
            mounting_left: RegisterRange::from_addresses(self.left),
            mounting_written: RegisterRange::from_addresses(self.mounting_written),
        }
    }
}

fn preset_addresses() -> impl Iterator<Item = RegisterAddress> {
    BissProfile::PRESET.parse::<RegisterRange>().into_iter().flat_map(RegisterRange::addresses)
}

/// Returns the operations that store changes in an area. An area that is opened and saved as a whole needs only one.
/// Otherwise, each register needs its own.
pub(super) fn store_operations(area: &Area, registers: Vec<RegisterChange>) -> Vec<Op> {
    if area.open.is_some() {
        return vec![Op::StoreData { area: area.clone(), registers }];
    }
    let single = |change: RegisterChange| Op::WriteRegister {
        address: change.address,
        old: Some(change.old),
        new: change.new,
        // The cost is unknown, but it is at most one write cycle.
        cycles: 1,
    };
    registers.into_iter().map(single).collect()
}

#[cfg(test)]
mod tests;
