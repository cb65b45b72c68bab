//! The set-up of an axis as one run: from a drive that nobody has asked for to limits in millimetres that have survived the
//! supply. A state machine over what is read ([`Seen`]) and what is to be done ([`Ask`]); it does nothing itself, and no step
//! goes on before its drive says what the step is about.
//!
//! Parameters are tried, which means that they are written and read back, but not saved: that is a step of its own, the last
//! but one. Whoever ends the run before it has changed nothing that lasts.

mod entries;
mod follow;
mod gate;
mod places;
pub mod words;

#[cfg(test)]
mod tests;

pub use entries::{Entries, Preview, Reference};
pub use places::{Outcome, Place, Travel};

use super::ruler::Ruler;
use crate::device::hiperdrive::dead_man::{Ended, Lock};
use crate::protocol::hiperdrive::{Actual, Direction, DriveNumber, Family, PositionScale};

/// A step of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Step {
    /// The drive is requested: parameter 152.
    Request,
    /// Pitch and resolution become parameters 154 and 156.
    Scale,
    /// The limits that hold for the set-up are looked at, in millimetres.
    Confirm,
    /// The axis is moved slowly, to see which way is +.
    Jog,
    /// The place where it stands gets its position: parameter 198.
    Reference,
    /// The lower limit is taught.
    Lower,
    /// The upper limit is taught, and both are written: parameters 158 and 160.
    Upper,
    /// It is moved between the limits, and to both.
    Test,
    /// Everything is saved: 47 = 1.
    Save,
    /// The supply is switched off and on.
    PowerCycle,
}

/// What is known of the drive at a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// The device answers.
    pub connected: bool,
    /// It is asked for something, or a review is open.
    pub busy: bool,
    /// Its parameters may be others than those that were read.
    pub stale: bool,
    /// It is a virtual one.
    pub is_virtual: bool,
    /// The cyclic connection is open.
    pub controlled: bool,
    /// Something moves, or is about to.
    pub moves: bool,
    /// What turns in speed mode, which way.
    pub turns: Option<Direction>,
    /// What the drive said last.
    pub actual: Option<Actual>,
    /// Parameter 152.
    pub requested: Option<bool>,
    /// Parameters 154 and 156.
    pub scale: Option<PositionScale>,
    /// Parameters 158 and 160.
    pub limits: Option<(i32, i32)>,
    /// How far it turns.
    pub family: Option<Family>,
    /// Why it may not move.
    pub locks: Vec<Lock>,
    /// The last act of a person that is over.
    pub ended: Option<(u64, Ended)>,
}

/// What is to be done for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ask {
    /// Parameters, by the numbers of drive 1, are written through a plan that does not save.
    Try(Vec<(u16, i64)>),
    /// The place where the drive stands gets this position, which is not saved.
    SetPosition(i32),
    /// Somebody has seen what the limits are.
    ConfirmLimits,
    /// The drive moves slowly.
    Move(i32),
    /// The cyclic connection is opened.
    Take,
    /// It is closed.
    Give,
    /// Everything is saved.
    Save,
    /// What was saved last counts again.
    Recall,
    /// The virtual device's supply goes and comes back.
    PowerCycle,
}

/// What can be pressed, beside what moves while it is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// What the step is about: request, write, save.
    Do,
    /// The limits are right.
    Confirm,
    /// The limits are to be as wide as the drive turns.
    Widen,
    /// A test move.
    Go(Place),
    /// The cyclic connection.
    Take,
    /// It is closed.
    Give,
    /// The virtual supply.
    PowerCycle,
    /// Back to what was saved.
    Recall,
}

/// What a person does in the run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Action {
    /// Begin it, or begin it again.
    Begin,
    /// Something was typed.
    Edit(Box<Entries>),
    /// A button.
    Press(Button),
    /// The place where the axis is becomes the limit of the step.
    TakePlace,
    /// To the next step.
    Next,
    /// To the next one without this one.
    Skip,
    /// To the one before.
    Back,
    /// End it: the drive stops.
    Cancel,
}

/// How far a step is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reached {
    /// It is over.
    Done,
    /// It counts now.
    Now,
    /// It was left out.
    Skipped,
    /// It did not hold.
    Failed,
    /// It comes later.
    Ahead,
}

/// How the run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// To its end.
    Done,
    /// Somebody has cancelled it.
    Cancelled,
}

/// What has been changed, in its order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// A parameter, by the number of drive 1.
    Parameter(u16, i64),
    /// The position of a place.
    Position(i32),
}

/// What is known before the supply goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Before {
    scale: Option<PositionScale>,
    limits: Option<(i32, i32)>,
    position: Option<i32>,
}

/// What came of the supply's going and coming back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Power {
    /// The device still answers.
    On(Before),
    /// It has stopped answering, or its parameters were not read since.
    Gone(Before),
    /// It is back.
    Back {
        /// What was saved is there.
        kept: bool,
        /// Steps between where it stood and where it stands; `None` where one of them is not known.
        moved: Option<i64>,
        /// So many are allowed.
        allowed: i64,
    },
}

/// The run for one drive.
#[derive(Clone, Debug)]
pub struct Axis {
    drive: DriveNumber,
    step: Step,
    /// What is typed.
    entries: Entries,
    /// The spindle is known from before: what is typed is no mere proposal.
    spindle_known: bool,
    /// The scale under which the limits were confirmed, and those.
    confirmed: Option<(PositionScale, (i32, i32))>,
    travel: Travel,
    /// What the place got: `None`: nothing yet.
    reference: Option<i32>,
    skipped: Vec<Step>,
    outcomes: [Option<Outcome>; 3],
    /// The test move under way: where it leads, and the act that began it.
    going: Option<(Place, i32, u64)>,
    changes: Vec<Change>,
    /// Not all of the changes may have been made.
    partly: bool,
    saved: bool,
    /// What is being written.
    asked: Option<Ask>,
    power: Option<Power>,
    /// The drive does not say any more what an earlier step has made sure of.
    fell_back: bool,
    end: Option<End>,
}

impl Step {
    /// All steps in their order.
    pub const ALL: [Step; 10] = [
        Step::Request,
        Step::Scale,
        Step::Confirm,
        Step::Jog,
        Step::Reference,
        Step::Lower,
        Step::Upper,
        Step::Test,
        Step::Save,
        Step::PowerCycle,
    ];

    /// It needs the cyclic connection.
    pub const fn moves(self) -> bool {
        matches!(self, Step::Jog | Step::Reference | Step::Lower | Step::Upper | Step::Test)
    }

    /// The drive is moved by hand in it.
    pub const fn jogs(self) -> bool {
        matches!(self, Step::Jog | Step::Reference | Step::Lower | Step::Upper)
    }

    /// It may be left out.
    pub const fn may_be_skipped(self) -> bool {
        matches!(self, Step::Reference | Step::PowerCycle)
    }

    fn beside(self, by: isize) -> Option<Step> {
        let at = Step::ALL.iter().position(|own| *own == self)?;
        Step::ALL.get(at.checked_add_signed(by)?).copied()
    }
}

impl Axis {
    /// At its beginning, with what is known of the spindle.
    pub fn new(drive: DriveNumber, ruler: Option<Ruler>) -> Self {
        Axis {
            drive,
            step: Step::Request,
            entries: Entries::new(ruler),
            spindle_known: ruler.is_some_and(|own| own.pitch.is_some()),
            confirmed: None,
            travel: Travel::default(),
            reference: None,
            skipped: Vec::new(),
            outcomes: [None; 3],
            going: None,
            changes: Vec::new(),
            partly: false,
            saved: false,
            asked: None,
            power: None,
            fell_back: false,
            end: None,
        }
    }

    /// Whose it is.
    pub const fn drive(&self) -> DriveNumber {
        self.drive
    }

    /// The step that counts.
    pub const fn step(&self) -> Step {
        self.step
    }

    /// What is typed.
    pub const fn entries(&self) -> &Entries {
        &self.entries
    }

    /// How it ended; `None`: it goes on.
    pub const fn end(&self) -> Option<End> {
        self.end
    }

    /// What was changed, the first first. It lasts only where it was saved.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// A write ended early: some of the changes may not have been made.
    pub const fn is_partly_written(&self) -> bool {
        self.partly
    }

    /// All that was changed is saved.
    pub const fn is_saved(&self) -> bool {
        self.saved
    }

    /// Something is being written for it.
    pub const fn is_writing(&self) -> bool {
        self.asked.is_some()
    }

    /// How far the axis was moved by hand.
    pub const fn travel(&self) -> Travel {
        self.travel
    }

    /// The position that was set.
    pub const fn reference(&self) -> Option<i32> {
        self.reference
    }

    /// What came of a test move.
    pub fn outcome(&self, place: Place) -> Option<Outcome> {
        self.outcomes.get(place as usize).copied().flatten()
    }

    /// The test move under way.
    pub fn going(&self) -> Option<Place> {
        self.going.map(|(place, ..)| place)
    }

    /// What came of the supply.
    pub const fn power(&self) -> Option<Power> {
        self.power
    }

    /// An earlier step has to be done again, because the drive does not have any more what it made sure of.
    pub const fn fell_back(&self) -> bool {
        self.fell_back
    }

    /// How steps are measured: with the scale that the drive has, on the spindle that is known or was typed. What is only
    /// proposed measures nothing.
    pub fn ruler(&self, seen: &Seen) -> Option<Ruler> {
        let typed = self.spindle_known || self.step > Step::Scale;
        Some(Ruler { scale: seen.scale?, pitch: self.entries.pitch().ok().filter(|_| typed) })
    }

    /// How far each step is.
    pub fn reached(&self, step: Step) -> Reached {
        match step {
            _ if self.skipped.contains(&step) && step != self.step => Reached::Skipped,
            Step::PowerCycle if matches!(self.power, Some(Power::Back { .. })) && !self.survived() => Reached::Failed,
            _ if step < self.step || self.end == Some(End::Done) => Reached::Done,
            _ if step == self.step && self.end.is_none() => Reached::Now,
            _ => Reached::Ahead,
        }
    }

    /// What was saved is there after the supply was gone, and the axis stands where it stood.
    pub fn survived(&self) -> bool {
        matches!(self.power, Some(Power::Back { kept: true, moved: Some(moved), allowed }) if moved.abs() <= allowed)
    }
}
