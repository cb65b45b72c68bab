//! Jobs of a BiSS encoder and their results.

use std::fmt;

use super::Identity;
use crate::bits::hex_compact;
use crate::devices::biss::procedures::check::BissStepResult;
use crate::devices::biss::procedures::procedure::{
    Operator, OperatorAnswer, OperatorChannel, OperatorPrompt, ProcedureProgress, UnattendedOperator,
};
use crate::devices::biss::procedures::write::{InterruptedWrite, WrittenValues};
use crate::devices::biss::procedures::{EncoderStatus, Error, PositionReading, Survey};
use crate::devices::biss::profile::{
    Bank, BissPlan, BissProfile, MotorSource, MountingSteps, PlanError, PresetParts, RegisterRange, RestoreOptions,
    TypeMismatch,
};
use crate::devices::biss::protocol::{
    Area, DeviceMode, Identity as Kind, KIND, PositionFilter, PresetValue, RegisterAddress,
};
use crate::store::{DeviceKey, EntryKind, StoreError};
use crate::worker::commit::{ApprovedPlan, CycleCount, total_cycles_to_report};

/// Limit for the number of persistent writes to an encoder (manual 6.1: "1000 write cycles should not be
/// exceeded").
pub const WEAR_LIMIT: u64 = 1000;
/// Number of persistent writes at which warnings start.
pub const WEAR_WARNING: u64 = 800;

#[derive(Debug)]
pub enum BissJob {
    /// Reads all values that are displayed after connecting.
    Survey,
    Identify,
    /// Reads the device mode, errors, warnings, temperature and filter.
    Status,
    /// Checks the encoder against its description and its data sheet, checks the line, and rates each item.
    Check,
    Position,
    /// Reads consecutive registers. Registers of a data area are read only at standstill.
    Read(RegisterRange),
    /// Reads all direct registers, 40h to 7Fh.
    ReadDirect,
    ReadBank(u8),
    /// Reads all registers of a data area, at standstill.
    ReadArea(Area),
    /// Reads all values that a profile can restore, at standstill. The profile is marked if some of them may never have
    /// been saved in the encoder.
    Save,
    /// Reads the encoder for comparison. The job fails if some values may never have been saved.
    SaveToCompare,
    /// Prepares a plan without writing.
    Prepare(Change),
    Commit(Box<Commit>),
    /// Returns the encoder to operation mode and clears the password, even if another program changed the mode.
    ReturnToOperation,
}

#[derive(Clone, Debug)]
pub enum Change {
    Restore {
        profile: Box<BissProfile>,
        options: RestoreOptions,
    },
    /// Writes registers, given as addresses and bytes. Registers of a data area are saved together.
    Write(Vec<(RegisterRange, Vec<u8>)>),
    SelectFilter(PositionFilter),
    /// Stores the preset value, if given, and then sets the given parts of the shaft position to the stored value.
    Preset {
        value: Option<PresetValue>,
        parts: Option<PresetParts>,
    },
    Guided {
        run: MountingSteps,
        motor: MotorSource,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    Restore,
    /// Edited bytes. Bytes that could not be written remain marked as edited.
    Bytes,
    /// Guided procedures. An interrupted procedure must be started from the beginning.
    Guided,
    /// Guided procedures with a calibration. No backup contains the calibration table.
    Calibration,
    /// Only the Wiegand test, with its result saved.
    WiegandTest,
    Filter,
    /// A preset value to store, a position to set to it, or both.
    Preset,
}

impl ChangeKind {
    /// Returns the kind of logbook entry for this change.
    pub const fn entry_kind(self) -> EntryKind {
        match self {
            ChangeKind::Restore => EntryKind::Restore,
            ChangeKind::Bytes | ChangeKind::Filter => EntryKind::Write,
            ChangeKind::Guided | ChangeKind::Calibration | ChangeKind::WiegandTest => EntryKind::Procedure,
            ChangeKind::Preset => EntryKind::Preset,
        }
    }
}

impl Change {
    pub fn kind(&self) -> ChangeKind {
        match self {
            Change::Restore { .. } => ChangeKind::Restore,
            Change::Write(_) => ChangeKind::Bytes,
            Change::Guided { run, .. } if run.calibrate => ChangeKind::Calibration,
            Change::Guided { run, .. } if run.preset.is_none() && run.data.is_none() => ChangeKind::WiegandTest,
            Change::Guided { .. } => ChangeKind::Guided,
            Change::SelectFilter(_) => ChangeKind::Filter,
            Change::Preset { .. } => ChangeKind::Preset,
        }
    }
}

#[derive(Clone, Debug)]
pub struct Prepared {
    pub kind: ChangeKind,
    pub plan: BissPlan,
    pub identity: Identity,
    /// Number of persistent writes to the encoder recorded on this computer, or `None` if there is no record.
    pub cycles_seen: Option<CycleCount>,
    /// Number of registers that already have the intended value.
    pub unchanged: u64,
    /// Settings of a profile that the encoder does not have.
    pub missing: Vec<String>,
    /// Registers that differ but are skipped, because their values are only valid for another encoder on its motor.
    pub mounting_left: Vec<RegisterRange>,
    /// Device mode in which the profile was read, if the profile may contain values that were never saved in the
    /// encoder.
    pub unsaved: Option<DeviceMode>,
    pub other_type: Option<TypeMismatch>,
    /// Registers to write whose values were adjusted for another encoder on its motor. They must be adjusted again for
    /// this encoder.
    pub mounting_written: Vec<RegisterRange>,
}

impl Prepared {
    /// Returns the number of flash write cycles used after this write, as far as known. Returns `None` if no warning is
    /// needed.
    pub fn wear_to_report(&self) -> Option<u64> {
        total_cycles_to_report(self.cycles_seen, self.plan.write_cycles(), WEAR_WARNING)
    }
}

#[derive(Clone, Debug)]
pub struct Commit {
    pub agreed: ApprovedPlan<Prepared>,
    pub attendance: OperatorPresence,
}

/// The operator at the motor while a plan is executed, or the substitute if no operator is present.
#[derive(Clone, Debug)]
pub enum OperatorPresence {
    Attended(OperatorChannel),
    Unattended(UnattendedOperator),
}

impl Operator for OperatorPresence {
    fn on_task_start(&mut self) {
        match self {
            OperatorPresence::Attended(seat) => seat.on_task_start(),
            OperatorPresence::Unattended(operator) => operator.on_task_start(),
        }
    }

    fn ask(&mut self, demand: &OperatorPrompt) -> OperatorAnswer {
        match self {
            OperatorPresence::Attended(seat) => seat.ask(demand),
            OperatorPresence::Unattended(operator) => operator.ask(demand),
        }
    }
}

pub type Committed = crate::worker::CommitResult<WrittenValues>;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RegisterValues {
    pub start: RegisterAddress,
    /// Values in address order.
    pub bytes: Vec<u8>,
    /// Device mode during the reading, if the registers may show values that were never saved in the encoder.
    pub unsaved: Option<DeviceMode>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DeviceMessage {
    /// Number of frames with a wrong checksum, without those counted in a position reading.
    CrcErrors(u32),
    /// User-defined descriptions that cannot be used.
    Descriptions(Vec<StoreError>),
}

#[derive(Clone, Debug, PartialEq)]
pub enum JobStep {
    Register(RegisterAddress),
    Bank(u8),
    Operation { item: String, progress: Box<ProcedureProgress> },
}

impl fmt::Display for JobStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            JobStep::Register(address) => write!(f, "{address}"),
            JobStep::Bank(bank) => write!(f, "bank:0x{bank:02X}"),
            JobStep::Operation { item, .. } => f.write_str(item),
        }
    }
}

#[derive(Debug)]
pub enum BissOutput {
    Surveyed(Box<Survey>),
    Identity(Box<Identity>),
    Status(Box<EncoderStatus>),
    Check(Vec<BissStepResult>),
    Position(PositionReading),
    Registers(RegisterValues),
    Area {
        banks: Vec<Bank>,
        /// Device mode during the reading, if the registers may show values that were never saved in the encoder.
        unsaved: Option<DeviceMode>,
    },
    Saved(Box<BissProfile>),
    Prepared(Box<Prepared>),
    Committed(Box<Committed>),
    /// The encoder was returned to operation mode from the given device mode.
    ReturnedToOperation(DeviceMode),
}

pub type JobError = crate::worker::JobError<Error, PlanError, InterruptedWrite, ChangeKind>;

impl From<PlanError> for JobError {
    fn from(error: PlanError) -> Self {
        JobError::Plan(error)
    }
}

/// Returns the key that identifies an encoder in backups and the logbook. It includes the manufacturer and the device
/// ID, because a serial number is unique only together with them.
pub fn device_key(identity: &Identity, is_virtual: bool) -> DeviceKey {
    logbook_key(&identity.kind, &identity.serial_number, is_virtual)
}

pub fn logbook_key(kind: &Kind, serial_number: &str, is_virtual: bool) -> DeviceKey {
    let (manufacturer, device) = (hex_compact(&kind.manufacturer), hex_compact(&kind.device_id));
    DeviceKey::new(KIND, &format!("{manufacturer}-{device}"), serial_number, is_virtual)
}
