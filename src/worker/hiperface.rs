//! The jobs of a HIPERFACE session.

mod commit;
mod prepare;

use std::path::PathBuf;

use super::{Progress, Session};
use crate::device::hiperface::check::{self, Line};
use crate::device::hiperface::find::{self, Attempt, FindOptions, Findings};
use crate::device::hiperface::write::{Interrupted, Written};
use crate::device::hiperface::{
    self as device, Error, Identity, PositionReading, SaveOptions, identify, read_analogue, read_counter, read_field,
    read_field_status, read_position, read_range, read_status,
};
use crate::profile::Consent;
use crate::profile::hiperface::{FieldRange, HiperfacePlan, HiperfaceProfile, Item, PlanError, RestoreOptions};
use crate::protocol::hiperface::{
    AccessCode, CodeNumber, DataFieldStatus, DeviceAddress, FieldSize, Geometry, LineSettings, StatusCode,
};
use crate::store::FileError;

/// Persistent writes after which an encoder counts as worn: the manual says of the counter, which lives in the same
/// EEPROM, that it can be incremented about a million times.
pub const WEAR_LIMIT: u64 = 1_000_000;

/// What a session with a HIPERFACE encoder does.
#[derive(Debug)]
pub enum HiperfaceJob {
    /// Who is there.
    Identify,
    /// The whole error queue.
    Status,
    /// The position, once. With the geometry, where it is known already.
    Position(Option<Geometry>),
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
        /// The profile.
        profile: Box<HiperfaceProfile>,
        /// What the restore may do.
        options: RestoreOptions,
    },
    /// Write bytes of a data field.
    Store {
        /// Which field, from where; a count has to be that of the bytes.
        range: FieldRange,
        /// The bytes.
        bytes: Vec<u8>,
    },
    /// Create a data field.
    CreateField {
        /// Its number.
        number: u8,
        /// Its status.
        status: DataFieldStatus,
    },
    /// Give a field another status: protection, access code, or, for the last, size.
    Redefine {
        /// Its number.
        number: u8,
        /// Its status from then on; it exists.
        status: DataFieldStatus,
    },
    /// Write-protect a field, or make it writable.
    LockField {
        /// Its number.
        number: u8,
        /// Protect it.
        lock: bool,
    },
    /// Give the last field another size.
    ResizeField {
        /// Its number.
        number: u8,
        /// Its size.
        size: FieldSize,
    },
    /// Delete the last field.
    DeleteField {
        /// Its number.
        number: u8,
    },
    /// Change an access code; its present value is the session's.
    ChangeCode {
        /// Which.
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
    /// Give the encoder another address.
    SetAddress(DeviceAddress),
    /// Store other interface settings.
    Configure(LineSettings),
    /// Counter to 0.
    ClearCounter,
    /// Counter + 1.
    IncrementCounter,
}

/// A plan, ready to be looked at.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// What would be written.
    pub plan: HiperfacePlan,
    /// The encoder it is for.
    pub identity: Identity,
    /// Persistent writes that this computer has seen the encoder take; `None` where the logbook does not tell.
    pub cycles_seen: Option<u64>,
    /// Things that are as they should be already.
    pub unchanged: u64,
    /// Items that are left alone because one side does not have them or cannot read them.
    pub missing: Vec<String>,
    /// Values of the mounting that differ and are left alone.
    pub mounting_left: Vec<FieldRange>,
    /// The position asked for, where the plan sets another one that keeps the phase.
    pub wanted_position: Option<u32>,
}

/// A plan that a person consented to.
#[derive(Clone, Debug)]
pub struct Commit {
    /// The plan as it was shown.
    pub prepared: Prepared,
    /// The consent to it.
    pub consent: Consent,
    /// Write although the encoder counts as worn.
    pub force_wear: bool,
}

/// What a commit did.
#[derive(Clone, Debug, Default)]
pub struct Committed {
    /// Counts.
    pub written: Written,
    /// The before-image; `None` when there was nothing to write.
    pub backup: Option<PathBuf>,
    /// What the logbook could not take: the write itself is done.
    pub logbook_warning: Option<String>,
}

/// A value that was read.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number, with its unit where it has one.
    Number(i64),
    /// Bytes.
    Bytes(Vec<u8>),
}

/// A profile as it was read.
#[derive(Clone, Debug)]
pub struct SavedProfile {
    /// What was read.
    pub profile: HiperfaceProfile,
    /// Fields that could not be read, with the number of the code that guards them.
    pub locked: Vec<(u8, CodeNumber)>,
}

/// What a job gives.
#[derive(Debug)]
pub enum JobOutput {
    /// A HIPERFACE job.
    Hiperface(HiperfaceOutput),
}

/// What a HIPERFACE job gives.
#[derive(Debug)]
#[expect(missing_docs, reason = "each is the result of the job of that name")]
pub enum HiperfaceOutput {
    Identity(Identity),
    Status(Vec<StatusCode>),
    Position(PositionReading),
    Value(Value),
    Saved(Box<SavedProfile>),
    Check(Vec<Line>),
    Reset(Vec<StatusCode>),
    Found(Findings),
    Configured,
    Prepared(Box<Prepared>),
    Committed(Committed),
}

/// Why a job ended early.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// The device.
    #[error(transparent)]
    Device(#[from] Error),
    /// It cannot be planned; nothing was written.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The before-image cannot be kept; nothing was written.
    #[error(transparent)]
    NotKept(FileError),
    /// The encoder counts as worn; nothing was written.
    #[error("{used} write cycles seen, {cost} more would exceed {limit}")]
    Worn {
        /// Seen so far.
        used: u64,
        /// What the plan costs.
        cost: u64,
        /// The limit.
        limit: u64,
    },
    /// It was begun and not finished.
    #[error("{interrupted}; before-image: {}", backup.display())]
    Interrupted {
        /// What was written, and why it ended.
        interrupted: Box<Interrupted>,
        /// The before-image.
        backup: PathBuf,
        /// Operations of the plan.
        planned: usize,
    },
}

impl JobError {
    /// The user wished it.
    pub fn is_cancelled(&self) -> bool {
        match self {
            JobError::Device(error) => *error == Error::Cancelled,
            JobError::Interrupted { interrupted, .. } => interrupted.cause == Error::Cancelled,
            _ => false,
        }
    }
}

pub(super) fn run(
    session: &mut Session,
    job: HiperfaceJob,
    tell: &mut dyn FnMut(Progress),
) -> Result<JobOutput, JobError> {
    let types = session.types.clone();
    let output = match job {
        HiperfaceJob::Prepare(change) => HiperfaceOutput::Prepared(Box::new(prepare::prepare(session, change, tell)?)),
        HiperfaceJob::Commit(commit) => HiperfaceOutput::Committed(commit::commit(session, &commit, tell)?),
        HiperfaceJob::Identify => HiperfaceOutput::Identity(identify(&mut session.master(), &types)?),
        HiperfaceJob::Status => HiperfaceOutput::Status(read_status(&mut session.master())?),
        HiperfaceJob::Position(geometry) => HiperfaceOutput::Position(read_position(&mut session.master(), geometry)?),
        HiperfaceJob::Read(item) => HiperfaceOutput::Value(read_item(session, item)?),
        HiperfaceJob::Save(options) => {
            let progress = &mut |done, total| tell(Progress { done, total, what: format!("field:{done}") });
            let profile = device::save(&mut session.master(), &types, options, progress)?;
            let locked = profile.fields.iter().filter(|field| field.bytes.is_none());
            let locked = locked.map(|field| (field.number, field.status.code())).collect();
            HiperfaceOutput::Saved(Box::new(SavedProfile { profile, locked }))
        }
        HiperfaceJob::Check { restart } => {
            HiperfaceOutput::Check(check::check(&mut session.master(), &types, restart)?)
        }
        HiperfaceJob::Reset => HiperfaceOutput::Reset(device::reset(&mut session.master())?),
        HiperfaceJob::Find(options) => {
            let progress = &mut |done, total, attempt: &Attempt| {
                tell(Progress { done, total, what: attempt.to_string() });
            };
            HiperfaceOutput::Found(find::find(&mut session.master(), &options, progress)?)
        }
        HiperfaceJob::ConfigureForNow(settings) => {
            device::change_line_for_now(&mut session.master(), settings)?;
            HiperfaceOutput::Configured
        }
    };
    Ok(JobOutput::Hiperface(output))
}

fn read_item(session: &mut Session, item: Item) -> Result<Value, JobError> {
    let mut master = session.master();
    let value = read_value(&mut master, item);
    if let (Item::Field(FieldRange { field, .. }) | Item::Status(field), Err(error)) = (item, &value)
        && error.is_rejection(StatusCode::NO_SUCH_FIELD)
    {
        // Which ones there are says more than the encoder's refusal.
        let count = device::write::read_memory(&mut master)?.fields;
        return Err(PlanError::NoSuchField { field, count }.into());
    }
    Ok(value?)
}

fn read_value(master: &mut device::Master<'_>, item: Item) -> Result<Value, Error> {
    Ok(match item {
        Item::Field(range) => Value::Bytes(read_part(master, range)?),
        Item::Status(field) => Value::Number(read_field_status(master, field)?.byte().into()),
        Item::Analogue(channel) => Value::Number(read_analogue(master, channel)?.into()),
        Item::Counter => Value::Number(read_counter(master)?.into()),
        Item::Address => Value::Number(device::read_address(master)?.into()),
        Item::Settings => Value::Number(device::read_settings(master)?.byte().into()),
    })
}

fn read_part(master: &mut device::Master<'_>, range: FieldRange) -> Result<Vec<u8>, Error> {
    let status = read_field_status(master, range.field)?;
    let size = status.size().bytes();
    let count = range.count.unwrap_or(size.saturating_sub(range.start));
    if count == 0 || range.start.saturating_add(count) > size {
        return Err(Error::OutOfField { field: range.field, address: range.start, count: count.max(1), size });
    }
    if range.start == 0 && count == size {
        let field = read_field(master, range.field)?;
        return field.bytes.ok_or(Error::CodeUnknown { field: range.field, number: status.code() });
    }
    let code = master.station().codes.get(status.code());
    match read_range(master, range.field, range.start, count, code) {
        Err(error) if error.is_rejection(StatusCode::WRONG_CODE) => {
            Err(Error::CodeUnknown { field: range.field, number: status.code() })
        }
        result => result,
    }
}
