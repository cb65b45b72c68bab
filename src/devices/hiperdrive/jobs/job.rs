//! The jobs of an adapter or a hub with its drives, and their results.

use std::fmt;

use crate::devices::hiperdrive::procedures::check::{CheckStep, HiperdriveStepResult};
use crate::devices::hiperdrive::procedures::write::{Interrupted, Written};
use crate::devices::hiperdrive::procedures::{DriveReading, Error, Identity, Network, Status, Survey};
use crate::devices::hiperdrive::profile::{
    HiperdrivePlan, HiperdriveProfile, Image, Item, NetworkSettings, OtherType, PlanError, RestoreOptions, Service,
};
use crate::devices::hiperdrive::protocol::{DriveNumber, KIND, ParameterNumber, Value};
use crate::store::DeviceKey;
use crate::worker::commit::wear;

/// Number of saves from which the user is warned of wear: an assumption, since the manual gives no limit (`U`).
pub const WEAR_WARNING: u64 = 50_000;

/// Job of a session with an adapter or a hub. Reading changes nothing; drives move only between [`Take`](Self::Take) and
/// [`Give`](Self::Give), through the session's `Motion`.
#[derive(Debug)]
pub enum HiperdriveJob {
    /// Identifies the device after connecting, for a window.
    Hello,
    Survey,
    Identify,
    /// Errors and states of all drives.
    Status,
    /// Checks device and drives, with a verdict a line.
    Check,
    /// Reads the position of a drive once.
    Position(DriveNumber),
    Read(ParameterNumber),
    Network,
    Save,
    /// Makes a plan; writes nothing.
    Prepare(Change),
    /// Carries a plan out.
    Commit(Box<Commit>),
    /// Opens the cyclic connection. This moves nothing.
    Take,
    Give,
    Watch(DriveNumber),
}

/// A change that a user wants.
#[derive(Clone, Debug)]
pub enum Change {
    Restore {
        profile: Box<HiperdriveProfile>,
        options: RestoreOptions,
    },
    /// Writes these values and saves them; parameters that are not in the image stay as they are.
    Write(Box<Image>),
    /// Make it like this, and save nothing.
    Try(Box<Image>),
    SetPosition {
        drive: DriveNumber,
        /// Position in scaled steps, to be rounded to a multiple of 64.
        position: i32,
        /// Save it, and all that was not saved before.
        save: bool,
    },
    Do(Service),
    Network(NetworkSettings),
}

/// Kind of change, by how an interrupted one is completed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    Restore,
    /// Edits: those not yet written remain edits.
    Edits,
    Try,
    Position,
    Service(Service),
    Network,
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
    /// The stored values of the device, as read for the plan.
    pub image: Image,
    /// Number of saves of the device recorded on this computer; `None` if the logbook has no record.
    pub cycles_seen: Option<u64>,
    /// Items that are as they should be already.
    pub unchanged: u64,
    /// Items of a profile that the device does not have.
    pub missing: Vec<String>,
    /// Values of the mounting that differ and are left alone.
    pub mounting_left: Vec<Item>,
    /// Differences of type if the profile is of another type of device or drive.
    pub other_types: Vec<OtherType>,
    /// Values of another device's mounting that are written: they must be set up again.
    pub mounting_written: Vec<Item>,
}

impl Prepared {
    /// Returns the number of saves after this, if the user should know.
    pub fn wear(&self) -> Option<u64> {
        wear(self.cycles_seen, self.plan.write_cycles(), WEAR_WARNING)
    }
}

/// Plan with the user's consent.
pub type Commit = crate::worker::commit::ApprovedPlan<Prepared>;

pub type Committed = crate::worker::Committed<Written>;

/// A message during a job.
#[derive(Clone, Debug, PartialEq)]
pub enum DeviceMessage {
    /// The cyclic connection was lost and the drives stop; the session's `Motion` has the cause.
    ControlLost,
    /// The limits of a drive under control cannot be read, and are requested again repeatedly.
    RulesUnread(Box<Error>),
    /// The limits could be read again.
    RulesRead,
}

/// Step of a running job. Its text is that of the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobStep {
    Parameter(ParameterNumber),
    Step(CheckStep),
    /// Operation of a plan, with the item it changes.
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

/// The result of a job.
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

/// Why a job ended early.
pub type JobError = crate::worker::JobError<Error, PlanError, Interrupted, ChangeKind>;

impl From<PlanError> for JobError {
    fn from(error: PlanError) -> Self {
        JobError::Plan(error)
    }
}

/// Returns the key of a device for backups and the logbook: saves count for the adapter or hub, whichever drives are
/// connected.
pub fn device_key(identity: &Identity, is_virtual: bool) -> DeviceKey {
    DeviceKey::of(KIND, &identity.category, &identity.serial_number, is_virtual)
}
