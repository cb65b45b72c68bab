//! The review of a write, for every kind of device: what it would do, the consent, how far it is, and what came of it.

use super::Text;

/// A write on its way: `C` is what the user wants, `P` what was read and planned for it, `D` what came of it.
pub struct Review<C, P, D> {
    /// What the user wants.
    pub what: Text,
    /// How far it is.
    pub state: ReviewState<P, D>,
    /// Write although the device counts as worn.
    pub force_wear: bool,
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
    pub(in crate::app) fn new(what: Text, change: C) -> Self {
        Review { what, state: ReviewState::Planning, force_wear: false, change }
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
