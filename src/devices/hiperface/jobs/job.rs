//! Jobs of a HIPERFACE encoder and their results.

use std::fmt;

use crate::devices::hiperface::procedures::check::HiperfaceStepResult;
use crate::devices::hiperface::procedures::find::{Attempt, FindOptions, FoundEncoder, SearchFindings};
use crate::devices::hiperface::procedures::write::{Interrupted, Written};
use crate::devices::hiperface::procedures::{Error, Identity, LineQuality, PositionReading, Rest, SaveOptions, Survey};
use crate::devices::hiperface::profile::{
    FieldRange, HiperfacePlan, HiperfaceProfile, Item, Op, PlanError, Redo, RestoreOptions, UnknownField,
};
use crate::devices::hiperface::protocol::{
    AccessCode, CodeNumber, DataFieldStatus, DeviceAddress, FieldSize, Geometry, LineSettings, StatusCode,
};

/// Number of persistent writes at which an encoder has reached its limit: according to the manual, the counter, which
/// is in the same EEPROM, can be incremented about a million times.
pub const WEAR_LIMIT: u64 = 1_000_000;

#[derive(Debug)]
pub enum HiperfaceJob {
    /// Read everything that is displayed after connecting.
    Survey,
    Identify,
    /// The whole error queue.
    Status,
    /// Read the position once, interpreted with the geometry if already known.
    Position(Option<Geometry>),
    /// Read the shaft at rest: position, and sine and cosine if the encoder provides them.
    Rest,
    Read(Item),
    Save(SaveOptions),
    /// Execute the start-up sequence with a verdict for each item, after a restart if requested.
    Check {
        /// Send 53h first.
        restart: bool,
    },
    /// Sends 53h and waits for the restart.
    Reset,
    Find(FindOptions),
    /// 67h, and the settings of the host after it.
    ConfigureForNow(LineSettings),
    /// Uses an access code from now on; nothing is sent.
    UseCode {
        number: CodeNumber,
        /// Access code, which is never displayed.
        code: AccessCode,
    },
    Prepare(Change),
    Commit(Box<Commit>),
}

#[derive(Clone, Debug)]
pub enum Change {
    Restore {
        profile: Box<HiperfaceProfile>,
        options: RestoreOptions,
    },
    /// Write bytes of data fields; a count must equal the number of bytes.
    Store(Vec<(FieldRange, Vec<u8>)>),
    CreateField {
        number: u8,
        status: DataFieldStatus,
    },
    Redefine {
        number: u8,
        status: DataFieldStatus,
    },
    LockField {
        number: u8,
        lock: bool,
    },
    ResizeField {
        number: u8,
        size: FieldSize,
    },
    DeleteField {
        number: u8,
    },
    ChangeCode {
        number: CodeNumber,
        new: AccessCode,
    },
    SetPosition {
        wanted: u32,
        /// Whether to set exactly this value, even if that breaks the phase to the sine, rather than the nearest one
        /// that preserves it.
        exact: bool,
        /// Whether to align the code tracks as well (63h).
        synchronise: bool,
        /// The user states that the encoder is a kit, if the type does not tell.
        kit: bool,
    },
    /// Add steps to the position, modulo the measuring range, at standstill. This undoes setting a position, wherever
    /// the shaft is now.
    ShiftPosition {
        steps: i64,
    },
    SetAddress(DeviceAddress),
    Configure(LineSettings),
    ClearCounter,
    IncrementCounter,
}

/// Kind of change, which determines how an interrupted one is completed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    Restore,
    /// Edited bytes; those not yet written remain edits.
    Bytes,
    /// A single operation, which is either done or not.
    Single,
}

impl Change {
    pub fn kind(&self) -> ChangeKind {
        match self {
            Change::Restore { .. } => ChangeKind::Restore,
            Change::Store(_) => ChangeKind::Bytes,
            _ => ChangeKind::Single,
        }
    }
}

#[derive(Clone, Debug)]
pub struct Prepared {
    pub kind: ChangeKind,
    pub plan: HiperfacePlan,
    pub identity: Identity,
    /// Number of persistent writes to the encoder recorded on this computer, or `None` if the logbook has no record.
    pub cycles_seen: Option<u64>,
    /// Number of items that already have the right value.
    pub unchanged: u64,
    /// Items left unchanged because one side lacks them or cannot read them.
    pub missing: Vec<FieldRange>,
    /// Values of the mounting that differ and are left alone.
    pub mounting_left: Vec<FieldRange>,
    /// Written values that belong to the mounting of another device and must be set up again.
    pub mounting_written: Vec<FieldRange>,
    /// Data fields with bytes of unknown meaning that differ from another encoder's.
    pub unknown_fields: Vec<UnknownField>,
    /// Data fields created by the write that this one undoes, and left in place because they have changed since, or are
    /// not the last.
    pub created_left: Vec<u8>,
    pub other_type: Option<OtherType>,
    /// Requested position, if the plan sets another one that preserves the phase.
    pub wanted_position: Option<u32>,
}

/// Type of a profile and of the encoder of another type to which it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OtherType {
    pub profile: u8,
    pub device: u8,
}

impl Prepared {
    /// Returns the values that must be set up again afterwards. Any value of another mounting, and any byte of unknown
    /// meaning, may be an offset between encoder and motor.
    pub fn redo(&self) -> Vec<Redo> {
        let values = self.mounting_written.iter().copied().map(Redo::Value);
        let copies = self.unknown_fields.iter().any(UnknownField::is_copied);
        let commutation = (copies || !self.mounting_written.is_empty()).then_some(Redo::Commutation);
        commutation.into_iter().chain(values).collect()
    }
}

/// Plan with the user's consent.
pub type Commit = crate::worker::commit::ApprovedPlan<Prepared>;

pub type Committed = crate::worker::Committed<Written>;

#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(i64),
    /// Analogue value, and its limit if the extended label contains one.
    Analogue {
        value: i16,
        limit: Option<i16>,
    },
    Bytes(Vec<u8>),
}

#[derive(Clone, Debug)]
pub struct SavedProfile {
    pub profile: HiperfaceProfile,
    /// Fields that could not be read, with the number of the access code that protects them.
    pub locked: Vec<(u8, CodeNumber)>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DeviceMessage {
    Codes(Vec<StatusCode>),
    /// Number of status codes that may have been lost, since 50h removes them from the encoder, and its reply was lost
    /// or damaged.
    CodesUnheard(u32),
    /// An encoder that replied during a search.
    Found(FoundEncoder),
    /// Something was repeated, or arrived too late.
    Line(LineQuality),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobStep {
    Field(u64),
    Operation(Op),
    Attempt(Attempt),
}

impl fmt::Display for JobStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            JobStep::Field(field) => write!(f, "field:{field}"),
            JobStep::Operation(op) => op.item().fmt(f),
            JobStep::Attempt(attempt) => attempt.fmt(f),
        }
    }
}

#[derive(Debug)]
pub enum HiperfaceOutput {
    Surveyed(Box<Survey>),
    Identity(Identity),
    Status(Vec<StatusCode>),
    Position(PositionReading),
    Rest(Rest),
    Value(Value),
    Saved(Box<SavedProfile>),
    Check(Vec<HiperfaceStepResult>),
    Reset(Vec<StatusCode>),
    Found(SearchFindings),
    Configured,
    CodeNoted,
    Prepared(Box<Prepared>),
    Committed(Committed),
}

pub type JobError = crate::worker::JobError<Error, PlanError, Interrupted, ChangeKind>;

impl From<PlanError> for JobError {
    fn from(error: PlanError) -> Self {
        JobError::Plan(error)
    }
}

impl JobError {
    /// Returns whether the encoder is present but has no position to return at the moment.
    pub fn means_no_position(&self) -> bool {
        matches!(self, JobError::Device(error) if error.means_no_position())
    }
}
