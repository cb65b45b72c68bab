//! The review of a write before it is executed, for any kind of device. It shows the effect, asks for approval, and
//! reports the result.

mod notices;
mod permit;
mod undone;

use std::path::PathBuf;

pub use notices::redo;
pub(crate) use notices::{skipped_item_messages, undo_texts};
pub use permit::{Permit, PermitToggle};
pub use undone::UndoneEntry;

use super::session::Kind;
use super::{Severity, Text, explain};
use crate::profile::{Plan, PlanId};
use crate::store::EntryUid;
use crate::worker::commit::PlannedWrite;
use crate::worker::{CommitResult, is_incomplete, is_uncounted};

pub struct Review<K: Reviewable> {
    pub title: Text,
    pub state: ReviewState<K>,
    /// Whether to write although the device has reached its limit of write cycles.
    pub force_wear: bool,
    pub is_for_another: bool,
    /// Whether the change was made for another type of device.
    pub is_for_other_type: bool,
    pub(crate) change: K::Change,
    /// Permissions that affect the plan, and whether each one is granted.
    permits: Vec<PermitToggle>,
    /// Logbook entry that the write undoes, if any.
    undone: Option<UndoneEntry>,
}

pub enum ReviewState<K: Reviewable> {
    Planning,
    Ready(Box<K::Prepared>),
    Writing(Box<K::Prepared>),
    /// The plan was executed, and the values were read back.
    Done(Box<K::Prepared>, CommitResult<K::Written>),
    /// The write is impossible or was aborted.
    Failed {
        /// Messages that state what happened and what to do.
        texts: Vec<Text>,
        /// Whether the device had been written to before the write was aborted.
        begun: bool,
        /// The plan that was being executed, and the number of operations known to be complete.
        cut_off: Option<(Box<K::Prepared>, usize)>,
    },
}

impl<K: Reviewable> Review<K> {
    pub(crate) fn new(mut change: K::Change, is_for_another: bool, is_for_other_type: bool) -> Self {
        let own = |permit| K::permit_flag(&mut change, permit).map(|own| PermitToggle { permit, is_on: *own });
        let permits = Permit::ALL.into_iter().filter_map(own).collect();
        let what = K::change_title(&change);
        Review {
            title: what,
            state: ReviewState::Planning,
            force_wear: false,
            is_for_another,
            is_for_other_type,
            change,
            permits,
            undone: None,
        }
    }

    /// Turns this into the review of an undo, which may never be written to another device.
    pub(in crate::app) fn undoing(mut self, undone: UndoneEntry) -> Self {
        self.title = undone.title();
        self.permits.clear();
        self.undone = Some(undone);
        self
    }

    /// Returns the logbook entry that the write undoes, if any.
    pub(in crate::app) fn undone_entry(&self) -> Option<&EntryUid> {
        self.undone.as_ref().map(UndoneEntry::uid)
    }

    /// Returns a review of the given change, still without a plan.
    pub(crate) fn renewed(&self, change: K::Change) -> Self {
        let again = Review::new(change, self.is_for_another, self.is_for_other_type);
        match &self.undone {
            Some(undone) => again.undoing(undone.clone()),
            None => again,
        }
    }

    /// Adopts a plan, unless it undoes a write whose values have changed since then. An undo reports skipped items only
    /// if they belong to the original write.
    pub(in crate::app) fn adopt_plan(&mut self, mut prepared: Box<K::Prepared>) {
        if let Some(undone) = &self.undone {
            if let Some(texts) = undone.rejection(&*prepared) {
                return self.abort(texts, false, 0);
            }
            K::retain_missing(&mut prepared, &|item| undone.concerns(item));
        }
        self.state = ReviewState::Ready(prepared);
    }

    /// Returns the displayed plan. It is available until the review fails.
    pub fn prepared_plan(&self) -> Option<&K::Prepared> {
        match &self.state {
            ReviewState::Ready(prepared) | ReviewState::Writing(prepared) | ReviewState::Done(prepared, _) => {
                Some(prepared)
            }
            ReviewState::Planning | ReviewState::Failed { .. } => None,
        }
    }

    pub(crate) fn plan_in_progress(&self) -> Option<&K::Prepared> {
        self.prepared_plan().filter(|_| self.is_writing())
    }

    pub fn is_planning(&self) -> bool {
        matches!(self.state, ReviewState::Planning)
    }

    pub fn is_writing(&self) -> bool {
        matches!(self.state, ReviewState::Writing(_))
    }

    /// Returns whether a plan has been requested or is ready, but has not been started.
    pub(in crate::app) fn has_pending_plan(&self) -> bool {
        matches!(self.state, ReviewState::Planning | ReviewState::Ready(_))
    }

    /// Aborts the review. `done` is the number of completed operations, if the execution had begun.
    pub(in crate::app) fn abort(&mut self, texts: Vec<Text>, begun: bool, done: usize) {
        let cut_off = self.plan_in_progress().filter(|_| begun).cloned().map(|prepared| (Box::new(prepared), done));
        self.state = ReviewState::Failed { texts, begun, cut_off };
    }

    /// Returns the change with a permission granted or withdrawn. Returns `None` for an undo, which has no permissions.
    pub(crate) fn with_toggled_permit(&self, permit: Permit) -> Option<K::Change> {
        if self.undone.is_some() {
            return None;
        }
        let mut change = self.change.clone();
        let own = K::permit_flag(&mut change, permit)?;
        *own = !*own;
        Some(change)
    }

    fn warnings(&self, prepared: &K::Prepared) -> Vec<Text> {
        let of_undo = self.undone.iter().flat_map(UndoneEntry::warnings);
        of_undo.chain(K::warnings(prepared)).collect()
    }

    /// Returns the permissions to offer: those already granted, and those that would change the plan.
    fn permit_toggles(&self) -> Vec<PermitToggle> {
        let matters = |permit| match permit {
            Permit::OtherDevice => self.is_for_another,
            Permit::TypeMismatch => self.is_for_other_type,
            Permit::Mounting => self.prepared_plan().is_some_and(K::skips_mounting_values),
            Permit::Recreate => true,
            // This permission is requested with a question.
            Permit::Copy(_) => false,
        };
        self.permits.iter().copied().filter(|own| own.is_on || matters(own.permit)).collect()
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OperationDescription {
    pub item: Text,
    /// Changes in order, never empty.
    pub changes: Vec<ChangeDescription>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChangeDescription {
    /// Part of the item that is changed, or `None` for the whole item.
    pub part: Option<Text>,
    pub old: Text,
    pub new: Text,
}

impl OperationDescription {
    pub fn single(item: Text, old: Text, new: Text) -> Self {
        OperationDescription { item, changes: vec![ChangeDescription { part: None, old, new }] }
    }

    pub fn texts(&self) -> impl Iterator<Item = &Text> {
        let changes = self.changes.iter().flat_map(|own| own.part.iter().chain([&own.old, &own.new]));
        std::iter::once(&self.item).chain(changes)
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    pub title: Text,
    /// Label of the button that denies the permission.
    pub no: Text,
    pub yes: Text,
    pub permit: Permit,
    pub is_on: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExecutionMode {
    Writes,
    /// The plan is executed step by step, with actions by the user at the device.
    Guided,
    /// The plan only tests the device step by step, without writing to it.
    Tests,
}

impl ExecutionMode {
    pub const fn button_id(self) -> &'static str {
        match self {
            ExecutionMode::Writes => "review.write",
            ExecutionMode::Guided => "review.begin",
            ExecutionMode::Tests => "review.test",
        }
    }

    /// Returns the id of the text that describes what to do next.
    pub const fn summary_id(self) -> &'static str {
        match self {
            ExecutionMode::Writes => "review.way",
            ExecutionMode::Guided => "review.way_led",
            ExecutionMode::Tests => "review.way_test",
        }
    }
}

/// A review in displayable form, for any kind of device.
#[derive(Clone, Debug)]
pub struct ReviewSheet {
    pub title: Text,
    pub stage: Stage,
    pub lines: Vec<OperationDescription>,
    pub warnings: Vec<Text>,
    /// What the user has to do at the device for this plan.
    pub needs: Vec<Text>,
    /// States which values from another device must be set up again later, from planning to the end.
    pub redo: Option<Text>,
    /// Wear caused by this write, in addition to the write cycles counted so far.
    pub cost: Option<Text>,
    /// How the write can be undone later.
    pub undo: Vec<Text>,
    pub execution_mode: ExecutionMode,
    pub toggles: Vec<PermitToggle>,
    /// Questions that the user must answer before the plan is executed.
    pub questions: Vec<Question>,
    /// Whether to write although the device has reached its limit of write cycles, or the number of earlier cycles is
    /// unknown. `None` if the user need not decide.
    pub force_wear: Option<bool>,
    /// Whether the number of earlier write cycles is unknown.
    pub is_uncounted: bool,
    /// Whether write cycles are missing from the logbook and the memory wears out quickly.
    pub is_incomplete: bool,
}

#[derive(Clone, Debug)]
pub enum Stage {
    Planning,
    /// The plan does not contain any operations.
    Nothing,
    Ready(PlanId),
    /// The plan is being executed. Contains the number of completed operations.
    Writing(usize),
    Done {
        verified: Text,
        backup: Option<PathBuf>,
        logbook: Option<Text>,
    },
    /// The write is impossible or was aborted.
    Failed {
        texts: Vec<Text>,
        /// Whether the device had been written to before the write was aborted.
        begun: bool,
        done: usize,
    },
}

/// A kind of device with writable memory, and the texts for reviewing its writes.
pub trait Reviewable: Kind<Review = Review<Self>> {
    type Change: Clone;
    type Prepared: PlannedWrite + Clone;
    type Written;

    fn change_title(change: &Self::Change) -> Text;
    /// Returns the flag in a change that grants a permission, or `None` if the change has no such flag.
    fn permit_flag(change: &mut Self::Change, permit: Permit) -> Option<&mut bool>;
    fn operation_texts(prepared: &Self::Prepared, op: &Op<Self>) -> OperationDescription;
    /// Returns whether the write skips some values because they depend on how the device is mounted.
    fn skips_mounting_values(_prepared: &Self::Prepared) -> bool {
        false
    }

    /// Returns the written values that come from another device and must be set up again.
    fn redo(_prepared: &Self::Prepared) -> Vec<Text> {
        Vec::new()
    }

    fn questions(_prepared: &Self::Prepared) -> Vec<Question> {
        Vec::new()
    }

    /// Removes items that are not part of the write from the list of missing items. The default is for kinds of devices
    /// with complete backups.
    fn retain_missing(_prepared: &mut Self::Prepared, _concerns: &dyn Fn(&str) -> bool) {}

    fn warnings(_prepared: &Self::Prepared) -> Vec<Text> {
        Vec::new()
    }

    /// Returns what the user has to do at the device for this plan.
    fn requirements(_change: &Self::Change, _prepared: &Self::Prepared) -> Vec<Text> {
        Vec::new()
    }

    fn cost_text(prepared: &Self::Prepared) -> Text;

    /// Returns whether the device reaches its limit of write cycles with this plan.
    fn reaches_wear_limit(prepared: &Self::Prepared) -> bool {
        let seen = prepared.cycles_seen().map_or(0, |count| count.seen);
        seen.saturating_add(prepared.plan().write_cycles()) > prepared.wear_limit()
    }

    fn written_text(written: &Self::Written) -> Text;

    fn verified_text(written: &Self::Written) -> Text {
        Self::written_text(written)
    }

    fn execution_mode(_prepared: &Self::Prepared) -> ExecutionMode {
        ExecutionMode::Writes
    }
}

pub(crate) type Op<K> = <<K as Reviewable>::Prepared as PlannedWrite>::Op;

pub fn write_result_messages<K: Reviewable>(committed: &CommitResult<K::Written>) -> (Severity, Vec<Text>) {
    let text = K::written_text(&committed.written);
    match &committed.logbook_warning {
        Some(why) => (Severity::Warning, vec![text, explain::logbook_error_text(why)]),
        None => (Severity::Good, vec![text]),
    }
}

impl<K: Reviewable> Review<K> {
    /// Returns the review in displayable form, after `done` completed operations.
    pub fn to_sheet(&self, done: usize) -> ReviewSheet {
        self.review_sheet(done, K::operation_texts)
    }

    /// Returns the review in displayable form. `op` describes the operations for the connected device.
    pub(in crate::app) fn review_sheet(
        &self,
        done: usize,
        op: impl Fn(&K::Prepared, &Op<K>) -> OperationDescription,
    ) -> ReviewSheet {
        let prepared = self.prepared_plan();
        let cut_off = match &self.state {
            ReviewState::Failed { cut_off: Some((prepared, done)), .. } => Some((&**prepared, *done)),
            _ => None,
        };
        let carried = prepared.or(cut_off.map(|(prepared, _)| prepared));
        let is_over = matches!(self.state, ReviewState::Done(..));
        let plan = prepared.map(PlannedWrite::plan).filter(|plan| !plan.is_empty()).map(Plan::id);
        let stage = match &self.state {
            ReviewState::Planning => Stage::Planning,
            ReviewState::Ready(_) => plan.map_or(Stage::Nothing, Stage::Ready),
            ReviewState::Writing(_) => Stage::Writing(done),
            ReviewState::Done(_, own) => Stage::Done {
                verified: K::verified_text(&own.written),
                backup: own.backup.clone(),
                logbook: own.logbook_warning.as_ref().map(explain::logbook_error_text),
            },
            ReviewState::Failed { texts, begun, .. } => {
                Stage::Failed { texts: texts.clone(), begun: *begun, done: cut_off.map_or(0, |(_, done)| done) }
            }
        };
        let shown = prepared.filter(|_| !is_over);
        let costs = shown.filter(|_| plan.is_some());
        let uncounted = |own: &K::Prepared| is_uncounted(own.cycles_seen(), own.plan().write_cycles());
        let incomplete =
            |own: &K::Prepared| is_incomplete(own.cycles_seen(), own.plan().write_cycles(), own.wear_limit());
        let needs_permit = |own: &&K::Prepared| uncounted(own) || incomplete(own) || K::reaches_wear_limit(own);
        let lines = |own: &K::Prepared| own.plan().ops.iter().map(|own_op| op(own, own_op)).collect();
        let lines: Vec<OperationDescription> = carried.map(lines).unwrap_or_default();
        let items = || lines.iter().map(|line| line.item.clone());
        let undo = costs.map(|own| undo_texts(items().zip(own.undos()))).unwrap_or_default();
        ReviewSheet {
            title: self.title.clone(),
            stage,
            lines,
            warnings: shown.map(|own| self.warnings(own)).unwrap_or_default(),
            needs: shown.map(|own| K::requirements(&self.change, own)).unwrap_or_default(),
            redo: carried.and_then(|own| redo(K::redo(own))),
            cost: costs.map(K::cost_text),
            undo,
            execution_mode: prepared.map_or(ExecutionMode::Writes, K::execution_mode),
            toggles: self.permit_toggles(),
            questions: shown.map(K::questions).unwrap_or_default(),
            force_wear: costs.filter(needs_permit).map(|_| self.force_wear),
            is_uncounted: costs.is_some_and(uncounted),
            is_incomplete: costs.is_some_and(incomplete),
        }
    }
}
