//! Jobs for a HIPERFACE encoder, and their results.

use crate::analysis::check::CycleCount;
use std::fmt;

use crate::devices::hiperface::procedures::check::HiperfaceStepResult;
use crate::devices::hiperface::procedures::find::{EncoderSearchResult, FindOptions, FoundEncoder, SearchStep};
use crate::devices::hiperface::procedures::write::{InterruptedWrite, WrittenChanges};
use crate::devices::hiperface::procedures::{
    Error, Identity, LineQuality, PositionReading, RestPosition, SaveOptions, Survey,
};
use crate::devices::hiperface::profile::{
    FieldRange, HiperfacePlan, HiperfaceProfile, Item, Op, PlanError, RequiredSetup, RestoreOptions,
    UnknownMeaningField,
};
use crate::devices::hiperface::protocol::{
    AccessCode, AccessCodeNumber, DataFieldStatus, DeviceAddress, FieldSize, Geometry, LineSettings, StatusCode,
};
use crate::store::EntryKind;

/// Number of persistent writes that an encoder is expected to withstand. According to the manual, its counter, which is
/// stored in the same EEPROM, can be incremented about a million times.
pub const WEAR_LIMIT: u64 = 1_000_000;

#[derive(Debug)]
pub enum HiperfaceJob {
    /// Reads all values that are displayed after connecting.
    Survey,
    Identify,
    /// Reads the complete status queue.
    Status,
    /// Reads the position once. If the geometry is known, it is used to interpret the position.
    Position(Option<Geometry>),
    /// Reads the position while the shaft is at rest, and the sine and cosine signals if the encoder provides them.
    Rest,
    Read(Item),
    Save(SaveOptions),
    /// Runs the start-up sequence, and rates each step.
    Check {
        /// Whether to restart the encoder with 53h first.
        restart: bool,
    },
    /// Sends command 53h and waits for the restart.
    Reset,
    Find(FindOptions),
    /// Sends command 67h and then changes the line settings of the host to match.
    ConfigureForNow(LineSettings),
    /// Uses an access code for later requests. Nothing is sent.
    UseCode {
        number: AccessCodeNumber,
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
    /// Writes bytes to data fields. The number of bytes must equal the count of the range.
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
        number: AccessCodeNumber,
        new: AccessCode,
    },
    SetPosition {
        wanted: u32,
        /// Whether to set exactly the requested value, even if it breaks the phase relation to the sine signal.
        /// Otherwise, the nearest value that preserves the phase is set.
        exact: bool,
        /// Whether to align the code tracks as well (63h).
        synchronise: bool,
        /// Whether the user has stated that the encoder is a kit encoder. This is needed only if the encoder type does
        /// not show it.
        kit: bool,
    },
    /// Adds steps to the position at standstill, modulo the measuring range. This undoes setting a position, even if
    /// the shaft has been turned since.
    ShiftPosition {
        steps: i64,
    },
    SetAddress(DeviceAddress),
    Configure(LineSettings),
    ClearCounter,
    IncrementCounter,
}

/// Kind of change, which determines how an interrupted change can be completed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    Restore,
    /// A write of edited bytes. Bytes that were not written remain in the editor as unwritten edits.
    Bytes,
    /// A single operation, which is executed either completely or not at all.
    Single,
}

impl ChangeKind {
    /// Returns the kind of the logbook entry.
    pub const fn entry_kind(self) -> EntryKind {
        match self {
            ChangeKind::Restore => EntryKind::Restore,
            ChangeKind::Bytes | ChangeKind::Single => EntryKind::Write,
        }
    }
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
    pub cycles_seen: Option<CycleCount>,
    /// Number of items that already have the intended value.
    pub unchanged: u64,
    /// Items left unchanged because they cannot be read, or because they are missing in the profile or the encoder.
    pub missing: Vec<FieldRange>,
    /// Mounting values, such as a commutation offset, that differ but are left unchanged.
    pub mounting_left: Vec<FieldRange>,
    /// Mounting values that are copied from another device and must be set up again.
    pub mounting_written: Vec<FieldRange>,
    /// Data fields whose bytes of unknown meaning differ between the profile and the encoder.
    pub unknown_fields: Vec<UnknownMeaningField>,
    /// Data fields that the undone write created and that are kept, because they have changed or other fields follow.
    pub created_left: Vec<u8>,
    pub other_type: Option<TypeMismatch>,
    /// Position that the user requested, if the plan sets a different one to preserve the phase.
    pub wanted_position: Option<u32>,
}

/// Type codes of a profile and of the encoder to which it is written, if they differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TypeMismatch {
    pub profile: u8,
    pub device: u8,
}

impl Prepared {
    /// Returns the values that must be set up again after the write. Mounting values of another encoder and bytes of
    /// unknown meaning may contain an offset between encoder and motor.
    pub fn redo(&self) -> Vec<RequiredSetup> {
        let values = self.mounting_written.iter().copied().map(RequiredSetup::Value);
        let copies = self.unknown_fields.iter().any(UnknownMeaningField::is_copied);
        let commutation = (copies || !self.mounting_written.is_empty()).then_some(RequiredSetup::Commutation);
        commutation.into_iter().chain(values).collect()
    }
}

/// A plan that the user has approved.
pub type Commit = crate::worker::commit::ApprovedPlan<Prepared>;

pub type Committed = crate::worker::CommitResult<WrittenChanges>;

#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(i64),
    /// Measured analogue value, and its limit if the extended label contains one.
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
    pub locked: Vec<(u8, AccessCodeNumber)>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DeviceMessage {
    Codes(Vec<StatusCode>),
    /// Number of status codes that may have been lost. Command 50h removes a code from the encoder even if the reply is
    /// lost or damaged.
    CodesLost(u32),
    /// An encoder that replied during a search.
    Found(FoundEncoder),
    /// A request was repeated, or a reply arrived too late.
    Line(LineQuality),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobStep {
    Field(u64),
    Operation(Op),
    Attempt(SearchStep),
}

impl fmt::Display for JobStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            JobStep::Field(field) => write!(f, "field:{field}"),
            JobStep::Operation(op) => op.plan_item().fmt(f),
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
    Rest(RestPosition),
    Value(Value),
    Saved(Box<SavedProfile>),
    Check(Vec<HiperfaceStepResult>),
    Reset(Vec<StatusCode>),
    Found(EncoderSearchResult),
    Configured,
    CodeNoted,
    Prepared(Box<Prepared>),
    Committed(Committed),
}

pub type JobError = crate::worker::JobError<Error, PlanError, InterruptedWrite, ChangeKind>;

impl From<PlanError> for JobError {
    fn from(error: PlanError) -> Self {
        JobError::Plan(error)
    }
}

impl JobError {
    /// Returns whether the encoder currently has no position to report.
    pub fn is_without_position(&self) -> bool {
        matches!(self, JobError::Device(error) if error.is_without_position())
    }
}
