//! The jobs of a HIPERFACE encoder, and their results.

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

/// Persistent writes after which an encoder counts as worn: the manual says of the counter, which lives in the same
/// EEPROM, that it can be incremented about a million times.
pub const WEAR_LIMIT: u64 = 1_000_000;

/// A job of a session with a HIPERFACE encoder.
#[derive(Debug)]
pub enum HiperfaceJob {
    /// Everything there is to see: for a window, after connecting.
    Survey,
    /// Reads the identity.
    Identify,
    /// The whole error queue.
    Status,
    /// The position, once. With the geometry, where it is known already.
    Position(Option<Geometry>),
    /// The shaft at rest: position, and sine and cosine where the encoder gives them.
    Rest,
    /// One value.
    Read(Item),
    /// Everything that can be restored.
    Save(SaveOptions),
    /// The start-up sequence with a verdict a line; with a restart first.
    Check {
        /// Send 53h first.
        restart: bool,
    },
    /// 53h and its waits.
    Reset,
    /// All speeds, parities and addresses.
    Find(FindOptions),
    /// 67h, and our side after it.
    ConfigureForNow(LineSettings),
    /// Uses an access code from now on; nothing is sent.
    UseCode {
        number: CodeNumber,
        /// Its value; it is shown nowhere.
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
    /// Make the encoder as the profile says.
    Restore {
        profile: Box<HiperfaceProfile>,
        options: RestoreOptions,
    },
    /// Write bytes of data fields: where, and which; a count has to be that of the bytes.
    Store(Vec<(FieldRange, Vec<u8>)>),
    CreateField {
        number: u8,
        status: DataFieldStatus,
    },
    /// Give a field another status: protection, access code, or, for the last, size.
    Redefine {
        number: u8,
        /// Its status from then on; it exists.
        status: DataFieldStatus,
    },
    /// Write-protect a field, or make it writable.
    LockField {
        number: u8,
        /// Protect it.
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
    /// Change an access code; its present value is the session's.
    ChangeCode {
        number: CodeNumber,
        /// Its new value.
        new: AccessCode,
    },
    /// Set the position; at standstill.
    SetPosition {
        /// The position wanted.
        wanted: u32,
        /// Exactly that, also when it breaks the phase to the sine; else the nearest that keeps it.
        exact: bool,
        /// 63h: align the code tracks as well.
        synchronise: bool,
        /// The user says that the encoder is a kit, where the type does not tell.
        kit: bool,
    },
    /// Add steps to the position, round the end of the measuring range; at standstill. It undoes a set position wherever
    /// the shaft is by now.
    ShiftPosition {
        /// Number of steps.
        steps: i64,
    },
    /// Give the encoder another address.
    SetAddress(DeviceAddress),
    /// Store other interface settings.
    Configure(LineSettings),
    /// Counter to 0.
    ClearCounter,
    /// Counter + 1.
    IncrementCounter,
}

/// Kinds of change that differ in what completes one that was cut off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    /// A profile is restored: doing it again completes it.
    Restore,
    /// Edited bytes are written: those that are not yet stay edited.
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

/// A plan, ready to be looked at.
#[derive(Clone, Debug)]
pub struct Prepared {
    pub kind: ChangeKind,
    pub plan: HiperfacePlan,
    /// The encoder it is for.
    pub identity: Identity,
    /// Persistent writes that this computer has seen the encoder take; `None` where the logbook does not tell.
    pub cycles_seen: Option<u64>,
    /// Things that are as they should be already.
    pub unchanged: u64,
    /// Items that are left alone because one side does not have them or cannot read them.
    pub missing: Vec<FieldRange>,
    /// Values of the mounting that differ and are left alone.
    pub mounting_left: Vec<FieldRange>,
    /// Values of another device's mounting that are written: they have to be set up again.
    pub mounting_written: Vec<FieldRange>,
    /// Data fields with bytes of unknown meaning that differ from another encoder's.
    pub unknown_fields: Vec<UnknownField>,
    /// Data fields that the write created which this undoes, and that are left: they have changed since, or are not the last.
    pub created_left: Vec<u8>,
    /// The profile is of another type of encoder.
    pub other_type: Option<OtherType>,
    /// The position asked for, where the plan sets another one that keeps the phase.
    pub wanted_position: Option<u32>,
}

/// The types of a profile and of the encoder that it goes onto, which is of another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OtherType {
    pub profile: u8,
    /// In the encoder.
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

/// A plan that a person consented to.
pub type Commit = crate::worker::commit::ApprovedPlan<Prepared>;

/// The result of a commit.
pub type Committed = crate::worker::Committed<Written>;

/// A value that was read.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(i64),
    /// An analogue value, and what it should not exceed, where the encoder's extended label says so.
    Analogue {
        value: i16,
        limit: Option<i16>,
    },
    Bytes(Vec<u8>),
}

/// A profile as it was read.
#[derive(Clone, Debug)]
pub struct SavedProfile {
    /// The profile that was read.
    pub profile: HiperfaceProfile,
    /// Fields that could not be read, with the number of the code that guards them.
    pub locked: Vec<(u8, CodeNumber)>,
}

/// A message of a HIPERFACE encoder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DeviceMessage {
    /// Status codes that replies announced.
    Codes(Vec<StatusCode>),
    /// Number of status codes that may have been lost: 50h takes them out of the encoder, and its reply was lost or
    /// damaged.
    CodesUnheard(u32),
    /// An encoder that answered while one searched.
    Found(FoundEncoder),
    /// Something had to be repeated, or came too late.
    Line(LineQuality),
}

/// The step that a HIPERFACE job is at. Its text is the command line's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobStep {
    /// The data field of that number is read.
    Field(u64),
    /// An operation of a plan is carried out.
    Operation(Op),
    /// An encoder is searched.
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
    /// The encoder is there and has no position to give at the moment.
    pub fn means_no_position(&self) -> bool {
        matches!(self, JobError::Device(error) if error.means_no_position())
    }
}
