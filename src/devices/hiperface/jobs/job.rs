//! Jobs of a HIPERFACE encoder and their results.

use std::fmt;

use crate::devices::hiperface::procedures::check::HiperfaceStepResult;
use crate::devices::hiperface::procedures::find::{Attempt, FindOptions, Findings, FoundEncoder};
use crate::devices::hiperface::procedures::write::{Interrupted, Written};
use crate::devices::hiperface::procedures::{Error, Identity, LineQuality, PositionReading, Rest, SaveOptions, Survey};
use crate::devices::hiperface::profile::{
    FieldRange, HiperfacePlan, HiperfaceProfile, Item, Op, PlanError, Redo, RestoreOptions, UnknownField,
};
use crate::devices::hiperface::protocol::{
    AccessCode, CodeNumber, DataFieldStatus, DeviceAddress, FieldSize, Geometry, LineSettings, StatusCode,
};

/// Persistent writes after which an encoder counts as worn: by the manual, the counter, which is in the same EEPROM, can be
/// incremented about a million times.
pub const WEAR_LIMIT: u64 = 1_000_000;

/// A job of a session with a HIPERFACE encoder.
#[derive(Debug)]
pub enum HiperfaceJob {
    /// Reads everything that is displayed: for a window, after connecting.
    Survey,
    Identify,
    /// The whole error queue.
    Status,
    /// Reads the position once. With the geometry, if it is already known.
    Position(Option<Geometry>),
    /// Reads the shaft at rest: position, and sine and cosine if the encoder provides them.
    Rest,
    Read(Item),
    Save(SaveOptions),
    /// Carries out the start-up sequence with one verdict per item; with a restart first if requested.
    Check {
        /// Send 53h first.
        restart: bool,
    },
    /// Sends 53h and waits for the restart.
    Reset,
    Find(FindOptions),
    /// 67h, and our side after it.
    ConfigureForNow(LineSettings),
    /// Uses an access code from now on; nothing is sent.
    UseCode {
        number: CodeNumber,
        /// Its value, which is never shown.
        code: AccessCode,
    },
    /// Makes a plan; writes nothing.
    Prepare(Change),
    /// Carries a plan out.
    Commit(Box<Commit>),
}

/// A change that a user wants.
#[derive(Clone, Debug)]
pub enum Change {
    Restore {
        profile: Box<HiperfaceProfile>,
        options: RestoreOptions,
    },
    /// Writes bytes of data fields: ranges and bytes; a count must equal the number of bytes.
    Store(Vec<(FieldRange, Vec<u8>)>),
    CreateField {
        number: u8,
        status: DataFieldStatus,
    },
    /// Changes the status of a field: protection, access code, or, for the last one, size.
    Redefine {
        number: u8,
        status: DataFieldStatus,
    },
    LockField {
        number: u8,
        lock: bool,
    },
    /// Give the last field another size.
    ResizeField {
        number: u8,
        size: FieldSize,
    },
    /// Delete the last field.
    DeleteField {
        number: u8,
    },
    /// Changes an access code; its present value is the session's.
    ChangeCode {
        number: CodeNumber,
        new: AccessCode,
    },
    SetPosition {
        wanted: u32,
        /// Exactly this value, even if it breaks the phase to the sine; otherwise the nearest that keeps it.
        exact: bool,
        /// 63h: align the code tracks as well.
        synchronise: bool,
        /// The user states that the encoder is a kit, if the type does not tell.
        kit: bool,
    },
    /// Adds steps to the position, modulo the measuring range; at standstill. It undoes setting a position wherever the
    /// shaft is now.
    ShiftPosition {
        /// Number of steps.
        steps: i64,
    },
    SetAddress(DeviceAddress),
    /// Store other interface settings.
    Configure(LineSettings),
    /// Counter to 0.
    ClearCounter,
    /// Counter + 1.
    IncrementCounter,
}

/// Kind of change, by how an interrupted one is completed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    Restore,
    /// Edited bytes: those not yet written remain edits.
    Bytes,
    /// One thing, which is done or not.
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
    /// Number of persistent writes of the encoder recorded on this computer; `None` if the logbook has no record.
    pub cycles_seen: Option<u64>,
    /// Number of items that already have the right value.
    pub unchanged: u64,
    /// Items left alone because one side does not have them or cannot read them.
    pub missing: Vec<FieldRange>,
    /// Values of the mounting that differ and are left alone.
    pub mounting_left: Vec<FieldRange>,
    /// Values of another device's mounting that are written: they must be set up again.
    pub mounting_written: Vec<FieldRange>,
    /// Data fields with bytes of unknown meaning that differ from another encoder's.
    pub unknown_fields: Vec<UnknownField>,
    /// Data fields created by the write that this one undoes, and left in place: they have changed since, or are not the
    /// last.
    pub created_left: Vec<u8>,
    pub other_type: Option<OtherType>,
    /// The requested position, if the plan sets another one that keeps the phase.
    pub wanted_position: Option<u32>,
}

/// The types of a profile and of the encoder that it goes onto, which is of another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OtherType {
    pub profile: u8,
    pub device: u8,
}

impl Prepared {
    /// Returns the values that have to be set up again afterwards. Any value of another mounting, and any byte of
    /// unknown meaning, may be an offset between encoder and motor.
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

/// A value that was read.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(i64),
    /// Analogue value, and its limit if the encoder's extended label contains one.
    Analogue {
        value: i16,
        limit: Option<i16>,
    },
    Bytes(Vec<u8>),
}

/// A profile as it was read.
#[derive(Clone, Debug)]
pub struct SavedProfile {
    pub profile: HiperfaceProfile,
    /// Fields that could not be read, with the number of the code that guards them.
    pub locked: Vec<(u8, CodeNumber)>,
}

/// A message of a HIPERFACE encoder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DeviceMessage {
    Codes(Vec<StatusCode>),
    /// Number of status codes that may have been lost: 50h removes them from the encoder, and its reply was lost or
    /// damaged.
    CodesUnheard(u32),
    /// An encoder that answered while one searched.
    Found(FoundEncoder),
    /// Something was repeated, or arrived too late.
    Line(LineQuality),
}

/// Step of a running HIPERFACE job. Its text is that of the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobStep {
    Field(u64),
    /// An operation of a plan is carried out.
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

/// The result of a HIPERFACE job.
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
    Found(Findings),
    Configured,
    CodeNoted,
    Prepared(Box<Prepared>),
    Committed(Committed),
}

/// Why a job ended early.
pub type JobError = crate::worker::JobError<Error, PlanError, Interrupted, ChangeKind>;

impl From<PlanError> for JobError {
    fn from(error: PlanError) -> Self {
        JobError::Plan(error)
    }
}

impl JobError {
    /// Returns whether the encoder is there and has no position to give at the moment.
    pub fn means_no_position(&self) -> bool {
        matches!(self, JobError::Device(error) if error.means_no_position())
    }
}
