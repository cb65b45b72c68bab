//! The review of a write, for every kind of device: what it would do, the consent, how far it is, and what came of it.

use std::path::PathBuf;

use super::Text;
use crate::profile::PlanId;

/// A write on its way: `C` is what the user wants, `P` what was read and planned for it, `D` what came of it.
pub struct Review<C, P, D> {
    /// What the user wants.
    pub what: Text,
    /// How far it is.
    pub state: ReviewState<P, D>,
    /// Write although the device counts as worn.
    pub force_wear: bool,
    /// What is wanted was made for another device.
    pub is_for_another: bool,
    pub(in crate::app) change: C,
}

/// How far a write is.
pub enum ReviewState<P, D> {
    /// The device is read and the plan made.
    Planning,
    /// The plan is shown.
    Ready(Box<P>),
    /// It is being carried out.
    Writing(Box<P>),
    /// It was carried out and read back.
    Done(Box<P>, D),
    /// It cannot be done, or ended early: what happened, and what to do.
    Failed {
        /// In words.
        texts: Vec<Text>,
        /// Something was written before it ended.
        begun: bool,
    },
}

impl<C, P, D> Review<C, P, D> {
    pub(in crate::app) fn new(what: Text, change: C, is_for_another: bool) -> Self {
        Review { what, state: ReviewState::Planning, force_wear: false, is_for_another, change }
    }

    /// The plan as it was shown, from then to its end.
    pub fn prepared(&self) -> Option<&P> {
        match &self.state {
            ReviewState::Ready(prepared) | ReviewState::Writing(prepared) | ReviewState::Done(prepared, _) => {
                Some(prepared)
            }
            ReviewState::Planning | ReviewState::Failed { .. } => None,
        }
    }

    /// The plan is being made.
    pub fn is_planning(&self) -> bool {
        matches!(self.state, ReviewState::Planning)
    }

    /// It is being carried out.
    pub fn is_writing(&self) -> bool {
        matches!(self.state, ReviewState::Writing(_))
    }

    /// It has not begun to be carried out, and has not failed.
    pub(in crate::app) fn is_plan(&self) -> bool {
        matches!(self.state, ReviewState::Planning | ReviewState::Ready(_))
    }

    /// It ended early.
    pub(in crate::app) fn fail(&mut self, texts: Vec<Text>, begun: bool) {
        self.state = ReviewState::Failed { texts, begun };
    }
}

/// An operation of a plan in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpWords {
    /// What it changes.
    pub item: Text,
    /// Each thing that it changes, in its order; at least one.
    pub changes: Vec<ChangeWords>,
}

/// One thing that an operation changes, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChangeWords {
    /// Which part of the item; `None`: all of it.
    pub part: Option<Text>,
    /// What is there now.
    pub old: Text,
    /// What will be there.
    pub new: Text,
}

impl OpWords {
    /// An operation that changes one thing.
    pub fn one(item: Text, old: Text, new: Text) -> Self {
        OpWords { item, changes: vec![ChangeWords { part: None, old, new }] }
    }

    /// All its texts.
    pub fn texts(&self) -> impl Iterator<Item = &Text> {
        let changes = self.changes.iter().flat_map(|own| own.part.iter().chain([&own.old, &own.new]));
        std::iter::once(&self.item).chain(changes)
    }
}

/// What the user may allow beyond the usual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Permit {
    /// To write what was made for another device.
    OtherDevice,
    /// To write what belongs to the mounting of another device.
    Mounting,
    /// To delete and create again.
    Recreate,
}

/// Something that the user may allow beyond the usual, and that makes another plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Toggle {
    /// What.
    pub permit: Permit,
    /// It is allowed.
    pub is_on: bool,
}

impl Permit {
    /// Its words, as a row of the texts.
    pub const fn word(self) -> &'static str {
        match self {
            Permit::OtherDevice => "review.allow_other",
            Permit::Mounting => "review.with_mounting",
            Permit::Recreate => "review.recreate",
        }
    }

    /// What it means, as a row of the texts.
    pub const fn hint(self) -> Option<&'static str> {
        match self {
            Permit::OtherDevice => None,
            Permit::Mounting => Some("review.with_mounting_hint"),
            Permit::Recreate => Some("review.recreate_hint"),
        }
    }
}

/// How a plan is carried out, and what starts it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manner {
    /// From end to end.
    Writes,
    /// Step by step, with somebody at the device.
    Leads,
    /// Step by step, and nothing is written.
    Tests,
}

impl Manner {
    /// What starts it, as a row of the texts.
    pub const fn word(self) -> &'static str {
        match self {
            Manner::Writes => "review.write",
            Manner::Leads => "review.begin",
            Manner::Tests => "review.test",
        }
    }

    /// What will be done, as a row of the texts.
    pub const fn way(self) -> &'static str {
        match self {
            Manner::Writes => "review.way",
            Manner::Leads => "review.way_led",
            Manner::Tests => "review.way_test",
        }
    }
}

/// A review as a person sees it, whatever the device.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// What the user wants.
    pub what: Text,
    /// How far it is.
    pub stage: Stage,
    /// The operations.
    pub lines: Vec<OpWords>,
    /// What should make somebody stop and look.
    pub warnings: Vec<Text>,
    /// What the plan needs from the person in front of the device.
    pub needs: Vec<Text>,
    /// What it costs, beside what this computer has seen the device take.
    pub cost: Option<Text>,
    /// How it is carried out.
    pub manner: Manner,
    /// What may be allowed beyond the usual.
    pub toggles: Vec<Toggle>,
    /// The device counts as worn after it: whether it is to be written all the same.
    pub force_wear: Option<bool>,
}

/// How far a review is.
#[derive(Clone, Debug)]
pub enum Stage {
    /// The device is read and the plan made.
    Planning,
    /// There is nothing to do.
    Nothing,
    /// The plan is shown.
    Ready(PlanId),
    /// It is being carried out: operations that are done.
    Writing(usize),
    /// It was carried out.
    Done {
        /// That it was read back.
        verified: Text,
        /// The before-image.
        backup: Option<PathBuf>,
        /// What the logbook could not take.
        logbook: Option<Text>,
    },
    /// It cannot be done, or ended early.
    Failed {
        /// What happened, and what to do.
        texts: Vec<Text>,
        /// Something was written before it ended.
        begun: bool,
    },
}

/// What a kind of device says about its reviews.
pub trait Reviewed {
    /// What was read and planned.
    type Prepared;
    /// What came of it.
    type Done;

    /// The plan; `None` where there is nothing to do.
    fn plan(prepared: &Self::Prepared) -> Option<PlanId>;
    /// Its operations.
    fn lines(prepared: &Self::Prepared) -> Vec<OpWords>;
    /// What should make somebody stop and look.
    fn warnings(&self, prepared: &Self::Prepared) -> Vec<Text>;
    /// What it needs from the person in front of the device.
    fn needs(&self, prepared: &Self::Prepared) -> Vec<Text>;
    /// What it costs.
    fn cost(prepared: &Self::Prepared) -> Text;
    /// How it is carried out.
    fn manner(prepared: &Self::Prepared) -> Manner;
    /// The device counts as worn after it.
    fn is_worn(prepared: &Self::Prepared) -> bool;
    /// What may be allowed beyond the usual.
    fn toggles(&self) -> Vec<Toggle>;
    /// That it was read back, the before-image, what the logbook could not take.
    fn done(done: &Self::Done) -> (Text, Option<PathBuf>, Option<Text>);
}

impl<C, P, D> Review<C, P, D>
where
    Review<C, P, D>: Reviewed<Prepared = P, Done = D>,
{
    /// The review as a person sees it; `done` operations have been carried out.
    pub(in crate::app) fn sheet(&self, done: usize) -> Sheet {
        let prepared = self.prepared();
        let is_over = matches!(self.state, ReviewState::Done(..));
        let plan = prepared.and_then(Self::plan);
        let stage = match &self.state {
            ReviewState::Planning => Stage::Planning,
            ReviewState::Ready(_) => plan.map_or(Stage::Nothing, Stage::Ready),
            ReviewState::Writing(_) => Stage::Writing(done),
            ReviewState::Done(_, own) => {
                let (verified, backup, logbook) = Self::done(own);
                Stage::Done { verified, backup, logbook }
            }
            ReviewState::Failed { texts, begun } => Stage::Failed { texts: texts.clone(), begun: *begun },
        };
        let shown = prepared.filter(|_| !is_over);
        let costs = shown.filter(|_| plan.is_some());
        Sheet {
            what: self.what.clone(),
            stage,
            lines: prepared.map(Self::lines).unwrap_or_default(),
            warnings: shown.map(|own| self.warnings(own)).unwrap_or_default(),
            needs: shown.map(|own| self.needs(own)).unwrap_or_default(),
            cost: costs.map(Self::cost),
            manner: prepared.map_or(Manner::Writes, Self::manner),
            toggles: self.toggles(),
            force_wear: costs.filter(|own| Self::is_worn(own)).map(|_| self.force_wear),
        }
    }
}
