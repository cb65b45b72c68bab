//! Carrying a plan out, for every kind of device in the same order: consent and base → before-image on disk → logbook:
//! intent → the operations, each read back → logbook: result. A device brings what differs and cannot leave a step out:
//! its operations take an [`Intended`], which only [`commit`] makes, after the steps before.

use std::path::{Path, PathBuf};

use jiff::Timestamp;

use super::interruption::{Interruption, JobError};
use crate::profile::{Body, Consent, Document, Operation, Plan};
use crate::store::{DeviceKey, EntryId, FileError, Logbook, LogbookError, Outcome, Store};

/// What a kind of device brings to a write.
pub trait Write {
    /// Consent and base hold.
    type Confirmed;
    /// What was written; nothing, to begin with.
    type Written: Default;
    /// Why nothing can be written.
    type Refusal;
    /// How far a write came that ended early, and why.
    type Interrupted: Interruption;

    /// Checks the consent, and reads again what the plan rests upon.
    fn confirm(&mut self) -> Result<Self::Confirmed, Self::Refusal>;

    /// A restorable text of what the plan touches, as it was.
    fn before_image(&self) -> String;

    /// Exactly the operations that were confirmed, each read back.
    fn carry_out(
        &mut self,
        confirmed: &Self::Confirmed,
        intended: &Intended,
    ) -> Result<Self::Written, Box<Self::Interrupted>>;

    /// Write cycles that it has cost.
    fn write_cycles(written: &Self::Written) -> u64;
}

/// A plan that a person consented to, with what was read for it.
#[derive(Clone, Debug)]
pub struct Agreed<P> {
    /// As it was shown.
    pub prepared: P,
    /// The consent to it.
    pub consent: Consent,
    /// Write although the device counts as worn, or its write cycles are not known.
    pub force_wear: bool,
}

/// What is written, and into what.
pub struct Terms {
    /// The device.
    pub(super) device: DeviceKey,
    /// What the operations change, as the logbook tells it.
    pub(super) items: Vec<String>,
    /// Write cycles that they cost.
    pub(super) cost: u64,
    /// Write cycles that this computer has seen the device take.
    pub(super) seen: Option<u64>,
    /// Write cycles from which the device counts as worn.
    pub(super) limit: u64,
    /// Write although it does.
    pub(super) force_wear: bool,
}

impl Terms {
    /// A plan, what is told of its operations, and how much of the device's life is known to be gone.
    pub fn of<Base, Op: Operation>(
        device: DeviceKey,
        plan: &Plan<Base, Op>,
        note: impl Fn(&Op) -> String,
        (seen, limit): (Option<u64>, u64),
        force_wear: bool,
    ) -> Self {
        let items = plan.ops.iter().map(note).collect();
        Terms { device, items, cost: plan.write_cycles(), seen, limit, force_wear }
    }
}

/// The before-image is kept, and the logbook has been told.
pub struct Intended {
    backup: PathBuf,
    entry: Result<(Logbook, EntryId), LogbookError>,
}

/// What a commit did.
#[derive(Clone, Debug, Default)]
pub struct Committed<W> {
    /// What was written, as its kind of device counts it.
    pub written: W,
    /// The before-image; `None` when there was nothing to write.
    pub backup: Option<PathBuf>,
    /// What the logbook could not take: the write itself is done.
    pub logbook_warning: Option<LogbookError>,
}

/// Why a write was not begun, whatever the device says. Nothing was written.
#[derive(Debug, thiserror::Error)]
pub enum NotBegun {
    /// How many write cycles the device has had cannot be read, or these cannot be counted.
    #[error("the write cycles so far are not known, {cost} more would not be counted")]
    WearUnknown {
        /// What the plan costs.
        cost: u64,
    },
    /// The device counts as worn.
    #[error("{seen} write cycles seen, {cost} more would exceed {limit}")]
    Worn {
        /// Seen so far.
        seen: u64,
        /// What the plan costs.
        cost: u64,
        /// The limit.
        limit: u64,
    },
    /// The before-image cannot be kept.
    #[error(transparent)]
    NotKept(FileError),
}

/// A write that is not done, or not to its end; where consent or base do not hold, it is the device's error.
pub(super) type Failed<W, P, K> = JobError<<W as Write>::Refusal, P, <W as Write>::Interrupted, K>;

/// The one way to write a change of such a kind. A plan without operations is done.
pub fn commit<W: Write, P, K>(
    store: &Store,
    terms: &Terms,
    kind: K,
    write: &mut W,
) -> Result<Committed<W::Written>, Failed<W, P, K>> {
    if terms.items.is_empty() {
        return Ok(Committed { written: W::Written::default(), backup: None, logbook_warning: None });
    }
    check_wear(terms.seen, terms.cost, terms.limit, terms.force_wear)?;
    let confirmed = write.confirm().map_err(JobError::Device)?;
    let intended = Intended::note(store, terms, &write.before_image()).map_err(NotBegun::NotKept)?;
    if let (Err(why), false) = (&intended.entry, terms.force_wear || terms.cost == 0) {
        tracing::warn!("{why}");
        return Err(NotBegun::WearUnknown { cost: terms.cost }.into());
    }
    let ended = write.carry_out(&confirmed, &intended);
    let (outcome, spent) = match &ended {
        Ok(written) => (Outcome::Done, W::write_cycles(written)),
        Err(interrupted) => (interrupted.why().map_or(Outcome::Cancelled, Outcome::Failed), interrupted.write_cycles()),
    };
    let (backup, logbook_warning) = intended.conclude(outcome, spent);
    match ended {
        Ok(written) => Ok(Committed { written, backup: Some(backup), logbook_warning }),
        Err(interrupted) => {
            if let Some(why) = logbook_warning {
                tracing::warn!("{why}");
            }
            Err(JobError::Interrupted { interrupted, backup, planned: terms.items.len(), kind })
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

/// Whether a write may begin that costs so many write cycles, as far as these are known.
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

impl Intended {
    /// Keeps the before-image and tells the logbook.
    fn note(store: &Store, terms: &Terms, before_image: &str) -> Result<Self, FileError> {
        let DeviceKey { kind, serial_number, .. } = &terms.device;
        let backup = store.backups().keep(kind, serial_number, Timestamp::now(), before_image)?;
        let entry = intend(&store.logbook_path(), terms, &backup);
        Ok(Intended { backup, entry })
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

fn intend(path: &Path, terms: &Terms, backup: &Path) -> Result<(Logbook, EntryId), LogbookError> {
    let mut logbook = Logbook::open(path)?;
    let what = terms.items.join(", ");
    let id = logbook.intend(Timestamp::now(), &terms.device, &what, terms.cost, Some(backup))?;
    Ok((logbook, id))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Notes what is asked of it, and looks on disk what has been done before.
    struct Spy {
        store: Store,
        steps: Vec<&'static str>,
        refuses: bool,
        ends_early: bool,
    }

    /// The user wished it, so many write cycles after it had begun.
    struct Cancelled {
        cycles: u64,
    }

    impl Interruption for Cancelled {
        type Error = ();

        fn error(&self) -> Option<&()> {
            None
        }

        fn why(&self) -> Option<String> {
            None
        }

        fn done(&self) -> usize {
            0
        }

        fn write_cycles(&self) -> u64 {
            self.cycles
        }
    }

    impl Spy {
        fn open_intents(&self) -> usize {
            let logbook = Logbook::open(&self.store.logbook_path()).unwrap();
            let entries = logbook.history(&terms(0).device, 9).unwrap();
            entries.iter().filter(|entry| entry.conclusion.is_none()).count()
        }
    }

    impl Write for Spy {
        type Confirmed = ();
        type Written = u64;
        type Refusal = ();
        type Interrupted = Cancelled;

        fn confirm(&mut self) -> Result<(), ()> {
            self.steps.push("confirm");
            assert!(self.store.backups().list("spy", "1").unwrap().is_empty());
            if self.refuses { Err(()) } else { Ok(()) }
        }

        fn before_image(&self) -> String {
            "before".to_owned()
        }

        fn carry_out(&mut self, (): &(), _intended: &Intended) -> Result<u64, Box<Cancelled>> {
            self.steps.push("carry out");
            assert_eq!(self.store.backups().list("spy", "1").unwrap().len(), 1);
            assert_eq!(self.open_intents(), 1);
            if self.ends_early { Err(Box::new(Cancelled { cycles: 1 })) } else { Ok(2) }
        }

        fn write_cycles(written: &u64) -> u64 {
            *written
        }
    }

    fn terms(seen: u64) -> Terms {
        let device = DeviceKey {
            kind: "spy".to_owned(),
            device_type: "1".to_owned(),
            serial_number: "1".to_owned(),
            is_virtual: true,
        };
        Terms {
            device,
            items: vec!["a".to_owned(), "b".to_owned()],
            cost: 2,
            seen: Some(seen),
            limit: 10,
            force_wear: false,
        }
    }

    #[test]
    fn every_write_takes_all_steps_in_their_order() {
        let cases = [
            ("done", 0, false, false, vec!["confirm", "carry out"], 2),
            ("cut off", 0, false, true, vec!["confirm", "carry out"], 1),
            ("refused", 0, true, false, vec!["confirm"], 0),
            ("worn", 9, false, false, vec![], 0),
        ];
        for (label, seen, refuses, ends_early, steps, spent) in cases {
            let root = tempfile::tempdir().unwrap();
            let store = Store::at(root.path());
            let mut spy = Spy { store: store.clone(), steps: Vec::new(), refuses, ends_early };
            let ended: Result<_, Failed<Spy, (), char>> = commit(&store, &terms(seen), 'k', &mut spy);
            assert_eq!(spy.steps, steps, "{label}");
            assert_eq!(cycles_seen(&store, &terms(0).device), Some(spent), "{label}");
            match ended {
                Ok(done) => assert!(label == "done" && done.written == 2 && done.logbook_warning.is_none()),
                Err(JobError::Interrupted { interrupted, backup, planned: 2, kind: 'k' }) => {
                    assert!(label == "cut off" && interrupted.cycles == 1 && backup.exists());
                }
                Err(JobError::Device(())) => assert_eq!(label, "refused"),
                Err(JobError::NotBegun(NotBegun::Worn { seen: 9, cost: 2, limit: 10 })) => assert_eq!(label, "worn"),
                Err(_) => panic!("{label}"),
            }
        }
    }

    /// Issue 22.4: a count that is not known is no 0. It opens by force alone, and is told then.
    #[test]
    fn a_logbook_that_cannot_be_used_stops_a_write() {
        let root = tempfile::tempdir().unwrap();
        let store = Store::at(root.path());
        std::fs::create_dir_all(store.logbook_path()).unwrap();
        struct Plain(u32);
        impl Write for Plain {
            type Confirmed = ();
            type Written = ();
            type Refusal = ();
            type Interrupted = Cancelled;
            fn confirm(&mut self) -> Result<(), ()> {
                Ok(())
            }
            fn before_image(&self) -> String {
                String::new()
            }
            fn carry_out(&mut self, (): &(), _: &Intended) -> Result<(), Box<Cancelled>> {
                self.0 += 1;
                Ok(())
            }
            fn write_cycles((): &()) -> u64 {
                2
            }
        }
        let seen = cycles_seen(&store, &terms(0).device);
        assert_eq!(seen, None);
        // Not read; or read before and not to be written now.
        for seen in [seen, Some(0)] {
            let mut plain = Plain(0);
            let terms = |force_wear, cost| Terms { seen, force_wear, cost, ..terms(0) };
            let ended: Result<_, Failed<Plain, (), ()>> = commit(&store, &terms(false, 2), (), &mut plain);
            let refused = matches!(ended, Err(JobError::NotBegun(NotBegun::WearUnknown { cost: 2 })));
            assert!(refused && plain.0 == 0, "{seen:?}");
            let ended: Result<_, Failed<Plain, (), ()>> = commit(&store, &terms(true, 2), (), &mut plain);
            let Ok(done) = ended else { panic!("{seen:?}") };
            assert!(done.logbook_warning.is_some() && plain.0 == 1, "{seen:?}");
            // What costs nothing wears nothing.
            let ended: Result<_, Failed<Plain, (), ()>> = commit(&store, &terms(false, 0), (), &mut plain);
            assert!(ended.is_ok() && plain.0 == 2, "{seen:?}");
        }
    }
}
