//! Tests of the steps of a write, and of errors that prevent it from starting.

use super::*;
use crate::profile::{Comparison, Entries, Profile, ProfileError, Redo, Writer, WrittenChanges};

/// A device that records its calls and checks which backups and logbook entries exist at each one.
struct Spy {
    store: Store,
    steps: Vec<&'static str>,
    refuses: bool,
    ends_early: bool,
}

/// The error after a cancellation by the user.
#[derive(Debug, PartialEq)]
struct Cancelled;

impl std::fmt::Display for Cancelled {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("cancelled")
    }
}

impl OperationError for Cancelled {
    type Device = ();

    fn device(&self) -> Option<&()> {
        None
    }

    fn is_only_cancelled(&self) -> bool {
        true
    }
}

/// An operation that costs the given number of write cycles.
#[derive(Clone, Hash)]
struct Op(u64);

impl Operation for Op {
    fn write_cycles(&self) -> u64 {
        self.0
    }
}

impl Spy {
    fn new(store: &Store, refuses: bool, ends_early: bool) -> Self {
        Spy { store: store.clone(), steps: Vec::new(), refuses, ends_early }
    }

    fn open_intents(&self) -> usize {
        let logbook = Logbook::open(&self.store.logbook_path()).unwrap();
        let entries = logbook.history(&device(), 9).unwrap();
        entries.iter().filter(|entry| entry.conclusion.is_none()).count()
    }
}

impl Write for Spy {
    type Base = ();
    type Op = Op;
    type Error = Cancelled;
    type Written = WrittenChanges;
    type EndState = &'static str;

    fn confirm_base(&mut self, _: &Plan<(), Op>) -> Result<(), ()> {
        self.steps.push("confirm");
        assert!(self.store.backups().list_for_device("spy", "1").unwrap().is_empty());
        if self.refuses { Err(()) } else { Ok(()) }
    }

    fn begin(&mut self) -> Result<(), Cancelled> {
        self.steps.push("begin");
        assert_eq!(self.store.backups().list_for_device("spy", "1").unwrap().len(), 1);
        assert_eq!(self.open_intents(), 1);
        Ok(())
    }

    fn apply(&mut self, op: &Op, _: &ConfirmedPlan<'_, (), Op>, done: &mut WrittenChanges) -> Result<(), Cancelled> {
        self.steps.push("apply");
        if self.ends_early && done.ops == 1 {
            return Err(Cancelled);
        }
        done.write_cycles += op.0;
        done.count_operation(1);
        Ok(())
    }

    fn finish(&mut self, _: &ConfirmedPlan<'_, (), Op>, done: &mut WrittenChanges) -> Result<(), Cancelled> {
        self.steps.push("finish");
        done.verified = done.written;
        Ok(())
    }

    fn return_to_safe_state(
        &mut self,
        _: &ConfirmedPlan<'_, (), Op>,
        ended: Result<(), Cancelled>,
        _: &mut WrittenChanges,
    ) -> Result<(), Cancelled> {
        self.steps.push("lead back");
        ended
    }

    fn end_state(&mut self, _: &Cancelled) -> &'static str {
        "as it was"
    }
}

/// The profile of a device on which an operation costing 3 cycles can only be undone by another write, and one costing
/// 4 cycles not at all.
#[derive(Clone, Debug, PartialEq)]
struct SpyProfile;

impl Profile for SpyProfile {
    const KIND: &'static str = "spy";

    fn read(_: &mut Entries) -> Result<Self, ProfileError> {
        Ok(SpyProfile)
    }

    fn write(&self, _: &mut Writer) {}

    fn compare(&self, _: &Self) -> Comparison {
        Comparison::default()
    }

    fn redo(&self, item: &ChangedItem) -> Option<Redo> {
        match item.item.as_str() {
            "3" => Some(Redo::Write("40".to_owned())),
            "4" => Some(Redo::ChangeCode),
            _ => None,
        }
    }
}

struct Prepared {
    kind: EntryKind,
    seen: Option<CycleCount>,
    plan: Plan<(), Op>,
}

impl PlannedWrite for Prepared {
    type Base = ();
    type Op = Op;
    type Kind = char;

    fn header(&self) -> PlanHeader<'_, Self> {
        PlanHeader { plan: &self.plan, kind: 'k', cycles_seen: self.seen, wear_limit: 10 }
    }

    fn device(&self, is_virtual: bool) -> DeviceKey {
        assert!(is_virtual);
        device()
    }

    fn changed_items(&self, op: &Op) -> Vec<ChangedItem> {
        vec![ChangedItem::new(op.0, None, None)]
    }

    fn entry_kind(&self) -> EntryKind {
        self.kind
    }

    fn backup(&self) -> ProfileDocument {
        backup_document(Body::new(SpyProfile))
    }
}

fn device() -> DeviceKey {
    let (kind, one) = ("spy".to_owned(), "1".to_owned());
    DeviceKey { kind, device_type: one.clone(), serial_number: one, is_virtual: true }
}

fn confirm_plan(seen: Option<CycleCount>, ops: &[u64], force_wear: bool) -> ApprovedPlan<Prepared> {
    let plan = Plan { base: (), ops: ops.iter().copied().map(Op).collect() };
    let consent = Consent::to(plan.id());
    ApprovedPlan { prepared: Prepared { kind: EntryKind::Write, seen, plan }, consent, force_wear, undoes: None }
}

fn write(
    spy: &mut Spy,
    agreed: &ApprovedPlan<Prepared>,
) -> Result<CommitResult<WrittenChanges>, WritePlanError<Prepared, Spy, ()>> {
    let (store, mut told) = (spy.store.clone(), Vec::new());
    let ended = write_plan(&store, true, agreed, spy, &mut |at| told.push((at.done, at.total, at.step.0)));
    let applied = spy.steps.iter().filter(|step| **step == "apply").count();
    let ops = (0..).zip(&agreed.prepared.plan.ops).map(|(at, op)| (at, agreed.prepared.plan.ops.len() as u64, op.0));
    assert_eq!(told, ops.take(applied).collect::<Vec<_>>(), "each is told before it begins");
    ended
}

#[test]
fn write_performs_steps_in_order() {
    let whole = vec!["confirm", "begin", "apply", "apply", "finish", "lead back"];
    let cases = [
        ("done", 0, false, false, whole, 3),
        ("cut off", 0, false, true, vec!["confirm", "begin", "apply", "apply", "lead back"], 1),
        ("refused", 0, true, false, vec!["confirm"], 0),
        ("worn", 9, false, false, vec![], 0),
    ];
    for (label, seen, refuses, ends_early, steps, spent) in cases {
        let root = tempfile::tempdir().unwrap();
        let mut spy = Spy::new(&Store::at_root(root.path()), refuses, ends_early);
        let ended = write(&mut spy, &confirm_plan(Some(CycleCount::complete(seen)), &[1, 2], false));
        assert_eq!(spy.steps, steps, "{label}");
        assert_eq!(known_cycles(&spy.store, &device()), Some(CycleCount::complete(spent)), "{label}");
        match ended {
            Ok(done) => assert!(label == "done" && done.written.verified == 2 && done.logbook_warning.is_none()),
            Err(JobError::Interrupted { interrupted, backup, planned: 2, kind: 'k' }) => {
                assert!(label == "cut off" && interrupted.cause == Cancelled && backup.exists());
                assert_eq!((interrupted.unfinished.map(|op| op.0), interrupted.end_state), (Some(2), "as it was"));
            }
            Err(JobError::Device(())) => assert_eq!(label, "refused"),
            Err(JobError::NotStarted(NotStarted::Worn { seen: 9, cost: 3, limit: 10 })) => assert_eq!(label, "worn"),
            Err(_) => panic!("{label}"),
        }
    }
}

#[test]
fn write_requires_operations_and_matching_consent() {
    let root = tempfile::tempdir().unwrap();
    let mut spy = Spy::new(&Store::at_root(root.path()), false, false);
    let done = write(&mut spy, &confirm_plan(Some(CycleCount::complete(0)), &[], false)).ok().unwrap();
    assert_eq!((done.written, done.backup), (WrittenChanges::default(), None));
    let consent = confirm_plan(Some(CycleCount::complete(0)), &[2], false).consent;
    let ended = write(&mut spy, &ApprovedPlan { consent, ..confirm_plan(Some(CycleCount::complete(0)), &[1], false) });
    assert!(matches!(ended, Err(JobError::NotStarted(NotStarted::OtherPlan))) && spy.steps.is_empty());
}

/// An unknown count is not 0: the write begins only if forced, and then reports the logbook error (issue 22.4).
#[test]
fn unusable_logbook_prevents_write() {
    /// A device that checks nothing.
    struct Plain(u32);
    impl Write for Plain {
        type Base = ();
        type Op = Op;
        type Error = Cancelled;
        type Written = WrittenChanges;
        type EndState = ();
        fn confirm_base(&mut self, _: &Plan<(), Op>) -> Result<(), ()> {
            Ok(())
        }
        fn apply(&mut self, _: &Op, _: &ConfirmedPlan<'_, (), Op>, _: &mut WrittenChanges) -> Result<(), Cancelled> {
            self.0 += 1;
            Ok(())
        }
        fn end_state(&mut self, _: &Cancelled) {}
    }
    let root = tempfile::tempdir().unwrap();
    let store = Store::at_root(root.path());
    std::fs::create_dir_all(store.logbook_path()).unwrap();
    let seen = known_cycles(&store, &device());
    assert_eq!(seen, None);
    let write = |plain: &mut Plain, agreed| -> Result<_, WritePlanError<Prepared, Plain, ()>> {
        write_plan(&store, true, &agreed, plain, &mut |_| {})
    };
    // Not read; or read before and not to be written now.
    for seen in [seen, Some(CycleCount::complete(0))] {
        let mut plain = Plain(0);
        let ended = write(&mut plain, confirm_plan(seen, &[2], false));
        let refused = matches!(ended, Err(JobError::NotStarted(NotStarted::WearUnknown { cost: 2 })));
        assert!(refused && plain.0 == 0, "{seen:?}");
        let Ok(done) = write(&mut plain, confirm_plan(seen, &[2], true)) else { panic!("{seen:?}") };
        assert!(done.logbook_warning.is_some() && plain.0 == 1, "{seen:?}");
        // An operation without cost causes no wear.
        assert!(write(&mut plain, confirm_plan(seen, &[0], false)).is_ok() && plain.0 == 2, "{seen:?}");
    }
}

/// While the logbook server is unreachable, writing to a memory that wears out quickly needs permission (issue 30).
#[test]
fn incomplete_count_requires_permit() {
    let seen = Some(CycleCount { seen: 7, is_complete: false });
    for (limit, cost, refused) in
        [(449, 1, true), (1_000, 2, true), (449, 0, false), (1_000_000, 1, false), (u64::MAX, 1, false)]
    {
        assert_eq!(is_incomplete(seen, cost, limit), refused, "{cost} of {limit}");
        assert_eq!(check_wear(seen, cost, limit, false).is_err(), refused, "{cost} of {limit}");
        assert!(
            check_wear(seen, cost, limit, true).is_ok() && !is_incomplete(Some(CycleCount::complete(7)), cost, limit)
        );
    }
    assert!(matches!(check_wear(seen, 443, 449, false), Err(NotStarted::Worn { seen: 7, .. })), "worn in any case");
}

#[test]
fn operations_announce_undo() {
    let undos = |kind: EntryKind| {
        let agreed = confirm_plan(None, &[0, 1, 3, 4], false);
        let prepared = Prepared { kind, ..agreed.prepared };
        prepared.undos()
    };
    let again = Some(Undo::AnotherWrite { value: "40".to_owned(), cycles: 3 });
    let code = Some(Undo::Never(Redo::ChangeCode));
    // Without a value and without a cost, nothing is changed.
    assert_eq!(undos(EntryKind::Write), [None, Some(Undo::Exactly), again.clone(), code.clone()]);
    assert_eq!(undos(EntryKind::Procedure), [None, Some(Undo::RestoreBackup), again, code]);
    let position = Some(Undo::Never(Redo::SetPosition));
    assert_eq!(undos(EntryKind::Preset), [None, position.clone(), position.clone(), position]);
}
