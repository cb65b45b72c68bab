//! Jobs of a BiSS encoder and their results.

use std::fmt;

use super::Identity;
use crate::bits::hex_compact;
use crate::devices::biss::procedures::check::BissStepResult;
use crate::devices::biss::procedures::procedure::{
    Answer, Demand, Operator, OperatorChannel, ProcedureProgress, Unattended,
};
use crate::devices::biss::procedures::write::{Interrupted, Written};
use crate::devices::biss::procedures::{Error, PositionReading, Status, Survey};
use crate::devices::biss::profile::{
    Bank, BissPlan, BissProfile, MotorSource, MountingRun, OtherType, PlanError, PresetParts, RegisterRange,
    RestoreOptions,
};
use crate::devices::biss::protocol::{Area, DeviceMode, Filter, KIND, PresetValue, RegisterAddress};
use crate::store::{DeviceKey, StoreError};
use crate::worker::commit::{ApprovedPlan, wear};

/// Number of persistent writes at which an encoder has reached its limit (manual 6.1: "1000 write cycles should not be
/// exceeded").
pub const WEAR_LIMIT: u64 = 1000;
/// Number of persistent writes from which the user is warned.
pub const WEAR_WARNING: u64 = 800;

#[derive(Debug)]
pub enum BissJob {
    /// Read everything that is displayed after connecting.
    Survey,
    Identify,
    /// Mode, errors, warnings, temperature, filter.
    Status,
    /// Check the encoder against its description, its data sheet and the line, with a verdict for each item.
    Check,
    Position,
    /// Read consecutive registers; those of a data area only at standstill.
    Read(RegisterRange),
    /// Reads all direct registers, 40h…7Fh.
    ReadDirect,
    ReadBank(u8),
    /// Reads all registers of a data area, at standstill.
    ReadArea(Area),
    /// Reads everything that can be restored, at standstill. Values that were never saved are marked.
    Save,
    /// Save for a comparison, which is refused if there may be values that were never saved.
    SaveToCompare,
    /// Prepare a plan without writing.
    Prepare(Change),
    Commit(Box<Commit>),
    /// Return the encoder to operation and clear the password, whoever changed the mode.
    LeadBack,
}

#[derive(Clone, Debug)]
pub enum Change {
    Restore {
        profile: Box<BissProfile>,
        options: RestoreOptions,
    },
    /// Write registers, given as addresses and bytes. Those of a data area are saved together.
    Write(Vec<(RegisterRange, Vec<u8>)>),
    SelectFilter(Filter),
    /// Store this preset value, if given; then set the given parts of the position at the present shaft angle to the
    /// stored value.
    Preset {
        value: Option<PresetValue>,
        parts: Option<PresetParts>,
    },
    Guided {
        run: MountingRun,
        motor: MotorSource,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    Restore,
    /// Edited bytes; those not yet written remain edits.
    Bytes,
    /// Guided procedures; incomplete ones are started again.
    Guided,
    /// Guided procedures including a calibration, whose table no backup contains.
    Calibration,
    /// Only the Wiegand test, which stores nothing but its result.
    WiegandTest,
    Filter,
    /// Preset: its value, its execution, or both.
    Preset,
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
    /// Number of persistent writes to the encoder recorded on this computer, or `None` if the logbook has no record.
    pub cycles_seen: Option<u64>,
    /// Number of registers that already have the intended value.
    pub unchanged: u64,
    /// Settings of a profile that the encoder does not have.
    pub missing: Vec<String>,
    /// Values of the mounting that differ and are left alone.
    pub mounting_left: Vec<RegisterRange>,
    /// Device mode in which the profile to restore was read, if it may contain values that were never saved.
    pub unsaved: Option<DeviceMode>,
    pub other_type: Option<OtherType>,
    /// Written values that belong to the mounting of another device and must be set up again.
    pub mounting_written: Vec<RegisterRange>,
}

impl Prepared {
    /// Returns the minimum number of write cycles of the flash, if the user should be warned.
    pub fn wear(&self) -> Option<u64> {
        wear(self.cycles_seen, self.plan.write_cycles(), WEAR_WARNING)
    }
}

#[derive(Clone, Debug)]
pub struct Commit {
    pub agreed: ApprovedPlan<Prepared>,
    pub attendance: OperatorPresence,
}

/// Presence of an operator at the motor while a plan is carried out.
#[derive(Clone, Debug)]
pub enum OperatorPresence {
    Attended(OperatorChannel),
    Unattended(Unattended),
}

impl Operator for OperatorPresence {
    fn on_task_start(&mut self) {
        match self {
            OperatorPresence::Attended(seat) => seat.on_task_start(),
            OperatorPresence::Unattended(nobody) => nobody.on_task_start(),
        }
    }

    fn attend(&mut self, demand: &Demand) -> Answer {
        match self {
            OperatorPresence::Attended(seat) => seat.attend(demand),
            OperatorPresence::Unattended(nobody) => nobody.attend(demand),
        }
    }
}

pub type Committed = crate::worker::Committed<Written>;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadRegisters {
    pub start: RegisterAddress,
    /// Values in address order.
    pub bytes: Vec<u8>,
    /// Device mode during the reading, if the registers may show values that were never saved.
    pub unsaved: Option<DeviceMode>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DeviceMessage {
    /// Frames with a wrong checksum that belong to no reading.
    CrcErrors(u32),
    /// Descriptions of the user's own that cannot be used.
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
    Status(Box<Status>),
    Check(Vec<BissStepResult>),
    Position(PositionReading),
    Registers(ReadRegisters),
    Area {
        banks: Vec<Bank>,
        /// Device mode during the reading, if the registers may show values that were never saved.
        unsaved: Option<DeviceMode>,
    },
    Saved(Box<BissProfile>),
    Prepared(Box<Prepared>),
    Committed(Box<Committed>),
    /// With the mode before.
    LedBack(DeviceMode),
}

pub type JobError = crate::worker::JobError<Error, PlanError, Interrupted, ChangeKind>;

impl From<PlanError> for JobError {
    fn from(error: PlanError) -> Self {
        JobError::Plan(error)
    }
}

/// Returns the key of an encoder for backups and the logbook: serial numbers are unique within a manufacturer's device
/// id.
pub fn device_key(identity: &Identity, is_virtual: bool) -> DeviceKey {
    let (manufacturer, device) = (hex_compact(&identity.kind.manufacturer), hex_compact(&identity.kind.device_id));
    DeviceKey::of(KIND, &format!("{manufacturer}-{device}"), &identity.serial_number, is_virtual)
}
