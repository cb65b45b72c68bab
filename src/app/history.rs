//! Undo and redo for any type of state. The owner stores the current state.

/// An undo history with the earlier and the undone states.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct History<T> {
    undo: Vec<T>,
    redo: Vec<T>,
}

impl<T> Default for History<T> {
    fn default() -> Self {
        History { undo: Vec::new(), redo: Vec::new() }
    }
}

impl<T> History<T> {
    /// Maximum number of steps that can be undone.
    const STEPS: usize = 200;

    pub(crate) fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    pub(crate) fn can_redo(&self) -> bool {
        !self.redo.is_empty()
    }

    /// Records the step that led from the state `before`. Undone steps are discarded.
    pub(crate) fn record_step(&mut self, before: T) {
        self.redo.clear();
        self.undo.push(before);
        if self.undo.len() > Self::STEPS {
            self.undo.remove(0);
        }
    }

    /// Undoes the last step by restoring the state before it in `now`. Returns `false` if there is none.
    pub(crate) fn undo(&mut self, now: &mut T) -> bool {
        let Some(before) = self.undo.pop() else { return false };
        self.redo.push(std::mem::replace(now, before));
        true
    }

    pub(crate) fn redo(&mut self, now: &mut T) -> bool {
        let Some(after) = self.redo.pop() else { return false };
        self.undo.push(std::mem::replace(now, after));
        true
    }

    pub(crate) fn clear_steps(&mut self) {
        *self = History::default();
    }

    pub(super) fn discard_undone_steps(&mut self) {
        self.redo.clear();
    }
}

impl<T: PartialEq> History<T> {
    /// Changes `now` to `after` and records the step. Returns `false` if nothing changes.
    pub(crate) fn apply_step(&mut self, now: &mut T, after: T) -> bool {
        if *now == after {
            return false;
        }
        self.record_step(std::mem::replace(now, after));
        true
    }

    /// Applies `follow` to the current state and all recorded ones, because the data on which they are based have
    /// changed. Steps without any remaining effect are removed.
    pub(crate) fn update_all_states(&mut self, now: &mut T, follow: impl Fn(&mut T)) {
        self.undo.iter_mut().for_each(&follow);
        follow(now);
        self.redo.clear();
        self.undo.dedup();
        self.undo.pop_if(|last| *last == *now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn new_step_ends_redo() {
        let (mut history, mut now) = (History::default(), 1);
        assert!(history.apply_step(&mut now, 2) && history.apply_step(&mut now, 3) && !history.apply_step(&mut now, 3));
        assert!(history.undo(&mut now) && now == 2 && history.can_redo());
        assert!(history.redo(&mut now) && now == 3 && !history.can_redo());
        assert!(history.undo(&mut now) && history.undo(&mut now) && now == 1 && !history.undo(&mut now));
        assert!(history.apply_step(&mut now, 4) && !history.redo(&mut now), "another way was taken");
        history.clear_steps();
        assert!(!history.can_undo() && now == 4);
    }

    #[test]
    fn undoes_last_two_hundred_steps() {
        let (mut history, mut now) = (History::default(), 0);
        (1..=250).for_each(|after| assert!(history.apply_step(&mut now, after)));
        while history.undo(&mut now) {}
        assert_eq!(now, 50);
    }

    #[test]
    fn rebase_drops_undo_steps() {
        let (mut history, mut now) = (History::default(), 1);
        for after in [2, 3, 14] {
            history.apply_step(&mut now, after);
        }
        history.undo(&mut now);
        // 1, 2 and 3 all become 0.
        history.update_all_states(&mut now, |own| *own /= 10);
        assert!(now == 0 && !history.can_undo() && !history.can_redo());
    }
}
