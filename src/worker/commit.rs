//! The one way to write, for every kind of device in the same order: consent and base → before-image on disk → logbook:
//! intent → the operations, each read back → logbook: result. A device brings what differs as a [`Write`] and cannot leave
//! a step out: its operations take a [`Confirmed`], which only [`write_plan`] has made.

#[cfg(test)]
mod tests;

use std::hash::Hash;
use std::path::PathBuf;

use jiff::Timestamp;

use super::{JobError, Progress};
use crate::profile::{
    Body, Confirmed, Consent, Document, InterruptedWrite, Operation, OperationError, Plan, Write, WriteRecord,
};
use crate::store::{DeviceKey, EntryId, FileError, Logbook, LogbookError, Outcome, Store};

/// A plan that a person consented to, with what was read for it.
#[derive(Clone, Debug)]
pub struct ApprovedPlan<P> {
    /// As it was shown.
    pub prepared: P,
    /// The consent to it.
    pub consent: Consent,
    /// Write although the device counts as worn, or its write cycles are not known.
    pub force_wear: bool,
}

/// The before-image is kept, and the logbook has been told.
struct WriteIntent {
    backup: PathBuf,
    entry: Result<(Logbook, EntryId), LogbookError>,
}

/// The result of a commit.
#[derive(Clone, Debug, Default)]
pub struct Committed<W> {
    /// What was written, as counted by the kind of device.
    pub written: W,
    /// The before-image; `None` when there was nothing to write.
    pub backup: Option<PathBuf>,
    /// What the logbook could not record; the write itself is done.
    pub logbook_warning: Option<LogbookError>,
}

/// Why a write was not begun, for any kind of device. Nothing was written.
#[derive(Debug, thiserror::Error)]
pub enum NotBegun {
    /// The consent is for another plan.
    #[error("the consent is for another plan")]
    OtherPlan,
    /// The number of earlier write cycles cannot be read, or the new ones cannot be counted.
    #[error("the write cycles so far are not known, {cost} more would not be counted")]
    WearUnknown {
        /// Write cycles of the plan.
        cost: u64,
    },
    /// The device counts as worn.
    #[error("{seen} write cycles seen, {cost} more would exceed {limit}")]
    Worn {
        /// Seen so far.
        seen: u64,
        /// Write cycles of the plan.
        cost: u64,
        /// The limit.
        limit: u64,
    },
    /// The before-image cannot be kept.
    #[error(transparent)]
    NotKept(FileError),
}

/// A plan that a job has made, with what was read for it: what a write has to know beside the wire.
pub trait Planned {
    /// The values that the plan is based on.
    type Base: Hash;
    /// An operation of it.
    type Op: Operation + Clone + Hash;
    /// Kinds of change that differ in what completes one that was cut off.
    type Kind;

    /// Returns the plan, what it is for, and the wear of the device.
    fn head(&self) -> PlanHead<'_, Self>;

    /// Returns how backups and the logbook know the device.
    fn device(&self, is_virtual: bool) -> DeviceKey;

    /// Returns what an operation changes, as the logbook tells it.
    fn note(&self, op: &Self::Op) -> String;

    /// Returns a restorable text of what the plan touches, as it was.
    fn before_image(&self) -> String;

    /// Returns what would be written.
    fn plan(&self) -> &Plan<Self::Base, Self::Op> {
        self.head().plan
    }

    /// Returns the kind of change that it is for.
    fn kind(&self) -> Self::Kind {
        self.head().kind
    }

    /// Returns the write cycles that this computer has seen the device take; `None` where the logbook does not tell.
    fn cycles_seen(&self) -> Option<u64> {
        self.head().cycles_seen
    }

    /// Returns the write cycles beyond which the device counts as worn.
    fn wear_limit(&self) -> u64 {
        self.head().wear_limit
    }
}

/// A plan, what it is for, and the wear of the device.
pub struct PlanHead<'p, P: Planned + ?Sized> {
    /// What would be written.
    pub plan: &'p Plan<P::Base, P::Op>,
    /// The kind of change that it is for.
    pub kind: P::Kind,
    /// Write cycles that this computer has seen the device take; `None` where the logbook does not tell.
    pub cycles_seen: Option<u64>,
    /// Write cycles beyond which the device counts as worn.
    pub wear_limit: u64,
}

/// A write that is not done, or not to its end; where the base does not hold, it is the device's error.
type Unfinished<P, W, E> =
    JobError<<<W as Write>::Error as OperationError>::Device, E, InterruptedWrite<W>, <P as Planned>::Kind>;

/// Writes a plan that a person consented to: the one way to write, for every kind of device. Each operation is told before
/// it begins. A plan without operations is done.
///
/// # Errors
/// See [`JobError`].
pub fn write_plan<P: Planned, W: Write<Base = P::Base, Op = P::Op>, E>(
    store: &Store,
    is_virtual: bool,
    agreed: &ApprovedPlan<P>,
    write: &mut W,
    tell: &mut dyn FnMut(Progress<&P::Op>),
) -> Result<Committed<W::Written>, Unfinished<P, W, E>> {
    let ApprovedPlan { prepared, consent, force_wear } = agreed;
    let plan = prepared.plan();
    if plan.is_empty() {
        return Ok(Committed::default());
    }
    let (cost, planned) = (plan.write_cycles(), plan.ops.len());
    check_wear(prepared.cycles_seen(), cost, prepared.wear_limit(), *force_wear)?;
    let confirmed = Confirmed::confirm(plan, *consent, write).ok_or(NotBegun::OtherPlan)?.map_err(JobError::Device)?;
    let items = plan.ops.iter().map(|op| prepared.note(op)).collect::<Vec<_>>().join(", ");
    let intended = WriteIntent::note(store, &prepared.device(is_virtual), &items, cost, &prepared.before_image());
    let intended = intended.map_err(NotBegun::NotKept)?;
    if let (Err(why), false) = (&intended.entry, *force_wear || cost == 0) {
        tracing::warn!("{why}");
        return Err(NotBegun::WearUnknown { cost }.into());
    }
    let tell = &mut |at: usize, what: &P::Op| tell(Progress { done: at as u64, total: planned as u64, what });
    let ended = confirmed.carry_out(write, tell);
    let (outcome, spent) = match &ended {
        Ok(written) => (Outcome::Done, written.write_cycles()),
        Err(own) => (own.reason().map_or(Outcome::Cancelled, Outcome::Failed), own.done.write_cycles()),
    };
    let (backup, logbook_warning) = intended.conclude(outcome, spent);
    match ended {
        Ok(written) => Ok(Committed { written, backup: Some(backup), logbook_warning }),
        Err(interrupted) => {
            if let Some(why) = logbook_warning {
                tracing::warn!("{why}");
            }
            Err(JobError::Interrupted { interrupted, backup, planned, kind: prepared.kind() })
        }
    }
}

/// A profile as it is kept before a write.
pub fn backup_of(body: Body) -> Document {
    let mut document = Document::new(Timestamp::now().to_string(), body);
    document.note = Some("before-image of a write".to_owned());
    document
}

/// Write cycles that a device will have taken at least when it has taken `cost` more, where a person should know that they
/// are numbered: from `warning` on.
pub(crate) fn wear(seen: Option<u64>, cost: u64, warning: u64) -> Option<u64> {
    let after = seen.unwrap_or(0).saturating_add(cost);
    (cost > 0 && after >= warning).then_some(after)
}

/// A write costs cycles of a device of which it is not known how many it has had.
pub const fn is_uncounted(seen: Option<u64>, cost: u64) -> bool {
    seen.is_none() && cost > 0
}

/// Write cycles that this computer has seen a device take; `None` where the logbook does not tell.
pub fn cycles_seen(store: &Store, device: &DeviceKey) -> Option<u64> {
    let path = store.logbook_path();
    if matches!(path.try_exists(), Ok(false)) {
        return Some(0);
    }
    match Logbook::open(&path).and_then(|logbook| logbook.write_cycles(device)) {
        Ok(cycles) => Some(cycles),
        Err(error) => {
            tracing::warn!("{error}");
            None
        }
    }
}

/// Returns whether a write of this cost may begin, as far as the earlier write cycles are known.
///
/// # Errors
/// [`NotBegun::WearUnknown`], [`NotBegun::Worn`].
pub const fn check_wear(seen: Option<u64>, cost: u64, limit: u64, force_wear: bool) -> Result<(), NotBegun> {
    match seen {
        _ if force_wear => Ok(()),
        None if cost > 0 => Err(NotBegun::WearUnknown { cost }),
        Some(seen) if seen.saturating_add(cost) > limit => Err(NotBegun::Worn { seen, cost, limit }),
        _ => Ok(()),
    }
}

impl WriteIntent {
    /// Keeps the before-image and tells the logbook.
    fn note(store: &Store, device: &DeviceKey, items: &str, cost: u64, before: &str) -> Result<Self, FileError> {
        let backup = store.backups().keep(&device.kind, &device.serial_number, Timestamp::now(), before)?;
        let intend = |mut logbook: Logbook| {
            let id = logbook.intend(Timestamp::now(), device, items, cost, Some(&backup))?;
            Ok((logbook, id))
        };
        let entry = Logbook::open(&store.logbook_path()).and_then(intend);
        Ok(WriteIntent { backup, entry })
    }

    /// The before-image, and what the logbook could not take.
    fn conclude(self, outcome: Outcome, spent: u64) -> (PathBuf, Option<LogbookError>) {
        let warning = match self.entry {
            Ok((mut logbook, id)) => logbook.conclude(id, Timestamp::now(), outcome, spent).err(),
            Err(error) => Some(error),
        };
        (self.backup, warning)
    }
}
