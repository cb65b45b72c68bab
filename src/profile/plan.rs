//! Plans, the only way to write to a device: read → difference → plan → consent to this plan → write → read back.

use std::hash::{DefaultHasher, Hash, Hasher};

/// A planned write for the user to review. Only the operations in the plan are executed.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Plan<Base, Op> {
    /// The values on which the plan is based. They are read again before the first operation and must be unchanged.
    pub base: Base,
    /// Operations in order of execution.
    pub ops: Vec<Op>,
}

/// An operation of a plan.
pub trait Operation {
    /// Returns how many persistent writes the operation needs if nothing has to be repeated.
    fn write_cycles(&self) -> u64;
}

/// The identifier by which a consent refers to a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanId(u64);

impl<Base: Hash, Op: Hash> Plan<Base, Op> {
    /// Returns the identifier of the plan, which is a hash of its base and operations.
    pub fn id(&self) -> PlanId {
        let mut hasher = DefaultHasher::new();
        self.hash(&mut hasher);
        PlanId(hasher.finish())
    }
}

impl<Base, Op> Plan<Base, Op> {
    /// Returns whether the plan contains no operations.
    pub fn is_empty(&self) -> bool {
        self.ops.is_empty()
    }
}

impl<Base, Op: Operation> Plan<Base, Op> {
    /// Returns how many persistent writes the plan needs if nothing has to be repeated.
    pub fn write_cycles(&self) -> u64 {
        self.ops.iter().map(Operation::write_cycles).sum()
    }
}

/// The user's consent to a plan. Only the window and the command line create one.
#[derive(Clone, Copy, Debug)]
pub struct Consent(PlanId);

impl Consent {
    /// Creates the consent of a user who has approved the plan with this identifier.
    pub fn to(plan: PlanId) -> Self {
        Consent(plan)
    }

    /// Returns whether the consent applies to a plan.
    pub fn covers(self, plan: PlanId) -> bool {
        self.0 == plan
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Hash)]
    enum Step {
        Try,
        Save,
        SaveTwice,
    }

    impl Operation for Step {
        fn write_cycles(&self) -> u64 {
            match self {
                Step::Try => 0,
                Step::Save => 1,
                Step::SaveTwice => 2,
            }
        }
    }

    #[test]
    fn plan_cost_sums_operations() {
        let plan = |ops: &[Step]| Plan { base: (), ops: ops.to_vec() };
        assert_eq!(plan(&[Step::Save, Step::Try, Step::SaveTwice, Step::Save]).write_cycles(), 4);
        assert!(plan(&[]).is_empty());
        let free = plan(&[Step::Try]);
        assert_eq!((free.write_cycles(), free.is_empty()), (0, false), "what costs nothing is done all the same");
        assert_ne!(free.id(), plan(&[Step::Save]).id());
    }

    #[test]
    fn consent_covers_only_shown_plan() {
        let shown = Plan { base: 1, ops: vec!["a", "b"] };
        let consent = Consent::to(shown.id());
        assert!(consent.covers(shown.clone().id()));
        assert!(!consent.covers(Plan { base: 2, ops: vec!["a", "b"] }.id()));
        assert!(!consent.covers(Plan { base: 1, ops: vec!["b", "a"] }.id()));
    }
}
