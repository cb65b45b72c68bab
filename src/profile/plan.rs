//! The one way to write: read → difference → plan → consent to *this* plan → write → read back.

use std::hash::{DefaultHasher, Hash, Hasher};

/// What a write would do, for a person to look at. Nothing but its operations is carried out.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Plan<Base, Op> {
    /// What was read before; it is read again before the first operation and must be the same.
    pub base: Base,
    /// The operations, in the order in which they are carried out. Each is one persistent write.
    pub ops: Vec<Op>,
}

/// Which plan a consent is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanId(u64);

impl<Base: Hash, Op: Hash> Plan<Base, Op> {
    /// Two plans with another base or other operations have another id.
    pub fn id(&self) -> PlanId {
        let mut hasher = DefaultHasher::new();
        self.hash(&mut hasher);
        PlanId(hasher.finish())
    }

    /// Persistent writes it costs when nothing has to be repeated.
    pub fn write_cycles(&self) -> u64 {
        self.ops.len() as u64
    }

    /// There is nothing to do.
    pub fn is_empty(&self) -> bool {
        self.ops.is_empty()
    }
}

/// A person's consent to one plan. Only the window and the command line make one.
#[derive(Clone, Copy, Debug)]
pub struct Consent(PlanId);

impl Consent {
    /// The person has seen the plan with this id and wants it.
    pub fn to(plan: PlanId) -> Self {
        Consent(plan)
    }

    /// The consent is for this plan.
    pub fn covers(self, plan: PlanId) -> bool {
        self.0 == plan
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_consent_covers_the_plan_that_was_shown() {
        let shown = Plan { base: 1, ops: vec!["a", "b"] };
        let consent = Consent::to(shown.id());
        assert!(consent.covers(shown.clone().id()));
        assert!(!consent.covers(Plan { base: 2, ops: vec!["a", "b"] }.id()));
        assert!(!consent.covers(Plan { base: 1, ops: vec!["b", "a"] }.id()));
    }
}
