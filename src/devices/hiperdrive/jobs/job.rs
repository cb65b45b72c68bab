//! Jobs for an adapter or a hub with its drives, and the results of these jobs.

use std::fmt;

use crate::devices::hiperdrive::procedures::check::{CheckStep, HiperdriveStepResult};
use crate::devices::hiperdrive::procedures::write::{InterruptedWrite, WrittenChanges};
use crate::devices::hiperdrive::procedures::{DriveReading, Error, Identity, Network, Status, Survey};
use crate::devices::hiperdrive::profile::{
    HiperdrivePlan, HiperdriveProfile, Image, Item, NetworkSettings, PlanError, RestoreOptions, Service, TypeMismatch,
};
use crate::devices::hiperdrive::protocol::{DriveNumber, KIND, ParameterNumber, Value};
use crate::store::{DeviceKey, EntryKind};
use crate::worker::commit::{CycleCount, total_cycles_to_report};

/// Number of saves above which the user is warned of memory wear. The value is an assumption, since the manual gives no
/// limit (`U`).
pub const WEAR_WARNING: u64 = 50_000;

/// A job in a session with an adapter or a hub. Drives move only between [`Take`](Self::Take) and [`Give`](Self::Give),
/// through the session's `Motion`.
#[derive(Debug)]
pub enum HiperdriveJob {
    Hello,
    Survey,
    Identify,
    Status,
    /// Checks the device and its drives, and reports one result per line.
    Check,
    Position(DriveNumber),
    Read(ParameterNumber),
    Network,
    Save,
    Prepare(Change),
    Commit(Box<Commit>),
    /// Opens the cyclic connection without moving a drive.
    Take,
    Give,
    Watch(DriveNumber),
}

#[derive(Clone, Debug)]
pub enum Change {
    Restore {
        profile: Box<HiperdriveProfile>,
        options: RestoreOptions,
    },
    /// Writes and saves the given values. All other parameters stay unchanged.
    Write(Box<Image>),
    /// Writes the given values without saving them.
    Try(Box<Image>),
    SetPosition {
        drive: DriveNumber,
        /// New position in scaled steps, rounded to a multiple of 64.
        position: i32,
        /// Whether to save the position, which also saves all other unsaved values.
        save: bool,
    },
    Do(Service),
    Network(NetworkSettings),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    Restore,
    /// Writes edited values. If the write fails, the remaining edits are kept.
    Edits,
    Try,
    Position,
    Service(Service),
    Network,
}

impl ChangeKind {
    /// Returns the kind of the logbook entry.
    pub const fn entry_kind(self) -> EntryKind {
        match self {
            ChangeKind::Restore => EntryKind::Restore,
            ChangeKind::Edits | ChangeKind::Try | ChangeKind::Network => EntryKind::Write,
            ChangeKind::Position => EntryKind::Preset,
            ChangeKind::Service(_) => EntryKind::Procedure,
        }
    }
}

impl Change {
    pub const fn kind(&self) -> ChangeKind {
        match self {
            Change::Restore { .. } => ChangeKind::Restore,
            Change::Write(_) => ChangeKind::Edits,
            Change::Try(_) => ChangeKind::Try,
            Change::SetPosition { .. } => ChangeKind::Position,
            Change::Do(service) => ChangeKind::Service(*service),
            Change::Network(_) => ChangeKind::Network,
        }
    }
}

#[derive(Clone, Debug)]
pub struct Prepared {
    pub kind: ChangeKind,
    pub plan: HiperdrivePlan,
    pub identity: Identity,
    /// Values stored in the device at the time the plan was made.
    pub image: Image,
    /// Number of saves recorded for the device on this computer, or `None` if the logbook has no record.
    pub cycles_seen: Option<CycleCount>,
    /// Number of items that already have the requested value.
    pub unchanged: u64,
    /// Profile items that the device does not have.
    pub missing: Vec<String>,
    /// Parameters that differ but are left unchanged, because they depend on how the drive is mounted.
    pub mounting_left: Vec<Item>,
    /// Type mismatches between the profile on one side and the device or its drives on the other.
    pub other_types: Vec<TypeMismatch>,
    /// Parameters that come from the profile of another device and depend on how the drive is mounted. They must be set
    /// up again after the write.
    pub mounting_written: Vec<Item>,
}

impl Prepared {
    /// Returns the total number of saves after this plan, or `None` if no wear warning is needed.
    pub fn wear_to_report(&self) -> Option<u64> {
        total_cycles_to_report(self.cycles_seen, self.plan.write_cycles(), WEAR_WARNING)
    }
}

/// A plan that the user has approved.
pub type Commit = crate::worker::commit::ApprovedPlan<Prepared>;

pub type Committed = crate::worker::CommitResult<WrittenChanges>;

#[derive(Clone, Debug, PartialEq)]
pub enum DeviceMessage {
    /// The cyclic connection was lost and the drives are being stopped. The session's `Motion` holds the cause.
    ControlLost,
    /// The limits of a drive under control could not be read. Reading is retried until it succeeds.
    RulesUnread(Box<Error>),
    RulesRead,
}

/// A step of a running job, displayed as on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobStep {
    Parameter(ParameterNumber),
    Step(CheckStep),
    /// An operation of a plan, given by the item that it changes.
    Operation(String),
}

impl fmt::Display for JobStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            JobStep::Parameter(number) => match number.row() {
                Some(row) => write!(f, "{} ({})", Item(*number), row.name),
                None => Item(*number).fmt(f),
            },
            JobStep::Step(step) => step.fmt(f),
            JobStep::Operation(item) => f.write_str(item),
        }
    }
}

#[derive(Debug)]
pub enum HiperdriveOutput {
    Hello(Box<Identity>),
    Surveyed(Box<Survey>),
    Identity(Box<Identity>),
    Status(Box<Status>),
    Check(Vec<HiperdriveStepResult>),
    Position(DriveReading),
    Value(ParameterNumber, Value),
    Network(Box<Network>),
    Saved(Box<HiperdriveProfile>),
    Prepared(Box<Prepared>),
    Committed(Box<Committed>),
    Taken,
    Given,
    Watched(DriveNumber),
}

pub type JobError = crate::worker::JobError<Error, PlanError, InterruptedWrite, ChangeKind>;

impl From<PlanError> for JobError {
    fn from(error: PlanError) -> Self {
        JobError::Plan(error)
    }
}

/// Returns the key of a device for backups and the logbook. The key does not depend on the connected drives, so saves
/// are counted per adapter or hub.
pub fn device_key(identity: &Identity, is_virtual: bool) -> DeviceKey {
    logbook_key(&identity.category, &identity.serial_number, is_virtual)
}

pub fn logbook_key(category: &str, serial_number: &str, is_virtual: bool) -> DeviceKey {
    DeviceKey::new(KIND, category, serial_number, is_virtual)
}
