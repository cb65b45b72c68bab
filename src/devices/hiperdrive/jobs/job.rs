//! Jobs for an adapter or a hub with its drives, and their results.

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

/// Save count above which the user is warned of memory wear. The value is an assumption, since the manual gives no
/// limit (`U`).
pub const WEAR_WARNING: u64 = 50_000;

/// A job in a session with an adapter or a hub. Reading does not change anything; drives move only between
/// [`Take`](Self::Take) and [`Give`](Self::Give), through the session's `Motion`.
#[derive(Debug)]
pub enum HiperdriveJob {
    Hello,
    Survey,
    Identify,
    Status,
    /// Checks the device and its drives and reports one verdict per line.
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
    /// Writes and saves the given values. Parameters missing from the image stay unchanged.
    Write(Box<Image>),
    /// Writes the given values without saving them.
    Try(Box<Image>),
    SetPosition {
        drive: DriveNumber,
        /// New position in scaled steps, rounded to a multiple of 64.
        position: i32,
        /// Whether to save the position. All other unsaved values are saved as well.
        save: bool,
    },
    Do(Service),
    Network(NetworkSettings),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    Restore,
    /// A write of edits. Edits that were not written remain as edits.
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
    /// Values stored in the device, as read for the plan.
    pub image: Image,
    /// Number of saves recorded for the device on this computer, or `None` if the logbook has no record.
    pub cycles_seen: Option<CycleCount>,
    /// Number of items that already have the desired value.
    pub unchanged: u64,
    /// Profile items that the device does not have.
    pub missing: Vec<String>,
    /// Parameters that depend on the mounting of the drive and differ, but are left unchanged.
    pub mounting_left: Vec<Item>,
    /// Type differences between the profile and the device or its drives.
    pub other_types: Vec<TypeMismatch>,
    /// Parameters from the profile of another device that depend on the mounting. They must be set up again after
    /// writing.
    pub mounting_written: Vec<Item>,
}

impl Prepared {
    /// Returns the number of saves after this plan if a wear warning is needed, or `None` otherwise.
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
    /// The limits of a drive under control cannot be read. The reading is repeated until it succeeds.
    RulesUnread(Box<Error>),
    RulesRead,
}

/// A step of a running job, displayed as on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobStep {
    Parameter(ParameterNumber),
    Step(CheckStep),
    /// An operation of a plan, described by the item that it changes.
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

/// Returns the key of a device for backups and the logbook. Saves are counted per adapter or hub, whichever drives are
/// connected.
pub fn device_key(identity: &Identity, is_virtual: bool) -> DeviceKey {
    logbook_key(&identity.category, &identity.serial_number, is_virtual)
}

pub fn logbook_key(category: &str, serial_number: &str, is_virtual: bool) -> DeviceKey {
    DeviceKey::new(KIND, category, serial_number, is_virtual)
}
