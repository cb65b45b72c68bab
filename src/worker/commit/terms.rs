//! The way of kinds that bring a loop over the operations of their own.

use super::{Committed, Intended, NotBegun, check_wear};
use crate::profile::{Operation, Plan};
use crate::store::{DeviceKey, Outcome, Store};
use crate::worker::{Interruption, JobError};

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
    let items = terms.items.join(", ");
    let intended = Intended::note(store, &terms.device, &items, terms.cost, &write.before_image());
    let intended = intended.map_err(NotBegun::NotKept)?;
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
