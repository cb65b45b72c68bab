//! The only way to write, with the same steps for every kind of device. The plan requires consent and an unchanged
//! base. A backup is saved on disk, and the logbook records the intent. Each operation is written and read back, and
//! the logbook records the result. A device supplies its own parts as a [`Write`] and cannot omit a step: its
//! operations require a [`ConfirmedPlan`], which only [`write_plan`] creates.

#[cfg(test)]
mod tests;
mod undo;

use std::hash::Hash;
use std::path::{Path, PathBuf};

use jiff::Timestamp;

pub use undo::Undo;

use super::{JobError, Progress, SessionLog};
pub use crate::analysis::check::CycleCount;
use crate::profile::{
    Body, ChangedItem, ConfirmedPlan, Consent, Operation, OperationError, Plan, ProfileDocument, Write,
    WriteInterruption, WriteRecord,
};
use crate::store::{
    DeviceKey, EntryId, EntryKind, EntryUid, FileError, Intent, Logbook, LogbookError, LogbookServer, Outcome, Store,
};

/// Highest limit of write cycles at which a memory is considered to wear out quickly. Write cycles missing from the
/// logbook could then use up all that are left.
const LOW_ENDURANCE_CYCLES: u64 = 10_000;

/// A plan approved by the user, with the values on which it is based.
#[derive(Clone, Debug)]
pub struct ApprovedPlan<P> {
    /// The plan as shown.
    pub prepared: P,
    /// The consent to the plan.
    pub consent: Consent,
    /// Whether to write even if the device is worn, or its write cycles are unknown.
    pub force_wear: bool,
    /// The logbook entry that the write undoes, if any.
    pub undoes: Option<EntryUid>,
}

/// A write that is recorded in the logbook, with the backup saved before it.
struct WriteIntent {
    backup: PathBuf,
    entry: Result<(Logbook, EntryId), LogbookError>,
}

/// The result of a commit.
#[derive(Clone, Debug, Default)]
pub struct CommitResult<W> {
    /// Result of the write, as defined by the kind of device.
    pub written: W,
    /// Path of the backup. `None` if there was nothing to write.
    pub backup: Option<PathBuf>,
    /// Logbook error after the write, which is itself complete.
    pub logbook_warning: Option<LogbookError>,
}

/// The reason why a write did not begin. Nothing was written.
#[derive(Debug, thiserror::Error)]
pub enum NotStarted {
    /// The consent is for another plan.
    #[error("the consent is for another plan")]
    OtherPlan,
    /// The number of earlier write cycles is unknown, or the new ones cannot be counted.
    #[error("the number of previous write cycles is unknown, so {cost} more cannot be counted")]
    WearUnknown {
        /// Number of write cycles required by the plan.
        cost: u64,
    },
    /// Write cycles may be missing from the logbook, and the memory wears out quickly.
    #[error("at least {seen} of {limit} write cycles seen, {cost} more are planned")]
    WearIncomplete {
        /// Number of known write cycles.
        seen: u64,
        /// Number of write cycles required by the plan.
        cost: u64,
        /// Number of write cycles beyond which the device is considered worn.
        limit: u64,
    },
    /// The write would exceed the limit of write cycles of the device.
    #[error("{cost} more write cycles would exceed the limit of {limit} ({seen} counted so far)")]
    Worn {
        /// Number of known write cycles.
        seen: u64,
        /// Number of write cycles required by the plan.
        cost: u64,
        /// Number of write cycles beyond which the device is considered worn.
        limit: u64,
    },
    /// The backup cannot be saved.
    #[error(transparent)]
    BackupFailed(FileError),
}

/// A plan made by a job, with everything needed to write it except the connection.
pub trait PlannedWrite {
    /// Values on which the plan is based.
    type Base: Hash;
    /// A single operation of the plan.
    type Op: Operation + Clone + Hash;
    /// Kind of change. It determines how an interrupted write is completed.
    type Kind;

    /// Returns the plan with its kind of change and the wear of the device.
    fn header(&self) -> PlanHeader<'_, Self>;

    /// Returns the key that identifies the device in backups and the logbook.
    fn device(&self, is_virtual: bool) -> DeviceKey;

    /// Returns the items changed by an operation, for the logbook.
    fn changed_items(&self, op: &Self::Op) -> Vec<ChangedItem>;

    /// Returns the kind of the logbook entry.
    fn entry_kind(&self) -> EntryKind;

    /// Returns the profile to save before the write. It contains the values for undoing the write.
    fn backup(&self) -> ProfileDocument;

    /// Returns how each operation can be undone, or `None` for an operation that changes nothing.
    fn undos(&self) -> Vec<Option<Undo>> {
        Undo::for_write_plan(self)
    }

    /// Returns the plan to write.
    fn plan(&self) -> &Plan<Self::Base, Self::Op> {
        self.header().plan
    }

    /// Returns the kind of change that the plan makes.
    fn kind(&self) -> Self::Kind {
        self.header().kind
    }

    /// Returns the device's write cycles according to the logbook, or `None` if the logbook cannot be read.
    fn cycles_seen(&self) -> Option<CycleCount> {
        self.header().cycles_seen
    }

    /// Returns the number of write cycles beyond which the device is considered worn.
    fn wear_limit(&self) -> u64 {
        self.header().wear_limit
    }
}

/// A plan with its kind of change and the wear of the device.
pub struct PlanHeader<'p, P: PlannedWrite + ?Sized> {
    /// Plan to write.
    pub plan: &'p Plan<P::Base, P::Op>,
    /// Kind of change that the plan makes.
    pub kind: P::Kind,
    /// Write cycles of the device according to the logbook. `None` if the logbook cannot be read.
    pub cycles_seen: Option<CycleCount>,
    /// Number of write cycles beyond which the device is considered worn.
    pub wear_limit: u64,
}

/// The error of a write that did not begin or was interrupted. If the base has changed, it is the device's own error.
type WritePlanError<P, W, E> =
    JobError<<<W as Write>::Error as OperationError>::Device, E, WriteInterruption<W>, <P as PlannedWrite>::Kind>;

/// Writes a plan to which the user has consented. Each operation is reported before it begins. A plan without
/// operations always succeeds.
///
/// # Errors
/// Returns a [`JobError`] if the write did not begin or was not completed.
pub fn write_plan<P: PlannedWrite, W: Write<Base = P::Base, Op = P::Op>, E>(
    store: &Store,
    is_virtual: bool,
    agreed: &ApprovedPlan<P>,
    write: &mut W,
    tell: &mut dyn FnMut(Progress<&P::Op>),
) -> Result<CommitResult<W::Written>, WritePlanError<P, W, E>> {
    let ApprovedPlan { prepared, consent, force_wear, undoes } = agreed;
    let plan = prepared.plan();
    if plan.is_empty() {
        return Ok(CommitResult::default());
    }
    let (cost, planned) = (plan.write_cycles(), plan.ops.len());
    check_wear(prepared.cycles_seen(), cost, prepared.wear_limit(), *force_wear)?;
    let confirmed =
        ConfirmedPlan::confirm(plan, *consent, write).ok_or(NotStarted::OtherPlan)?.map_err(JobError::Device)?;
    let items = plan.ops.iter().flat_map(|op| prepared.changed_items(op)).collect();
    let intent =
        Intent { kind: prepared.entry_kind(), items, planned_cycles: cost, backup: None, undoes: undoes.clone() };
    let intended = WriteIntent::record(store, &prepared.device(is_virtual), intent, &prepared.backup().emit());
    let intended = intended.map_err(NotStarted::BackupFailed)?;
    if let (Err(why), false) = (&intended.entry, *force_wear || cost == 0) {
        tracing::warn!("{why}");
        return Err(NotStarted::WearUnknown { cost }.into());
    }
    let tell = &mut |at: usize, what: &P::Op| tell(Progress { done: at as u64, total: planned as u64, step: what });
    let ended = confirmed.execute(write, tell);
    let (outcome, spent) = match &ended {
        Ok(written) => (Outcome::Done, written.write_cycles()),
        Err(own) => (own.reason().map_or(Outcome::Cancelled, Outcome::Failed), own.done.write_cycles()),
    };
    let (backup, logbook_warning) = intended.record_outcome(outcome, spent);
    match ended {
        Ok(written) => Ok(CommitResult { written, backup: Some(backup), logbook_warning }),
        Err(interrupted) => {
            if let Some(why) = logbook_warning {
                tracing::warn!("{why}");
            }
            Err(JobError::Interrupted { interrupted, backup, planned, kind: prepared.kind() })
        }
    }
}

/// Creates the profile to save before a write.
pub fn backup_document(body: Body) -> ProfileDocument {
    let mut document = ProfileDocument::new(Timestamp::now().to_string(), body);
    document.note = Some("before-image of a write".to_owned());
    document
}

/// Returns the minimum total of write cycles after `cost` more. Returns `None` if `cost` is zero or the total is below
/// `warning`.
pub(crate) fn total_cycles_to_report(seen: Option<CycleCount>, cost: u64, warning: u64) -> Option<u64> {
    let after = seen.map_or(0, |count| count.seen).saturating_add(cost);
    (cost > 0 && after >= warning).then_some(after)
}

/// Returns whether a write costs write cycles although the number of earlier ones is unknown.
pub const fn is_uncounted(seen: Option<CycleCount>, cost: u64) -> bool {
    seen.is_none() && cost > 0
}

/// Returns whether a write needs permission because write cycles may be missing from the logbook.
pub fn is_incomplete(seen: Option<CycleCount>, cost: u64, limit: u64) -> bool {
    matches!(check_wear(seen, cost, limit, false), Err(NotStarted::WearIncomplete { .. }))
}

/// Returns a device's write cycles according to the logbook, after fetching those recorded on other computers. Also
/// announces to them that the device is connected here. Returns `None` if the logbook cannot be read.
pub fn cycles_seen(log: &SessionLog, store: &Store, device: &DeviceKey) -> Option<CycleCount> {
    log.record_identity(store, device);
    let path = store.logbook_path();
    // If the exchange fails, only the write cycles known to this computer count.
    let transferred = store.logbook_server().transfer_unless_recently_failed(&path, LogbookServer::TIMEOUT);
    count_cycles(&path, device, transferred.is_none_or(|result| result.is_ok()))
}

/// Returns a device's write cycles according to the local file. Returns `None` if the file cannot be read, or if an
/// earlier damaged file still exists.
pub fn known_cycles(store: &Store, device: &DeviceKey) -> Option<CycleCount> {
    let server = store.logbook_server();
    count_cycles(&store.logbook_path(), device, !server.is_set() || server.contact().is_reached)
}

/// Counts the write cycles in the local file. `is_complete` states whether the file has the entries of all computers.
fn count_cycles(path: &Path, device: &DeviceKey, is_complete: bool) -> Option<CycleCount> {
    if matches!(path.try_exists(), Ok(false)) {
        return Some(CycleCount { seen: 0, is_complete });
    }
    let read = |logbook: Logbook| Ok((logbook.write_cycles(device)?, logbook.damaged_file()?));
    match Logbook::open(path).and_then(read) {
        // The damaged file may contain any number of write cycles, until the user has dealt with it.
        Ok((_, Some(damaged))) if damaged.try_exists().unwrap_or(true) => None,
        Ok((seen, damaged)) => Some(CycleCount { seen, is_complete: is_complete && damaged.is_none() }),
        Err(error) => {
            tracing::warn!("{error}");
            None
        }
    }
}

/// Checks whether a write of this cost may begin, given the known write cycles.
///
/// # Errors
/// Returns [`NotStarted::WearUnknown`], [`NotStarted::WearIncomplete`] or [`NotStarted::Worn`].
pub const fn check_wear(seen: Option<CycleCount>, cost: u64, limit: u64, force_wear: bool) -> Result<(), NotStarted> {
    match seen {
        _ if force_wear => Ok(()),
        None if cost > 0 => Err(NotStarted::WearUnknown { cost }),
        Some(CycleCount { seen, .. }) if seen.saturating_add(cost) > limit => {
            Err(NotStarted::Worn { seen, cost, limit })
        }
        Some(CycleCount { seen, is_complete: false }) if cost > 0 && limit <= LOW_ENDURANCE_CYCLES => {
            Err(NotStarted::WearIncomplete { seen, cost, limit })
        }
        _ => Ok(()),
    }
}

impl WriteIntent {
    /// Saves a backup and records the intended write in the logbook.
    fn record(store: &Store, device: &DeviceKey, intent: Intent, before: &str) -> Result<Self, FileError> {
        let backup = store.backups().save(&device.kind, &device.serial_number, Timestamp::now(), before)?;
        let intent = Intent { backup: Some(backup.clone()), ..intent };
        let intend = |mut logbook: Logbook| {
            let id = logbook.record_intent(Timestamp::now(), device, &intent)?;
            Ok((logbook, id))
        };
        let entry = Logbook::open(&store.logbook_path()).and_then(intend);
        Ok(WriteIntent { backup, entry })
    }

    /// Records the result of the write. Returns the path of the backup and any logbook error.
    fn record_outcome(self, outcome: Outcome, spent: u64) -> (PathBuf, Option<LogbookError>) {
        let warning = match self.entry {
            Ok((mut logbook, id)) => logbook.record_outcome(id, Timestamp::now(), outcome, spent).err(),
            Err(error) => Some(error),
        };
        (self.backup, warning)
    }
}
